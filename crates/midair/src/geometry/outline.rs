//! A shape as a draughtsman draws it: its edges, and what its contour is made of from any side.

use super::mesh_surface::MeshSurface;
use super::swept::of_swept;
use super::{Convex, Frame, HeightField, Shape, Sheet, Vec3};
use std::f64::consts::TAU;

/// A shape's lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// Edges, rims and a few lines on open sheets: drawn from every side.
    pub edges: Vec<Vec<Vec3>>,
    /// Points whose convex hull, projected, is the contour; empty for what is not convex.
    pub hull: Vec<Vec3>,
    /// Edges of a mesh: each is part of the contour where one of its faces is seen from the front and the other from the back.
    pub folds: Vec<Fold>,
}

/// An edge between two faces of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// Its ends.
    pub ends: [Vec3; 2],
    /// The unit normals of the faces on either side; opposite ones at a rim, which is always seen.
    pub normals: [Vec3; 2],
}

/// Points around a full circle.
const AROUND: usize = 96;
/// Lines across a sheet or a height field, along each side.
const ACROSS: usize = 5;

impl Shape {
    /// Its lines, in its own frame.
    pub fn outline(&self) -> Outline {
        match self {
            Self::Convex(convex) => of_convex(convex),
            Self::Sheet(sheet) => of_sheet(sheet),
            Self::Swept(swept) => of_swept(swept),
            Self::HeightField(field) => of_field(field),
            Self::Mesh(mesh) => of_mesh(mesh),
        }
    }
}

impl Outline {
    /// A rectangle's lines, about the origin of its own frame.
    pub fn of_rectangle([w, h]: [f64; 2]) -> Self {
        let corners = rectangle([0.5 * w, 0.5 * h]);
        let edge = corners.iter().chain(corners.first()).copied().collect();
        Self { edges: vec![edge], hull: corners.to_vec(), folds: Vec::new() }
    }

    /// The same in the world.
    pub fn placed(&self, frame: &Frame) -> Self {
        let place = |points: &Vec<Vec3>| points.iter().map(|&p| frame.to_world(p)).collect();
        Self {
            edges: self.edges.iter().map(place).collect(),
            hull: place(&self.hull),
            folds: self
                .folds
                .iter()
                .map(|fold| Fold {
                    ends: fold.ends.map(|p| frame.to_world(p)),
                    normals: fold.normals.map(|n| frame.to_world_direction(n)),
                })
                .collect(),
        }
    }
}

fn rectangle([x, y]: [f64; 2]) -> [Vec3; 4] {
    [[-x, -y], [x, -y], [x, y], [-x, y]].map(|[x, y]| Vec3::new(x, y, 0.0))
}

/// A closed circle about y.
fn circle(radius: f64, y: f64) -> Vec<Vec3> {
    let point = |k: usize| {
        let (s, c) = (k as f64 / AROUND as f64 * TAU).sin_cos();
        Vec3::new(radius * s, y, radius * c)
    };
    (0..=AROUND).map(point).collect()
}

fn of_convex(convex: &Convex) -> Outline {
    let mut outline = Outline::default();
    match *convex {
        Convex::Sphere { .. } | Convex::Ellipsoid { .. } => {
            let radii = match *convex {
                Convex::Ellipsoid { radii } => radii,
                _ => Vec3::new(convex.reach(), convex.reach(), convex.reach()),
            };
            for row in 0..=AROUND / 2 {
                let (s, c) = (row as f64 / (AROUND / 2) as f64 * TAU / 2.0).sin_cos();
                let ring = circle(s, c);
                outline.hull.extend(
                    ring.iter().map(|p| Vec3::new(p.x * radii.x, p.y * radii.y, p.z * radii.z)),
                );
            }
        }
        Convex::Box { half } => {
            let corner = |k: usize| {
                let side = |bit: usize, half: f64| if k >> bit & 1 == 0 { -half } else { half };
                Vec3::new(side(0, half.x), side(1, half.y), side(2, half.z))
            };
            outline.hull = (0..8).map(corner).collect();
            for k in 0..8 {
                for bit in (0..3).filter(|bit| k >> bit & 1 == 0) {
                    outline.edges.push(vec![corner(k), corner(k | 1 << bit)]);
                }
            }
        }
        Convex::Frustum { middle_radius, slope, half_height } => {
            for y in [-half_height, half_height] {
                let rim = circle((middle_radius + slope * y).max(0.0), y);
                outline.hull.extend(&rim);
                outline.edges.push(rim);
            }
        }
    }
    outline
}

