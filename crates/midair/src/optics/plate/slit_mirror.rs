//! The slit-mirror plate: two crossed layers of slit mirrors in glass, ray by ray.
//!
//! ```text
//!   +z side   ============================  cover glass
//!             |   |   |   |   |   |   |   |  layer 0: mirrors run along `azimuth`
//!             =  =  =  =  =  =  =  =  =  =  layer 1: mirrors run at right angles to layer 0's
//!   -z side   ============================  cover glass
//! ```
//!
//! A layer's mirrors stand across the plate, one pitch apart, both faces reflecting. Seen along
//! one layer's mirrors, a ray zigzags between two of them; *unfolded*, it is a straight line that
//! crosses equal cells, and the number of cells crossed is the number of mirrors met. So a ray
//! costs the same whatever the pitch. An odd number of mirrors reverses the ray's component across
//! them, an even number leaves it. Odd in both layers forms the mid-air image.
//!
//! Parameters, with their defaults (an ASKA3D-like plate, 4 mm thick), in [`SlitMirror`]:
//!
//! | key | unit | default | |
//! | --- | --- | --- | --- |
//! | `pitch` | mm | 0.5 | distance from mirror to mirror in one layer |
//! | `layer_depth` | mm | 1.25 | depth of each layer |
//! | `azimuth` | degrees | 45 | direction of layer 0's mirrors from local +x |
//! | `reflectance` | | 0.87 | of one mirror, by linear R, G, B |
//! | `ior` | | 1.52 | refractive index of all the glass |
//! | `absorption` | 1/mm | 0 | of the glass, by linear R, G, B (natural logarithm) |
//! | `cover_glass` | mm | 0.75 | glass on each face, before the layers and behind them |
//! | `mirror_thickness` | mm | 0 | of each mirror; light that meets its front end is absorbed |
//!
//! Phase: in both layers a mirror's mid-plane passes through the plate's centre.
//!
//! Values: Kiuchi and Koizumi, Computers & Graphics 96, 2021. Left out: diffraction at the slits,
//! mirrors that are not quite parallel, and light reflected to and fro between the outer faces.

use crate::geometry::{Real, Vec3};
use crate::optics::interface::{beer_lambert, fresnel};

/// The micro-structure of a slit-mirror plate; [the module](self) explains each value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlitMirror {
    /// Distance between the mirrors of one layer, mm (default 0.5).
    pub pitch: f64,
    /// Depth of each of the two layers, mm (default 1.25).
    pub layer_depth: f64,
    /// Direction of layer 0's mirrors from local +x, degrees (default 45).
    pub azimuth: f64,
    /// Reflectance of one mirror by linear R, G, B (default 0.87).
    pub reflectance: [f64; 3],
    /// Refractive index of the plate's glass (default 1.52).
    pub ior: f64,
    /// Absorption of the glass per mm by linear R, G, B (default 0).
    pub absorption: [f64; 3],
    /// Thickness of the glass on each face, outside the layers, mm (default 0.75).
    pub cover_glass: f64,
    /// Thickness of each mirror, mm (default 0).
    pub mirror_thickness: f64,
}

impl Default for SlitMirror {
    fn default() -> Self {
        Self {
            pitch: 0.5,
            layer_depth: 1.25,
            azimuth: 45.0,
            reflectance: [0.87; 3],
            ior: 1.52,
            absorption: [0.0; 3],
            cover_glass: 0.75,
            mirror_thickness: 0.0,
        }
    }
}

impl SlitMirror {
    /// Thickness of the whole plate, mm.
    pub fn thickness(&self) -> f64 {
        2.0 * (self.layer_depth + self.cover_glass)
    }
}

/// A value of [`SlitMirror`] that no plate can have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("plate: `{key}` is {value}, but must be {allowed}")]
pub struct PlateError {
    /// The value's name.
    pub key: &'static str,
    /// What was given.
    pub value: f64,
    /// What is possible.
    pub allowed: &'static str,
}

/// What a passage through the plate makes of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Class {
    /// Odd in both layers: forms the mid-air image.
    Real,
    /// Odd in one layer: forms a stray image.
    Stray,
    /// Even in both layers: goes on as if through a window.
    Through,
}

impl Class {
    /// By the mirrors met in the two layers.
    #[inline]
    pub fn of(mirrors: [u32; 2]) -> Self {
        match mirrors.map(|k| k % 2 == 1) {
            [true, true] => Self::Real,
            [false, false] => Self::Through,
            _ => Self::Stray,
        }
    }
}

/// A ray's way through the plate; points and directions in the plate's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Where light leaves the far face, mm.
    pub exit_point: Vec3,
    /// Unit direction of travel behind the plate.
    pub direction: Vec3,
    /// Mirrors met in layer 0 and in layer 1.
    pub mirrors: [u32; 2],
    /// By the parity of both.
    pub class: Class,
    /// Share of the light left by linear R, G, B: reflectance of the mirrors met, Fresnel
    /// transmittance of both faces (unpolarised), absorption in the glass.
    pub weight: [f64; 3],
}

