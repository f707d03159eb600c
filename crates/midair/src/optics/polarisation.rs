//! Polarised light along a path: Jones calculus on fields in space.
//!
//! Light is followed backwards, from the eye, which sees all light alike: as the fields of two crossed analysers before it.
//! By reciprocity (Jones matrices of the way back are the transposed ones of the way there) the share of a polarised source's light that
//! arrives is the sum of both fields' squared components along the source's.
//!
//! Amplitudes are those of energy: their squares are shares of light, whatever the index. s lies across the plane of incidence, p = d x s for
//! the direction d of each ray, so that at normal incidence r_s = -r_p (Hecht, Optics, 4.6.2; Born and Wolf, Principles of Optics, 7th
//! ed., 1.5.2 and, for total reflection, 1.5.4).

use super::interface::{Fresnel, fresnel};
use super::plate::pass_ideal;
use crate::geometry::Vec3;

/// What two crossed analysers before the eye let through, followed back along a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Analysed {
    /// Real and imaginary parts of the two fields, transverse to the ray.
    fields: [[Vec3; 2]; 2],
}

/// A complex amplitude.
type Amplitude = [f64; 2];

impl Analysed {
    /// Two crossed analysers of a ray with unit direction `d`; which two does not matter.
    pub fn at_eye(d: Vec3) -> Self {
        Self { fields: d.perpendicular().map(|unit| [unit, Vec3::ZERO]) }
    }

    /// Through an interface: unit directions before and behind, the unit normal on the side that the ray comes from, and
    /// eta = index before over index behind. Nothing is left at total internal reflection.
    pub fn refract(&mut self, d: Vec3, n: Vec3, eta: f64, out: Vec3) {
        let f = fresnel(cosine(d, n), eta);
        self.interface(d, n, out, [transmitted(f.s), transmitted(f.p)]);
    }

    /// Back from an interface, in part or totally; as [`Self::refract`].
    pub fn reflect(&mut self, d: Vec3, n: Vec3, eta: f64, out: Vec3) {
        self.interface(d, n, out, reflected(cosine(d, n), eta));
    }

    /// Back from a mirror that takes nothing and turns no phase but by half a wave (what real metals turn besides is a few degrees but at grazing
    /// incidence).
    pub fn mirror(&mut self, n: Vec3) {
        self.each(|v| n * (2.0 * v.dot(n)) - v);
    }

    /// Through an ideal plate with unit normal `n`: two mirrors at right angles to each other and to the plate.
    pub fn pass_ideal(&mut self, n: Vec3) {
        self.each(|v| pass_ideal(v, n));
    }

    /// The share that arrives of light that is polarised along `e` (a unit vector across the ray), from 0 to 1.
    pub fn share(&self, e: Vec3) -> f64 {
        let along = |[re, im]: &[Vec3; 2]| re.dot(e).powi(2) + im.dot(e).powi(2);
        self.fields.iter().map(along).sum()
    }

    /// The share that arrives of unpolarised light.
    pub fn mean(&self) -> f64 {
        let energy = |[re, im]: &[Vec3; 2]| re.squared_length() + im.squared_length();
        0.5 * self.fields.iter().map(energy).sum::<f64>()
    }

    /// Multiplies the share by a factor.
    pub fn scale(&mut self, share: f64) {
        let amplitude = share.sqrt();
        self.each(|v| v * amplitude);
    }

    fn each(&mut self, change: impl Fn(Vec3) -> Vec3) {
        self.fields = self.fields.map(|field| field.map(&change));
    }

    fn interface(
        &mut self,
        d: Vec3,
        n: Vec3,
        out: Vec3,
        [s_amplitude, p_amplitude]: [Amplitude; 2],
    ) {
        let across = d.cross(n);
        // At normal incidence any direction across will do: s and p fare alike.
        let s = match across.squared_length() > 1e-24 {
            true => across.normalized(),
            false => d.perpendicular()[0],
        };
        let (before, behind) = (d.cross(s), out.cross(s));
        let times = |[a, b]: Amplitude, [re, im]: [f64; 2]| [a * re - b * im, a * im + b * re];
        self.fields = self.fields.map(|field| {
            let s_part = times(s_amplitude, field.map(|v| v.dot(s)));
            let p_part = times(p_amplitude, field.map(|v| v.dot(before)));
            [0, 1].map(|part| s * s_part[part] + behind * p_part[part])
        });
    }
}

/// Rounding must not take a grazing cosine out of its range.
fn cosine(d: Vec3, n: Vec3) -> f64 {
    (-d.dot(n)).clamp(0.0, 1.0)
}

