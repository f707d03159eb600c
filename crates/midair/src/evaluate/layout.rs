//! A set-up as it is drawn: its bodies' lines, the light's way, and views of them.

use crate::geometry::{Outline, Shape, Vec3};
use crate::transport::{End, Matter, Setup};

/// What a body is in the set-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The display.
    Display,
    /// The plate.
    Plate,
    /// The mid-air image.
    Image,
    /// A refractive solid.
    Solid,
    /// A mirror.
    Mirror,
    /// An opaque part.
    Opaque,
}

impl Role {
    /// Its name in data.
    pub fn name(self) -> &'static str {
        match self {
            Self::Display => "display",
            Self::Plate => "plate",
            Self::Image => "image",
            Self::Solid => "solid",
            Self::Mirror => "mirror",
            Self::Opaque => "opaque",
        }
    }
}

/// A thing in its place.
#[derive(Clone, Debug)]
pub struct Body {
    /// What it is.
    pub role: Role,
    /// What it is called.
    pub name: String,
    /// Its frame's origin in the world, mm: a rectangle's middle.
    pub centre: Vec3,
    /// Its measures in words.
    pub measures: String,
    /// Its lines in the world, mm.
    pub outline: Outline,
}

/// A set-up as it is drawn.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Display, plate, image and elements.
    pub bodies: Vec<Body>,
    /// The light's way from the viewpoint through places of the image to the display, corner by corner, mm: the image's middle, and the
    /// middles of its edges. Ways that do not reach the display are left out.
    pub courses: Vec<Vec<Vec3>>,
    /// The viewpoint, mm.
    pub eye: Vec3,
    /// The image's middle, mm.
    pub image: Vec3,
    /// Unit vectors: horizontally towards the viewer, to the viewer's right, and up.
    pub axes: [Vec3; 3],
}

/// Places of the image whose light is drawn.
const PLACES: [[f64; 2]; 5] = [[0.5, 0.5], [0.5, 1.0], [0.5, 0.0], [0.0, 0.5], [1.0, 0.5]];

impl Layout {
    /// Of a set-up.
    pub fn of(setup: &Setup) -> Self {
        let sides = |[w, h]: [f64; 2]| format!("{} x {} mm", shown(w), shown(h));
        let rectangle = |role, name: &str, r: &crate::geometry::Rectangle, more: &str| Body {
            role,
            name: name.to_owned(),
            centre: r.frame.origin,
            measures: format!("{}{more}", sides(r.size)),
            outline: Outline::of_rectangle(r.size).placed(&r.frame),
        };
        let [columns, rows] = setup.resolution;
        let pixels = format!(", {columns} x {rows} pixels");
        let mut bodies = vec![
            rectangle(Role::Display, "display", &setup.display, &pixels),
            rectangle(Role::Plate, "plate", &setup.plate.rectangle, ""),
            rectangle(Role::Image, "image", &setup.image, ""),
        ];
        for element in &setup.elements {
            let (role, matter) = match element.matter {
                Matter::Refractive { index, .. } => {
                    (Role::Solid, format!(", index {}", shown(index)))
                }
                Matter::Mirror { .. } => (Role::Mirror, ", mirror".to_owned()),
                Matter::Opaque => (Role::Opaque, ", opaque".to_owned()),
            };
            let [low, high] = element.shape.bounds();
            let extent = high - low;
            let measures = match element.shape {
                Shape::Sheet(_) => sides([extent.x, extent.y]),
                _ => format!("{} x {} x {} mm", shown(extent.x), shown(extent.y), shown(extent.z)),
            };
            bodies.push(Body {
                role,
                name: element.name.clone(),
                centre: element.frame.origin,
                measures: measures + &matter,
                outline: element.shape.outline().placed(&element.frame),
            });
        }
        let courses = PLACES.into_iter().filter_map(|uv| course(setup, uv)).collect();
        let image = setup.image.frame.origin;
        Self { bodies, courses, eye: setup.viewpoint, image, axes: axes(setup) }
    }

    /// The set-up from its side, the viewer on the right: to the right what is nearer to the viewer, up what is higher.
    pub fn side(&self) -> View {
        View::Parallel { right: self.axes[0], up: self.axes[2] }
    }

    /// From above, the viewer on the right: to the right what is nearer to the viewer, up what is on the viewer's right.
    pub fn top(&self) -> View {
        View::Parallel { right: self.axes[0], up: self.axes[1] }
    }

