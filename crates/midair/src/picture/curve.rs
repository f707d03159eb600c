//! How 16-bit codes stand for light: sRGB and the curves of films of a wide range, as tables.

use super::srgb;

/// A transfer function. Light of 1 is the brightest that a code can say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curve {
    /// IEC 61966-2-1, for everything without a wide range.
    #[default]
    Srgb,
    /// Codes are light.
    Linear,
    /// SMPTE ST 2084, "PQ": absolute, 1 is 10000 cd/m2.
    Pq,
    /// ARIB STD-B67, "HLG" (ITU-R BT.2100): the light of the scene.
    Hlg,
}

// ST 2084, 5.1.
const M1: f64 = 2610.0 / 16384.0;
const M2: f64 = 2523.0 / 4096.0 * 128.0;
const C1: f64 = 3424.0 / 4096.0;
const C2: f64 = 2413.0 / 4096.0 * 32.0;
const C3: f64 = 2392.0 / 4096.0 * 32.0;
// BT.2100-2, table 5.
const A: f64 = 0.178_832_77;
const B: f64 = 0.284_668_92;
const C: f64 = 0.559_910_73;

impl Curve {
    /// Light of an encoded value, both in \[0, 1\].
    pub fn decode(self, encoded: f64) -> f64 {
        match self {
            Self::Srgb => srgb::decode(encoded),
            Self::Linear => encoded,
            Self::Pq => {
                let e = encoded.powf(1.0 / M2);
                ((e - C1).max(0.0) / (C2 - C3 * e)).powf(1.0 / M1)
            }
            Self::Hlg if encoded <= 0.5 => encoded * encoded / 3.0,
            Self::Hlg => (((encoded - C) / A).exp() + B) / 12.0,
        }
    }

    /// Encoded value of light, both in \[0, 1\].
    pub fn encode(self, light: f64) -> f64 {
        match self {
            Self::Srgb => srgb::encode(light),
            Self::Linear => light,
            Self::Pq => {
                let y = light.powf(M1);
                ((C1 + C2 * y) / (1.0 + C3 * y)).powf(M2)
            }
            Self::Hlg if light <= 1.0 / 12.0 => (3.0 * light).sqrt(),
            Self::Hlg => A * (12.0 * light - B).ln() + C,
        }
    }
}

/// A curve for 16-bit codes, both ways.
#[derive(Clone, Debug)]
pub(super) struct Tables {
    light: Vec<f32>,
    /// Encoded values at floats whose lower 13 bits are 0, from [`SMALLEST`] to 1 and one more.
    codes: Vec<f32>,
}

/// 2^-60: below it codes go straight to 0.
const SMALLEST: u32 = (127 - 60) << 23;
/// Bits of a float that lie between two entries.
const BETWEEN: u32 = 13;

impl Tables {
    pub(super) fn new(curve: Curve) -> Self {
        let light =
            (0..=u16::MAX).map(|code| curve.decode(f64::from(code) / 65535.0) as f32).collect();
        let last = (1.0f32.to_bits() - SMALLEST) >> BETWEEN;
        let codes = (0..=last + 1)
            .map(|entry| {
                let light = f64::from(f32::from_bits(SMALLEST + (entry << BETWEEN))).min(1.0);
                (curve.encode(light) * 65535.0) as f32
            })
            .collect();
        Self { light, codes }
    }

    pub(super) fn decode(&self, code: u16) -> f32 {
        self.light[usize::from(code)]
    }

    /// The nearest code of light, which must be a number; below 0 gives 0, above 1 gives 65535.
    pub(super) fn encode(&self, light: f32) -> u16 {
        let light = light.clamp(0.0, 1.0);
        let code = match light.to_bits().checked_sub(SMALLEST) {
            None => self.codes[0] * (light / f32::from_bits(SMALLEST)),
            Some(above) => {
                let entry = (above >> BETWEEN) as usize;
                let rest = (above & ((1 << BETWEEN) - 1)) as f32 / (1u32 << BETWEEN) as f32;
                self.codes[entry] + rest * (self.codes[entry + 1] - self.codes[entry])
            }
        };
        (code + 0.5) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Curve; 4] = [Curve::Srgb, Curve::Linear, Curve::Pq, Curve::Hlg];

    #[test]
    fn the_standards_own_points_hold() {
        // BT.2100: HLG's halves meet at 1/12 and 0.5, and 1 is 1. BT.2408: PQ says 100 cd/m2 at 0.508, 1000 at 0.752.
        assert!((Curve::Hlg.encode(1.0 / 12.0) - 0.5).abs() < 1e-12);
        assert!((Curve::Hlg.encode(1.0) - 1.0).abs() < 1e-6);
        assert!((Curve::Pq.encode(0.01) - 0.508).abs() < 5e-4);
        assert!((Curve::Pq.encode(0.1) - 0.752).abs() < 5e-4);
        assert!((Curve::Pq.encode(1.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn every_code_survives_and_tables_are_the_formulas() {
        for curve in ALL {
            let tables = Tables::new(curve);
            for code in 0..=u16::MAX {
                // The lowest PQ codes stand for less light than a float's smallest entry tells apart.
                if curve != Curve::Pq || code > 200 {
                    assert_eq!(tables.encode(tables.decode(code)), code, "{curve:?}");
                }
            }
            for i in 1..5000 {
                let light = (f64::from(i) / 5000.0).powi(4) as f32;
                let exact = curve.encode(f64::from(light)) * 65535.0;
                // Half a code of rounding; chords of 2^-10 of the light bend by less than 0.01 codes.
                assert!(
                    (f64::from(tables.encode(light)) - exact).abs() < 0.51,
                    "{curve:?} {light}"
                );
            }
        }
    }

    #[test]
    fn the_ends_saturate() {
        for curve in ALL {
            let tables = Tables::new(curve);
            let codes = [-1.0, 1.0, 2.0, f32::INFINITY].map(|light| tables.encode(light));
            assert_eq!(codes[1..], [65535; 3]);
            assert!(codes[0] == tables.encode(0.0) && codes[0] == 0, "{curve:?}: {codes:?}");
        }
    }
}