fn transmitted(reflectance: f64) -> Amplitude {
    [(1.0 - reflectance).max(0.0).sqrt(), 0.0]
}

/// r_s and r_p.
fn reflected(cos_i: f64, eta: f64) -> [Amplitude; 2] {
    let Fresnel { cos_t, .. } = fresnel(cos_i, eta);
    if !cos_t.is_nan() && cos_t > 0.0 {
        let s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
        let p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
        return [[s, 0.0], [p, 0.0]];
    }
    // cos_t is imaginary: (a - i b) / (a + i b).
    let depth = (eta * eta * (1.0 - cos_i * cos_i) - 1.0).max(0.0).sqrt();
    let phase = |a: f64, b: f64| match a * a + b * b {
        0.0 => [-1.0, 0.0],
        square => [(a * a - b * b) / square, -2.0 * a * b / square],
    };
    [phase(eta * cos_i, depth), phase(cos_i, eta * depth)]
}

/// The field of a display's light in the direction `d` (unit, from the display or towards it): what a sheet polariser lets through whose absorbing axis lies across
/// `axis` in the display's plane with unit normal `n` (an O-type polariser, which absorbs along its axis' projection; Yeh and Gu, Optics of Liquid Crystal Displays,
/// 2nd ed., 3.2). Along the normal that is `axis` itself.
pub fn polariser_field(d: Vec3, axis: Vec3, n: Vec3) -> Vec3 {
    d.cross(n.cross(axis)).normalized()
}

#[cfg(test)]
mod tests {
    use super::super::interface::{reflect, refract};
    use super::*;
    use proptest::prelude::*;

    const N: Vec3 = Vec3::new(0.0, 0.0, 1.0);

    fn incident(angle: f64, around: f64) -> Vec3 {
        Vec3::new(angle.sin() * around.cos(), angle.sin() * around.sin(), -angle.cos())
    }

    /// Through a slab of index n whose faces are z = 0, met at an angle: the analysers behind it, followed back.
    fn through_slab(d: Vec3, index: f64) -> Analysed {
        let mut field = Analysed::at_eye(d);
        let inside = refract(d, N, 1.0 / index);
        field.refract(d, N, 1.0 / index, inside);
        let out = refract(inside, N, index);
        field.refract(inside, N, index, out);
        field
    }

    #[test]
    fn at_brewsters_angle_a_slab_passes_all_of_p_and_the_textbooks_share_of_s() {
        let n = 1.49f64;
        let d = incident(n.atan(), 0.7);
        let field = through_slab(d, n);
        let s = d.cross(N).normalized();
        let p = d.cross(s);
        // tan B = n: R_p = 0, and R_s = ((n^2 - 1) / (n^2 + 1))^2 at either face (Hecht, Optics, 8.6).
        let left = 1.0 - ((n * n - 1.0) / (n * n + 1.0)).powi(2);
        assert!((field.share(p) - 1.0).abs() < 1e-14, "{}", field.share(p));
        assert!((field.share(s) - left * left).abs() < 1e-14);
        assert!((field.mean() - 0.5 * (1.0 + left * left)).abs() < 1e-14);
        // In between, Malus: s and p keep their phase in transmission.
        let between = (s + p) * 0.5f64.sqrt();
        assert!((field.share(between) - field.mean()).abs() < 1e-14);
    }

