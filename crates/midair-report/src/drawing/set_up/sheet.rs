//! The dimensioned drawing: side and top view on one sheet of A4, true to scale.

use super::{Bounds, INK, LIGHT, Pens, farthest_first, paint};
use crate::drawing::vector::{Anchor, Vector};
use midair::evaluate::layout::{Body, Layout, Role, View};

/// The sheet, mm.
const SHEET: [f64; 2] = [210.0, 297.0];
const MARGIN: f64 = 10.0;
/// Room for measures at the left and right of the views, and under each of them.
const LEFT: f64 = 26.0;
const UNDER: f64 = 22.0;
const HEAD: f64 = 16.0;
/// For the table of parts: a line each.
const LINE: f64 = 4.6;
/// Height of letters, mm.
const LETTERS: f64 = 2.7;

/// Millimetres of the set-up to one of the sheet.
const SCALES: [f64; 14] =
    [0.1, 0.2, 0.5, 1.0, 2.0, 2.5, 4.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 1000.0];

/// The drawing of a set-up: its side above, its top below, both to one scale, which is written on it; light's way; distances between the parts'
/// middles in chains; and a table of the parts. Printed at its own size (A4) it is true to scale.
pub fn drawing(layout: &Layout, name: &str) -> String {
    let views = [layout.side(), layout.top()];
    let bodies = |view: &View| {
        let place = |p| view.place(p);
        Bounds::of(layout.bodies.iter().flat_map(Body::points).map(place))
    };
    let mut bounds = views.each_ref().map(bodies);
    let table = (layout.bodies.len() + 2) as f64 * LINE;
    let room = [
        SHEET[0] - 2.0 * MARGIN - LEFT,
        SHEET[1] - 2.0 * MARGIN - HEAD - table - 2.0 * UNDER - 6.0,
    ];
    let fits = |bounds: &[Bounds; 2], scale: f64| {
        let across = bounds[0].side(0).max(bounds[1].side(0));
        across <= scale * room[0] && bounds[0].side(1) + bounds[1].side(1) <= scale * room[1]
    };
    let scale = SCALES.into_iter().find(|&scale| fits(&bounds, scale));
    let scale = scale.unwrap_or(SCALES[SCALES.len() - 1]);
    // The eye is drawn where the scale leaves room for it; else its light is cut off, and its distance written.
    let with_eye: [Bounds; 2] = std::array::from_fn(|k| {
        let [x, y] = bounds[k].0;
        let eye = views[k].place(layout.eye);
        Bounds::of([[x[0], y[0]], [x[1], y[1]], eye].into_iter())
    });
    let eye_shown = fits(&with_eye, scale);
    if eye_shown {
        bounds = with_eye;
    } else {
        // A fifth more to the right, as far as there is room: light is seen to go on.
        let spare = (scale * room[0] - bounds[0].side(0)).max(0.0);
        for b in &mut bounds {
            b.0[0][1] += spare.min(0.2 * (b.0[0][1] - b.0[0][0])).max(0.0);
        }
    }
    let mut vector = Vector::new(SHEET);
    head(&mut vector, name, scale);
    let left = MARGIN + LEFT;
    let mut top = MARGIN + HEAD;
    for (k, view) in views.iter().enumerate() {
        let figure = Figure {
            layout,
            view,
            bounds: bounds[k],
            origin: [
                left - bounds[0].0[0][0].min(bounds[1].0[0][0]) / scale,
                top + bounds[k].0[1][1] / scale,
            ],
            scale,
            eye_shown,
        };
        figure.draw(&mut vector, ["side", "top"][k]);
        top += bounds[k].side(1) / scale + UNDER;
    }
    parts(&mut vector, layout, SHEET[1] - MARGIN - table);
    vector.finish(&format!("{name}: side and top view"))
}

fn head(vector: &mut Vector, name: &str, scale: f64) {
    vector.text([MARGIN, MARGIN + 5.0], 5.0, Anchor::Start, 0.0, name);
    let scale = if scale >= 1.0 { format!("1 : {scale}") } else { format!("{} : 1", 1.0 / scale) };
    let told =
        format!("scale {scale} on A4, millimetres, the viewer on the right; light in orange");
    vector.text([MARGIN, MARGIN + 10.5], LETTERS, Anchor::Start, 0.0, &told);
}

