//! Warping sRGB frames in linear light: decoded to 15-bit light, interpolated, encoded again.
//!
//! A step of 15-bit light is at most a tenth of an 8-bit code (at black, where the curve is steepest).

use super::WarpError;
use super::evened::HEADROOM;
use super::taps::{CubicTables, ONE, Plan, Tap, WEIGHT_BITS, unpack};
use crate::media::brightness::{Evening, Overflow};
use crate::media::srgb;
use crate::optics::screen::Screen;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Arc, LazyLock};

/// White, in 15-bit light.
pub(super) const WHITE: i32 = 32767;

/// Bits dropped between the horizontal and the vertical sums: white, overshot by a quarter each way (the most
/// that cubic weights can), then stays below 2^31.
pub(super) const DROP: u32 = WEIGHT_BITS - 1;
/// What is left to drop at the end.
pub(super) const LAST: u32 = 2 * WEIGHT_BITS - DROP;

/// Codes to light: sRGB for colours, proportional for alpha.
pub(super) static DECODE: LazyLock<[[i16; 256]; 2]> = LazyLock::new(|| {
    let fixed = |light: f32| (light * WHITE as f32).round() as i16;
    [
        std::array::from_fn(|code| fixed(srgb::decode_8(code as u8))),
        std::array::from_fn(|code| fixed(code as f32 / 255.0)),
    ]
});

/// Codes of 15-bit light, whose every value has a place.
type Codes = [u8; WHITE as usize + 1];

fn table(code: impl Fn(i32) -> u8) -> Arc<Codes> {
    let mut table = Box::new([0; WHITE as usize + 1]);
    table.iter_mut().zip(0..).for_each(|(entry, light)| *entry = code(light));
    table.into()
}

/// What a display is sent so that it emits light: the codes of its channels' light, and a gain that is divided out before.
#[derive(Clone, Debug)]
pub struct Drive {
    pub(super) codes: [Arc<Codes>; 4],
    /// Which colour, of red, green and blue, each of the first three channels is.
    colours: [usize; 3],
    evening: Option<Evening>,
}

impl Default for Drive {
    /// sRGB codes of red, green, blue; alpha is proportional.
    fn default() -> Self {
        static SRGB: LazyLock<Arc<Codes>> =
            LazyLock::new(|| table(|light| srgb::encode_8(light as f32 / WHITE as f32)));
        static PROPORTIONAL: LazyLock<Arc<Codes>> =
            LazyLock::new(|| table(|light| ((light * 255 + WHITE / 2) / WHITE) as u8));
        let [colour, alpha] = [&SRGB, &PROPORTIONAL].map(|table| Arc::clone(table));
        let codes = [Arc::clone(&colour), Arc::clone(&colour), colour, alpha];
        Self { codes, colours: [0, 1, 2], evening: None }
    }
}

impl Drive {
    /// A display's own codes, for frames whose first three channels are these colours (0 red, 1 green, 2 blue). Light below the
    /// display's black becomes code 0.
    pub fn of_screen(screen: &Screen, colours: [usize; 3]) -> Self {
        let mut drive = Self { colours, ..Self::default() };
        if !screen.is_plain() {
            for (channel, c) in colours.into_iter().enumerate() {
                drive.codes[channel] = table(|light| {
                    let code = screen.code(c, f64::from(light) / f64::from(WHITE));
                    (code * 255.0).round() as u8
                });
            }
        }
        drive
    }

    /// As [`of_screen`](Self::of_screen), for frames whose gain was divided out when they were decoded
    /// ([`LightFrame::decode_evened`]): what takes more than the display's white is treated as `overflow` says.
    pub fn of_evened(screen: &Screen, colours: [usize; 3], overflow: Overflow) -> Self {
        let unit = f64::from(WHITE) / f64::from(HEADROOM);
        let light = |light: i32| f64::from(overflow.held((f64::from(light) / unit) as f32));
        let codes = std::array::from_fn(|channel| {
            table(|value| {
                let code = match colours.get(channel) {
                    Some(&c) => screen.code(c, light(value)),
                    None => (f64::from(value) / unit).min(1.0),
                };
                (code * 255.0).round() as u8
            })
        });
        Self { codes, colours, evening: None }
    }

    /// With a gain divided out, of as many pixels as the warp makes.
    pub fn with_evening(self, evening: Option<Evening>) -> Self {
        Self { evening, ..self }
    }

