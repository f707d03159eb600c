//! The viewer's pupil.

use super::Camera;
use crate::geometry::{Ray, Vec3};
use crate::transport::Setup;

/// A viewer with a pupil: a camera or an eye, as a thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewer {
    /// Where it looks from, and at what.
    pub camera: Camera,
    /// Diameter of the pupil, mm: an eye's is 2 to 8; 0 is a pinhole. It stands across the line of sight to
    /// the image's centre.
    pub aperture: f64,
    /// Distance of the plane in focus from the eye, mm along the line of sight to the image's centre and across
    /// it; `None`: the image's plane is in focus.
    pub focus: Option<f64>,
}

impl Viewer {
    /// A pinhole.
    pub fn pinhole(camera: Camera) -> Self {
        Self { camera, aperture: 0.0, focus: None }
    }
}

/// A viewer made ready: the ray of each place on the view and on the pupil.
pub(super) struct Lens {
    eye: Vec3,
    /// The pupil's radii, mm.
    across: [Vec3; 2],
    sight: Vec3,
    focus: Option<f64>,
    /// The image's plane at the view's top-left corner, and its change with each column and row.
    corner: Vec3,
    column: Vec3,
    row: Vec3,
}

impl Lens {
    pub(super) fn new(viewer: &Viewer, setup: &Setup) -> Self {
        let camera = &viewer.camera;
        let at = |column, row| setup.image.point(camera.image_point(column, row));
        let corner = at(0.0, 0.0);
        let sight = (setup.image.frame.origin - camera.eye).normalized();
        Self {
            eye: camera.eye,
            across: sight.perpendicular().map(|unit| unit * (0.5 * viewer.aperture)),
            sight,
            focus: viewer.focus,
            corner,
            column: at(1.0, 0.0) - corner,
            row: at(0.0, 1.0) - corner,
        }
    }

    /// The ray through a position of the view (columns and rows from its top-left corner) from a place on
    /// the pupil, which two numbers in \[0, 1) choose, evenly over its area.
    #[inline]
    pub(super) fn ray(&self, column: f64, row: f64, pupil: [f32; 2]) -> Ray {
        let mut target = self.corner + self.column * column + self.row * row;
        if let Some(focus) = self.focus {
            let to = target - self.eye;
            target = self.eye + to * (focus / to.dot(self.sight));
        }
        // Points of a disc keep their even spread where areas are kept: radius by square root.
        let radius = pupil[0].sqrt();
        let (s, c) = (std::f32::consts::TAU * pupil[1]).sin_cos();
        let [a, b] = self.across;
        let origin = self.eye + a * f64::from(radius * c) + b * f64::from(radius * s);
        Ray { origin, direction: (target - origin).normalized() }
    }
}
