//! How far a shape reaches, and which parts of a line lie in it: questions about where things stand, apart from where light goes.

use super::{Convex, Crossing, Hit, Ray, Search, Shape, Sheet, Vec3};

/// More meetings of one line with one shape are not told apart.
const MOST: usize = 256;

impl Shape {
    /// Least and largest x, y and z in the shape's own frame, mm. Of a height field it is what its spline cannot exceed.
    pub fn bounds(&self) -> [Vec3; 2] {
        match self {
            Self::Convex(convex) => {
                let reach = match *convex {
                    Convex::Sphere { radius } => Vec3::new(radius, radius, radius),
                    Convex::Ellipsoid { radii } => radii,
                    Convex::Box { half } => half,
                    Convex::Frustum { middle_radius, slope, half_height } => {
                        let widest = middle_radius + (slope * half_height).abs();
                        Vec3::new(widest, half_height, widest)
                    }
                };
                [-reach, reach]
            }
            Self::Sheet(sheet) => of_sheet(sheet),
            Self::Swept(swept) => swept.bounds(),
            Self::HeightField(field) => field.bounds(),
            Self::Mesh(mesh) => mesh.bounds(),
        }
    }

    /// The parts of a whole line, before its start as well, that lie within a solid: distances of entry and exit, mm, in their order along
    /// it. None for a sheet.
    pub fn chords(&self, line: &Ray) -> Vec<[f64; 2]> {
        let mut chords = Vec::new();
        if !self.is_solid() {
            return chords;
        }
        let (ray, ahead) = self.line_before(line);
        let mut after = 0.0;
        while chords.len() < MOST
            && let Some(enter) = self.first(&ray, Some(Crossing::Enter), after)
            && let Some(leave) = self.first(&ray, Some(Crossing::Leave), enter.t)
        {
            chords.push([enter.t + ahead, leave.t + ahead]);
            after = leave.t;
        }
        chords
    }

    /// Where a whole line, before its start as well, meets the surface: distances, mm, in their order along it.
    pub fn meetings(&self, line: &Ray) -> Vec<f64> {
        if self.is_solid() {
            return self.chords(line).concat();
        }
        let (ray, ahead) = self.line_before(line);
        let mut meetings = Vec::new();
        let mut after = 0.0;
        while meetings.len() < MOST
            && let Some(hit) = self.first(&ray, None, after)
        {
            meetings.push(hit.t + ahead);
            after = hit.t;
        }
        meetings
    }

    /// Whether a point (in the shape's frame) lies within a solid.
    pub fn contains(&self, point: Vec3) -> bool {
        // Any direction does; this one lies along no edge of what people build.
        let line = Ray { origin: point, direction: Vec3::new(0.36, 0.48, 0.8) };
        self.chords(&line).iter().any(|&[enter, leave]| enter <= 0.0 && leave >= 0.0)
    }

    fn first(&self, ray: &Ray, crossing: Option<Crossing>, after: f64) -> Option<Hit> {
        self.nearest(ray, Search { crossing, after, standing_on: None })
    }

    /// The line as a ray that sets out before the shape, and how far ahead of the line's own start that is (less than 0: behind it).
    fn line_before(&self, line: &Ray) -> (Ray, f64) {
        let [low, high] = self.bounds();
        let middle = (low + high) * 0.5;
        // A millimetre to spare.
        let ahead = (middle - line.origin).dot(line.direction) - 0.5 * (high - low).length() - 1.0;
        (Ray { origin: line.at(ahead), direction: line.direction }, ahead)
    }
}

