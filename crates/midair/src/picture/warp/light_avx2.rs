//! The kernels for frames as light, with 256-bit integers. Same arithmetic as [`super::linear`] and [`super::evened`], same results.

use super::evened::{Light, MOST, ROUNDING, decode_row_plain};
use super::linear::{DROP, LAST, Run, WHITE};
use super::taps::{AHEAD, ONE, Tap};
use std::arch::x86_64::*;

/// Two neighbouring pixels of four channels.
#[inline]
#[target_feature(enable = "avx2")]
fn load_two(light: &[[i16; 4]], first: usize) -> __m128i {
    // Taps lie within the source: there always are two.
    let two = light.get(first..).and_then(|rest| rest.first_chunk::<2>()).unwrap_or(&[[0; 4]; 2]);
    // SAFETY: the two pixels have the 16 bytes that are read; the load needs no alignment.
    unsafe { _mm_loadu_si128(two.as_ptr().cast()) }
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
fn weights(taps: &[Tap; 8]) -> (__m256i, __m256i) {
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

/// A run of pixels of one bilinear sample each, without a gain, from a source of at least two rows and columns.
#[target_feature(enable = "avx2")]
pub(super) fn bilinear<const C: usize>(run: &Run, output: &mut [u8]) {
    let (light, width, codes) = (run.light, run.source[0], &run.drive.codes);
    // Pairs (channel of a pixel, same channel of the next) of two pixels.
    let pairs = _mm256_broadcastsi128_si256(_mm_setr_epi8(
        0, 1, 8, 9, 2, 3, 10, 11, 4, 5, 12, 13, 6, 7, 14, 15,
    ));
    let half_across = _mm256_set1_epi32(1 << (DROP - 1));
    // Sums across have 16 bits. They are made signed by taking half of that away, and what this takes from the sum of both rows is
    // given back.
    let signed = _mm256_set1_epi16(i16::MIN);
    let half = _mm256_set1_epi32((1 << (LAST - 1)) + (ONE << 15));
    let first = codes.first.map(|first| first as i32);
    let tables = _mm256_setr_epi32(
        first[0], first[1], first[2], first[3], first[0], first[1], first[2], first[3],
    );
    let (white, byte) = (_mm256_set1_epi32(WHITE), _mm256_set1_epi32(0xff));
    let (blocks, _) = run.plan.taps(run.pixels.clone()).as_chunks::<8>();
    let (targets, last) = output.split_at_mut(blocks.len() * 8 * C);
    for (block, target) in blocks.iter().zip(targets.chunks_exact_mut(8 * C)) {
        _mm_prefetch::<_MM_HINT_T0>(block.as_ptr().wrapping_add(AHEAD).cast());
        let (wx, wy) = weights(block);
        // Pixels k and k + 4 in the two lanes.
        macro_rules! two {
            ($k:literal, $spread:literal) => {{
                let (a, b) = (block[$k].pixel as usize, block[$k + 4].pixel as usize);
                let top = _mm256_set_m128i(load_two(light, b), load_two(light, a));
                let bottom =
                    _mm256_set_m128i(load_two(light, b + width), load_two(light, a + width));
                let w = _mm256_shuffle_epi32::<$spread>(wx);
                let top = _mm256_madd_epi16(_mm256_shuffle_epi8(top, pairs), w);
                let bottom = _mm256_madd_epi16(_mm256_shuffle_epi8(bottom, pairs), w);
                let top = _mm256_add_epi32(top, half_across);
                let bottom = _mm256_add_epi32(bottom, half_across);
                // Both halves of each 32 bits: top's bits from DROP on, and bottom's.
                let column = _mm256_blend_epi16::<0b1010_1010>(
                    _mm256_srli_epi32::<{ DROP as i32 }>(top),
                    _mm256_slli_epi32::<{ 16 - DROP as i32 }>(bottom),
                );
                let column = _mm256_xor_si256(column, signed);
                let sum = _mm256_madd_epi16(column, _mm256_shuffle_epi32::<$spread>(wy));
                let value = _mm256_srli_epi32::<{ LAST as i32 }>(_mm256_add_epi32(sum, half));
                let place = _mm256_add_epi32(_mm256_and_si256(value, white), tables);
                // SAFETY: a place is that of a table and at most WHITE more, so within its table; after the last table stand the
                // three bytes more that are read.
                let code = unsafe {
                    _mm256_i32gather_epi32::<1>(codes.bytes.as_ptr().cast::<i32>(), place)
                };
                _mm256_and_si256(code, byte)
            }};
        }
        let (r0, r1, r2, r3) = (two!(0, 0x00), two!(1, 0x55), two!(2, 0xaa), two!(3, 0xff));
        store_eight::<C>([r0, r1, r2, r3], target);
    }
    let pixels = run.pixels.start + blocks.len() * 8..run.pixels.end;
    Run { pixels, ..*run }.warp_plain::<C, false>(&[], &[], last);
}

/// A row of pixels with its gain divided out: as [`decode_row_plain`].
#[target_feature(enable = "avx2")]
pub(super) fn decode_row(
    frame: &[[u8; 4]],
    tables: &Light,
    [above, below]: [&[[f32; 4]]; 2],
    t: f32,
    light: &mut [[i16; 4]],
) -> usize {
    let curves = _mm256_setr_epi32(0, 0, 0, 256, 0, 0, 0, 256);
    let colours = _mm256_setr_epi32(-1, -1, -1, 0, -1, -1, -1, 0);
    let (most, mask) = (_mm256_set1_epi32(MOST), _mm256_set1_epi32(0x7fff));
    let (share, rounding) = (_mm256_set1_ps(t), _mm256_set1_ps(ROUNDING));
    let numbers = tables.as_ptr().cast::<f32>();
    let mut above_white = _mm256_setzero_si256();
    let whole = frame.len().min(light.len()).min(above.len()).min(below.len()) / 4 * 4;
    let lines = above.as_chunks::<4>().0.iter().zip(below.as_chunks::<4>().0);
    let pixels = frame.as_chunks::<4>().0.iter().zip(light.as_chunks_mut::<4>().0);
    for ((pixels, light), (a, b)) in pixels.zip(lines) {
        // Two pixels' values in 32 bits each.
        macro_rules! two {
            ($first:literal) => {{
                let [one, next] = [pixels[$first], pixels[$first + 1]].map(i32::from_le_bytes);
                let place = _mm256_cvtepu8_epi32(_mm_setr_epi32(one, next, 0, 0));
                let place = _mm256_add_epi32(place, curves);
                // SAFETY: a place is a code, or a code and 256, of 2 x 256 numbers.
                let decoded = unsafe { _mm256_i32gather_ps::<4>(numbers, place) };
                // SAFETY: four pixels' factors are there, of which two are read each time.
                let (a, b) = unsafe {
                    (
                        _mm256_loadu_ps(a.as_ptr().add($first).cast::<f32>()),
                        _mm256_loadu_ps(b.as_ptr().add($first).cast::<f32>()),
                    )
                };
                let factor = _mm256_add_ps(a, _mm256_mul_ps(share, _mm256_sub_ps(b, a)));
                let value = _mm256_add_ps(_mm256_mul_ps(decoded, factor), rounding);
                let value = _mm256_and_si256(_mm256_castps_si256(value), mask);
                let over = _mm256_and_si256(_mm256_cmpgt_epi32(value, most), colours);
                above_white = _mm256_sub_epi32(above_white, over);
                value
            }};
        }
        // The lanes hold pixels 0 and 2, 1 and 3.
        let values = _mm256_packs_epi32(two!(0), two!(2));
        let values = _mm256_permute4x64_epi64::<0b11_01_10_00>(values);
        // SAFETY: four pixels of four channels are as long as the 32 bytes that are written; the store needs no alignment.
        unsafe { _mm256_storeu_si256(light.as_mut_ptr().cast(), values) };
    }
    let mut counts = [0i32; 8];
    // SAFETY: the array is as long as the 32 bytes that are written; the store needs no alignment.
    unsafe { _mm256_storeu_si256(counts.as_mut_ptr().cast(), above_white) };
    let counted = counts.iter().map(|&count| count as usize).sum::<usize>();
    let rest = [&above[whole..], &below[whole..]];
    counted + decode_row_plain(&frame[whole..], tables, rest, t, &mut light[whole..])
}

/// Stores eight pixels as C bytes each, given in 32 bits a channel: in each number a pixel k and, in the upper lane, the pixel k + 4.
#[inline]
#[target_feature(enable = "avx2")]
fn store_eight<const C: usize>([a, b, c, d]: [__m256i; 4], target: &mut [u8]) {
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

#[cfg(test)]
mod tests {
    use super::super::tests::{bent_map, noise};
    use super::super::{Drive, Filter};
    use super::*;
    use crate::optics::screen::{Response, Screen};
    use crate::picture::Overflow;
    use crate::picture::warp::taps::Plan;

    fn there() -> bool {
        let there = std::arch::is_x86_feature_detected!("avx2");
        if !there {
            midair_peers::missing(midair_peers::Peer::Avx2, "the processor has no AVX2");
        }
        there
    }

    #[test]
    fn light_is_warped_by_vectors_as_by_plain_code_to_the_bit() {
        if !there() {
            return;
        }
        fn check<const C: usize>(source: [usize; 2], drive: &Drive) {
            let map = bent_map(83, 59);
            let bytes = noise(source[0], source[1], 8);
            // All values, black and white among them.
            let pixel = |b: &[u8; 8]| {
                [0, 1, 2, 3].map(|c| i16::from_le_bytes([b[2 * c], b[2 * c + 1] & 0x7f]))
            };
            let mut light: Vec<[i16; 4]> = bytes.as_chunks::<8>().0.iter().map(pixel).collect();
            light[..2].fill([i16::MAX; 4]);
            light[source[0]..source[0] + 2].fill([i16::MAX; 4]);
            let plan = Plan::new(&map, source, Filter::Bilinear);
            let light = &light[..];
            let run = Run { light, source, tables: None, plan: &plan, pixels: 0..83 * 59, drive };
            let [mut fast, mut plain] = [vec![0; 83 * 59 * C], vec![1; 83 * 59 * C]];
            run.warp_plain::<C, false>(&[], &[], &mut plain);
            // SAFETY: the processor has AVX2.
            unsafe { bilinear::<C>(&run, &mut fast) };
            assert_eq!(fast, plain);
        }
        let black = [0.004, 0.01, 0.0];
        let screen = Screen { response: Response::Gamma(1.8), black, bits: None };
        let drives = [
            Drive::default(),
            Drive::of_screen(&screen, [2, 1, 0]),
            Drive::of_evened(&screen, [2, 1, 0], Overflow::Soft),
            Drive::of_evened(&Screen::default(), [0, 1, 2], Overflow::Clip),
        ];
        for drive in &drives {
            for source in [[50, 41], [150, 130], [2, 2]] {
                check::<3>(source, drive);
                check::<4>(source, drive);
            }
        }
    }

    #[test]
    fn rows_are_evened_by_vectors_as_by_plain_code_to_the_bit() {
        if !there() {
            return;
        }
        let tables: Light =
            std::array::from_fn(|curve| std::array::from_fn(|code| (code * (128 - curve)) as f32));
        for width in [1, 3, 4, 5, 64, 131] {
            let frame = noise(width, 1, 4);
            let numbers = noise(width, 2, 4);
            let factors: Vec<[f32; 4]> = numbers
                .as_chunks::<4>()
                .0
                .iter()
                .map(|n| n.map(|n| f32::from(n) / 255.0))
                .collect();
            let lines = [&factors[..width], &factors[width..]];
            for t in [0.0, 0.3, 1.0] {
                let frame = frame.as_chunks::<4>().0;
                let [mut fast, mut plain] = [vec![[-1; 4]; width], vec![[-2; 4]; width]];
                let over = decode_row_plain(frame, &tables, lines, t, &mut plain);
                // SAFETY: the processor has AVX2.
                let found = unsafe { decode_row(frame, &tables, lines, t, &mut fast) };
                assert_eq!((fast, found), (plain, over));
                assert!(width < 64 || (over > 0 && over < 3 * width), "{over}");
            }
        }
    }
}
