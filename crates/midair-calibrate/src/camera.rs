//! The camera: its lens by OpenCV's model, its place, and the ray of each of its pixels.

use midair::geometry::{Dual, Frame, Ray, Real, Vec3};
use midair::transport::Placing;
use serde::Serialize;

/// How a camera's lens lays directions on its pixels: OpenCV's pinhole model with its five distortion coefficients. Pixels are counted from the
/// picture's upper left corner, so that their centres lie at half-integers (OpenCV's own count is half a pixel less).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Lens<T = f64> {
    /// Focal lengths, px.
    pub focal: [T; 2],
    /// Where the optical axis meets the picture, px.
    pub centre: [T; 2],
    /// k1, k2, p1, p2, k3.
    pub distortion: [T; 5],
}

/// What each number of a lens is called, in the order of [`Lens::numbers`].
pub const LENS_NUMBERS: [&str; 9] =
    ["focal.x", "focal.y", "centre.x", "centre.y", "k1", "k2", "p1", "p2", "k3"];

impl<T: Real> Lens<T> {
    /// All numbers in a row.
    pub fn numbers(&self) -> [T; 9] {
        let ([a, b], [c, d], [k1, k2, p1, p2, k3]) = (self.focal, self.centre, self.distortion);
        [a, b, c, d, k1, k2, p1, p2, k3]
    }

    /// From all numbers in a row.
    pub fn from_numbers([a, b, c, d, k1, k2, p1, p2, k3]: [T; 9]) -> Self {
        Self { focal: [a, b], centre: [c, d], distortion: [k1, k2, p1, p2, k3] }
    }

    /// Where a direction (x right, y down, at distance 1 ahead) comes to lie after the lens' distortion.
    pub fn distorted(&self, [x, y]: [T; 2]) -> [T; 2] {
        let [k1, k2, p1, p2, k3] = self.distortion;
        let r2 = x * x + y * y;
        let radial = ((k3 * r2 + k2) * r2 + k1) * r2 + 1.0;
        let cross = x * y * 2.0;
        [
            x * radial + p1 * cross + p2 * (r2 + x * x * 2.0),
            y * radial + p1 * (r2 + y * y * 2.0) + p2 * cross,
        ]
    }

    /// The pixel that sees a direction.
    pub fn pixel(&self, direction: [T; 2]) -> [T; 2] {
        let [x, y] = self.distorted(direction);
        [x * self.focal[0] + self.centre[0], y * self.focal[1] + self.centre[1]]
    }

    /// The direction that a pixel sees; NaN where the distortion has none.
    pub fn direction(&self, pixel: [f64; 2]) -> [T; 2] {
        let wanted = [0, 1].map(|c| (-self.centre[c] + pixel[c]) / self.focal[c]);
        let plain = Lens::from_numbers(self.numbers().map(Real::value));
        let Some((found, inverse)) = plain.undistorted(wanted.map(Real::value)) else {
            return [T::constant(f64::NAN); 2];
        };
        // One more step over the numbers that carry derivatives: by the implicit function theorem it gives them exactly.
        let [x, y] = found.map(T::constant);
        let reached = self.distorted([x, y]);
        let off = [0, 1].map(|c| reached[c] - wanted[c]);
        [
            x - (off[0] * inverse[0][0] + off[1] * inverse[0][1]),
            y - (off[0] * inverse[1][0] + off[1] * inverse[1][1]),
        ]
    }
}

impl Lens {
    /// The direction that is distorted into this one, and the inverse of the distortion's Jacobian there: Newton's method.
    fn undistorted(&self, wanted: [f64; 2]) -> Option<([f64; 2], [[f64; 2]; 2])> {
        let lifted = Lens::from_numbers(self.numbers().map(<Dual as Real>::constant));
        let mut at = wanted;
        for _ in 0..30 {
            let [a, b] = lifted.distorted([Dual::variable(at[0], 0), Dual::variable(at[1], 1)]);
            let determinant = a.d[0] * b.d[1] - a.d[1] * b.d[0];
            // Where the picture folds over there is no lens.
            if !(determinant > 1e-6) {
                return None;
            }
            let inverse = [
                [b.d[1] / determinant, -a.d[1] / determinant],
                [-b.d[0] / determinant, a.d[0] / determinant],
            ];
            let off = [a.re - wanted[0], b.re - wanted[1]];
            let step = [0, 1].map(|c| inverse[c][0] * off[0] + inverse[c][1] * off[1]);
            at = [at[0] - step[0], at[1] - step[1]];
            if step[0].hypot(step[1]) < 1e-14 {
                return Some((at, inverse));
            }
        }
        // It went to and fro in the last digit.
        let reached = self.distorted(at);
        let off = (reached[0] - wanted[0]).hypot(reached[1] - wanted[1]);
        (off < 1e-11).then(|| self.undistorted_inverse(at)).flatten().map(|inverse| (at, inverse))
    }

