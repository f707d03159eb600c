//! Warping sRGB frames in linear light: decoded to 15-bit light, interpolated, encoded again.
//!
//! A step of 15-bit light is at most a tenth of an 8-bit code (at black, where the curve is steepest).

use super::WarpError;
use super::evened::HEADROOM;
#[cfg(target_arch = "x86_64")]
use super::light_avx2;
use super::taps::{CubicTables, ONE, Plan, Tap, WEIGHT_BITS, unpack};
use crate::optics::screen::Screen;
use crate::picture::brightness::{Evening, Overflow};
use crate::picture::srgb;
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

/// Values of 15-bit light, each of which has a place in a table of codes.
const LEVELS: usize = WHITE as usize + 1;

/// The codes of light in four channels. Channels that are alike share their table, so that it stays in the processor's first cache.
#[derive(Clone, Debug)]
pub(super) struct Codes {
    /// The tables, and [`SLACK`](Self::SLACK) bytes more.
    pub(super) bytes: Arc<[u8]>,
    /// Where each channel's table begins.
    pub(super) first: [usize; 4],
}

impl Codes {
    /// Vectors of codes are read four bytes at a time.
    pub(super) const SLACK: usize = 3;

    /// `tables` are made once each; `of_channel` says which one a channel takes.
    fn new(tables: &[&dyn Fn(i32) -> u8], of_channel: [usize; 4]) -> Self {
        let values = || 0..=WHITE;
        let mut bytes: Vec<u8> = tables.iter().flat_map(|code| values().map(code)).collect();
        bytes.extend([0; Self::SLACK]);
        Self { bytes: bytes.into(), first: of_channel.map(|table| table * LEVELS) }
    }

    /// The codes of a display's colours, each of which stands in one of the first three channels.
    fn of_colours(
        screen: &Screen,
        colours: [usize; 3],
        code: impl Fn(usize, i32) -> u8,
        alpha: impl Fn(i32) -> u8,
    ) -> Self {
        let of = |c: usize| {
            let code = &code;
            move |value| code(c, value)
        };
        let [red, green, blue] = [of(0), of(1), of(2)];
        if screen.is_plain() {
            return Self::new(&[&red, &alpha], [0, 0, 0, 1]);
        }
        let [a, b, c] = colours;
        Self::new(&[&red, &green, &blue, &alpha], [a, b, c, 3])
    }

    #[inline(always)]
    pub(super) fn of(&self, channel: usize) -> &[u8] {
        &self.bytes[self.first[channel]..][..LEVELS]
    }
}

/// What a display is sent so that it emits light: the codes of its channels' light, and a gain that is divided out before.
#[derive(Clone, Debug)]
pub struct Drive {
    pub(super) codes: Codes,
    /// Which colour, of red, green and blue, each of the first three channels is.
    colours: [usize; 3],
    evening: Option<Evening>,
}

/// Alpha is proportional.
fn proportional(value: i32) -> u8 {
    ((value * 255 + WHITE / 2) / WHITE) as u8
}

impl Default for Drive {
    /// sRGB codes of red, green, blue; alpha is proportional.
    fn default() -> Self {
        static PLAIN: LazyLock<Codes> = LazyLock::new(|| {
            let colour = |value| srgb::encode_8(value as f32 / WHITE as f32);
            Codes::new(&[&colour, &proportional], [0, 0, 0, 1])
        });
        Self { codes: PLAIN.clone(), colours: [0, 1, 2], evening: None }
    }
}

impl Drive {
    /// A display's own codes, for frames whose first three channels are these colours (0 red, 1 green, 2 blue). Light below the
    /// display's black becomes code 0.
    pub fn of_screen(screen: &Screen, colours: [usize; 3]) -> Self {
        if screen.is_plain() {
            return Self { colours, ..Self::default() };
        }
        let code = |c: usize, value: i32| {
            let code = screen.code(c, f64::from(value) / f64::from(WHITE));
            (code * 255.0).round() as u8
        };
        let codes = Codes::of_colours(screen, colours, code, proportional);
        Self { codes, colours, evening: None }
    }

    /// As [`of_screen`](Self::of_screen), for frames whose gain was divided out when they were decoded
    /// ([`LightFrame::decode_evened`]): what takes more than the display's white is treated as `overflow` says.
    pub fn of_evened(screen: &Screen, colours: [usize; 3], overflow: Overflow) -> Self {
        let unit = f64::from(WHITE) / f64::from(HEADROOM);
        let code = |c: usize, value: i32| {
            let light = overflow.held((f64::from(value) / unit) as f32);
            (screen.code(c, f64::from(light)) * 255.0).round() as u8
        };
        let alpha = |value: i32| ((f64::from(value) / unit).min(1.0) * 255.0).round() as u8;
        Self { codes: Codes::of_colours(screen, colours, code, alpha), colours, evening: None }
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
            let one_each = self.tables.is_none() && self.drive.evening.is_none();
            if one_each && self.source[0] > 1 && self.source[1] > 1 {
                // SAFETY: the processor has AVX2; the function asks for nothing else.
                return unsafe { light_avx2::bilinear::<C>(&self, output) };
            }
            // SAFETY: as above.
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
    pub(super) fn warp_plain<const C: usize, const CUBIC: bool>(
        &self,
        table_x: &[[i32; 2]],
        table_y: &[[i32; 2]],
        output: &mut [u8],
    ) {
        let codes: [&[u8]; 4] = std::array::from_fn(|c| self.drive.codes.of(c));
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
                assert_eq!(usize::from(drive.codes.of(c)[light]), code);
            }
        }
    }
}
