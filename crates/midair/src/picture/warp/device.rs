//! What a graphics device needs to warp as the processor does: the same integers, so that both show the same codes.

use super::linear::{DROP, LAST, WHITE};
use super::taps::WEIGHT_BITS;
use super::{Drive, LightFrame, Warp};
use rayon::prelude::*;

/// The first word of a pixel that shows nothing of the image, in [`Warp::bilinear_taps`]; no source has that many pixels.
pub const NO_TAP: u32 = u32::MAX;

/// The fixed-point arithmetic of bilinear warps of light ([`Warp::apply_light`]). A sample is, in 32-bit integers with
/// `one = 1 << weight_bits` and the tap's fractions x, y,
///
/// ```text
/// across(a, b) = (a * (one - x) + b * x + (1 << (drop - 1))) >> drop
/// (across(upper) * (one - y) + across(lower) * y + (1 << (last - 1))) >> last
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedPoint {
    /// Bits of a fraction.
    pub weight_bits: u32,
    /// Bits dropped between the horizontal and the vertical sum.
    pub drop: u32,
    /// Bits dropped at the end.
    pub last: u32,
}

impl FixedPoint {
    /// What is used.
    pub const LIGHT: Self = Self { weight_bits: WEIGHT_BITS, drop: DROP, last: LAST };
}

impl Warp {
    /// The taps of a bilinear warp, two words for each output pixel: the number of the first of the 2 x 2 source pixels that it lies among (rows
    /// from the top; [`NO_TAP`] for a pixel that shows nothing of the image), and how far on it lies, x in the lower 16 bits and y in the
    /// upper ones, in parts of `1 <<` [`FixedPoint::weight_bits`]. What was in `taps` is lost, but for its memory. `None` for a warp
    /// by another filter.
    pub fn bilinear_taps<'a>(&self, taps: &'a mut Vec<[u32; 2]>) -> Option<&'a [[u32; 2]]> {
        if self.tables.is_some() || !self.plan.is_single() {
            return None;
        }
        taps.resize(self.width * self.height, [NO_TAP, 0]);
        taps.par_chunks_mut(self.width.max(1)).enumerate().for_each(|(row, line)| {
            line.fill([NO_TAP, 0]);
            let first = row * self.width;
            for span in self.plan.spans(row) {
                let known = self.plan.taps(first + span.start..first + span.end);
                for (word, tap) in line[span].iter_mut().zip(known) {
                    *word = [tap.pixel, u32::from(tap.x) | u32::from(tap.y) << 16];
                }
            }
        });
        Some(taps)
    }
}

impl LightFrame {
    /// The frame's light, four channels a pixel, 0 to [`Drive::WHITE`].
    pub fn values(&self) -> &[[i16; 4]] {
        &self.light
    }
}

impl Drive {
    /// The brightest light of a [`LightFrame`].
    pub const WHITE: i32 = WHITE;

    /// The codes of a channel (0 to 3) for light of 0 to [`WHITE`](Self::WHITE).
    ///
    /// # Panics
    /// For another channel.
    pub fn codes(&self, channel: usize) -> &[u8] {
        self.codes.of(channel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Map;
    use crate::picture::Filter;

    #[test]
    fn taps_and_arithmetic_are_told_as_they_are_used() {
        let mut map = Map::identity(61, 40);
        for (i, uv) in map.uv.iter_mut().enumerate() {
            *uv = [0.1 + 0.83 * uv[0] * uv[1], 0.9 * uv[1] - 0.05 * uv[0]];
            if i % 7 == 3 || (5..9).contains(&(i / 61)) {
                *uv = [f64::NAN; 2];
            }
        }
        let source = [37, 29];
        let frame: Vec<u8> = (0..37 * 29 * 4).map(|i| (i * 97 % 251) as u8).collect();
        let warp = Warp::new(&map, source, Filter::Bilinear).unwrap();
        let (mut taps, mut shown) = (vec![[1, 1]; 5], vec![0; 61 * 40 * 4]);
        let (mut light, drive) = (LightFrame::default(), Drive::default());
        light.decode(&frame, 4).unwrap();
        warp.apply_light(&light, 4, &drive, &mut shown).unwrap();
        let FixedPoint { weight_bits, drop, last } = FixedPoint::LIGHT;
        let one = 1 << weight_bits;
        let taps = warp.bilinear_taps(&mut taps).unwrap();
        assert_eq!(taps.len(), 61 * 40);
        for (i, &[pixel, ways]) in taps.iter().enumerate() {
            assert_eq!(pixel == NO_TAP, map.drawn(i % 61, i / 61).is_none());
            for c in 0..4 {
                let expected = if pixel == NO_TAP {
                    0
                } else {
                    let (x, y) = ((ways & 0xffff) as i32, (ways >> 16) as i32);
                    let at = |by: usize| i32::from(light.values()[pixel as usize + by][c]);
                    let across = |row: usize| {
                        let sum = at(row * source[0]) * (one - x) + at(row * source[0] + 1) * x;
                        (sum + (1 << (drop - 1))) >> drop
                    };
                    let sum = across(0) * (one - y) + across(1) * y + (1 << (last - 1));
                    drive.codes(c)[(sum >> last) as usize]
                };
                assert_eq!(shown[i * 4 + c], expected, "pixel {i}");
            }
        }
        let sharp = Warp::new(&map, source, Filter::Sharp).unwrap();
        assert!(sharp.bilinear_taps(&mut Vec::new()).is_none());
    }
}