    /// The gain that is divided out.
    pub fn evening(&self) -> Option<&Evening> {
        self.evening.as_ref()
    }
}

/// Which of the two curves a channel has.
pub(super) fn curve(channel: usize) -> usize {
    usize::from(channel == 3)
}

/// The light of a frame: to be decoded once, and warped as often as the map changes.
#[derive(Clone, Debug, Default)]
pub struct LightFrame {
    pub(super) light: Vec<[i16; 4]>,
}

impl LightFrame {
    /// Takes an sRGB frame of `channels` (3 or 4) bytes a pixel in the place of what was there. A fourth channel is proportional;
    /// in frames of three it is 0.
    ///
    /// # Errors
    /// [`WarpError::Channels`] for another number of channels.
    pub fn decode(&mut self, frame: &[u8], channels: usize) -> Result<(), WarpError> {
        match channels {
            3 => decode::<3>(frame, &mut self.light),
            4 => decode::<4>(frame, &mut self.light),
            other => return Err(WarpError::Channels(other)),
        }
        Ok(())
    }
}

/// The light of a frame's pixels; the fourth channel is 0 in frames of three.
fn decode<const C: usize>(frame: &[u8], light: &mut Vec<[i16; 4]>) {
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
    pub(super) drive: &'a Drive,
}

impl Run<'_> {
    pub(super) fn warp<const C: usize>(self, output: &mut [u8]) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2; the function asks for nothing else.
            return unsafe { self.warp_avx2::<C>(output) };
        }
        match self.tables {
            Some(tables) => self.warp_plain::<C, true>(&tables.x, &tables.y, output),
            None => self.warp_plain::<C, false>(&[], &[], output),
        }
    }

    /// The same code, for the compiler to use wider instructions in.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn warp_avx2<const C: usize>(self, output: &mut [u8]) {
        match self.tables {
            Some(tables) => self.warp_plain::<C, true>(&tables.x, &tables.y, output),
            None => self.warp_plain::<C, false>(&[], &[], output),
        }
    }

    /// Written without closures: they would not share their caller's instruction set.
    #[inline(always)]
    fn warp_plain<const C: usize, const CUBIC: bool>(
        &self,
        table_x: &[[i32; 2]],
        table_y: &[[i32; 2]],
        output: &mut [u8],
    ) {
        let codes: [&Codes; 4] = std::array::from_fn(|c| &*self.drive.codes[c]);
        let (light, [width, height]) = (self.light, self.source);
        for (index, target) in self.pixels.clone().zip(output.as_chunks_mut::<C>().0) {
            let taps = self.plan.samples(index);
            let mut value = [0i32; 4];
            for tap in taps {
                let sample = if CUBIC {
                    let wx = unpack(table_x[usize::from(tap.x)]);
                    let wy = unpack(table_y[usize::from(tap.y)]);
                    weighted_sum(light, width, height, tap, wx, wy)
                } else {
                    let (fx, fy) = (i32::from(tap.x), i32::from(tap.y));
                    weighted_sum(light, width, height, tap, [ONE - fx, fx], [ONE - fy, fy])
                };
                for c in 0..4 {
                    value[c] += sample[c];
                }
            }
            if taps.len() > 1 {
                let count = taps.len() as i32;
                for c in 0..4 {
                    value[c] = (value[c] + count / 2) / count;
                }
            }
            if let Some(evening) = &self.drive.evening {
                for c in 0..3 {
                    let light = value[c] as f32 / WHITE as f32;
                    let emitted = evening.emitted(index, self.drive.colours[c], light);
                    value[c] = (emitted * WHITE as f32 + 0.5) as i32;
                }
            }
            for c in 0..C {
                // A mean of values from 0 to white is one; the mask only tells the compiler so.
                target[c] = codes[c][(value[c] & WHITE) as usize];
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
        if start + N <= light.len() {
            let row = &light[start..start + N];
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
    for c in 0..4 {
        sum[c] = (sum[c] >> LAST).clamp(0, WHITE);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives() {
        let drive = Drive::default();
        for c in [0, 3] {
            for code in 0..256 {
                let light = DECODE[curve(c)][code] as usize;
                assert_eq!(usize::from(drive.codes[c][light]), code);
            }
        }
    }
}