    fn undistorted_inverse(&self, at: [f64; 2]) -> Option<[[f64; 2]; 2]> {
        let lifted = Lens::from_numbers(self.numbers().map(<Dual as Real>::constant));
        let [a, b] = lifted.distorted([Dual::variable(at[0], 0), Dual::variable(at[1], 1)]);
        let determinant = a.d[0] * b.d[1] - a.d[1] * b.d[0];
        (determinant > 1e-6).then(|| {
            [
                [b.d[1] / determinant, -a.d[1] / determinant],
                [-b.d[0] / determinant, a.d[0] / determinant],
            ]
        })
    }
}

/// The ray of a pixel: from the camera's place (its axes right, down and ahead) through its lens.
pub fn pixel_ray<T: Real>(camera: &Placing<T>, lens: &Lens<T>, pixel: [f64; 2]) -> Ray<T> {
    ray_along(camera, lens.direction(pixel))
}

/// The ray from the camera's place along a direction (x right, y down, at distance 1 ahead).
pub fn ray_along<T: Real>(camera: &Placing<T>, [x, y]: [T; 2]) -> Ray<T> {
    let [right, down, ahead] = camera.axes;
    let direction = (right.scaled(x) + down.scaled(y) + ahead).normalized();
    Ray { origin: camera.origin, direction }
}

/// A camera at a place that looks at a point, upright.
pub fn looking_at(from: Vec3, at: Vec3) -> Frame {
    let ahead = (at - from).normalized();
    let up = Vec3::new(0.0, 1.0, 0.0);
    let right = ahead.cross(up);
    // Straight down there is no upright: any right will do.
    let right = if right.length() > 1e-9 { right.normalized() } else { Vec3::new(1.0, 0.0, 0.0) };
    Frame { origin: from, axes: [right, ahead.cross(right), ahead] }
}

/// The pixel in which a camera sees a point of the world; `None` behind it.
pub fn seen_at(camera: &Frame, lens: &Lens, point: Vec3) -> Option<[f64; 2]> {
    let local = camera.to_local(point);
    (local.z > 0.0).then(|| lens.pixel([local.x / local.z, local.y / local.z]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENS: Lens = Lens {
        focal: [3200.0, 3180.0],
        centre: [1500.5, 1010.25],
        distortion: [-0.21, 0.12, 0.0007, -0.0011, -0.03],
    };

    #[test]
    fn a_pixel_sees_what_is_shown_in_it() {
        for pixel in [[0.5, 0.5], [1500.5, 1010.25], [2999.0, 1999.0], [40.0, 1700.0]] {
            let again = LENS.pixel(LENS.direction(pixel));
            // Rounding of a few thousand pixels.
            assert!((again[0] - pixel[0]).hypot(again[1] - pixel[1]) < 1e-9, "{again:?}");
        }
    }

    #[test]
    fn directions_carry_the_lens_derivatives() {
        let pixel = [400.0, 1800.0];
        for number in 0..9 {
            let lifted = Lens::from_numbers(std::array::from_fn(|i| {
                let value = LENS.numbers()[i];
                if i == number { Dual::<1>::variable(value, 0) } else { Real::constant(value) }
            }));
            let found = lifted.direction(pixel);
            let step = if number < 4 { 1e-2 } else { 1e-5 };
            let moved = |by: f64| {
                let mut numbers = LENS.numbers();
                numbers[number] += by;
                Lens::from_numbers(numbers).direction(pixel)
            };
            let (plus, minus) = (moved(step), moved(-step));
            for c in 0..2 {
                let difference = (plus[c] - minus[c]) / (2.0 * step);
                // Central differences: the square of the step, and rounding over the step.
                assert!(
                    (difference - found[c].d[0]).abs() < 1e-8,
                    "{number} {difference} {found:?}"
                );
            }
        }
    }

    #[test]
    fn a_camera_looks_where_it_is_told() {
        let target = Vec3::new(3.0, -8.0, 1.0);
        let camera = looking_at(Vec3::new(200.0, 90.0, 700.0), target);
        let pixel = seen_at(&camera, &LENS, target).expect("it is ahead");
        assert!((pixel[0] - LENS.centre[0]).hypot(pixel[1] - LENS.centre[1]) < 1e-9);
        // Up in the world is up in the picture: a smaller y. The lens' own bend is left out.
        let straight = Lens { distortion: [0.0; 5], ..LENS };
        let above = target + Vec3::new(0.0, 5.0, 0.0);
        let above = seen_at(&camera, &straight, above).expect("ahead");
        assert!(above[1] < pixel[1] && (above[0] - pixel[0]).abs() < 1e-9);
        let ray = pixel_ray(&Placing::constant(&camera), &LENS, pixel);
        let miss = (target - ray.origin).cross(ray.direction).length();
        assert!(miss < 1e-9, "{miss}");
    }
}
