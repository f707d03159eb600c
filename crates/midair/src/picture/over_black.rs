//! Frames with alpha, as a display shows them: what is transparent emits no light.

use super::curve::Tables;
use super::{Curve, srgb};

/// Puts frames with alpha over black, in light: packed RGBA becomes RGB. Alpha is not premultiplied, as films keep it.
#[derive(Clone, Debug)]
pub struct OverBlack(Kind);

#[derive(Clone, Debug)]
enum Kind {
    /// The code of each code (lower 8 bits) and alpha (upper).
    Eight(Vec<u8>),
    Sixteen(Box<Tables>),
}

impl OverBlack {
    /// For frames of 16 bits a sample (little-endian) whose codes stand for light by `curve`, or of 8 bits of sRGB.
    pub fn new(deep: bool, curve: Curve) -> Self {
        if deep {
            return Self(Kind::Sixteen(Box::new(Tables::new(curve))));
        }
        let codes = (0..=u16::MAX).map(|both| {
            let [alpha, code] = both.to_be_bytes();
            srgb::encode_8(srgb::decode_8(code) * f32::from(alpha) / 255.0)
        });
        Self(Kind::Eight(codes.collect()))
    }

    /// One frame; `rgb` gets its bytes.
    pub fn apply(&self, rgba: &[u8], rgb: &mut Vec<u8>) {
        rgb.clear();
        match &self.0 {
            Kind::Eight(codes) => {
                rgb.extend(rgba.as_chunks::<4>().0.iter().flat_map(|&[r, g, b, alpha]| {
                    [r, g, b].map(|code| codes[usize::from(u16::from_be_bytes([alpha, code]))])
                }));
            }
            Kind::Sixteen(tables) => {
                for pixel in rgba.as_chunks::<8>().0 {
                    let samples: [u16; 4] = std::array::from_fn(|c| {
                        u16::from_le_bytes([pixel[2 * c], pixel[2 * c + 1]])
                    });
                    let alpha = samples[3];
                    for &code in &samples[..3] {
                        let shown = match alpha {
                            u16::MAX => code,
                            _ => tables.encode(tables.decode(code) * f32::from(alpha) / 65535.0),
                        };
                        rgb.extend(shown.to_le_bytes());
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_alpha_is_half_the_light() {
        let mut rgb = Vec::new();
        // Half the light of white is sRGB's 188 (0.5 encoded is 0.7354).
        OverBlack::new(false, Curve::Srgb)
            .apply(&[255, 0, 80, 128, 9, 200, 255, 0, 1, 2, 3, 255], &mut rgb);
        let half = srgb::encode(128.0 / 255.0) * 255.0;
        assert_eq!(rgb[0], half.round() as u8);
        assert_eq!((rgb[1], &rgb[3..]), (0, &[0, 0, 0, 1, 2, 3][..]));
        let samples: [u16; 8] = [65535, 30000, 0, 32768, 1, 777, 65535, 65535];
        let bytes: Vec<u8> = samples.iter().flat_map(|s| s.to_le_bytes()).collect();
        for curve in [Curve::Srgb, Curve::Linear, Curve::Pq] {
            OverBlack::new(true, curve).apply(&bytes, &mut rgb);
            let shown: Vec<u16> =
                rgb.as_chunks::<2>().0.iter().map(|&pair| u16::from_le_bytes(pair)).collect();
            for c in 0..3 {
                let light = curve.decode(f64::from(samples[c]) / 65535.0) * 32768.0 / 65535.0;
                let wanted = curve.encode(light) * 65535.0;
                // Half a code of rounding, and a float's 24 bits where the curve is steep.
                assert!((f64::from(shown[c]) - wanted).abs() < 0.6, "{curve:?} {c}");
            }
            assert_eq!(shown[3..], samples[4..7]);
        }
    }
}
