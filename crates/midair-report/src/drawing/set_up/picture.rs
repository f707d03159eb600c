//! The set-up in perspective.

use super::{Bounds, LIGHT, Pens, farthest_first, paint};
use crate::drawing::vector::{Anchor, Vector};
use midair::evaluate::layout::{Body, Layout, Role, View};

/// Width of the picture, mm, and the room around what is seen.
const WIDTH: f64 = 180.0;
const MARGIN: f64 = 12.0;
/// The tallest that it may become.
const TALLEST: f64 = 150.0;
/// Height of letters, mm.
const LETTERS: f64 = 4.0;

/// The set-up as an eye sees it from the viewer's right and above: bodies translucent, light from the display by way of the plate to the viewer,
/// names. The way to the viewer is cut off where it leaves the neighbourhood of the bodies.
pub fn picture(layout: &Layout, name: &str) -> String {
    let view = layout.oblique();
    let reach = reach(layout);
    let courses: Vec<Vec<[f64; 2]>> = layout
        .courses
        .iter()
        .map(|course| {
            let mut points = course.clone();
            if let [eye, next, ..] = points[..] {
                let way = eye - next;
                let length = way.length();
                // As much as the bodies themselves reach.
                if length > reach {
                    points[0] = next + way * (reach / length);
                }
            }
            points.iter().map(|&p| view.place(p)).collect()
        })
        .collect();
    let bodies = layout.bodies.iter().flat_map(Body::points).map(|p| view.place(p));
    let all = bodies.chain(courses.iter().flatten().copied());
    let Bounds([x, y]) = Bounds::of(all);
    let (across, up) = ((x[1] - x[0]).max(1e-9), (y[1] - y[0]).max(1e-9));
    let factor = ((WIDTH - 2.0 * MARGIN) / across).min(TALLEST / up);
    let height = up * factor + 2.0 * MARGIN;
    let left = 0.5 * (WIDTH - across * factor);
    let at = |p: [f64; 2]| [left + (p[0] - x[0]) * factor, MARGIN + (y[1] - p[1]) * factor];
    let mut vector = Vector::new([WIDTH, (height * 10.0).round() / 10.0]);
    for body in farthest_first(layout, &view) {
        let opacity = match body.role {
            Role::Display => 0.9,
            Role::Image | Role::Opaque => 0.75,
            Role::Plate | Role::Solid | Role::Mirror => 0.35,
        };
        paint(&mut vector, body, &view, &at, Pens { opacity, contour: 0.4, lines: 0.3 });
    }
    for course in &courses {
        let points: Vec<_> = course.iter().map(|&p| at(p)).collect();
        let style = format!(
            "fill=\"none\" stroke=\"{LIGHT}\" stroke-width=\"0.35\" stroke-opacity=\"0.85\""
        );
        vector.path(&points, false, &style);
    }
    names(&mut vector, layout, &view, &at);
    if let Some(&eye) = courses.first().and_then(|course| course.first()) {
        let [ex, ey] = at(eye);
        let anchor = if ex > 0.5 * WIDTH { Anchor::End } else { Anchor::Start };
        vector.text([ex, ey - 2.5], LETTERS, anchor, 0.0, "to the viewer");
    }
    vector.finish(&format!("{name}: the set-up"))
}

/// How far bodies reach from the image, mm.
fn reach(layout: &Layout) -> f64 {
    let far = |p: midair::geometry::Vec3| (p - layout.image).length();
    layout.bodies.iter().flat_map(Body::points).map(far).fold(1.0, f64::max)
}

/// Names beside their bodies, each moved away from those that stand already.
fn names(vector: &mut Vector, layout: &Layout, view: &View, at: &dyn Fn([f64; 2]) -> [f64; 2]) {
    let mut placed: Vec<([f64; 2], f64)> = Vec::new();
    for body in &layout.bodies {
        let seen = body.seen(view);
        let points = seen.contour.iter().chain(seen.lines.iter().flatten()).map(|&p| at(p));
        // At the lowest point for what lies below, at the highest for the rest.
        let lowest =
            points.clone().fold([0.0, f64::NEG_INFINITY], |a, p| if p[1] > a[1] { p } else { a });
        let highest = points.fold([0.0, f64::INFINITY], |a, p| if p[1] < a[1] { p } else { a });
        let below = body.role == Role::Display || body.role == Role::Mirror;
        let mut place = if below {
            [lowest[0], lowest[1] + 1.2 * LETTERS]
        } else {
            [highest[0], highest[1] - 0.5 * LETTERS]
        };
        let wide = 0.55 * LETTERS * body.name.chars().count() as f64;
        let step = if below { 0.5 } else { -0.5 };
        let meets = |p: [f64; 2], placed: &[([f64; 2], f64)]| {
            placed.iter().any(|(q, w)| {
                (p[0] - q[0]).abs() < 0.5 * (wide + w) + 1.0 && (p[1] - q[1]).abs() < LETTERS
            })
        };
        while meets(place, &placed) {
            place[1] += step;
        }
        place[0] = place[0].clamp(0.5 * wide + 1.0, WIDTH - 0.5 * wide - 1.0);
        placed.push((place, wide));
        vector.text(place, LETTERS, Anchor::Middle, 0.0, &body.name);
    }
}
