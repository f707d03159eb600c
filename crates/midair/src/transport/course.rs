//! A path with the places that it goes through.

use super::path::{End, Path};
use super::setup::Setup;
use crate::geometry::{Ray, Vec3};

/// A path with the places that it goes through, from the eye on.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// The eye, then where the path meets something, in the world, mm; last its place in the display's plane, where it gets there.
    pub points: Vec<Vec3>,
    /// Unit vectors: which way it goes on from each of these points, but for the display's.
    pub directions: Vec<Vec3>,
    /// What it meets at the points between.
    pub steps: Path,
    /// How it ends.
    pub end: End,
}

impl Setup {
    /// The course of a ray: as [`trace`](Self::trace), with its places.
    pub fn course(&self, ray: Ray) -> Course {
        let mut steps = Path::new();
        let end = self.trace(ray, &mut steps);
        let (mut points, mut directions) = (vec![ray.origin], vec![ray.direction]);
        let mut ray = ray;
        for step in &steps {
            ray = self.advance(&ray, step);
            points.push(ray.origin);
            directions.push(ray.direction);
        }
        if let End::Display { st, .. } = end {
            points.push(self.display.point(st));
        }
        Course { points, directions, steps, end }
    }
}

#[cfg(test)]
mod tests {
    use crate::transport::bench_setup::{ACRYLIC, block, element, setup};

    /// A block straight on: in at its front, out at its back, to the plate and the mirror image of the image point.
    #[test]
    fn a_course_goes_from_the_eye_through_what_it_meets_to_the_display() {
        let block = element(block(50.0, 50.0, 50.0), ACRYLIC, [0.0; 3], [0.0; 3], 0);
        let setup = setup(20.0, vec![block]);
        let course = setup.course(setup.ray([0.5, 0.5]));
        let depths: Vec<f64> = course.points.iter().map(|point| point.z).collect();
        assert_eq!(depths.len(), 5);
        for (z, expected) in depths.into_iter().zip([800.0, 25.0, -25.0, -150.0, -150.0]) {
            assert!((z - expected).abs() < 1e-9, "{:?}", course.points);
        }
        let middle = setup.plate.rectangle.mirrored(setup.image.point([0.5, 0.5]));
        assert!((course.points[4] - middle).length() < 1e-9);
        assert_eq!((course.directions.len(), course.steps.len()), (4, 3));
        // Each point lies on the way from the one before.
        for (pair, direction) in course.points.windows(2).zip(&course.directions) {
            let way = (pair[1] - pair[0]).normalized();
            assert!((way - *direction).length() < 1e-9, "{way:?} {direction:?}");
        }
    }
}
