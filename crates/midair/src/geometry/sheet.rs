//! Open mirrors: flat, bent, and a cap of a sphere.

use super::convex::quadratic_root;
use super::{Crossing, Hit, Ray, Real, Search, Vec3};

/// A sheet without thickness in its own frame: its middle at the origin, normal +z there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sheet {
    /// Flat.
    Plane {
        /// Half width and half height, mm.
        half: [f64; 2],
    },
    /// Bent about an axis parallel to y.
    Cylinder {
        /// z of the axis, mm: minus the radius for a convex sheet, plus the radius for a concave one.
        centre: f64,
        /// Half of the angle that the arc spans, radians.
        half_angle: f64,
        /// Half the length along y, mm.
        half_height: f64,
    },
    /// A cap of a sphere.
    Sphere {
        /// z of the centre, mm: minus the radius for a convex cap, plus the radius for a concave one.
        centre: f64,
        /// Radius of the rim, mm.
        rim: f64,
    },
}

impl Sheet {
    /// The first hit after `search.after` that is not where the ray stands.
    pub fn nearest(&self, ray: &Ray, search: Search) -> Option<Hit> {
        let standing = search.standing_on.is_some();
        if let Self::Plane { half } = *self {
            if standing {
                return None;
            }
            let t = -ray.origin.z / ray.direction.z;
            let p = ray.at(t);
            return (t > search.after && p.x.abs() <= half[0] && p.y.abs() <= half[1])
                .then_some(Hit { t, face: 0, crossing: Crossing::Enter });
        }
        let roots = [Crossing::Enter, Crossing::Leave].map(|c| (self.root(ray, c), c));
        // Standing on the quadric, one of the roots is where the ray stands: rounding decides
        // its sign, so it is told by being the smaller one.
        let own = (roots[0].0.abs() < roots[1].0.abs()) as usize ^ 1;
        roots
            .into_iter()
            .enumerate()
            .filter(|&(i, (t, _))| {
                t > search.after && !(standing && i == own) && self.bounded(ray.at(t))
            })
            .map(|(_, (t, crossing))| Hit { t, face: 0, crossing })
            .next()
    }

    fn root<T: Real>(&self, ray: &Ray<T>, crossing: Crossing) -> T {
        let (o, d) = (ray.origin, ray.direction);
        match *self {
            Self::Plane { .. } => -o.z / d.z,
            Self::Cylinder { centre, .. } => {
                let z = o.z - centre;
                quadratic_root(
                    d.x * d.x + d.z * d.z,
                    o.x * d.x + z * d.z,
                    o.x * o.x + z * z - centre * centre,
                    crossing,
                )
            }
            Self::Sphere { centre, .. } => {
                let o = Vec3::new(o.x, o.y, o.z - centre);
                quadratic_root(d.dot(d), o.dot(d), o.dot(o) - centre * centre, crossing)
            }
        }
    }

    fn bounded(&self, p: Vec3) -> bool {
        match *self {
            Self::Plane { half } => p.x.abs() <= half[0] && p.y.abs() <= half[1],
            Self::Cylinder { centre, half_angle, half_height } => {
                let towards_middle = (p.z - centre) * -centre.signum();
                p.x.abs().atan2(towards_middle) <= half_angle && p.y.abs() <= half_height
            }
            Self::Sphere { centre, rim } => {
                (p.z - centre) * -centre.signum() >= 0.0 && p.x.hypot(p.y) <= rim
            }
        }
    }

    /// Distance along a ray and the normal on the +z side, the sheet counted as unbounded.
    pub fn cross<T: Real>(&self, ray: &Ray<T>, crossing: Crossing) -> (T, Vec3<T>) {
        let t = self.root(ray, crossing);
        let normal = match *self {
            Self::Plane { .. } => Vec3::constant(Vec3::new(0.0, 0.0, 1.0)),
            Self::Cylinder { centre, .. } => {
                let p = ray.at(t);
                Vec3::new(p.x, T::constant(0.0), p.z - centre) * (-1.0 / centre)
            }
            Self::Sphere { centre, .. } => {
                let p = ray.at(t);
                Vec3::new(p.x, p.y, p.z - centre) * (-1.0 / centre)
            }
        };
        (t, normal)
    }
}
