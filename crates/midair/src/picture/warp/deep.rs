//! Warping frames of 16-bit samples, in linear light and single precision.

use super::taps::{CubicTables, ONE, Plan, Tap, unpack};
use super::{Warp, WarpError, check_gain, check_samples};
use crate::picture::brightness::Evening;
use crate::picture::curve::{Curve, Tables};
use rayon::prelude::*;

/// Working memory of [`Warp::apply_deep`].
#[derive(Clone, Debug, Default)]
pub struct DeepScratch {
    light: Vec<[f32; 3]>,
    tables: Option<(Curve, Tables)>,
}

impl Warp {
    /// Warps one frame of RGB samples of 16 bits in linear light. `frame` holds the source's rows from the top, three samples a
    /// pixel and no padding; so will `output`. `curve` says how codes stand for light. `scratch` is working memory, to be kept
    /// from frame to frame. A gain is divided out of the display's pixels, if there is one. Pixels without an answer become 0.
    ///
    /// # Errors
    /// [`WarpError::FrameSize`] where the number of samples is wrong, [`WarpError::Gain`] where that of the gain's pixels is.
    pub fn apply_deep(
        &self,
        frame: &[u16],
        curve: Curve,
        evening: Option<&Evening>,
        scratch: &mut DeepScratch,
        output: &mut [u16],
    ) -> Result<(), WarpError> {
        check_samples(self.source[0], self.source[1], 3, frame.len())?;
        check_samples(self.width, self.height, 3, output.len())?;
        check_gain(evening, self.width * self.height)?;
        if scratch.tables.as_ref().is_none_or(|(known, _)| *known != curve) {
            scratch.tables = Some((curve, Tables::new(curve)));
        }
        let Some((_, tables)) = &scratch.tables else { return Ok(()) };
        frame
            .as_chunks::<3>()
            .0
            .par_iter()
            .with_min_len(1 << 14)
            .map(|pixel| pixel.map(|code| tables.decode(code)))
            .collect_into_vec(&mut scratch.light);
        let source =
            Source { light: &scratch.light, size: self.source, cubic: self.tables.as_ref() };
        let plan: &Plan = &self.plan;
        output.par_chunks_mut(self.width.max(1) * 3).enumerate().for_each(|(row, line)| {
            line.fill(0);
            for span in plan.spans(row) {
                let targets = line[span.start * 3..span.end * 3].as_chunks_mut::<3>().0;
                for (column, target) in span.zip(targets) {
                    let index = row * self.width + column;
                    let taps = plan.samples(index);
                    let mut sum = [0.0f32; 3];
                    for tap in taps {
                        let light = source.sample(tap);
                        for c in 0..3 {
                            // What overshoots is held to the range, as in a still.
                            sum[c] += light[c].clamp(0.0, 1.0);
                        }
                    }
                    for c in 0..3 {
                        let light = sum[c] / taps.len() as f32;
                        let light = evening.map_or(light, |e| e.emitted(index, c, light));
                        target[c] = tables.encode(light);
                    }
                }
            }
        });
        Ok(())
    }
}

struct Source<'a> {
    light: &'a [[f32; 3]],
    size: [usize; 2],
    cubic: Option<&'a CubicTables>,
}

impl Source<'_> {
    fn sample(&self, tap: &Tap) -> [f32; 3] {
        match self.cubic {
            Some(tables) => {
                let row = |table: &[[i32; 2]], index: u16| unpack(table[usize::from(index)]);
                self.sum(tap, row(&tables.x, tap.x), row(&tables.y, tap.y))
            }
            None => {
                let (fx, fy) = (i32::from(tap.x), i32::from(tap.y));
                self.sum(tap, [ONE - fx, fx], [ONE - fy, fy])
            }
        }
    }

    fn sum<const N: usize>(&self, tap: &Tap, wx: [i32; N], wy: [i32; N]) -> [f32; 3] {
        let weight = |w: i32| w as f32 / ONE as f32;
        let mut sum = [0.0; 3];
        // A source of fewer rows or columns has no weight on those that it lacks.
        for j in 0..N.min(self.size[1]) {
            let start = tap.pixel as usize + j * self.size[0];
            let mut across = [0.0; 3];
            for (pixel, &w) in self.light[start..].iter().zip(&wx[..N.min(self.size[0])]) {
                for c in 0..3 {
                    across[c] += pixel[c] * weight(w);
                }
            }
            for c in 0..3 {
                sum[c] += across[c] * weight(wy[j]);
            }
        }
        sum
    }
}
