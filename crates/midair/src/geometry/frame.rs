//! A thing's own frame in the world.

use super::{Real, Vec3};

/// An orthonormal right-handed frame: where a thing stands and how it is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The frame's origin in the world, mm.
    pub origin: Vec3,
    /// The frame's x, y and z axes in the world, unit length.
    pub axes: [Vec3; 3],
}

impl Frame {
    /// The world's own frame.
    pub const WORLD: Self = Self {
        origin: Vec3::ZERO,
        axes: [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)],
    };

    /// A frame at `position` (mm) turned by Rx*Ry*Rz of the `rotation` angles in degrees.
    ///
    /// Right angles are exact: a rotation of 90 leaves no rounding residue of pi/2.
    pub fn new(position: Vec3, rotation: [f64; 3]) -> Self {
        let [(sx, cx), (sy, cy), (sz, cz)] = rotation.map(sin_cos_degrees);
        Self {
            origin: position,
            axes: [
                Vec3::new(cy * cz, cx * sz + sx * sy * cz, sx * sz - cx * sy * cz),
                Vec3::new(-cy * sz, cx * cz - sx * sy * sz, sx * cz + cx * sy * sz),
                Vec3::new(sy, -sx * cy, cx * cy),
            ],
        }
    }

    /// The angles in degrees that [`new`](Self::new) makes these axes of: Rx*Ry*Rz, with no turn about z where y is a right angle and only the
    /// sum of the others counts.
    pub fn rotation(&self) -> [f64; 3] {
        let [x, y, z] = self.axes;
        // The matrix's columns are the axes; Rx*Ry*Rz has sin(y) at row 0, column 2.
        let about_y = z.x.clamp(-1.0, 1.0).asin();
        let (about_x, about_z) = if z.x.abs() < 1.0 - 1e-12 {
            ((-z.y).atan2(z.z), (-y.x).atan2(x.x))
        } else {
            (y.z.atan2(y.y), 0.0)
        };
        [about_x, about_y, about_z].map(f64::to_degrees)
    }

    /// The frame's z axis: the normal of a plane or rectangle.
    #[inline]
    pub fn normal(&self) -> Vec3 {
        self.axes[2]
    }

    /// A world point in this frame.
    #[inline]
    pub fn to_local<T: Real>(&self, point: Vec3<T>) -> Vec3<T> {
        self.to_local_direction(point - Vec3::constant(self.origin))
    }

    /// A world direction in this frame.
    #[inline]
    pub fn to_local_direction<T: Real>(&self, d: Vec3<T>) -> Vec3<T> {
        Vec3::new(d.dot_plain(self.axes[0]), d.dot_plain(self.axes[1]), d.dot_plain(self.axes[2]))
    }

    /// A point of this frame in the world.
    #[inline]
    pub fn to_world<T: Real>(&self, point: Vec3<T>) -> Vec3<T> {
        self.to_world_direction(point) + Vec3::constant(self.origin)
    }

    /// A direction of this frame in the world.
    #[inline]
    pub fn to_world_direction<T: Real>(&self, d: Vec3<T>) -> Vec3<T> {
        let [a, b, c] = self.axes;
        Vec3::new(
            d.x * a.x + d.y * b.x + d.z * c.x,
            d.x * a.y + d.y * b.y + d.z * c.y,
            d.x * a.z + d.y * b.z + d.z * c.z,
        )
    }
}

fn sin_cos_degrees(angle: f64) -> (f64, f64) {
    let turned = angle.rem_euclid(360.0);
    match turned {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => turned.to_radians().sin_cos(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn plate_turned_by_minus_45_faces_up_and_forward() {
        let frame = Frame::new(Vec3::ZERO, [-45.0, 0.0, 0.0]);
        let half = 0.5f64.sqrt();
        assert!((frame.normal() - Vec3::new(0.0, half, half)).length() < 1e-15);
    }

    proptest! {
        #[test]
        fn rotation_is_rx_ry_rz(rx in -360.0..360.0, ry in -360.0..360.0, rz in -360.0..360.0) {
            let all = Frame::new(Vec3::ZERO, [rx, ry, rz]);
            let [x, y, z] = [[rx, 0.0, 0.0], [0.0, ry, 0.0], [0.0, 0.0, rz]]
                .map(|r| Frame::new(Vec3::ZERO, r));
            let v = Vec3::new(0.3, -1.2, 0.7);
            let composed = x.to_world(y.to_world(z.to_world(v)));
            // Three products of unit-size numbers: a few ulp of 2.
            prop_assert!((all.to_world(v) - composed).length() < 1e-14);
            prop_assert!((all.to_local(all.to_world(v)) - v).length() < 1e-14);
        }

        #[test]
        fn the_angles_of_a_frame_make_it_again(rx in -360.0..360.0, ry in -5i32..=5, rz in -360.0..360.0) {
            // Right angles about y among them, where the other two turns are one.
            let frame = Frame::new(Vec3::ZERO, [rx, 45.0 * f64::from(ry), rz]);
            let again = Frame::new(Vec3::ZERO, frame.rotation());
            for (a, b) in frame.axes.into_iter().zip(again.axes) {
                // An arc sine near 1 has the square root of rounding.
                prop_assert!((a - b).length() < 1e-7, "{frame:?} {again:?}");
            }
        }
    }
}
