//! The kernels of [`super::kernel`] with 256-bit integers. Same arithmetic, same results; every load is
//! bounds-checked.

use super::kernel::{self, BILINEAR_DROP, BILINEAR_LAST, CUBIC_DROP, CUBIC_LAST, SAMPLE_BITS};
use super::taps::{AHEAD, CubicTables, ONE, Plan, Tap};
use std::arch::x86_64::*;
use std::ops::Range;

/// Eight bytes from `start`, those past the frame's end being 0.
#[inline(always)]
fn load_8(frame: &[u8], start: usize) -> i64 {
    match frame.get(start..).and_then(|rest| rest.first_chunk::<8>()) {
        Some(bytes) => i64::from_le_bytes(*bytes),
        None => load_8_at_the_end(frame, start),
    }
}

#[cold]
fn load_8_at_the_end(frame: &[u8], start: usize) -> i64 {
    let mut bytes = [0; 8];
    let rest = &frame[start..];
    bytes[..rest.len()].copy_from_slice(rest);
    i64::from_le_bytes(bytes)
}

/// Sixteen bytes from `start`, those past the frame's end being 0.
#[inline]
#[target_feature(enable = "avx2")]
fn load_16(frame: &[u8], start: usize) -> __m128i {
    match frame.get(start..).and_then(|rest| rest.first_chunk::<16>()) {
        // SAFETY: the chunk has the 16 bytes that are read; the load needs no alignment.
        Some(bytes) => unsafe { _mm_loadu_si128(bytes.as_ptr().cast()) },
        None => load_16_at_the_end(frame, start),
    }
}

#[cold]
#[inline(never)]
#[target_feature(enable = "avx2")]
fn load_16_at_the_end(frame: &[u8], start: usize) -> __m128i {
    let mut bytes = [0; 16];
    let rest = &frame[start..];
    bytes[..rest.len()].copy_from_slice(rest);
    // SAFETY: the array has the 16 bytes that are read; the load needs no alignment.
    unsafe { _mm_loadu_si128(bytes.as_ptr().cast()) }
}

/// The shuffle that makes 16-bit pairs (channel of pixel `first`, same channel of the next) of packed bytes.
#[inline]
#[target_feature(enable = "avx2")]
fn pair_mask<const C: usize>(first: usize) -> __m256i {
    let mut mask = [-1i8; 16];
    for c in 0..C {
        mask[4 * c] = (first * C + c) as i8;
        mask[4 * c + 2] = ((first + 1) * C + c) as i8;
    }
    let [low, high] =
        [0, 8].map(|i| i64::from_le_bytes(std::array::from_fn(|k| mask[i + k] as u8)));
    _mm256_set_epi64x(high, low, high, low)
}

/// Weights (1 - f, f) as pairs, of fractions in the low halves.
#[inline]
#[target_feature(enable = "avx2")]
fn weight_pairs(fractions: __m256i) -> __m256i {
    let first = _mm256_sub_epi32(_mm256_set1_epi32(ONE), fractions);
    _mm256_or_si256(first, _mm256_slli_epi32::<16>(fractions))
}

/// The weights of eight pixels' taps, across and down.
#[inline]
#[target_feature(enable = "avx2")]
pub(super) fn weights(taps: &[Tap; 8]) -> (__m256i, __m256i) {
    // Written out: closures would not share the instruction set, and the numbers would go through memory.
    macro_rules! fractions {
        ($axis:ident) => {
            _mm256_setr_epi32(
                i32::from(taps[0].$axis),
                i32::from(taps[1].$axis),
                i32::from(taps[2].$axis),
                i32::from(taps[3].$axis),
                i32::from(taps[4].$axis),
                i32::from(taps[5].$axis),
                i32::from(taps[6].$axis),
                i32::from(taps[7].$axis),
            )
        };
    }
    (weight_pairs(fractions!(x)), weight_pairs(fractions!(y)))
}

