//! From other primaries to those of sRGB.

use moxcms::{Chromaticity, ColorPrimaries, Matrix3d, adaption_matrix_d};

/// The colours that a file's red, green, blue and white are, as CIE 1931 x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primaries {
    /// Pure red.
    pub red: [f32; 2],
    /// Pure green.
    pub green: [f32; 2],
    /// Pure blue.
    pub blue: [f32; 2],
    /// All three at their most.
    pub white: [f32; 2],
}

/// ISO 11664-2, as BT.709 rounds it.
const D65: [f32; 2] = [0.3127, 0.3290];

/// What a difference in x or y is a rounding of the same number: files keep four or five digits.
const SAME: f32 = 2e-3;

impl Primaries {
    /// BT.709, which sRGB shares.
    pub const SRGB: Self = Self::of(ColorPrimaries::BT_709, D65);
    /// BT.2020 and BT.2100.
    pub const BT2020: Self = Self::of(ColorPrimaries::BT_2020, D65);
    /// Display P3 (SMPTE EG 432-1).
    pub const DISPLAY_P3: Self = Self::of(ColorPrimaries::DISPLAY_P3, D65);
    /// The cinema's P3 (SMPTE RP 431-2), with its greenish white.
    pub const DCI_P3: Self = Self::of(ColorPrimaries::DCI_P3, [0.314, 0.351]);

    const fn of(primaries: ColorPrimaries, white: [f32; 2]) -> Self {
        let ColorPrimaries { red, green, blue } = primaries;
        Self { red: [red.x, red.y], green: [green.x, green.y], blue: [blue.x, blue.y], white }
    }

    /// Those of a code point of ITU-T H.273, table 2; `None` for codes that say nothing or are reserved.
    pub fn of_code(code: u8) -> Option<Self> {
        // Illuminant C, of the films and television of old.
        const C: [f32; 2] = [0.310, 0.316];
        Some(match code {
            1 => Self::SRGB,
            4 => Self::of(ColorPrimaries::BT_470M, C),
            5 => Self::of(ColorPrimaries::BT_470BG, D65),
            6 | 7 => Self::of(ColorPrimaries::BT_601, D65),
            8 => Self::of(ColorPrimaries::GENERIC_FILM, C),
            9 => Self::BT2020,
            11 => Self::DCI_P3,
            12 => Self::DISPLAY_P3,
            22 => Self::of(ColorPrimaries::EBU_3213, D65),
            _ => return None,
        })
    }

    /// Whether they are sRGB's, but for the digits that files keep.
    pub fn is_srgb(&self) -> bool {
        let parts = |p: &Self| [p.red, p.green, p.blue, p.white].concat();
        parts(self).iter().zip(parts(&Self::SRGB)).all(|(a, b)| (a - b).abs() <= SAME)
    }

    /// The matrix that takes light in these primaries to light in sRGB's, white to white (Bradford's adaptation; Lindbloom's derivation); `None`
    /// where they span no colours.
    pub fn to_srgb(&self) -> Option<ToSrgb> {
        let known = [self.red, self.green, self.blue, self.white];
        if !known.iter().flatten().all(|c| c.is_finite() && c.abs() < 10.0) || self.white[1] <= 0.0
        {
            return None;
        }
        let area = |[a, b, c]: [[f32; 2]; 3]| {
            (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        };
        if area([self.red, self.green, self.blue]).abs() < 1e-4 {
            return None;
        }
        let adapted = adaption_matrix_d(point(self.white).to_xyz(), point(D65).to_xyz());
        let matrix = Self::SRGB.to_xyz().inverse().mat_mul(adapted.mat_mul(self.to_xyz()));
        matrix.v.iter().flatten().all(|x| x.is_finite()).then_some(ToSrgb(matrix.v))
    }

    fn to_xyz(self) -> Matrix3d {
        let primaries = ColorPrimaries {
            red: point(self.red),
            green: point(self.green),
            blue: point(self.blue),
        };
        primaries.transform_to_xyz_d(point(self.white))
    }
}

fn point([x, y]: [f32; 2]) -> Chromaticity {
    Chromaticity::new(x, y)
}

/// A matrix from other primaries to sRGB's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToSrgb([[f64; 3]; 3]);

impl ToSrgb {
    /// Light in sRGB's primaries: below 0 or above 1 where the colour lies outside of what they span.
    pub fn apply(&self, light: [f32; 3]) -> [f32; 3] {
        let light = light.map(f64::from);
        self.0.map(|row| (row[0] * light[0] + row[1] * light[1] + row[2] * light[2]) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: [f32; 3], b: [f32; 3], tolerance: f32) {
        assert!((0..3).all(|c| (a[c] - b[c]).abs() <= tolerance), "{a:?} {b:?}");
    }

    #[test]
    fn the_matrices_are_the_published_ones() {
        // BT.2087-0 prints the matrix from BT.709 to BT.2020 to four digits.
        let to_709 = Primaries::BT2020.to_srgb().unwrap();
        for (column, light) in
            [[0.6274, 0.0691, 0.0164], [0.3293, 0.9195, 0.0880], [0.0433, 0.0114, 0.8956]]
                .into_iter()
                .zip([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        {
            // Half a unit of the fourth digit, up to 1.66 times three of them.
            close(to_709.apply(column), light, 3e-4);
        }
        // CSS Color 4 converts color(display-p3 1 0 0) to color(srgb-linear 1.2249 -0.0421 -0.0196).
        close(
            Primaries::DISPLAY_P3.to_srgb().unwrap().apply([1.0, 0.0, 0.0]),
            [1.2249, -0.0421, -0.0196],
            1e-4,
        );
        // ACES 2065-1, white about D60.
        let aces = Primaries {
            red: [0.7347, 0.2653],
            green: [0.0, 1.0],
            blue: [0.0001, -0.077],
            white: [0.32168, 0.33767],
        };
        // Bradford's matrix as OpenColorIO and colour-science print it: rows 2.5216 -1.1341 -0.3876, -0.2765 1.3727 -0.0962, -0.0154 -0.1530 1.1684.
        let light = [0.5, 0.2, 0.1];
        let row = |r: [f32; 3]| (0..3).map(|c| r[c] * light[c]).sum::<f32>();
        let wanted = [
            row([2.5216, -1.1341, -0.3876]),
            row([-0.2765, 1.3727, -0.0962]),
            row([-0.0154, -0.1530, 1.1684]),
        ];
        close(aces.to_srgb().unwrap().apply(light), wanted, 1e-4);
    }

    #[test]
    fn white_stays_white_and_srgb_stays_itself() {
        for code in 0..=255 {
            let Some(primaries) = Primaries::of_code(code) else { continue };
            close(primaries.to_srgb().unwrap().apply([1.0; 3]), [1.0; 3], 1e-5);
        }
        assert!(Primaries::SRGB.is_srgb() && !Primaries::DISPLAY_P3.is_srgb());
        close(Primaries::SRGB.to_srgb().unwrap().apply([0.2, 0.5, 0.9]), [0.2, 0.5, 0.9], 1e-6);
    }

    #[test]
    fn primaries_that_span_nothing_are_none() {
        let mut flat = Primaries::SRGB;
        flat.blue = flat.green;
        assert_eq!(flat.to_srgb(), None);
        let nan = Primaries { white: [f32::NAN, 0.3], ..Primaries::SRGB };
        assert_eq!(nan.to_srgb(), None);
    }
}