fn parts(vector: &mut Vector, layout: &Layout, mut y: f64) {
    let columns = [MARGIN, MARGIN + 52.0, MARGIN + 130.0];
    let row = |vector: &mut Vector, y: f64, cells: [&str; 3]| {
        for (x, cell) in columns.into_iter().zip(cells) {
            vector.text([x, y], LETTERS, Anchor::Start, 0.0, cell);
        }
    };
    row(vector, y, ["part", "measures", "middle: x, y, z"]);
    let rule = format!("fill=\"none\" stroke=\"{INK}\" stroke-width=\"0.2\"");
    vector.path(&[[MARGIN, y + 1.4], [SHEET[0] - MARGIN, y + 1.4]], false, &rule);
    let place = |p: [f64; 3]| p.map(shown).join(", ");
    for body in &layout.bodies {
        y += LINE;
        row(vector, y, [&body.name, &body.measures, &place(body.centre.to_array())]);
    }
    row(vector, y + LINE, ["viewpoint", "", &place(layout.eye.to_array())]);
}

/// To a tenth of a millimetre, without a needless 0.
fn shown(value: f64) -> String {
    format!("{}", (value * 10.0).round() / 10.0 + 0.0)
}

/// One view on the sheet.
struct Figure<'a> {
    layout: &'a Layout,
    view: &'a View,
    /// What it shows, mm of the set-up.
    bounds: Bounds,
    /// Where the world's origin lies on the sheet.
    origin: [f64; 2],
    scale: f64,
    eye_shown: bool,
}

impl Figure<'_> {
    /// A place of the view on the sheet.
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.origin[0] + x / self.scale, self.origin[1] - y / self.scale]
    }

    fn draw(&self, vector: &mut Vector, name: &str) {
        let [[left, _], [bottom, _]] = self.bounds.0;
        for body in farthest_first(self.layout, self.view) {
            // A rectangle seen along its edge has no contour but a line, which carries the weight.
            let lines = if is_rectangle(body) { 0.5 } else { 0.2 };
            let pens = Pens { opacity: 0.35, contour: 0.3, lines };
            paint(vector, body, self.view, &|p| self.at(p), pens);
        }
        self.light(vector);
        self.measures(vector);
        self.names(vector);
        let corner = self.at([left, bottom]);
        vector.text(
            [MARGIN, corner[1] + UNDER - 5.0],
            LETTERS,
            Anchor::Start,
            0.0,
            &format!("from the {name}"),
        );
    }

    /// Light's ways, cut off at the view's right edge if the eye is beyond it.
    fn light(&self, vector: &mut Vector) {
        let right = self.bounds.0[0][1];
        let style = format!("fill=\"none\" stroke=\"{LIGHT}\" stroke-width=\"0.2\"");
        for course in &self.layout.courses {
            let mut points: Vec<[f64; 2]> = course.iter().map(|&p| self.view.place(p)).collect();
            if let [eye, next, ..] = points[..]
                && !self.eye_shown
                && eye[0] > right
                && next[0] < right
            {
                let share = (right - next[0]) / (eye[0] - next[0]);
                points[0] = [right, next[1] + share * (eye[1] - next[1])];
            }
            let on_sheet: Vec<_> = points.iter().map(|&p| self.at(p)).collect();
            vector.path(&on_sheet, false, &style);
        }
        if self.eye_shown {
            vector.dot(self.at(self.view.place(self.layout.eye)), 0.9, LIGHT);
        }
    }

    /// Chains of distances between the parts' middles: below, and at the left.
    fn measures(&self, vector: &mut Vector) {
        let [[left, _], [bottom, _]] = self.bounds.0;
        for axis in 0..2 {
            let mut stations: Vec<f64> = self
                .layout
                .bodies
                .iter()
                .filter(|body| is_rectangle(body))
                .map(|body| self.view.place(body.centre)[axis])
                .collect();
            if self.eye_shown {
                stations.push(self.view.place(self.layout.eye)[axis]);
            }
            stations.sort_by(f64::total_cmp);
            // What lies nearer than a twentieth of a millimetre is one station.
            stations.dedup_by(|b, a| (*b - *a).abs() < 0.05);
            let foot = self.at([left, bottom]);
            for pair in stations.windows(2) {
                let distance = shown(pair[1] - pair[0]);
                if axis == 0 {
                    let [from, to] =
                        [pair[0], pair[1]].map(|x| [self.at([x, 0.0])[0], foot[1] + 7.0]);
                    dimension(vector, from, to, &distance);
                } else {
                    let [from, to] =
                        [pair[1], pair[0]].map(|y| [foot[0] - 8.0, self.at([0.0, y])[1]]);
                    dimension(vector, from, to, &distance);
                }
            }
            // Thin lines from the middles to their chain.
            let style = format!(
                "fill=\"none\" stroke=\"{INK}\" stroke-width=\"0.1\" stroke-dasharray=\"2 1\""
            );
            for body in &self.layout.bodies {
                if is_rectangle(body) {
                    let at = self.at(self.view.place(body.centre));
                    let to =
                        if axis == 0 { [at[0], foot[1] + 8.5] } else { [foot[0] - 9.5, at[1]] };
                    vector.path(&[at, to], false, &style);
                }
            }
        }
        if !self.eye_shown {
            let image = self.layout.image;
            let distance = (self.layout.eye - image).length();
            let [[_, right], _] = self.bounds.0;
            let from = self.layout.courses.first().and_then(|course| course.get(1)).copied();
            let aim = self.view.place(from.unwrap_or(image));
            let eye = self.view.place(self.layout.eye);
            let share = if eye[0] > aim[0] {
                ((right - aim[0]) / (eye[0] - aim[0])).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let at = self.at([right, aim[1] + share * (eye[1] - aim[1])]);
            let told = format!("eye {} from the image", shown(distance));
            vector.text([at[0], at[1] - 4.0], LETTERS, Anchor::End, 0.0, &told);
        }
    }

    /// Each part's name beside its middle, the lower ones moved down where names would meet.
    fn names(&self, vector: &mut Vector) {
        let mut placed: Vec<[f64; 2]> = Vec::new();
        let mut named: Vec<&Body> = self.layout.bodies.iter().collect();
        named.sort_by(|a, b| self.view.place(b.centre)[1].total_cmp(&self.view.place(a.centre)[1]));
        for body in named {
            let seen = body.seen(self.view);
            let points = seen.contour.iter().chain(seen.lines.iter().flatten());
            let b = Bounds::of(points.map(|&p| self.at(p)));
            let mut at = [b.0[0][1] + 1.5, 0.5 * (b.0[1][0] + b.0[1][1]) + 1.0];
            // A plate or display that is seen from its front is named at its upper edge.
            if b.side(1) > 25.0 {
                at = [b.0[0][1] + 1.5, b.0[1][0] + 2.0];
            }
            while placed
                .iter()
                .any(|p| (p[0] - at[0]).abs() < 24.0 && (p[1] - at[1]).abs() < LETTERS + 0.5)
            {
                at[1] += 0.5;
            }
            placed.push(at);
            vector.text(at, LETTERS, Anchor::Start, 0.0, &body.name);
        }
    }
}

