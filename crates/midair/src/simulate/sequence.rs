//! The numbers that choose a path: well spread, and independent from pixel to pixel.

use crate::transport::packet::LANES;
use sobol_burley::{sample, sample_4d};

/// Numbers that a path needs: place on the pixel (2), place on the pupil (2), and one that decides at surfaces.
pub(super) const DIMENSIONS: usize = 5;

/// Bits of each number.
const BITS: u32 = 24;

/// A stretch of one Owen-scrambled Sobol sequence (Burley, Practical Hash-based Owen Scrambling, JCGT 9(4), 2020), which all
/// pixels share, each with random digital shifts of its own: the bits of each number are flipped by a random mask. Shifted so,
/// every point is evenly spread, and sequences with different masks are independent (L'Ecuyer and Lemieux 2002, section 2.4), while each
/// keeps its even spread: a mask permutes the cells of every dyadic grid.
pub(super) struct Points {
    bits: Vec<[u32; DIMENSIONS]>,
}

impl Points {
    /// The points `first .. first + count`.
    pub(super) fn new(seed: u32, first: u32, count: u32) -> Self {
        let scale = f64::from(1u32 << BITS);
        let whole = |number: f32| (f64::from(number) * scale) as u32;
        let point = |index: u32| {
            // A sequence longer than the generator's 2^16 goes on with another.
            let (part, index) = (index >> 16, index & 0xffff);
            let own = mix(seed).wrapping_add(part.wrapping_mul(0x9e37_79b9));
            let [x, y, r, turn] = sample_4d(index, 0, own).map(whole);
            [x, y, r, turn, whole(sample(index, 4, own))]
        };
        Self { bits: (first..first + count).map(point).collect() }
    }

    /// Numbers in (0, 1): the points of these indices (from the stretch's first), shifted by what these keys choose.
    #[inline(always)]
    pub(super) fn numbers(
        &self,
        keys: &[u32; LANES],
        indices: &[u32; LANES],
        numbers: &mut [[f64; LANES]; DIMENSIONS],
    ) {
        let mut bits = [[0u32; LANES]; DIMENSIONS];
        for i in 0..LANES {
            let point = &self.bits[indices[i] as usize];
            for dimension in 0..DIMENSIONS {
                bits[dimension][i] = point[dimension];
            }
        }
        for dimension in 0..DIMENSIONS {
            let salt = (dimension as u32 + 1).wrapping_mul(0x9e37_79b9);
            for i in 0..LANES {
                let mask = mix(keys[i].wrapping_add(salt)) >> (32 - BITS);
                // The middle of the cell that the bits name.
                let scale = 1.0 / f64::from(1u32 << BITS);
                numbers[dimension][i] =
                    (f64::from((bits[dimension][i] ^ mask) as i32) + 0.5) * scale;
            }
        }
    }
}

/// A hash of 32 bits in which every bit depends on every one (Wellons's "lowbias32", 2018).
#[inline(always)]
pub(super) fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_key_spreads_its_points_evenly_and_differently() {
        let points = Points::new(5, 0, 64);
        let all = |key: u32| -> Vec<[f64; DIMENSIONS]> {
            (0..64)
                .map(|index| {
                    let mut numbers = [[0.0; LANES]; DIMENSIONS];
                    points.numbers(&[key; LANES], &[index; LANES], &mut numbers);
                    numbers.map(|lanes| lanes[LANES - 1])
                })
                .collect()
        };
        let (a, b) = (all(1), all(2));
        assert_ne!(a, b);
        for points in [a, b] {
            for dimension in 0..DIMENSIONS {
                // One number in each 64th.
                let mut cells: Vec<i32> =
                    points.iter().map(|p| (p[dimension] * 64.0) as i32).collect();
                cells.sort_unstable();
                assert_eq!(cells, (0..64).collect::<Vec<_>>());
            }
            // Over the pixel, one point in each of 8 x 8 squares.
            let square = |p: &[f64; DIMENSIONS]| (p[0] * 8.0) as i32 * 8 + (p[1] * 8.0) as i32;
            let mut squares: Vec<i32> = points.iter().map(square).collect();
            squares.sort_unstable();
            assert_eq!(squares, (0..64).collect::<Vec<_>>());
        }
    }
}
