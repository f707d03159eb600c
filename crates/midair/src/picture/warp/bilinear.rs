//! Bilinear taps of whole rows, and which of their pixels have one.

use super::taps::{ONE, Tap, WEIGHT_BITS};
use crate::map::to_drawn_precision;
use std::ops::Range;

/// Writes the taps of a row's pixels, with the widest instructions that this machine has. uv are taken to
/// the [precision](to_drawn_precision) of all that is drawn. What is written for a pixel without an
/// answer is a tap within the source, of no meaning.
pub(super) fn tap_row(uv: &[[f64; 2]], source: [usize; 2], taps: &mut [Tap]) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        // SAFETY: the instructions were just found to exist.
        return unsafe { tap_row_avx2(uv, source, taps) };
    }
    tap_row_plain(uv, source, taps);
}

/// As [`tap_row_plain`], to the same bit, four pixels at a time.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn tap_row_avx2(uv: &[[f64; 2]], source: [usize; 2], taps: &mut [Tap]) {
    use super::taps::AHEAD;
    use std::arch::x86_64::*;
    let [zero, half, one] = [0.0, 0.5, 1.0].map(|c| _mm256_set1_pd(c));
    let [parts, rounding] = [ONE as f64, ROUNDING].map(|c| _mm256_set1_pd(c));
    let mantissa = _mm256_set1_epi64x(MANTISSA as i64);
    let columns = _mm256_set1_epi64x(source[0] as i64);
    let [size, last] = [0.0, 1.0].map(|less| source.map(|n| _mm256_set1_pd(n as f64 - less)));
    let most = source.map(|n| _mm256_set1_epi64x(n.saturating_sub(2) as i64));
    // As [`split`]: the first of two pixels, and the fraction.
    macro_rules! split {
        ($coordinate:expr, $axis:literal) => {{
            // Of NaN and another number the latter is taken.
            let place = _mm256_min_pd(_mm256_max_pd($coordinate, zero), last[$axis]);
            let fixed = _mm256_add_pd(_mm256_mul_pd(place, parts), rounding);
            let fixed = _mm256_and_si256(_mm256_castpd_si256(fixed), mantissa);
            let below = _mm256_srli_epi64::<{ WEIGHT_BITS as i32 }>(fixed);
            // Both are far below 2^32.
            let below = _mm256_min_epu32(below, most[$axis]);
            let fraction =
                _mm256_sub_epi64(fixed, _mm256_slli_epi64::<{ WEIGHT_BITS as i32 }>(below));
            (below, fraction)
        }};
    }
    let count = uv.len().min(taps.len()) / 4 * 4;
    for (uv, taps) in uv.as_chunks::<4>().0.iter().zip(taps.as_chunks_mut::<4>().0) {
        // Each a signpost to memory that is written later on, and is on its way until then.
        _mm_prefetch::<_MM_HINT_ET0>(taps.as_ptr().wrapping_add(AHEAD).cast());
        let [low, high] = [&uv[..2], &uv[2..]].map(|two| {
            // SAFETY: two pixels are four numbers; the load needs no alignment.
            unsafe { _mm256_loadu_pd(two.as_ptr().cast()) }
        });
        let [low, high] = [low, high].map(|uv| _mm256_cvtps_pd(_mm256_cvtpd_ps(uv)));
        // Pixels 0, 2, 1, 3.
        let (u, v) = (_mm256_unpacklo_pd(low, high), _mm256_unpackhi_pd(low, high));
        let (column, x) = split!(_mm256_sub_pd(_mm256_mul_pd(u, size[0]), half), 0);
        let down = _mm256_mul_pd(_mm256_sub_pd(one, v), size[1]);
        let (row, y) = split!(_mm256_sub_pd(down, half), 1);
        let pixel = _mm256_add_epi64(_mm256_mul_epu32(row, columns), column);
        let fractions = _mm256_or_si256(_mm256_slli_epi64::<32>(x), _mm256_slli_epi64::<48>(y));
        let words = _mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_or_si256(pixel, fractions));
        // SAFETY: four taps are as long as the 32 bytes that are written, each word being a tap's pixel, x and y; the store needs no alignment.
        unsafe { _mm256_storeu_si256(taps.as_mut_ptr().cast(), words) };
    }
    tap_row_plain(&uv[count..], source, &mut taps[count..]);
}

/// Written without closures: they would not share their caller's instruction set.
#[inline(always)]
fn tap_row_plain(uv: &[[f64; 2]], source: [usize; 2], taps: &mut [Tap]) {
    let size = [source[0] as f64, source[1] as f64];
    let most = [source[0].saturating_sub(2) as u64, source[1].saturating_sub(2) as u64];
    let columns = source[0] as u32;
    for (tap, &uv) in taps.iter_mut().zip(uv) {
        let [u, v] = to_drawn_precision(uv);
        let (column, x) = split(u * size[0] - 0.5, size[0] - 1.0, most[0]);
        let (row, y) = split((1.0 - v) * size[1] - 0.5, size[1] - 1.0, most[1]);
        *tap = Tap { pixel: row.wrapping_mul(columns).wrapping_add(column), x, y };
    }
}