/// A slit-mirror plate, ready to pass rays.
#[derive(Clone, Debug)]
pub struct SlitMirrorPlate {
    parameters: SlitMirror,
    /// Sine and cosine of the azimuth.
    turn: (f64, f64),
    half_thickness: f64,
    inverse_pitch: f64,
    half_mirror: f64,
    /// Clear width between two mirrors, half of it with room for rounding, and its inverse.
    clear: f64,
    half_clear: f64,
    inverse_clear: f64,
    eta: f64,
    absorbs: bool,
    powers: [[f64; 3]; POWERS],
}

/// Reflectances to the powers 0 .. POWERS are kept: the mirrors that rays meet in practice.
const POWERS: usize = 16;

impl SlitMirrorPlate {
    /// Prepares a plate.
    ///
    /// # Errors
    /// A [`PlateError`] names the first value that no plate can have.
    pub fn new(parameters: SlitMirror) -> Result<Self, PlateError> {
        let p = parameters;
        check("pitch", p.pitch, "a length above 0", |v| v > 0.0)?;
        check("layer_depth", p.layer_depth, "a length above 0", |v| v > 0.0)?;
        check("azimuth", p.azimuth, "an angle in degrees", |_| true)?;
        for r in p.reflectance {
            check("reflectance", r, "a share from 0 to 1", |v| (0.0..=1.0).contains(&v))?;
        }
        check("ior", p.ior, "an index of at least 1", |v| v >= 1.0)?;
        for a in p.absorption {
            check("absorption", a, "0 or more, per mm", |v| v >= 0.0)?;
        }
        check("cover_glass", p.cover_glass, "a length of 0 or more", |v| v >= 0.0)?;
        check("mirror_thickness", p.mirror_thickness, "a length from 0 to below the pitch", |v| {
            (0.0..p.pitch).contains(&v)
        })?;

        let clear = p.pitch - p.mirror_thickness;
        let mut powers = [[1.0; 3]; POWERS];
        for k in 1..POWERS {
            for c in 0..3 {
                powers[k][c] = powers[k - 1][c] * p.reflectance[c];
            }
        }
        Ok(Self {
            parameters,
            turn: p.azimuth.to_radians().sin_cos(),
            half_thickness: 0.5 * p.thickness(),
            inverse_pitch: 1.0 / p.pitch,
            half_mirror: 0.5 * p.mirror_thickness,
            clear,
            // Mirrors without thickness absorb nothing: rounding in the entry offset must not
            // find an end to hit.
            half_clear: 0.5 * clear + 1e-9 * p.pitch,
            inverse_clear: 1.0 / clear,
            eta: 1.0 / p.ior,
            absorbs: p.absorption.iter().any(|&a| a > 0.0),
            powers,
        })
    }

    /// What the plate was made from.
    pub fn parameters(&self) -> &SlitMirror {
        &self.parameters
    }

    /// Passes a ray that travels along the unit vector `direction` through `point` (any point of
    /// the ray in air, mm; also one on its straight extension into the plate) to the far face.
    ///
    /// `None` if no light leaves: it met a mirror's front end, or never meets the plate
    /// (`direction.z` is 0). The plate's edges are the caller's: it has none here.
    ///
    /// Odd in both layers gives [`pass_ideal`](super::pass_ideal)'s direction, to rounding.
    pub fn pass(&self, point: Vec3, direction: Vec3) -> Option<Passage> {
        let passed = self.unfold(point, direction, direction.z > 0.0);
        if !passed.open {
            return None;
        }
        let mirrors = passed.mirrors.map(|met| met as u32);
        Some(Passage {
            exit_point: passed.exit_point,
            direction: passed.direction,
            mirrors,
            class: Class::of(mirrors),
            weight: self.weight(mirrors, passed.faces, passed.cos_t),
        })
    }

    /// [`Self::pass`] in arithmetic without branches, for many rays at once: `upwards` is whether the direction's z is above 0.
    #[inline(always)]
    pub(crate) fn unfold(&self, point: Vec3, direction: Vec3, upwards: bool) -> Unfolded {
        let p = &self.parameters;
        let d = direction;
        let face = if upwards { -self.half_thickness } else { self.half_thickness };
        let to_face = (face - point.z) / d.z;
        let at_face = [point.x + d.x * to_face, point.y + d.y * to_face];

        let f = fresnel(d.z.abs(), self.eta);
        // Snell keeps the tangential component but for the factor eta; per mm of depth:
        let deflection = self.eta / f.cos_t;

        let at = self.across(at_face);
        let along = self.across([d.x, d.y]);
        // Glass in front of each layer and behind it, as the ray meets them.
        let (near, far) = (p.cover_glass, p.cover_glass + p.layer_depth);
        let (before, after) = if upwards { (far, near) } else { (near, far) };
        let first = self.cross_layer(at[0], along[0] * deflection, before, after);
        let second = self.cross_layer(at[1], along[1] * deflection, after, before);

        let turned = |c: &Crossing, s: f64| if c.odd { -s } else { s };
        let exit = self.across_inverse([first.exit, second.exit]);
        let out = self.across_inverse([turned(&first, along[0]), turned(&second, along[1])]);
        let transmitted = f.transmittance();
        Unfolded {
            exit_point: Vec3::new(exit[0], exit[1], -face),
            direction: Vec3::new(out[0], out[1], d.z),
            mirrors: [first.mirrors, second.mirrors],
            open: first.open & second.open,
            faces: transmitted * transmitted,
            cos_t: f.cos_t,
        }
    }

