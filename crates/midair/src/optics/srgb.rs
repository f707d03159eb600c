//! The sRGB transfer functions (IEC 61966-2-1:1999, with Amendment 1), for the whole library.

use std::sync::LazyLock;

/// Linear light of an encoded value in \[0, 1\].
pub fn decode(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Encoded value of linear light in \[0, 1\].
pub fn encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Slope of [`encode`]: how much a step of linear light shows in the encoded value.
pub fn encode_slope(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 } else { 1.055 / 2.4 * linear.powf(1.0 / 2.4 - 1.0) }
}

static DECODE_8: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| decode(code as f64 / 255.0) as f32));

static DECODE_16: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=u16::MAX).map(|code| decode(f64::from(code) / 65535.0) as f32).collect());

/// Linear light of an 8-bit code.
pub fn decode_8(code: u8) -> f32 {
    DECODE_8[usize::from(code)]
}

/// Linear light of a 16-bit code.
pub fn decode_16(code: u16) -> f32 {
    DECODE_16[usize::from(code)]
}

/// Bins of linear light in which the search for an 8-bit code starts.
const BINS: usize = 4096;

struct Encode8 {
    /// `threshold[k]`: the least linear light that rounds to code k + 1.
    threshold: [f32; 256],
    /// Code of the lower edge of each bin.
    start: [u8; BINS + 1],
}

static ENCODE_8: LazyLock<Encode8> = LazyLock::new(|| {
    let threshold: [f32; 256] = std::array::from_fn(|k| {
        if k == 255 {
            return f32::INFINITY;
        }
        // The exact threshold lies between two floats; the upper one is the first that rounds up.
        let exact = decode((k as f64 + 0.5) / 255.0);
        let near = exact as f32;
        if f64::from(near) < exact { near.next_up() } else { near }
    });
    let start = std::array::from_fn(|bin| {
        let edge = bin as f32 / BINS as f32;
        threshold.partition_point(|&limit| limit <= edge) as u8
    });
    Encode8 { threshold, start }
});

/// The 8-bit code nearest to linear light; below 0 (and NaN) gives 0, above 1 gives 255.
pub fn encode_8(linear: f32) -> u8 {
    let table = &*ENCODE_8;
    if linear <= 0.0 || linear.is_nan() {
        return 0;
    }
    if linear >= 1.0 {
        return 255;
    }
    let mut code = table.start[(linear * BINS as f32) as usize];
    while linear >= table.threshold[usize::from(code)] {
        code += 1;
    }
    code
}

/// The 16-bit code nearest to linear light; below 0 (and NaN) gives 0, above 1 gives 65535.
pub fn encode_16(linear: f32) -> u16 {
    // `as` saturates and sends NaN to 0.
    (encode(f64::from(linear.clamp(0.0, 1.0))) * 65535.0 + 0.5) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_standards_own_points_hold() {
        // IEC 61966-2-1: white, black, and mid grey 188 is about half the light.
        assert_eq!(decode(0.0), 0.0);
        assert!((decode(1.0) - 1.0).abs() < 1e-15);
        assert!((decode(188.0 / 255.0) - 0.5028).abs() < 1e-4);
        // The two pieces meet to the precision of the standard's rounded constants.
        assert!((decode(0.04045) - decode(0.04045 + 1e-12)).abs() < 1e-7);
    }

    #[test]
    fn every_code_survives_the_round_trip() {
        for code in 0..=255u8 {
            assert_eq!(encode_8(decode_8(code)), code);
        }
        for code in 0..=u16::MAX {
            assert_eq!(encode_16(decode_16(code)), code);
        }
    }

    #[test]
    fn slope_is_the_derivative() {
        for linear in [1e-4, 0.002, 0.01, 0.2, 0.9] {
            let step = 1e-7;
            let difference = (encode(linear + step) - encode(linear - step)) / (2.0 * step);
            // Central difference: truncation f''' step^2 / 6 and rounding 1e-16 / step are below 1e-6 relative.
            assert!((difference / encode_slope(linear) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_ends_saturate() {
        assert_eq!(encode_8(f32::NAN), 0);
        assert_eq!(encode_8(-1.0), 0);
        assert_eq!(encode_8(f32::INFINITY), 255);
        assert_eq!(encode_16(f32::NAN), 0);
        assert_eq!(encode_16(7.0), 65535);
    }

    #[test]
    fn eight_bit_encoding_switches_exactly_at_the_half_steps() {
        for k in 0..255u8 {
            let exact = decode((f64::from(k) + 0.5) / 255.0);
            let mut above = exact as f32;
            if f64::from(above) < exact {
                above = above.next_up();
            }
            assert_eq!(encode_8(above), k + 1);
            assert_eq!(encode_8(above.next_down()), k);
        }
    }

    proptest! {
        #[test]
        fn encoding_is_the_formula_rounded(linear in 0.0f32..=1.0) {
            let exact = encode(f64::from(linear)) * 255.0;
            // Nearest code: no further than half a step, with the rounding of the f64 formula.
            prop_assert!((f64::from(encode_8(linear)) - exact).abs() <= 0.5 + 1e-9);
        }
    }
}