    proptest! {
        /// What is reflected and what is refracted add up to what came, for any field and in total reflection too.
        #[test]
        fn energy_is_conserved(
            angle in 0.0..1.57f64, around in 0.0..6.2f64, eta in 0.4..2.5f64, turn in 0.0..3.1f64,
            before in (0.1..1.4f64, 0.0..6.2f64),
        ) {
            let d = incident(angle, around);
            // A field that two interfaces before have made elliptic.
            let mut field = Analysed::at_eye(d);
            let tilted = incident(before.0, before.1);
            field.interface(d, -tilted, d, [[turn.cos(), turn.sin()], [0.8, -0.1]]);
            let came = field.mean();
            let (mut back, mut on) = (field, field);
            back.reflect(d, N, eta, reflect(d, N));
            let out = refract(d, N, eta);
            if out.is_finite() {
                on.refract(d, N, eta, out);
                prop_assert!((back.mean() + on.mean() - came).abs() < 1e-13);
            } else {
                prop_assert!((back.mean() - came).abs() < 1e-13);
            }
        }

        /// A scalar calculation by s and p alone, where the plane of incidence stays the same, and crossed analysers of any turn see the same.
        #[test]
        fn in_one_plane_of_incidence_s_and_p_go_by_themselves(
            angle in 0.01..1.5f64, n in 1.1..1.9f64, turn in 0.0..3.1f64,
        ) {
            let d = incident(angle, 0.3);
            let s = d.cross(N).normalized();
            let p = d.cross(s);
            let f = fresnel(angle.cos(), 1.0 / n);
            let inside = refract(d, N, 1.0 / n);
            let g = fresnel(-inside.dot(N), n);
            let (through_s, through_p) = ((1.0 - f.s) * (1.0 - g.s), (1.0 - f.p) * (1.0 - g.p));
            let field = through_slab(d, n);
            prop_assert!((field.share(s) - through_s).abs() < 1e-13);
            prop_assert!((field.share(p) - through_p).abs() < 1e-13);
            let e = s * turn.cos() + p * turn.sin();
            let malus = through_s * turn.cos().powi(2) + through_p * turn.sin().powi(2);
            prop_assert!((field.share(e) - malus).abs() < 1e-13);
        }

        /// A mirror, and an ideal plate, keep lengths and angles of fields, and fields transverse.
        #[test]
        fn mirrors_and_the_ideal_plate_take_nothing(
            angle in 0.0..1.5f64, around in 0.0..6.2f64, turn in 0.0..3.1f64,
        ) {
            let d = incident(angle, around);
            let [a, b] = d.perpendicular();
            let mut field = Analysed::at_eye(d);
            field.mirror(N);
            let out = reflect(d, N);
            prop_assert!(field.fields.iter().flatten().all(|v| v.dot(out).abs() < 1e-14));
            prop_assert!((field.mean() - 1.0).abs() < 1e-14);
            let mut field = Analysed::at_eye(d);
            field.pass_ideal(N);
            let out = pass_ideal(d, N);
            prop_assert!(field.fields.iter().flatten().all(|v| v.dot(out).abs() < 1e-14));
            // Two mirrors at right angles to the plate and to each other make the same turn.
            let mut mirrors = Analysed::at_eye(d);
            mirrors.mirror(Vec3::new(turn.cos(), turn.sin(), 0.0));
            mirrors.mirror(Vec3::new(-turn.sin(), turn.cos(), 0.0));
            for (x, y) in field.fields.iter().flatten().zip(mirrors.fields.iter().flatten()) {
                prop_assert!((*x - *y).length() < 1e-14);
            }
            prop_assert!((field.share(pass_ideal(a, N)) - 1.0).abs() < 1e-14 && b.is_finite());
        }
    }

    /// Fresnel's rhomb: two total reflections at 54.62 degrees in glass of index 1.51 make circular light of light at 45 degrees (Born and Wolf, 1.5.4).
    #[test]
    fn fresnels_rhomb_makes_circular_light() {
        let n = 1.51f64;
        // tan(delta / 2) = cos i sqrt(sin^2 i - 1 / n^2) / sin^2 i, which is to be tan(22.5 degrees).
        let delta = |i: f64| {
            2.0 * (i.cos() * (i.sin().powi(2) - 1.0 / (n * n)).sqrt() / i.sin().powi(2)).atan()
        };
        let (mut low, mut high) = (52f64.to_radians(), 60f64.to_radians());
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if delta(middle) > std::f64::consts::FRAC_PI_4 { low = middle } else { high = middle }
        }
        assert!((low.to_degrees() - 54.62).abs() < 0.02, "{}", low.to_degrees());
        let d = incident(low, 0.0);
        let out = reflect(d, N);
        // The second face is parallel to the first: the way back along d.
        let s = d.cross(N).normalized();
        let p = d.cross(s);
        let linear = (s + p) * 0.5f64.sqrt();
        let mut field = Analysed { fields: [[linear, Vec3::ZERO], [Vec3::ZERO; 2]] };
        field.reflect(d, N, n, out);
        field.reflect(out, -N, n, d);
        for turn in 0..12 {
            let turn = f64::from(turn) * 0.3;
            let analyser = s * turn.cos() + p * turn.sin();
            // Half of circular light passes a polariser however it is turned.
            assert!((field.share(analyser) - 0.5).abs() < 1e-12, "{}", field.share(analyser));
        }
    }

    #[test]
    fn a_polarisers_field_is_its_axis_along_the_normal_and_across_the_ray_aslant() {
        let axis = Vec3::new(0.6, 0.8, 0.0);
        assert!((polariser_field(N, axis, N).dot(axis).abs() - 1.0).abs() < 1e-15);
        let d = incident(0.9, 0.2);
        let e = polariser_field(d, axis, N);
        assert!(e.dot(d).abs() < 1e-15 && (e.length() - 1.0).abs() < 1e-15);
        // Nothing along the absorbing axis.
        assert!(e.dot(Vec3::new(-0.8, 0.6, 0.0)).abs() < 1e-15);
    }
}
