//! The arithmetic of a warp, and the choice of how it is computed.

use super::taps::{CubicTables, ONE, Plan, Tap, WEIGHT_BITS, unpack};
use std::ops::Range;

/// Bits dropped between the horizontal and the vertical sums, so that the former fit 16 bits.
pub(super) const BILINEAR_DROP: u32 = 7;
/// The same for cubic sums, which overshoot.
pub(super) const CUBIC_DROP: u32 = 8;
/// What is left to drop at the end.
pub(super) const BILINEAR_LAST: u32 = 2 * WEIGHT_BITS - BILINEAR_DROP;
/// The same for cubic sums.
pub(super) const CUBIC_LAST: u32 = 2 * WEIGHT_BITS - CUBIC_DROP;
/// Fraction bits that are kept of each of several samples.
pub(super) const SAMPLE_BITS: u32 = 6;

/// Whether the source is large enough for the vector kernels' loads, and the machine has them.
#[cfg(target_arch = "x86_64")]
fn vectors(source: [usize; 2]) -> bool {
    source[0] >= 4 && source[1] >= 4 && std::arch::is_x86_feature_detected!("avx2")
}

/// Pixels of one bilinear sample each.
pub(super) fn bilinear<const C: usize>(
    frame: &[u8],
    source: [usize; 2],
    taps: &[Tap],
    output: &mut [u8],
) {
    #[cfg(target_arch = "x86_64")]
    if vectors(source) {
        // SAFETY: the processor has AVX2; the function asks for nothing else.
        return unsafe { super::avx2::bilinear::<C>(frame, source, taps, output) };
    }
    bilinear_plain::<C>(frame, source, taps, output);
}

pub(super) fn bilinear_plain<const C: usize>(
    frame: &[u8],
    source: [usize; 2],
    taps: &[Tap],
    output: &mut [u8],
) {
    let right = if source[0] > 1 { C } else { 0 };
    let below = if source[1] > 1 { source[0] * C } else { 0 };
    for (tap, pixel) in taps.iter().zip(output.chunks_exact_mut(C)) {
        let (fx, fy) = (i32::from(tap.x), i32::from(tap.y));
        let first = tap.pixel as usize * C;
        for (c, sample) in pixel.iter_mut().enumerate() {
            let across = |start: usize| {
                let (a, b) = (frame[start + c], frame[start + right + c]);
                (i32::from(a) * (ONE - fx) + i32::from(b) * fx) >> BILINEAR_DROP
            };
            let sum = across(first) * (ONE - fy) + across(first + below) * fy;
            *sample = ((sum + (1 << (BILINEAR_LAST - 1))) >> BILINEAR_LAST) as u8;
        }
    }
}

/// Pixels of one or more cubic samples each.
pub(super) fn cubic<const C: usize>(
    frame: &[u8],
    source: [usize; 2],
    tables: &CubicTables,
    plan: &Plan,
    pixels: Range<usize>,
    output: &mut [u8],
) {
    #[cfg(target_arch = "x86_64")]
    if vectors(source) {
        if plan.is_single() {
            let taps = plan.taps(pixels);
            // SAFETY: the processor has AVX2; the function asks for nothing else.
            return unsafe { super::avx2::cubic_single::<C>(frame, source, tables, taps, output) };
        }
        // SAFETY: as above.
        return unsafe { super::avx2::cubic::<C>(frame, source, tables, plan, pixels, output) };
    }
    cubic_plain::<C>(frame, source, tables, plan, pixels, output);
}

pub(super) fn cubic_plain<const C: usize>(
    frame: &[u8],
    source: [usize; 2],
    tables: &CubicTables,
    plan: &Plan,
    pixels: Range<usize>,
    output: &mut [u8],
) {
    for (index, pixel) in pixels.zip(output.chunks_exact_mut(C)) {
        let samples = plan.samples(index);
        for (c, target) in pixel.iter_mut().enumerate() {
            *target = match samples {
                [tap] => {
                    let sum = cubic_sum::<C>(frame, source, tables, tap, c);
                    ((sum + (1 << (CUBIC_LAST - 1))) >> CUBIC_LAST).clamp(0, 255) as u8
                }
                _ => {
                    let mut total = 0;
                    for tap in samples {
                        total += sample_code(cubic_sum::<C>(frame, source, tables, tap, c));
                    }
                    mean_code(total, samples.len())
                }
            };
        }
    }
}

/// A sum as one of several samples: held to a code's range, with a few bits of fraction.
#[inline]
fn sample_code(sum: i32) -> i32 {
    (sum >> (CUBIC_LAST - SAMPLE_BITS)).clamp(0, 255 << SAMPLE_BITS)
}

/// The code of a mean of samples.
#[inline]
pub(super) fn mean_code(total: i32, count: usize) -> u8 {
    let scale = count as f32 * (1 << SAMPLE_BITS) as f32;
    (total as f32 / scale + 0.5) as u8
}

/// The weighted sum of 4 x 4 codes.
#[inline]
fn cubic_sum<const C: usize>(
    frame: &[u8],
    source: [usize; 2],
    tables: &CubicTables,
    tap: &Tap,
    c: usize,
) -> i32 {
    let wx = unpack(tables.x[usize::from(tap.x)]);
    let wy = unpack(tables.y[usize::from(tap.y)]);
    let mut sum = 0;
    // A source of fewer than four rows or columns has no weight on those that it lacks.
    for j in 0..source[1].min(4) {
        let line = (tap.pixel as usize + j * source[0]) * C + c;
        let mut across = 0;
        for i in 0..source[0].min(4) {
            across += i32::from(frame[line + i * C]) * wx[i];
        }
        sum += (across >> CUBIC_DROP) * wy[j];
    }
    sum
}
