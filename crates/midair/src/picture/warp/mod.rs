//! Warping frames: the fixed part of a map computed once, then frame after frame, in linear light.
//!
//! Fractions and weights are fixed-point numbers of 14 bits and the sums 32 bits wide. On x86-64 with
//! AVX2, told at run time, the same integers are computed eight at a time; results are identical.

mod bilinear;
mod deep;
mod device;
mod evened;
#[cfg(target_arch = "x86_64")]
mod light_avx2;
mod linear;
mod rim;
mod taps;

pub use deep::DeepScratch;
pub use device::{FixedPoint, NO_TAP};
pub use evened::{FrameEvening, HEADROOM};
pub use linear::{Drive, LightFrame};

use crate::map::{Inverse, Map};
use crate::picture::brightness::Evening;
use rayon::prelude::*;
use std::ops::Range;
use taps::{CubicTables, Plan};

/// How a frame is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Bilinear interpolation at the pixel's centre: the fastest, what video tools do.
    Bilinear,
    /// The filter of [`display_image`](super::display_image): Catmull-Rom where the map magnifies,
    /// averaged over the pixel's footprint where it minifies.
    #[default]
    Sharp,
}

/// Why a frame cannot be warped.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WarpError {
    /// A frame's samples are not what its size says.
    #[error(
        "a frame of {width} x {height} pixels with {channels} channels has {expected} samples, not {found}"
    )]
    FrameSize {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Samples of a pixel.
        channels: usize,
        /// The samples that should be there.
        expected: usize,
        /// The samples that are.
        found: usize,
    },
    /// Only 3 and 4 channels are known.
    #[error("frames of {0} channels cannot be warped: give 3 (RGB) or 4 (RGBA)")]
    Channels(usize),
    /// A gain is for another display.
    #[error("the gain is of {found} pixels, the map of {expected}")]
    Gain {
        /// The map's.
        expected: usize,
        /// The gain's.
        found: usize,
    },
    /// A source without pixels, or with more than 32-bit offsets reach.
    #[error("a source of {0} x {1} pixels cannot be warped")]
    Source(usize, usize),
}

/// A map made ready for the frames of one size.
#[derive(Clone, Debug)]
pub struct Warp {
    width: usize,
    height: usize,
    source: [usize; 2],
    plan: Plan,
    /// For the sharp filter.
    tables: Option<CubicTables>,
}

/// Output rows that a task of the thread pool takes at a time.
const BAND: usize = 8;

impl Warp {
    /// Prepares `map` for source frames of `source` (width, height) pixels.
    ///
    /// # Errors
    /// [`WarpError::Source`] for a source of no pixels or of more than 2^30.
    pub fn new(map: &Map, source: [usize; 2], filter: Filter) -> Result<Self, WarpError> {
        check_source(source)?;
        let plan = Plan::new(map, source, filter);
        let tables = (filter == Filter::Sharp).then(|| CubicTables::new(source));
        Ok(Self { width: map.width, height: map.height, source, plan, tables })
    }

    /// Prepares an inverse for bilinear warping, of all pixels that its map would [draw](Map::drawn), in the memory of a warp that is no longer needed: what a show does that follows its viewer. Each row of the map is there only while taps
    /// are made of it, so that of all that is computed for a new viewpoint the taps alone go to memory.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_inverse(
        inverse: &Inverse,
        source: [usize; 2],
        old: Option<Self>,
    ) -> Result<Self, WarpError> {
        check_source(source)?;
        let [width, height] = inverse.size();
        let memory = old.map_or_else(Vec::new, |old| old.plan.into_taps());
        let plan = rim::plan(inverse, source, memory);
        Ok(Self { width, height, source, plan, tables: None })
    }

    /// Width and height of the warped frame.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Warps one frame in linear light, as [`display_image`](super::display_image) does, into what the display is sent: `channels` (3
    /// or 4) bytes a pixel, rows from the top, without padding. Pixels that show nothing of the image become 0 in every channel.
    ///
    /// # Errors
    /// [`WarpError`] where the number of channels, pixels or bytes is wrong.
    pub fn apply_light(
        &self,
        frame: &LightFrame,
        channels: usize,
        drive: &Drive,
        output: &mut [u8],
    ) -> Result<(), WarpError> {
        match channels {
            3 => self.apply_light_to::<3>(frame, drive, output),
            4 => self.apply_light_to::<4>(frame, drive, output),
            other => Err(WarpError::Channels(other)),
        }
    }

    fn apply_light_to<const C: usize>(
        &self,
        frame: &LightFrame,
        drive: &Drive,
        output: &mut [u8],
    ) -> Result<(), WarpError> {
        check_samples(self.source[0], self.source[1], 1, frame.light.len())?;
        check_gain(drive.evening(), self.width * self.height)?;
        let (light, source, plan) = (&frame.light[..], self.source, &self.plan);
        self.each_span::<C>(output, |pixels, target| {
            let tables = self.tables.as_ref();
            linear::Run { light, source, tables, plan, pixels, drive }.warp::<C>(target);
        })
    }

    /// Has each covered run of output pixels (their numbers, their bytes) filled; the rest becomes 0.
    fn each_span<const C: usize>(
        &self,
        output: &mut [u8],
        fill: impl Fn(Range<usize>, &mut [u8]) + Sync,
    ) -> Result<(), WarpError> {
        check_samples(self.width, self.height, C, output.len())?;
        let row_bytes = self.width * C;
        if row_bytes == 0 {
            return Ok(());
        }
        output.par_chunks_mut(row_bytes * BAND).enumerate().for_each(|(band, rows)| {
            for (i, output) in rows.chunks_exact_mut(row_bytes).enumerate() {
                let row = band * BAND + i;
                let mut done = 0;
                for span in self.plan.spans(row) {
                    output[done * C..span.start * C].fill(0);
                    let first = row * self.width;
                    let target = &mut output[span.start * C..span.end * C];
                    fill(first + span.start..first + span.end, target);
                    done = span.end;
                }
                output[done * C..].fill(0);
            }
        });
        Ok(())
    }
}

fn check_gain(evening: Option<&Evening>, expected: usize) -> Result<(), WarpError> {
    match evening.map(Evening::pixels) {
        Some(found) if found != expected => Err(WarpError::Gain { expected, found }),
        _ => Ok(()),
    }
}

fn check_source([width, height]: [usize; 2]) -> Result<(), WarpError> {
    match width.checked_mul(height) {
        Some(1..=0x4000_0000) => Ok(()),
        _ => Err(WarpError::Source(width, height)),
    }
}

fn check_samples(
    width: usize,
    height: usize,
    channels: usize,
    found: usize,
) -> Result<(), WarpError> {
    let expected = width * height * channels;
    if found == expected {
        Ok(())
    } else {
        Err(WarpError::FrameSize { width, height, channels, expected, found })
    }
}

#[cfg(test)]
mod tests;