/// Display, plate and image: what the set-up is measured by.
fn is_rectangle(body: &Body) -> bool {
    matches!(body.role, Role::Display | Role::Plate | Role::Image)
}

/// A measure between two places: a line with arrows and its number; with the number alone beside it where it is short.
fn dimension(vector: &mut Vector, from: [f64; 2], to: [f64; 2], text: &str) {
    let line = format!("fill=\"none\" stroke=\"{INK}\" stroke-width=\"0.15\"");
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    vector.path(&[from, to], false, &line);
    let along = [0, 1].map(|axis| (to[axis] - from[axis]) / length.max(1e-9));
    let across = [-along[1], along[0]];
    let head = 1.6f64.min(0.4 * length);
    for (tip, sign) in [(from, 1.0), (to, -1.0)] {
        let back = |side: f64| {
            [0, 1].map(|a| tip[a] + sign * head * along[a] + side * 0.3 * head * across[a])
        };
        vector.path(&[tip, back(1.0), back(-1.0)], true, &format!("fill=\"{INK}\""));
    }
    let middle = [0, 1].map(|axis| 0.5 * (from[axis] + to[axis]));
    let vertical = along[1].abs() > along[0].abs();
    let wide = 0.6 * LETTERS * text.len() as f64 + 1.0;
    let (place, turn) = match (vertical, wide <= length) {
        (false, true) => ([middle[0], middle[1] - 0.8], 0.0),
        // Beside the chain where it does not fit into it, turned so that neighbours do not meet.
        (false, false) => ([middle[0] + 0.35 * LETTERS, middle[1] + 1.5 + wide], -90.0),
        (true, true) => ([middle[0] - 0.8, middle[1]], -90.0),
        (true, false) => ([middle[0] - 1.5 - 0.5 * wide, middle[1] + 0.35 * LETTERS], 0.0),
    };
    let anchor = if !vertical && wide > length { Anchor::Start } else { Anchor::Middle };
    vector.text(place, LETTERS, anchor, turn, text);
}