#[target_feature(enable = "avx2")]
pub(super) fn bilinear<const C: usize>(
    frame: &[u8],
    source: [usize; 2],
    taps: &[Tap],
    output: &mut [u8],
) {
    let stride = source[0] * C;
    let pairs = pair_mask::<C>(0);
    let half = _mm256_set1_epi32(1 << (BILINEAR_LAST - 1));
    let (blocks, rest) = taps.as_chunks::<8>();
    let (targets, last) = output.split_at_mut(blocks.len() * 8 * C);
    for (block, target) in blocks.iter().zip(targets.chunks_exact_mut(8 * C)) {
        _mm_prefetch::<_MM_HINT_T0>(block.as_ptr().wrapping_add(AHEAD).cast());
        let (wx, wy) = weights(block);
        // Pixels k and k + 4 in the two lanes.
        macro_rules! two {
            ($k:literal, $spread:literal) => {{
                let (a, b) = (block[$k].pixel as usize * C, block[$k + 4].pixel as usize * C);
                let top = _mm256_set_m128i(
                    _mm_cvtsi64_si128(load_8(frame, b)),
                    _mm_cvtsi64_si128(load_8(frame, a)),
                );
                let bottom = _mm256_set_m128i(
                    _mm_cvtsi64_si128(load_8(frame, b + stride)),
                    _mm_cvtsi64_si128(load_8(frame, a + stride)),
                );
                let w = _mm256_shuffle_epi32::<$spread>(wx);
                let top = _mm256_madd_epi16(_mm256_shuffle_epi8(top, pairs), w);
                let bottom = _mm256_madd_epi16(_mm256_shuffle_epi8(bottom, pairs), w);
                // Both halves of each 32 bits: top's bits from 7 on, and bottom's.
                let column = _mm256_blend_epi16::<0b1010_1010>(
                    _mm256_srli_epi32::<{ BILINEAR_DROP as i32 }>(top),
                    _mm256_slli_epi32::<{ 16 - BILINEAR_DROP as i32 }>(bottom),
                );
                let sum = _mm256_madd_epi16(column, _mm256_shuffle_epi32::<$spread>(wy));
                _mm256_srli_epi32::<{ BILINEAR_LAST as i32 }>(_mm256_add_epi32(sum, half))
            }};
        }
        let (r0, r1, r2, r3) = (two!(0, 0x00), two!(1, 0x55), two!(2, 0xaa), two!(3, 0xff));
        store_eight::<C>([r0, r1, r2, r3], target);
    }
    kernel::bilinear_plain::<C>(frame, source, rest, last);
}

/// Stores eight pixels as C bytes each, given in 32 bits a channel: in each number a pixel k and, in the upper lane, the pixel k + 4.
#[inline]
#[target_feature(enable = "avx2")]
pub(super) fn store_eight<const C: usize>([a, b, c, d]: [__m256i; 4], target: &mut [u8]) {
    let codes = _mm256_packus_epi16(_mm256_packus_epi32(a, b), _mm256_packus_epi32(c, d));
    let (low, high) = target.split_at_mut(4 * C);
    store_four::<C>(_mm256_castsi256_si128(codes), low);
    store_four::<C>(_mm256_extracti128_si256::<1>(codes), high);
}

/// Stores four pixels of four bytes each, as C bytes each.
#[inline]
#[target_feature(enable = "avx2")]
fn store_four<const C: usize>(codes: __m128i, target: &mut [u8]) {
    let codes = if C == 4 {
        codes
    } else {
        let close = _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1);
        _mm_shuffle_epi8(codes, close)
    };
    target[..8].copy_from_slice(&_mm_cvtsi128_si64(codes).to_le_bytes());
    let high = _mm_extract_epi64::<1>(codes).to_le_bytes();
    target[8..].copy_from_slice(&high[..4 * C - 8]);
}

/// The weighted sums of 4 x 4 pixels, a channel in each lane. A macro, as it must be part of its
/// callers' loops: called, it costs a third more.
macro_rules! cubic_sum {
    ($frame:ident, $stride:ident, $tables:ident, $tap:expr, $near:ident, $far:ident) => {{
        let tap: &Tap = $tap;
        let start = tap.pixel as usize * C;
        let (wx, wy) = ($tables.x[usize::from(tap.x)], $tables.y[usize::from(tap.y)]);
        let (w_near, w_far) = (_mm256_set1_epi32(wx[0]), _mm256_set1_epi32(wx[1]));
        // Rows 0 and 2, rows 1 and 3: so the pairs to be summed stand in the same lane.
        let even = _mm256_set_m128i(load_16($frame, start + 2 * $stride), load_16($frame, start));
        let odd = _mm256_set_m128i(
            load_16($frame, start + 3 * $stride),
            load_16($frame, start + $stride),
        );
        let even = _mm256_add_epi32(
            _mm256_madd_epi16(_mm256_shuffle_epi8(even, $near), w_near),
            _mm256_madd_epi16(_mm256_shuffle_epi8(even, $far), w_far),
        );
        let odd = _mm256_add_epi32(
            _mm256_madd_epi16(_mm256_shuffle_epi8(odd, $near), w_near),
            _mm256_madd_epi16(_mm256_shuffle_epi8(odd, $far), w_far),
        );
        let column = _mm256_blend_epi16::<0b1010_1010>(
            _mm256_srai_epi32::<{ CUBIC_DROP as i32 }>(even),
            _mm256_slli_epi32::<{ 16 - CUBIC_DROP as i32 }>(odd),
        );
        let weights =
            _mm256_blend_epi32::<0b1111_0000>(_mm256_set1_epi32(wy[0]), _mm256_set1_epi32(wy[1]));
        let sums = _mm256_madd_epi16(column, weights);
        _mm_add_epi32(_mm256_castsi256_si128(sums), _mm256_extracti128_si256::<1>(sums))
    }};
}