fn of_sheet(sheet: &Sheet) -> Outline {
    let span = |half: f64, k: usize, of: usize| half * (2.0 * k as f64 / of as f64 - 1.0);
    let mut outline = Outline::default();
    match *sheet {
        Sheet::Plane { half: [x, y] } => return Outline::of_rectangle([2.0 * x, 2.0 * y]),
        Sheet::Cylinder { centre, half_angle, half_height } => {
            let point = |angle: f64, y: f64| {
                let (s, c) = angle.sin_cos();
                Vec3::new(centre.abs() * s, y, centre * (1.0 - c))
            };
            for line in 0..ACROSS {
                let y = span(half_height, line, ACROSS - 1);
                outline
                    .edges
                    .push((0..=AROUND).map(|k| point(span(half_angle, k, AROUND), y)).collect());
                let angle = span(half_angle, line, ACROSS - 1);
                outline.edges.push(vec![point(angle, -half_height), point(angle, half_height)]);
            }
        }
        Sheet::Sphere { centre, rim } => {
            let depth =
                |r: f64| centre - centre.signum() * (centre * centre - r * r).max(0.0).sqrt();
            for ring in 1..=2 {
                let r = rim * ring as f64 / 2.0;
                let points = circle(r, 0.0);
                outline.edges.push(points.iter().map(|p| Vec3::new(p.x, p.z, depth(r))).collect());
            }
            for along_x in [true, false] {
                let point = |k: usize| {
                    let r = span(rim, k, AROUND);
                    let [x, y] = if along_x { [r, 0.0] } else { [0.0, r] };
                    Vec3::new(x, y, depth(r))
                };
                outline.edges.push((0..=AROUND).map(point).collect());
            }
        }
    }
    outline
}

fn of_field(field: &HeightField) -> Outline {
    let mut outline = Outline::default();
    let [low, high] = field.bounds();
    let on_top = |x: f64, y: f64| Vec3::new(x, y, field.height_at([x, y]));
    for line in 0..ACROSS {
        let share = line as f64 / (ACROSS - 1) as f64;
        let at = |share: f64| [low.x + share * (high.x - low.x), low.y + share * (high.y - low.y)];
        let along = |k: usize| at(k as f64 / AROUND as f64);
        outline.edges.push((0..=AROUND).map(|k| on_top(along(k)[0], at(share)[1])).collect());
        outline.edges.push((0..=AROUND).map(|k| on_top(at(share)[0], along(k)[1])).collect());
    }
    if field.is_solid() {
        let bottom = rectangle([high.x, high.y]).map(|p| Vec3::new(p.x, p.y, low.z));
        outline.edges.push(bottom.iter().chain(bottom.first()).copied().collect());
        outline.edges.extend(bottom.map(|foot| vec![foot, on_top(foot.x, foot.y)]));
    }
    outline
}

fn of_mesh(mesh: &MeshSurface) -> Outline {
    Outline { folds: mesh.folds(), ..Outline::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_lie_on_their_shape() {
        let shapes = [
            Shape::Convex(Convex::Box { half: Vec3::new(2.0, 3.0, 4.0) }),
            Shape::Convex(Convex::Frustum { middle_radius: 4.0, slope: -0.25, half_height: 6.0 }),
            Shape::Convex(Convex::Ellipsoid { radii: Vec3::new(3.0, 5.0, 7.0) }),
            Shape::Sheet(Sheet::Sphere { centre: -12.0, rim: 6.0 }),
            Shape::Sheet(Sheet::Cylinder { centre: 10.0, half_angle: 1.2, half_height: 20.0 }),
        ];
        let mut compared = 0;
        for shape in &shapes {
            let outline = shape.outline();
            let [low, high] = shape.bounds().map(Vec3::to_array);
            let mut reached = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
            for point in outline.edges.iter().flatten().chain(&outline.hull) {
                for (axis, c) in point.to_array().into_iter().enumerate() {
                    reached[axis] = [reached[axis][0].min(c), reached[axis][1].max(c)];
                    assert!(c >= low[axis] - 1e-9 && c <= high[axis] + 1e-9, "{shape:?} {point:?}");
                }
                // A little towards the middle lies within a solid, a little away outside.
                if shape.is_solid() {
                    assert!(shape.contains(*point * 0.999) && !shape.contains(*point * 1.001));
                    compared += 1;
                }
            }
            for axis in 0..3 {
                // Circles of 96 points miss their axes' ends by less than r (1 - cos(pi / 96)).
                let slack = 6e-4 * (high[axis] - low[axis]) + 1e-9;
                assert!(reached[axis][0] <= low[axis] + slack, "{shape:?} {reached:?}");
                assert!(reached[axis][1] >= high[axis] - slack, "{shape:?} {reached:?}");
            }
        }
        assert!(compared > 1000, "{compared}");
    }

    #[test]
    fn a_placed_outline_is_where_the_frame_says() {
        let frame = Frame::new(Vec3::new(1.0, 2.0, 3.0), [0.0, 90.0, 0.0]);
        let outline = Outline::of_rectangle([4.0, 2.0]).placed(&frame);
        // Local x points to -z after a quarter turn about y.
        assert!(
            (outline.hull[1] - Vec3::new(1.0, 1.0, 1.0)).length() < 1e-12,
            "{:?}",
            outline.hull
        );
        assert_eq!(outline.edges[0].len(), 5);
    }
}
