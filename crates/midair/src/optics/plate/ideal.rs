//! The ideal plate: plane symmetry, at every angle and without loss.

use crate::geometry::{Real, Vec3};

/// Direction of light behind an ideal plate with unit normal `n` (either side's): the component
/// along the normal is kept, the tangential ones are reversed, `d' = -d + 2 (d.n) n` (the paper's
/// equation 3).
///
/// Light passes *through*. All light from a point meets again in the point's mirror image in the
/// plate's plane, so this is a retroreflection in the plane and a passage across it.
pub fn pass_ideal<T: Real>(d: Vec3<T>, n: Vec3<T>) -> Vec3<T> {
    n.scaled(d.dot(n) * 2.0) - d
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Dual, Frame};
    use crate::optics::interface::reflect;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = Vec3> {
        (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64)
            .prop_map(|(x, y, z)| Vec3::new(x, y, z))
            .prop_filter("too short for a direction", |v| v.length() > 0.1)
    }

    /// Where a ray meets the plane through `on` with normal `n`.
    fn meet(origin: Vec3, d: Vec3, on: Vec3, n: Vec3) -> Vec3 {
        origin + d * ((on - origin).dot(n) / d.dot(n))
    }

    /// Distance of a point from a line through `on` along the unit vector `d`.
    fn distance_to_line(point: Vec3, on: Vec3, d: Vec3) -> f64 {
        (point - on).cross(d).length()
    }

    proptest! {
        #[test]
        fn passing_twice_restores_the_direction(d in vector(), n in vector()) {
            let (d, n) = (d.normalized(), n.normalized());
            let out = pass_ideal(d, n);
            prop_assert!((pass_ideal(out, n) - d).length() < 1e-14);
            prop_assert!((out.length() - 1.0).abs() < 1e-14);
            // Either side's normal does.
            prop_assert_eq!(out, pass_ideal(d, -n));
        }

        #[test]
        fn normal_component_is_kept_and_tangential_ones_reversed(d in vector(), n in vector()) {
            let (d, n) = (d.normalized(), n.normalized());
            let out = pass_ideal(d, n);
            prop_assert!((out.dot(n) - d.dot(n)).abs() < 1e-14);
            prop_assert!((out.cross(n) + d.cross(n)).length() < 1e-14);
            // The plate is a retroreflector seen in a mirror.
            prop_assert!((out + reflect(d, n)).length() < 1e-14);
        }

        #[test]
        fn light_from_a_point_meets_in_its_mirror_image(
            source in vector(), first in vector(), rotation in prop::array::uniform3(-180.0..180.0),
        ) {
            let frame = Frame::new(Vec3::new(0.3, -0.2, 0.1), rotation);
            let n = frame.normal();
            let local = frame.to_local(source);
            prop_assume!(local.z.abs() > 0.05);
            let image = frame.to_world(Vec3::new(local.x, local.y, -local.z));
            let crossing = frame.to_world(Vec3::new(first.x, first.y, 0.0));
            let out = pass_ideal((crossing - source).normalized(), n);
            // Lengths below 10: a few ulp.
            prop_assert!(distance_to_line(image, crossing, out) < 1e-13);
        }

        /// The line identity: the display point, mirrored in the plate's plane, lies on the line of the
        /// ray that left the last element.
        #[test]
        fn mirrored_display_point_lies_on_the_incoming_line(
            origin in vector(), d in vector(), n in vector(), display in vector(), facing in vector(),
        ) {
            let (d, n, facing) = (d.normalized(), n.normalized(), facing.normalized());
            prop_assume!(d.dot(n).abs() > 0.1);
            let crossing = meet(origin, d, Vec3::ZERO, n);
            let out = pass_ideal(d, n);
            prop_assume!(out.dot(facing).abs() > 0.1);
            let reached = meet(crossing, out, display, facing);
            let mirrored = reached - n * (2.0 * reached.dot(n));
            prop_assert!(distance_to_line(mirrored, origin, d) < 1e-11);
        }
    }

    #[test]
    fn derivatives_are_those_of_a_linear_map() {
        let n = Vec3::new(0.6, 0.0, 0.8);
        let (e, f) = (Vec3::new(1.0, 2.0, -0.5), Vec3::new(-0.3, 0.4, 0.9));
        let lift = |re, du, dv| Dual { re, d: [du, dv] };
        let d = Vec3::new(lift(0.1, e.x, f.x), lift(-0.7, e.y, f.y), lift(0.2, e.z, f.z));
        let out = pass_ideal(d, Vec3::constant(n));
        for (axis, along) in [e, f].into_iter().enumerate() {
            let slope = Vec3::new(out.x.d[axis], out.y.d[axis], out.z.d[axis]);
            assert!((slope - pass_ideal(along, n)).length() < 1e-15);
        }
    }
}