    /// From a place before it on the viewer's right and above, far enough off that all bodies are seen.
    pub fn oblique(&self) -> View {
        let [towards, right, up] = self.axes;
        let points = || self.bodies.iter().flat_map(Body::points);
        let middle = self.axes.into_iter().fold(Vec3::ZERO, |middle, axis| {
            let along = points().map(|p| p.dot(axis));
            let [low, high] =
                along.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], c| [l.min(c), h.max(c)]);
            middle + axis * (0.5 * (low + high))
        });
        let reach = points().map(|p| (p - middle).length()).fold(1.0, f64::max);
        let back = (towards * 0.62 + right * 0.70 + up * 0.36).normalized();
        let across = up.cross(back).normalized();
        View::Central {
            eye: middle + back * (3.2 * reach),
            axes: [across, back.cross(across), back],
        }
    }
}

/// A number without needless decimals: to a hundredth.
fn shown(value: f64) -> String {
    format!("{}", (value * 100.0).round() / 100.0 + 0.0)
}

/// Where the viewer is; where the plate is, for a viewer straight above.
fn axes(setup: &Setup) -> [Vec3; 3] {
    let up = Vec3::new(0.0, 1.0, 0.0);
    let level = |v: Vec3| Vec3::new(v.x, 0.0, v.z);
    let sight = setup.viewpoint - setup.image.frame.origin;
    let ways = [
        (level(sight), sight.length()),
        (level(setup.plate.rectangle.frame.normal()), 1.0),
        (Vec3::new(0.0, 0.0, 1.0), 1.0),
    ];
    // A hundredth of the way: below that, which side the viewer is on is rounding.
    let towards = ways.into_iter().find(|(way, whole)| way.length() > 0.01 * whole);
    let towards = towards.map_or(Vec3::new(0.0, 0.0, 1.0), |(way, _)| way.normalized());
    [towards, up.cross(towards), up]
}

/// The corners of a path that reaches the display through the plate.
fn course(setup: &Setup, uv: [f64; 2]) -> Option<Vec<Vec3>> {
    let course = setup.course(setup.ray(uv));
    matches!(course.end, End::Display { through_plate: true, .. }).then_some(course.points)
}

impl Body {
    /// All points of its lines.
    pub fn points(&self) -> impl Iterator<Item = Vec3> + '_ {
        let Outline { edges, hull, folds } = &self.outline;
        let folds = folds.iter().flat_map(|fold| fold.ends);
        edges.iter().flatten().chain(hull).copied().chain(folds)
    }

    /// How it looks in a view.
    pub fn seen(&self, view: &View) -> Seen {
        let flat: Vec<[f64; 2]> = self.outline.hull.iter().map(|&p| view.place(p)).collect();
        let mut lines: Vec<Vec<[f64; 2]>> = self
            .outline
            .edges
            .iter()
            .map(|edge| edge.iter().map(|&p| view.place(p)).collect())
            .collect();
        for fold in &self.outline.folds {
            let towards = view.towards(fold.ends[0]);
            let [a, b] = fold.normals.map(|normal| normal.dot(towards) > 0.0);
            if a != b {
                lines.push(fold.ends.map(|p| view.place(p)).to_vec());
            }
        }
        Seen { contour: convex_hull(flat), lines }
    }
}

/// A body in a view; mm in the view's plane, right and up.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// Its contour, a closed polygon, if it is convex; else empty.
    pub contour: Vec<[f64; 2]>,
    /// Its lines.
    pub lines: Vec<Vec<[f64; 2]>>,
}

/// How space becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// True to scale: along parallel lines.
    Parallel {
        /// What lies to the right in the picture, a unit vector.
        right: Vec3,
        /// What lies up in it.
        up: Vec3,
    },
    /// As an eye sees it: in perspective.
    Central {
        /// The eye, mm.
        eye: Vec3,
        /// Right and up in the picture, and towards the eye: unit vectors.
        axes: [Vec3; 3],
    },
}

impl View {
    /// Where a point is in the picture: mm, or in perspective the tangents of angles.
    pub fn place(&self, point: Vec3) -> [f64; 2] {
        match *self {
            Self::Parallel { right, up } => [point.dot(right), point.dot(up)],
            Self::Central { eye, axes: [right, up, back] } => {
                let from = point - eye;
                // What is beside or behind the eye would be turned over: it is held a little before it.
                let depth = (-from.dot(back)).max(1e-3 * from.length().max(1e-9));
                [from.dot(right) / depth, from.dot(up) / depth]
            }
        }
    }

    /// From a point towards whoever looks, a unit vector.
    pub fn towards(&self, point: Vec3) -> Vec3 {
        match *self {
            Self::Parallel { right, up } => right.cross(up),
            Self::Central { eye, .. } => (eye - point).normalized(),
        }
    }

    /// How far a point is from whoever looks, for the order of painting.
    pub fn depth(&self, point: Vec3) -> f64 {
        match *self {
            Self::Parallel { right, up } => -point.dot(right.cross(up)),
            Self::Central { eye, .. } => (point - eye).length(),
        }
    }
}

