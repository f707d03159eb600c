//! Warping sRGB frames in linear light: decoded to 15-bit light, interpolated, encoded again.
//!
//! A step of 15-bit light is at most a tenth of an 8-bit code (at black, where the curve is steepest).

use super::taps::{CubicTables, ONE, Plan, Tap, WEIGHT_BITS, unpack};
use crate::media::srgb;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::LazyLock;

/// White, in 15-bit light.
const WHITE: i32 = 32767;

/// Bits dropped between the horizontal and the vertical sums: white, overshot by a quarter each way (the most
/// that cubic weights can), then stays below 2^31.
const DROP: u32 = WEIGHT_BITS - 1;
/// What is left to drop at the end.
const LAST: u32 = 2 * WEIGHT_BITS - DROP;

/// Codes to light: sRGB for colours, proportional for alpha.
static DECODE: LazyLock<[[i16; 256]; 2]> = LazyLock::new(|| {
    let fixed = |light: f32| (light * WHITE as f32).round() as i16;
    [
        std::array::from_fn(|code| fixed(srgb::decode_8(code as u8))),
        std::array::from_fn(|code| fixed(code as f32 / 255.0)),
    ]
});

/// Light to codes.
static ENCODE: LazyLock<[Vec<u8>; 2]> = LazyLock::new(|| {
    [
        (0..=WHITE).map(|light| srgb::encode_8(light as f32 / WHITE as f32)).collect(),
        (0..=WHITE).map(|light| ((light * 255 + WHITE / 2) / WHITE) as u8).collect(),
    ]
});

/// Which of the two curves a channel has.
fn curve(channel: usize) -> usize {
    usize::from(channel == 3)
}

/// The light of a frame's pixels; the fourth channel is 0 in frames of three.
pub(super) fn decode<const C: usize>(frame: &[u8], light: &mut Vec<[i16; 4]>) {
    let tables = &*DECODE;
    let pixels = frame.as_chunks::<C>().0;
    pixels
        .par_iter()
        .with_min_len(1 << 14)
        .map(|pixel| {
            let mut light = [0; 4];
            for c in 0..C {
                light[c] = tables[curve(c)][usize::from(pixel[c])];
            }
            light
        })
        .collect_into_vec(light);
}

/// A run of output pixels.
pub(super) struct Run<'a> {
    pub(super) light: &'a [[i16; 4]],
    pub(super) source: [usize; 2],
    /// For cubic samples; bilinear ones need none.
    pub(super) tables: Option<&'a CubicTables>,
    pub(super) plan: &'a Plan,
    pub(super) pixels: Range<usize>,
}

impl Run<'_> {
    pub(super) fn warp<const C: usize>(self, output: &mut [u8]) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2; the function asks for nothing else.
            return unsafe { self.warp_avx2::<C>(output) };
        }
        self.warp_plain::<C>(output);
    }

    /// The same code, for the compiler to use wider instructions in.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn warp_avx2<const C: usize>(self, output: &mut [u8]) {
        self.warp_plain::<C>(output);
    }

    #[inline(always)]
    fn warp_plain<const C: usize>(self, output: &mut [u8]) {
        let codes = &*ENCODE;
        let Self { light, source: [width, height], tables, plan, pixels } = self;
        for (index, target) in pixels.zip(output.as_chunks_mut::<C>().0) {
            let sample = |tap: &Tap| match tables {
                Some(tables) => {
                    let wx = unpack(tables.x[usize::from(tap.x)]);
                    let wy = unpack(tables.y[usize::from(tap.y)]);
                    weighted_sum(light, width, height, tap, wx, wy)
                }
                None => {
                    let (fx, fy) = (i32::from(tap.x), i32::from(tap.y));
                    weighted_sum(light, width, height, tap, [ONE - fx, fx], [ONE - fy, fy])
                }
            };
            let value = match plan.samples(index) {
                [tap] => sample(tap),
                taps => {
                    let mut total = [0i32; 4];
                    for tap in taps {
                        let value = sample(tap);
                        (0..4).for_each(|c| total[c] += value[c]);
                    }
                    let count = taps.len().max(1) as i32;
                    total.map(|sum| (sum + count / 2) / count)
                }
            };
            for c in 0..C {
                target[c] = codes[curve(c)][value[c] as usize];
            }
        }
    }
}

/// The weighted sum of N x N pixels, held between black and white.
#[inline(always)]
fn weighted_sum<const N: usize>(
    light: &[[i16; 4]],
    width: usize,
    height: usize,
    tap: &Tap,
    wx: [i32; N],
    wy: [i32; N],
) -> [i32; 4] {
    let first = tap.pixel as usize;
    let mut sum = [1i32 << (LAST - 1); 4];
    // A source of fewer rows or columns has no weight on those that it lacks.
    for j in 0..N.min(height) {
        let start = first + j * width;
        let mut across = [1i32 << (DROP - 1); 4];
        if let Some(row) = light.get(start..).and_then(|rest| rest.first_chunk::<N>()) {
            for i in 0..N {
                for c in 0..4 {
                    across[c] += i32::from(row[i][c]) * wx[i];
                }
            }
        } else {
            for i in 0..N.min(width) {
                for c in 0..4 {
                    across[c] += i32::from(light[start + i][c]) * wx[i];
                }
            }
        }
        for c in 0..4 {
            sum[c] += (across[c] >> DROP) * wy[j];
        }
    }
    sum.map(|sum| (sum >> LAST).clamp(0, WHITE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives() {
        for c in 0..2 {
            for code in 0..256 {
                assert_eq!(usize::from(ENCODE[c][DECODE[c][code] as usize]), code);
            }
        }
    }
}
