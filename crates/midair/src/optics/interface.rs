//! Light at the surface between two media: Snell's law, the mirror law and Fresnel's equations.
//!
//! Signs, the same in every function: `d` is the unit direction in which light travels, `n` the
//! unit normal on the side the light comes from (so `d.n <= 0`), `eta = n1 / n2` the index on that
//! side over the index on the other, `cos_i = -d.n` and `cos_t` the (positive) cosines of the
//! angles of incidence and refraction. A branch that does not exist is NaN.
//!
//! ```
//! use midair::{geometry::Vec3, optics::interface};
//! let half = 0.5f64.sqrt();
//! let d = Vec3::new(half, -half, 0.0); // 45 degrees, downwards
//! let t = interface::refract(d, Vec3::new(0.0, 1.0, 0.0), 1.0 / 1.49); // from air into acrylic
//! assert!((t.x - half / 1.49).abs() < 1e-15); // n1 sin t1 = n2 sin t2
//! ```

use crate::geometry::{Real, Vec3};

/// The mirror law: unit direction of the light that `n`'s surface reflects.
///
/// The side that `n` is on does not matter.
#[inline]
pub fn reflect<T: Real>(d: Vec3<T>, n: Vec3<T>) -> Vec3<T> {
    d - n.scaled(d.dot(n) * 2.0)
}

/// Snell's law: unit direction of the refracted light; NaN at total internal reflection.
///
/// The vector form of n1 sin t1 = n2 sin t2 (Glassner, An Introduction to Ray Tracing, 1989,
/// section 2.4.2): no angle is ever computed, and one square root is taken.
#[inline]
pub fn refract<T: Real>(d: Vec3<T>, n: Vec3<T>, eta: T) -> Vec3<T> {
    let cos_i = -d.dot(n);
    refract_with(d, n, eta, cos_i, refracted_cosine_squared(cos_i, eta).sqrt())
}

/// [`refract`] with both cosines already known, as [`fresnel`] leaves them.
#[inline]
pub fn refract_with<T: Real>(d: Vec3<T>, n: Vec3<T>, eta: T, cos_i: T, cos_t: T) -> Vec3<T> {
    d.scaled(eta) + n.scaled(eta * cos_i - cos_t)
}

/// cos_t squared; negative at total internal reflection.
fn refracted_cosine_squared<T: Real>(cos_i: T, eta: T) -> T {
    T::constant(1.0) - eta * eta * (T::constant(1.0) - cos_i * cos_i)
}

/// How light divides at an interface: shares of the energy, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel<T = f64> {
    /// Reflectance of light polarised across the plane of incidence (s).
    pub s: T,
    /// Reflectance of light polarised in the plane of incidence (p).
    pub p: T,
    /// Cosine of the angle of refraction; NaN at total internal reflection.
    pub cos_t: T,
}

impl<T: Real> Fresnel<T> {
    /// Reflectance of unpolarised light: the mean of `s` and `p`.
    pub fn reflectance(self) -> T {
        (self.s + self.p) * 0.5
    }

    /// Transmittance of unpolarised light: what is not reflected.
    pub fn transmittance(self) -> T {
        T::constant(1.0) - self.reflectance()
    }
}

/// Fresnel's equations between two dielectrics (Born and Wolf, Principles of Optics, 7th ed.,
/// 1.5.2, equation 21), as shares of energy.
///
/// From the critical angle on all light is reflected: `s` and `p` are 1 and `cos_t` is NaN beyond
/// it. `cos_i` is in [0, 1].
#[inline]
pub fn fresnel<T: Real>(cos_i: T, eta: T) -> Fresnel<T> {
    let cos2_t = refracted_cosine_squared(cos_i, eta);
    let cos_t = cos2_t.sqrt();
    let total = cos2_t.value() <= 0.0;
    // Computed in any case and then chosen: no branch, so that many rays can go side by side.
    let share = |share: T| if total { T::constant(1.0) } else { share };
    let (a, b) = (eta * cos_i, eta * cos_t);
    Fresnel {
        s: share(((a - cos_t) / (a + cos_t)).squared()),
        p: share(((cos_i - b) / (cos_i + b)).squared()),
        cos_t,
    }
}