fn of_sheet(sheet: &Sheet) -> [Vec3; 2] {
    use std::f64::consts::{FRAC_PI_2, PI};
    match *sheet {
        Sheet::Plane { half: [x, y] } => [Vec3::new(-x, -y, 0.0), Vec3::new(x, y, 0.0)],
        Sheet::Cylinder { centre, half_angle, half_height } => {
            let angle = half_angle.min(PI);
            let x = centre.abs() * angle.min(FRAC_PI_2).sin();
            let z = centre * (1.0 - angle.cos());
            [Vec3::new(-x, -half_height, z.min(0.0)), Vec3::new(x, half_height, z.max(0.0))]
        }
        Sheet::Sphere { centre, rim } => {
            let cosine = (1.0 - (rim / centre).powi(2)).max(0.0).sqrt();
            let z = centre * (1.0 - cosine);
            [Vec3::new(-rim, -rim, z.min(0.0)), Vec3::new(rim, rim, z.max(0.0))]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::HeightField;
    use std::sync::Arc;

    fn line(origin: [f64; 3], direction: [f64; 3]) -> Ray {
        Ray {
            origin: Vec3::from_array(origin),
            direction: Vec3::from_array(direction).normalized(),
        }
    }

    #[test]
    fn chords_are_what_school_geometry_says() {
        let ball = Shape::Convex(Convex::Sphere { radius: 5.0 });
        // Pythagoras: 3, 4, 5; the line starts within the ball, and beyond it.
        for start in [0.0, 40.0] {
            let chords = ball.chords(&line([start, 3.0, 0.0], [1.0, 0.0, 0.0]));
            assert_eq!(chords.len(), 1);
            assert!((chords[0][0] + 4.0 + start).abs() < 1e-12, "{chords:?}");
            assert!((chords[0][1] - 4.0 + start).abs() < 1e-12);
        }
        assert!(ball.chords(&line([0.0, 5.1, 0.0], [1.0, 0.0, 0.0])).is_empty());
        assert!(
            ball.contains(Vec3::new(2.8, 2.8, 2.8)) && !ball.contains(Vec3::new(2.9, 2.9, 2.9))
        );
    }

    #[test]
    fn a_line_enters_a_wavy_solid_as_often_as_it_waves() {
        // Crests at the samples with +1: a line at half height meets three of them.
        let wave: Vec<f64> = (0..13).map(|i| if i % 4 == 2 { 1.0 } else { -1.0 }).collect();
        let field = HeightField::new(&vec![wave; 13], [120.0, 120.0], Some(10.0));
        let shape = Shape::HeightField(Arc::new(field));
        let chords = shape.chords(&line([-500.0, 3.0, 0.5], [1.0, 0.0, 0.0]));
        assert_eq!(chords.len(), 3, "{chords:?}");
        assert!(chords.iter().all(|[a, b]| b > a));
        assert!(
            shape.contains(Vec3::new(3.0, 3.0, -9.0)) && !shape.contains(Vec3::new(3.0, 3.0, 5.0))
        );
    }

    #[test]
    fn sheets_are_met_and_hold_nothing() {
        // A half pipe of radius 10: a line across it at half its depth meets it twice, at x = +-sqrt(75).
        let pipe = Shape::Sheet(Sheet::Cylinder {
            centre: 10.0,
            half_angle: std::f64::consts::FRAC_PI_2,
            half_height: 20.0,
        });
        let met = pipe.meetings(&line([0.0, 0.0, 5.0], [1.0, 0.0, 0.0]));
        assert_eq!(met.len(), 2);
        assert!((met[0] + 75f64.sqrt()).abs() < 1e-12 && (met[1] - 75f64.sqrt()).abs() < 1e-12);
        assert!(!pipe.contains(Vec3::new(0.0, 0.0, 5.0)));
        let [low, high] = pipe.bounds();
        assert!((low - Vec3::new(-10.0, -20.0, 0.0)).length() < 1e-12);
        assert!((high - Vec3::new(10.0, 20.0, 10.0)).length() < 1e-12);
    }

    #[test]
    fn no_shape_reaches_beyond_its_bounds_and_each_touches_them() {
        let shapes = [
            Shape::Convex(Convex::Sphere { radius: 7.0 }),
            Shape::Convex(Convex::Ellipsoid { radii: Vec3::new(3.0, 5.0, 7.0) }),
            Shape::Convex(Convex::Box { half: Vec3::new(2.0, 3.0, 4.0) }),
            Shape::Convex(Convex::Frustum { middle_radius: 4.0, slope: -0.25, half_height: 6.0 }),
            Shape::Sheet(Sheet::Sphere { centre: -12.0, rim: 6.0 }),
        ];
        let mut seen = 0;
        for shape in shapes {
            let bounds = shape.bounds();
            let mut reached = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
            // Lines along each axis on a grid finer than the tolerance below asks for.
            for axis in 0..3 {
                for i in 0..=200 {
                    for j in 0..=200 {
                        let mut origin = [0.0; 3];
                        let mut direction = [0.0; 3];
                        direction[axis] = 1.0;
                        let [low, high] = bounds.map(Vec3::to_array);
                        for (other, k) in [((axis + 1) % 3, i), ((axis + 2) % 3, j)] {
                            let share = f64::from(k) / 200.0;
                            origin[other] = low[other] + share * (high[other] - low[other]);
                        }
                        for t in shape.meetings(&line(origin, direction)) {
                            reached[axis] = [reached[axis][0].min(t), reached[axis][1].max(t)];
                            seen += 1;
                        }
                    }
                }
            }
            for axis in 0..3 {
                let [low, high] = bounds.map(|b| b.to_array()[axis]);
                let [least, most] = reached[axis];
                // The grid passes the axes of all of these shapes, where they reach furthest; a flat sheet's edge lies between its lines.
                assert!(least >= low - 1e-9 && most <= high + 1e-9, "{shape:?} {axis}");
                assert!(least <= low + 0.1 && most >= high - 0.1, "{shape:?} {axis} {reached:?}");
            }
        }
        assert!(seen > 100_000, "{seen}");
    }
}
