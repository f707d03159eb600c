//! A rectangle in space.

use super::{Frame, Ray, Real, Vec3};

/// A rectangle: its frame's origin is its centre, x right, y up, z its front normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Centre and axes.
    pub frame: Frame,
    /// Width and height, mm.
    pub size: [f64; 2],
}

impl Rectangle {
    /// The world point at coordinates in \[0, 1\], from the left and from the bottom.
    pub fn point<T: Real>(&self, at: [T; 2]) -> Vec3<T> {
        let x = (at[0] - 0.5) * self.size[0];
        let y = (at[1] - 0.5) * self.size[1];
        let [a, b, _] = self.frame.axes;
        let o = self.frame.origin;
        Vec3::new(x * a.x + y * b.x + o.x, x * a.y + y * b.y + o.y, x * a.z + y * b.z + o.z)
    }

    /// Coordinates (0 to 1 within the rectangle) of a world point's foot on the plane.
    #[inline]
    pub fn coordinates<T: Real>(&self, point: Vec3<T>) -> [T; 2] {
        let local = self.frame.to_local(point);
        [local.x * self.size[0].recip() + 0.5, local.y * self.size[1].recip() + 0.5]
    }

    /// Distance along a ray to the rectangle's plane; infinite or NaN for a parallel one.
    #[inline]
    pub fn plane_distance<T: Real>(&self, ray: &Ray<T>) -> T {
        let n = self.frame.normal();
        (Vec3::constant(self.frame.origin) - ray.origin).dot_plain(n) / ray.direction.dot_plain(n)
    }

    /// A point mirrored in the rectangle's plane.
    pub fn mirrored(&self, point: Vec3) -> Vec3 {
        let n = self.frame.normal();
        point - n * (2.0 * (point - self.frame.origin).dot(n))
    }

    /// A direction mirrored in the rectangle's plane.
    pub fn mirrored_direction(&self, d: Vec3) -> Vec3 {
        let n = self.frame.normal();
        d - n * (2.0 * d.dot(n))
    }
}