/// 2^52: from here to twice as much a double's last bit counts ones, so that adding it rounds.
const ROUNDING: f64 = (1u64 << 52) as f64;
/// The bits that count them.
const MANTISSA: u64 = (1 << 52) - 1;

/// The first of two neighbouring pixels, and the way from there to the coordinate, in parts of [`ONE`]. NaN is taken for 0.
#[inline(always)]
fn split(coordinate: f64, last: f64, most: u64) -> (u32, u16) {
    let place = coordinate.max(0.0).min(last) * ONE as f64;
    // A place below 2^30 pixels, so below 2^44.
    let fixed = (place + ROUNDING).to_bits() & MANTISSA;
    let below = (fixed >> WEIGHT_BITS).min(most);
    (below as u32, (fixed - (below << WEIGHT_BITS)) as u16)
}

/// Pixels looked at together.
const BLOCK: usize = 32;

/// The covered runs of columns of a row.
pub(super) fn spans_of_row(uv: &[[f64; 2]]) -> Vec<Range<u32>> {
    let mut spans: Vec<Range<u32>> = Vec::new();
    let mut add = |start: usize, end: usize| {
        let (start, end) = (start as u32, end as u32);
        match spans.last_mut() {
            Some(span) if span.end == start => span.end = end,
            _ => spans.push(start..end),
        }
    };
    for (index, block) in uv.chunks(BLOCK).enumerate() {
        let start = index * BLOCK;
        // No branch from pixel to pixel.
        let answered = |&[u, v]: &[f64; 2]| u.is_finite() & v.is_finite();
        let count = block.iter().map(|uv| usize::from(answered(uv))).sum::<usize>();
        if count == block.len() {
            add(start, start + count);
        } else if count > 0 {
            for (i, uv) in block.iter().enumerate() {
                if answered(uv) {
                    add(start + i, start + i + 1);
                }
            }
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![
            8 => -0.2f64..1.2,
            1 => prop::sample::select(vec![
                0.0, 1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, f64::MIN_POSITIVE,
            ]),
        ]
    }

    proptest! {
        /// Against the definition, coordinate by coordinate in plain arithmetic.
        #[test]
        fn taps_are_where_the_coordinates_say(
            uv in prop::collection::vec([coordinate(), coordinate()], 0..100),
            width in 1usize..5000,
            height in prop::sample::select(vec![1, 2, 3, 57, 4320, 1 << 17]),
        ) {
            let mut taps = vec![Tap::default(); uv.len()];
            tap_row(&uv, [width, height], &mut taps);
            let mut compared = 0;
            for (tap, uv) in taps.iter().zip(&uv) {
                let (column, row) = (tap.pixel as usize % width, tap.pixel as usize / width);
                prop_assert!(row <= height.saturating_sub(2) && column <= width.saturating_sub(2));
                if !(uv[0].is_finite() && uv[1].is_finite()) {
                    continue;
                }
                let uv = to_drawn_precision(*uv);
                let wanted = [
                    (uv[0] * width as f64 - 0.5).clamp(0.0, (width - 1) as f64),
                    ((1.0 - uv[1]) * height as f64 - 0.5).clamp(0.0, (height - 1) as f64),
                ];
                let found = [(column, tap.x), (row, tap.y)];
                for ((below, fraction), wanted) in found.into_iter().zip(wanted) {
                    prop_assert!(i32::from(fraction) <= ONE);
                    let place = below as f64 + f64::from(fraction) / f64::from(ONE);
                    // Half a step of the fraction, and double precision's share.
                    prop_assert!((place - wanted).abs() <= 0.5 / f64::from(ONE) + 1e-9, "{place} {wanted}");
                }
                compared += 1;
            }
            // Seven of eight coordinates are numbers, but a row may be of three.
            prop_assume!(2 * compared >= uv.len());
        }

        #[test]
        fn spans_hold_the_finite_pixels_and_no_others(
            runs in prop::collection::vec((any::<bool>(), 1usize..80), 0..8),
        ) {
            let mut answered = Vec::new();
            for (there, length) in runs {
                answered.extend(std::iter::repeat_n(there, length));
            }
            let uv: Vec<[f64; 2]> = answered
                .iter()
                .enumerate()
                .map(|(i, &there)| match (there, i % 3) {
                    (true, _) => [0.5, 0.25],
                    (false, 0) => [f64::NAN, 0.5],
                    (false, 1) => [0.5, f64::NAN],
                    (false, _) => [f64::INFINITY, 0.5],
                })
                .collect();
            let spans = spans_of_row(&uv);
            let mut covered = vec![false; uv.len()];
            for span in &spans {
                for column in span.clone() {
                    prop_assert!(!covered[column as usize]);
                    covered[column as usize] = true;
                }
            }
            prop_assert_eq!(covered, answered);
            // Runs are whole: no two of them touch.
            prop_assert!(spans.windows(2).all(|pair| pair[0].end < pair[1].start));
        }
    }
}