/// Pixels of one cubic sample each.
#[target_feature(enable = "avx2")]
pub(super) fn cubic_single<const C: usize>(
    frame: &[u8],
    source: [usize; 2],
    tables: &CubicTables,
    taps: &[Tap],
    output: &mut [u8],
) {
    let stride = source[0] * C;
    let (near, far) = (pair_mask::<C>(0), pair_mask::<C>(2));
    let half = _mm_set1_epi32(1 << (CUBIC_LAST - 1));
    let (blocks, rest) = taps.as_chunks::<4>();
    let (targets, last) = output.split_at_mut(blocks.len() * 4 * C);
    for (block, target) in blocks.iter().zip(targets.chunks_exact_mut(4 * C)) {
        let mut codes = [half; 4];
        for (code, tap) in codes.iter_mut().zip(block) {
            let sum = cubic_sum!(frame, stride, tables, tap, near, far);
            *code = _mm_srai_epi32::<{ CUBIC_LAST as i32 }>(_mm_add_epi32(sum, half));
        }
        let codes = _mm_packus_epi16(
            _mm_packus_epi32(codes[0], codes[1]),
            _mm_packus_epi32(codes[2], codes[3]),
        );
        store_four::<C>(codes, target);
    }
    for (tap, target) in rest.iter().zip(last.chunks_exact_mut(C)) {
        let sum = cubic_sum!(frame, stride, tables, tap, near, far);
        let code = _mm_srai_epi32::<{ CUBIC_LAST as i32 }>(_mm_add_epi32(sum, half));
        let code = _mm_packus_epi16(_mm_packus_epi32(code, code), code);
        let bytes = _mm_cvtsi128_si32(code).to_le_bytes();
        target.copy_from_slice(&bytes[..C]);
    }
}

/// Pixels of any number of cubic samples.
#[target_feature(enable = "avx2")]
pub(super) fn cubic<const C: usize>(
    frame: &[u8],
    source: [usize; 2],
    tables: &CubicTables,
    plan: &Plan,
    pixels: Range<usize>,
    output: &mut [u8],
) {
    let stride = source[0] * C;
    let (near, far) = (pair_mask::<C>(0), pair_mask::<C>(2));
    let half = _mm_set1_epi32(1 << (CUBIC_LAST - 1));
    let ceiling = _mm_set1_epi32(255 << SAMPLE_BITS);
    for (index, target) in pixels.zip(output.chunks_exact_mut(C)) {
        let samples = plan.samples(index);
        let (mut sum, mut total) = (_mm_setzero_si128(), _mm_setzero_si128());
        for tap in samples {
            sum = cubic_sum!(frame, stride, tables, tap, near, far);
            let code = _mm_srai_epi32::<{ (CUBIC_LAST - SAMPLE_BITS) as i32 }>(sum);
            let code = _mm_max_epi32(_mm_min_epi32(code, ceiling), _mm_setzero_si128());
            total = _mm_add_epi32(total, code);
        }
        let code = if samples.len() == 1 {
            _mm_srai_epi32::<{ CUBIC_LAST as i32 }>(_mm_add_epi32(sum, half))
        } else {
            // As `mean_code`, on all channels.
            let scale = _mm_set1_ps(samples.len() as f32 * (1 << SAMPLE_BITS) as f32);
            let mean = _mm_div_ps(_mm_cvtepi32_ps(total), scale);
            _mm_cvttps_epi32(_mm_add_ps(mean, _mm_set1_ps(0.5)))
        };
        let code = _mm_packus_epi16(_mm_packus_epi32(code, code), code);
        let bytes = _mm_cvtsi128_si32(code).to_le_bytes();
        target.copy_from_slice(&bytes[..C]);
    }
}