/// The convex hull, counter-clockwise from the leftmost point (Andrew's monotone chain, 1979). Fewer than three points are returned as they are.
fn convex_hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.retain(|p| p.iter().all(|c| c.is_finite()));
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let turns_left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    };
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && !turns_left(a, b, point)
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::bench_setup::{ACRYLIC, block, element, setup, sphere};

    #[test]
    fn light_goes_from_the_eye_by_way_of_the_plate_to_the_display() {
        // With nothing in the way: straight to the plate, and from there to the mirror image of the image point.
        let bare = setup(20.0, vec![]);
        let layout = Layout::of(&bare);
        assert_eq!(layout.courses.len(), PLACES.len());
        for (course, uv) in layout.courses.iter().zip(PLACES) {
            let [eye, plate, display] = course[..] else { panic!("{course:?}") };
            assert_eq!(eye, bare.viewpoint);
            let r = &bare.plate.rectangle;
            assert!((plate - r.frame.origin).dot(r.frame.normal()).abs() < 1e-9);
            assert!((display - r.mirrored(bare.image.point(uv))).length() < 1e-9, "{display:?}");
        }
        // Through a block straight on: in at its front, out at its back, straight through.
        let block = element(block(50.0, 50.0, 50.0), ACRYLIC, [0.0; 3], [0.0; 3], 0);
        let layout = Layout::of(&setup(20.0, vec![block]));
        let places: Vec<f64> = layout.courses[0].iter().map(|p| p.z).collect();
        for (z, expected) in places.into_iter().zip([800.0, 25.0, -25.0, -150.0, -150.0]) {
            assert!((z - expected).abs() < 1e-9, "{:?}", layout.courses[0]);
        }
    }

    #[test]
    fn views_are_true_to_scale_and_from_where_they_say() {
        let ball = element(sphere(25.0), ACRYLIC, [10.0, 5.0, -3.0], [0.0; 3], 0);
        let layout = Layout::of(&setup(20.0, vec![ball]));
        // The viewer stands at +z, so x is on the viewer's right.
        assert_eq!(
            layout.axes,
            [Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)]
        );
        let ball = layout.bodies.last().unwrap();
        for (view, centre) in [(layout.side(), [-3.0, 5.0]), (layout.top(), [-3.0, 10.0])] {
            let contour = ball.seen(&view).contour;
            for p in &contour {
                let r = (p[0] - centre[0]).hypot(p[1] - centre[1]);
                // Hull points lie on the ball; between two of 96 the chord is r (1 - cos(pi / 96)) short, and rings lie as far off.
                assert!(r < 25.0 + 1e-9 && r > 25.0 * (1.0 - 2.2e-3), "{r}");
            }
            assert!(contour.len() > 40);
        }
        // From the side the plate is its edge: a line at 45 degrees, 488 mm long.
        let plate = &layout.bodies[1];
        let seen = plate.seen(&layout.side());
        let ends = seen.lines[0]
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |e, p| [e[0].min(p[1]), e[1].max(p[1])]);
        assert!((ends[1] - ends[0] - 488.0 * 0.5f64.sqrt()).abs() < 1e-9, "{ends:?}");
    }

    #[test]
    fn perspective_keeps_lines_straight_and_shrinks_with_distance() {
        let view = View::Central {
            eye: Vec3::new(0.0, 0.0, 100.0),
            axes: [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)],
        };
        let near = view.place(Vec3::new(3.0, 4.0, 50.0));
        let far = view.place(Vec3::new(3.0, 4.0, 0.0));
        for axis in 0..2 {
            assert!((near[axis] - 2.0 * far[axis]).abs() < 1e-12);
        }
        assert_eq!(far, [0.03, 0.04]);
    }

    #[test]
    fn the_oblique_view_sees_all_bodies_from_the_viewers_side() {
        let block = element(block(50.0, 50.0, 50.0), ACRYLIC, [0.0; 3], [0.0; 3], 0);
        let layout = Layout::of(&setup(20.0, vec![block]));
        let view = layout.oblique();
        let View::Central { eye, axes } = view else { panic!() };
        assert!(eye.z > 0.0 && eye.y > 0.0 && axes[1].y > 0.8);
        let mut seen = 0;
        for point in layout.bodies.iter().flat_map(Body::points) {
            // Within 25 degrees of the middle.
            assert!(view.place(point).iter().all(|c| c.abs() < 0.47), "{point:?}");
            seen += 1;
        }
        assert!(seen > 20);
    }

    #[test]
    fn a_hull_is_what_a_rubber_band_would_be() {
        let points = vec![
            [0.0, 0.0],
            [1.0, 0.5],
            [2.0, 0.0],
            [2.0, 2.0],
            [0.0, 2.0],
            [1.0, 1.0],
            [1.0, 0.0],
        ];
        assert_eq!(convex_hull(points), [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        assert_eq!(convex_hull(vec![[1.0, 1.0]; 5]), [[1.0, 1.0]]);
    }
}