    /// Share of light left by linear R, G, B, after so many mirrors in the two layers: `faces` is what both faces transmit, `cos_t` the
    /// cosine of the angle in the glass.
    #[inline]
    pub(crate) fn weight(&self, mirrors: [u32; 2], faces: f64, cos_t: f64) -> [f64; 3] {
        let p = &self.parameters;
        let met = mirrors[0].saturating_add(mirrors[1]);
        let mut weight = match self.powers.get(met as usize) {
            Some(&power) => power,
            None => p.reflectance.map(|r| r.powf(f64::from(met))),
        };
        weight = weight.map(|w| w * faces);
        if self.absorbs {
            let left = beer_lambert(p.absorption, 2.0 * self.half_thickness / cos_t);
            weight = [weight[0] * left[0], weight[1] * left[1], weight[2] * left[2]];
        }
        weight
    }

    /// Components across layer 0's mirrors and across layer 1's, of local x and y.
    #[inline]
    pub fn across(&self, xy: [f64; 2]) -> [f64; 2] {
        across(self.turn, xy)
    }

    /// Local x and y of components across the mirrors: the inverse of [`Self::across`].
    #[inline]
    pub fn across_inverse(&self, ab: [f64; 2]) -> [f64; 2] {
        across_inverse(self.turn, ab)
    }

    /// Crosses the plate in the plane across one layer's mirrors.
    ///
    /// `x` is the coordinate at the near face, `slope` its change per mm of depth, `before` and
    /// `after` the depths of glass in front of the layer and behind it.
    #[inline(always)]
    fn cross_layer(&self, x: f64, slope: f64, before: f64, after: f64) -> Crossing {
        let entry = x + slope * before;
        // The clear space between two mirrors that the ray enters, and where in it.
        let space = (entry * self.inverse_pitch).floor() * self.parameters.pitch + self.half_mirror;
        let offset = entry - space;
        // True is what lets light in, so NaN is refused as well.
        let open = (offset - 0.5 * self.clear).abs() <= self.half_clear;
        // Unfolded: a straight line over cells of the clear width.
        let unfolded = offset + slope * self.parameters.layer_depth;
        let cell = (unfolded * self.inverse_clear).floor();
        let mirrors = cell.abs();
        let odd = 0.5 * mirrors - (0.5 * mirrors).floor() > 0.25;
        let rest = unfolded - cell * self.clear;
        let (folded, slope) = if odd { (self.clear - rest, -slope) } else { (rest, slope) };
        Crossing { exit: space + folded + slope * after, mirrors, odd, open }
    }
}

/// [`SlitMirrorPlate::across`] for mirrors of this direction: sine and cosine of the azimuth.
#[inline]
pub(super) fn across<T: Real>((s, c): (f64, f64), [x, y]: [T; 2]) -> [T; 2] {
    [y * c - x * s, x * c + y * s]
}

/// [`SlitMirrorPlate::across_inverse`], likewise.
#[inline]
pub(super) fn across_inverse<T: Real>((s, c): (f64, f64), [a, b]: [T; 2]) -> [T; 2] {
    [b * c - a * s, a * c + b * s]
}

/// A ray's way across one layer, in the plane across its mirrors.
struct Crossing {
    /// Coordinate at the far face.
    exit: f64,
    /// How many mirrors were met: a whole number.
    mirrors: f64,
    odd: bool,
    /// Whether the ray entered between two mirrors; if not, the rest means nothing.
    open: bool,
}

/// What [`SlitMirrorPlate::pass`] makes a passage of.
pub(crate) struct Unfolded {
    pub(crate) exit_point: Vec3,
    pub(crate) direction: Vec3,
    /// Mirrors met in each layer: whole numbers.
    pub(crate) mirrors: [f64; 2],
    /// Whether light leaves; if not, the rest means nothing.
    pub(crate) open: bool,
    /// Transmittance of both faces.
    pub(crate) faces: f64,
    /// Cosine of the angle in the glass.
    pub(crate) cos_t: f64,
}

fn check(
    key: &'static str,
    value: f64,
    allowed: &'static str,
    holds: impl Fn(f64) -> bool,
) -> Result<(), PlateError> {
    if value.is_finite() && holds(value) { Ok(()) } else { Err(PlateError { key, value, allowed }) }
}

#[cfg(test)]
pub(super) mod tests;