/// Reflectance of unpolarised light, from 0 to 1: see [`fresnel`].
pub fn fresnel_unpolarised<T: Real>(cos_i: T, eta: T) -> T {
    fresnel(cos_i, eta).reflectance()
}

/// The Beer-Lambert law: share of light left after `length` mm in a medium that absorbs
/// `absorption` per mm (natural logarithm), `exp(-absorption * length)`, for each colour.
pub fn beer_lambert(absorption: [f64; 3], length: f64) -> [f64; 3] {
    absorption.map(|a| if a == 0.0 { 1.0 } else { (-a * length).exp() })
}

/// Leaves of light by linear R, G, B the share that something passes of each.
#[inline]
pub fn attenuate(light: &mut [f64; 3], by: [f64; 3]) {
    for c in 0..3 {
        light[c] *= by[c];
    }
}

/// The angle of incidence, in degrees, from which light is totally reflected; `None` if there is
/// none, because the other side is not the optically thinner one (`eta <= 1`).
pub fn critical_angle(eta: f64) -> Option<f64> {
    (eta > 1.0).then(|| (1.0 / eta).asin().to_degrees())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Dual;
    use proptest::prelude::*;

    const N: Vec3 = Vec3::new(0.0, 0.0, 1.0);

    /// A direction that meets the plane z = 0 from above at an angle of incidence (radians).
    fn incident(angle: f64, around: f64) -> Vec3 {
        Vec3::new(angle.sin() * around.cos(), angle.sin() * around.sin(), -angle.cos())
    }

    fn unit_vector() -> impl Strategy<Value = Vec3> {
        (-1.0..1.0f64, 0.0..std::f64::consts::TAU).prop_map(|(z, around)| {
            let r = (1.0 - z * z).sqrt();
            Vec3::new(r * around.cos(), r * around.sin(), z)
        })
    }

    /// A unit direction and a unit normal on its incident side.
    fn meeting() -> impl Strategy<Value = (Vec3, Vec3)> {
        (unit_vector(), unit_vector())
            .prop_map(|(d, n)| if d.dot(n) > 0.0 { (d, -n) } else { (d, n) })
    }

    proptest! {
        #[test]
        fn refraction_turns_by_the_angles_of_snell(
            angle in 0.0..1.57f64, around in 0.0..std::f64::consts::TAU, eta in 0.3..3.0f64,
        ) {
            let t = refract(incident(angle, around), N, eta);
            let sine = eta * angle.sin();
            if sine >= 1.0 {
                prop_assert!(t.x.is_nan() && t.y.is_nan() && t.z.is_nan());
            } else {
                // Near the critical angle cos_t = sqrt(1 - sine^2) has rounding of about
                // sqrt(1e-16): the tolerance grows with 1 / cos_t.
                let by_angle = incident(sine.asin(), around);
                prop_assert!((t - by_angle).length() < 1e-14 / (1.0 - sine * sine).sqrt());
            }
        }

        #[test]
        fn refraction_conserves_the_tangential_wave_vector_and_stays_unit(
            (d, n) in meeting(), eta in 0.3..3.0f64,
        ) {
            let t = refract(d, n, eta);
            prop_assume!(t.is_finite());
            let tangential = (d.cross(n)) * eta - t.cross(n);
            // Products of numbers up to 3: a few ulp.
            prop_assert!(tangential.length() < 1e-14);
            prop_assert!((t.length() - 1.0).abs() < 1e-14);
            prop_assert!(t.dot(n) <= 0.0);
        }

        #[test]
        fn refraction_is_reversible((d, n) in meeting(), eta in 0.3..3.0f64) {
            let t = refract(d, n, eta);
            // Grazing exits are left out: there the way back is at the critical angle, where the
            // cosine's rounding is the square root of the direction's.
            prop_assume!(t.is_finite() && d.dot(n) < -1e-3);
            let back = refract(-t, -n, 1.0 / eta);
            prop_assert!((back + d).length() < 1e-11);
        }

        #[test]
        fn reflection_keeps_the_tangent_and_flips_the_normal_component((d, n) in meeting()) {
            let r = reflect(d, n);
            prop_assert!((r.dot(n) + d.dot(n)).abs() < 8e-15);
            prop_assert!((r.cross(n) - d.cross(n)).length() < 8e-15);
            prop_assert!((reflect(r, n) - d).length() < 8e-15);
        }

        #[test]
        fn fresnel_agrees_with_the_laws_of_sines_and_tangents(
            angle in 0.01..1.5f64, eta in 0.3..3.0f64,
        ) {
            let sine = eta * angle.sin();
            prop_assume!(sine < 0.999 && (eta - 1.0).abs() > 0.01);
            let refracted = sine.asin();
            let f = fresnel(angle.cos(), eta);
            let s = ((angle - refracted).sin() / (angle + refracted).sin()).powi(2);
            let p = ((angle - refracted).tan() / (angle + refracted).tan()).powi(2);
            // Differences of nearby angles lose up to three digits here.
            prop_assert!((f.s - s).abs() < 1e-12 && (f.p - p).abs() < 1e-12);
            prop_assert!((f.cos_t - refracted.cos()).abs() < 1e-12);
        }

        #[test]
        fn reflected_and_transmitted_power_make_up_the_incident(
            cos_i in 0.001..1.0f64, eta in 0.3..3.0f64,
        ) {
            let f = fresnel(cos_i, eta);
            prop_assume!(f.cos_t > 1e-6);
            // Transmission from the field amplitudes (Born and Wolf 1.5.2, equation 20), with the
            // beam's change of width and of speed.
            let t_s = 2.0 * eta * cos_i / (eta * cos_i + f.cos_t);
            let t_p = 2.0 * eta * cos_i / (cos_i + eta * f.cos_t);
            let power = f.cos_t / (eta * cos_i);
            prop_assert!((f.s + power * t_s * t_s - 1.0).abs() < 1e-12);
            prop_assert!((f.p + power * t_p * t_p - 1.0).abs() < 1e-12);
            prop_assert!((f.reflectance() + f.transmittance() - 1.0).abs() < 1e-15);
        }

        #[test]
        fn fresnel_is_the_same_from_both_sides(cos_i in 0.001..1.0f64, eta in 0.3..3.0f64) {
            let there = fresnel(cos_i, eta);
            prop_assume!(there.cos_t > 1e-3);
            let back = fresnel(there.cos_t, 1.0 / eta);
            prop_assert!((there.reflectance() - back.reflectance()).abs() < 1e-9);
        }

        #[test]
        fn derivatives_agree_with_central_differences(
            angle in 0.05..1.4f64, around in 0.0..std::f64::consts::TAU, eta in 0.4..2.0f64,
        ) {
            // Away from the critical angle, where the slope is infinite.
            prop_assume!(eta * (angle + 1e-3).sin() < 0.95);
            let at = |x: f64, y: f64| incident(x, y);
            // u is the angle of incidence, v the angle around the normal.
            let (ca, sa) = (angle.cos(), angle.sin());
            let d = at(angle, around);
            let dual = |re, du, dv| Dual { re, d: [du, dv] };
            let lifted = Vec3::new(
                dual(d.x, ca * around.cos(), -sa * around.sin()),
                dual(d.y, ca * around.sin(), sa * around.cos()),
                dual(d.z, sa, 0.0),
            );
            let n = Vec3::constant(N);
            let eta_dual = Dual::constant(eta);
            let t = refract(lifted, n, eta_dual);
            let r = reflect(lifted, n);
            let f = fresnel_unpolarised(-lifted.dot(n), eta_dual);
            let h = 1e-5;
            for axis in 0..2 {
                let (hu, hv) = if axis == 0 { (h, 0.0) } else { (0.0, h) };
                let (plus, minus) = (at(angle + hu, around + hv), at(angle - hu, around - hv));
                let slope = |a: Vec3, b: Vec3| (a - b) * (0.5 / h);
                let dt = slope(refract(plus, N, eta), refract(minus, N, eta));
                let dr = slope(reflect(plus, N), reflect(minus, N));
                let df = (fresnel_unpolarised(-plus.dot(N), eta)
                    - fresnel_unpolarised(-minus.dot(N), eta)) * (0.5 / h);
                let of = |v: Vec3<Dual>| Vec3::new(v.x.d[axis], v.y.d[axis], v.z.d[axis]);
                // h^2 times the third derivative, which cos_t >= 0.31 lets reach some thousands.
                prop_assert!((of(t) - dt).length() < 1e-5);
                prop_assert!((of(r) - dr).length() < 1e-8);
                prop_assert!((f.d[axis] - df).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn brewsters_angle_reflects_no_p_light() {
        for eta in [1.0 / 1.33, 1.0 / 1.49, 1.52, 2.4] {
            let brewster = (1.0f64 / eta).atan();
            let f = fresnel(brewster.cos(), eta);
            assert!(f.p < 1e-28 && f.s > 0.01, "{f:?}");
        }
    }

    #[test]
    fn normal_incidence_follows_the_index_contrast() {
        for eta in [1.0 / 1.33, 1.0 / 1.49, 1.0, 1.52] {
            let share = ((eta - 1.0f64) / (eta + 1.0)).powi(2);
            assert!((fresnel_unpolarised(1.0, eta) - share).abs() < 1e-15);
            assert_eq!(refract(-N, N, eta), -N);
            assert_eq!(reflect(-N, N), N);
        }
    }

    #[test]
    fn grazing_light_is_all_reflected() {
        for eta in [0.5, 1.0 / 1.49, 1.0, 1.49] {
            assert_eq!(fresnel_unpolarised(0.0, eta), 1.0);
        }
        // R falls off linearly: 1 - R is a few times cos_i.
        assert!((1.0 - fresnel_unpolarised(1e-9, 1.0 / 1.49)) < 1e-8);
        // Same media: nothing is reflected at any other angle.
        assert!(fresnel_unpolarised(1e-3, 1.0) < 1e-20);
    }

    #[test]
    fn total_reflection_begins_at_the_critical_angle() {
        assert_eq!(critical_angle(1.0), None);
        assert_eq!(critical_angle(0.7), None);
        for eta in [1.0001, 1.33, 1.49, 2.4] {
            let critical = critical_angle(eta).unwrap().to_radians();
            assert!(refract(incident(critical - 1e-6, 1.0), N, eta).is_finite());
            assert!(fresnel_unpolarised((critical - 1e-6).cos(), eta) < 1.0);
            let beyond = fresnel((critical + 1e-6).cos(), eta);
            assert!(refract(incident(critical + 1e-6, 1.0), N, eta).x.is_nan());
            assert_eq!(beyond.reflectance(), 1.0);
            assert!(beyond.cos_t.is_nan());
        }
        // Acrylic to air: 42.16 degrees.
        assert!((critical_angle(1.49).unwrap() - 42.1552).abs() < 1e-4);
    }

    #[test]
    fn absorption_halves_over_each_half_value_layer() {
        let per_mm = std::f64::consts::LN_2 / 10.0;
        let left = beer_lambert([0.0, per_mm, 2.0 * per_mm], 30.0);
        assert_eq!(left[0], 1.0);
        assert!((left[1] - 0.125).abs() < 1e-15 && (left[2] - 1.0 / 64.0).abs() < 1e-15);
    }
}
