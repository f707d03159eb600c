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
#[derive(Clone, Copy)]
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
    #[inline(always)]
    pub(super) fn ray(&self, column: f64, row: f64, pupil: [f64; 2]) -> Ray {
        let mut target = self.corner + self.column * column + self.row * row;
        if let Some(focus) = self.focus {
            let to = target - self.eye;
            target = self.eye + to * (focus / to.dot(self.sight));
        }
        // Points of a disc keep their even spread where areas are kept: radius by square root.
        let radius = pupil[0].sqrt();
        let (s, c) = sin_cos_of_turn(pupil[1]);
        let [a, b] = self.across;
        let origin = self.eye + a * (radius * c) + b * (radius * s);
        Ray { origin, direction: (target - origin).normalized() }
    }
}

/// Sine and cosine of the angle `turn` - 1/2 in full turns, for turns in \[0, 1\]: in plain arithmetic, which goes on vector
/// units, to 1e-10. (Taylor's series of half the angle, which is a right one at most.)
#[inline(always)]
fn sin_cos_of_turn(turn: f64) -> (f64, f64) {
    let half = std::f64::consts::PI * (turn - 0.5);
    let x = half * half;
    let terms = |first: f64| {
        // 1 - x / (n (n + 1)) (1 - x / ((n + 2) (n + 3)) (1 - ...))
        let mut sum = 1.0;
        for k in (0..8).rev() {
            let n = first + 2.0 * f64::from(k);
            sum = 1.0 - x * (1.0 / (n * (n + 1.0))) * sum;
        }
        sum
    };
    let (s, c) = (half * terms(2.0), terms(1.0));
    (2.0 * s * c, 1.0 - 2.0 * s * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_and_cosines_are_the_library_ones() {
        for i in 0..=1000 {
            let turn = f64::from(i) / 1000.0;
            let (s, c) = (std::f64::consts::TAU * (turn - 0.5)).sin_cos();
            let (sine, cosine) = sin_cos_of_turn(turn);
            assert!((sine - s).abs() < 1e-10 && (cosine - c).abs() < 1e-10, "{turn}");
        }
    }
}
