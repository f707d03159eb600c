//! Frames whose gain is divided out before they are warped: what a show does that follows its viewer.
//!
//! The gain is a function of the image point ([`ImageGain`]), so it can be divided out of the source's pixels: a display pixel
//! interpolates among source pixels that are too bright by what each of them loses. Compared with dividing it out of the display's pixels,
//! a gain per source pixel is interpolated along with the light: the difference is a quarter of what the light differs by between
//! two source pixels times what the gain does, far less than a code. And nothing is worked out per display pixel.

#[cfg(target_arch = "x86_64")]
use super::light_avx2;
use super::linear::{DECODE, LightFrame, WHITE, curve};
use super::{WarpError, check_samples, check_source};
use crate::map::{ImageGain, cell};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Light of the brightest value in frames whose gain is divided out, over the display's white. What is above white is kept until it has been
/// interpolated, and only then held to white; gains of less than a quarter of the level are taken for a quarter. A step of light is then
/// four times as large as else: four tenths of an 8-bit code at black, where the curve is steepest, a fiftieth at white.
pub const HEADROOM: f32 = 4.0;

/// A gain over the image made ready to be divided out of source frames, at a given level.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameEvening {
    columns: usize,
    rows: usize,
    /// At the gain's nodes: what the light of a frame's channels is multiplied by, in parts of [`HEADROOM`].
    factors: Vec<[f32; 4]>,
}

impl FrameEvening {
    /// For frames whose first three channels are these colours (0 red, 1 green, 2 blue). `level` is how bright white is to be in the mid-air
    /// image, over the display's white: [`Evening::level`](crate::picture::Evening::level).
    pub fn new(gain: &ImageGain, level: f64, colours: [usize; 3]) -> Self {
        let level = level as f32;
        // No answer, no light: nothing to be made brighter. NaN is none of the two.
        let factor = |share: f32| match share > 0.0 {
            true => (level / share).min(HEADROOM) / HEADROOM,
            false if share == 0.0 => 1.0,
            false => 1.0 / HEADROOM,
        };
        let factors = gain.nodes.rgb.iter().map(|rgb| {
            let [a, b, c] = colours.map(|c| factor(rgb[c]));
            [a, b, c, 1.0 / HEADROOM]
        });
        Self { columns: gain.nodes.width, rows: gain.nodes.height, factors: factors.collect() }
    }

    /// Columns and rows of nodes.
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// At each node, rows from the top, those at the edges on the image's edges: what the light of a frame's channels is multiplied by,
    /// in parts of [`HEADROOM`].
    pub fn factors(&self) -> &[[f32; 4]] {
        &self.factors
    }

    /// The factors of a row of nodes, at the columns of a frame of `width`.
    fn line(&self, row: usize, width: usize, line: &mut Vec<[f32; 4]>) {
        let nodes = &self.factors[row * self.columns..(row + 1) * self.columns];
        let cells = self.columns - 1;
        let step = cells as f32 / width as f32;
        line.clear();
        for cell in 0..cells {
            let (start, end) = (first_in(cell, cells, width), first_in(cell + 1, cells, width));
            let offset = (start as f32 + 0.5) * step - cell as f32;
            let (a, b) = (nodes[cell], nodes[cell + 1]);
            line.extend((0..end - start).map(|i| mix(&a, &b, offset + i as f32 * step)));
        }
    }
}

fn mix(a: &[f32; 4], b: &[f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|c| a[c] + t * (b[c] - a[c]))
}

/// The factors of the rows of nodes above and below some rows of a frame, at the frame's columns.
#[derive(Default)]
struct Lines {
    /// Which row of nodes is the upper one.
    above: Option<usize>,
    lines: [Vec<[f32; 4]>; 2],
}

impl Lines {
    /// Those around the row of cells `above`, from the top.
    fn around(&mut self, above: usize, width: usize, evening: &FrameEvening) -> [&[[f32; 4]]; 2] {
        if self.above != Some(above) {
            let [upper, lower] = &mut self.lines;
            match self.above {
                Some(before) if before + 1 == above => std::mem::swap(upper, lower),
                _ => evening.line(above, width, upper),
            }
            evening.line(above + 1, width, lower);
            self.above = Some(above);
        }
        self.lines.each_ref().map(Vec::as_slice)
    }
}

impl LightFrame {
    /// As [`decode`](Self::decode), for a frame of `size` (width, height) pixels that shows the image, with its gain divided out. It is
    /// warped with a [`Drive::of_evened`](super::Drive::of_evened). Returns the share of the frame's samples (pixels times
    /// colours) that the display's white is not bright enough for.
    ///
    /// # Errors
    /// [`WarpError`] where the number of channels or bytes is wrong.
    pub fn decode_evened(
        &mut self,
        frame: &[u8],
        channels: usize,
        size: [usize; 2],
        evening: &FrameEvening,
    ) -> Result<f64, WarpError> {
        check_source(size)?;
        check_samples(size[0], size[1], channels, frame.len())?;
        self.light.resize(size[0] * size[1], [0; 4]);
        match channels {
            3 => Ok(decode::<3>(frame, size, evening, &mut self.light)),
            4 => Ok(decode::<4>(frame, size, evening, &mut self.light)),
            other => Err(WarpError::Channels(other)),
        }
    }
}

/// 2^23: from here to twice as much a float's last bit counts ones, so that adding it rounds.
pub(super) const ROUNDING: f32 = (1u32 << 23) as f32;

/// Light of the codes, colours' after one another and then alpha's.
pub(super) type Light = [[f32; 256]; 2];

/// The display's white, and one more: rounding of a pixel that is exactly at the level is no clipping.
pub(super) const MOST: i32 = WHITE / HEADROOM as i32 + 1;

fn decode<const C: usize>(
    frame: &[u8],
    [width, height]: [usize; 2],
    evening: &FrameEvening,
    light: &mut [[i16; 4]],
) -> f64 {
    let tables: Light = DECODE.each_ref().map(|table| table.map(f32::from));
    let clipped = AtomicUsize::new(0);
    let rows = light.par_chunks_mut(width).zip(frame.par_chunks(width * C)).enumerate();
    rows.with_min_len(16).for_each_init(Lines::default, |lines, (row, (light, frame))| {
        let (above, t) = cell((row as f64 + 0.5) / height as f64, evening.rows - 1);
        let factors = lines.around(above, width, evening);
        let above_white = decode_row::<C>(frame.as_chunks().0, &tables, factors, t, light);
        clipped.fetch_add(above_white, Ordering::Relaxed);
    });
    clipped.into_inner() as f64 / (3 * width * height) as f64
}

/// A row of pixels, `t` on the way from the upper factors to the lower ones. Returns how many samples take more than white.
fn decode_row<const C: usize>(
    frame: &[[u8; C]],
    tables: &Light,
    factors: [&[[f32; 4]]; 2],
    t: f32,
    light: &mut [[i16; 4]],
) -> usize {
    #[cfg(target_arch = "x86_64")]
    if C == 4 && std::arch::is_x86_feature_detected!("avx2") {
        let frame = frame.as_flattened().as_chunks().0;
        // SAFETY: the processor has AVX2; the function asks for nothing else.
        return unsafe { light_avx2::decode_row(frame, tables, factors, t, light) };
    }
    decode_row_plain(frame, tables, factors, t, light)
}

pub(super) fn decode_row_plain<const C: usize>(
    frame: &[[u8; C]],
    tables: &Light,
    [above, below]: [&[[f32; 4]]; 2],
    t: f32,
    light: &mut [[i16; 4]],
) -> usize {
    let mut above_white = 0;
    for (((light, pixel), a), b) in light.iter_mut().zip(frame).zip(above).zip(below) {
        for c in 0..C {
            let factor = a[c] + t * (b[c] - a[c]);
            let value = tables[curve(c)][usize::from(pixel[c])] * factor;
            let value = ((value + ROUNDING).to_bits() & 0x7fff) as i32;
            above_white += usize::from((c < 3) & (value > MOST));
            light[c] = value as i16;
        }
    }
    above_white
}

/// The first of `width` pixels whose centre does not lie before a cell.
fn first_in(cell: usize, cells: usize, width: usize) -> usize {
    (2 * cell * width).saturating_sub(cells).div_ceil(2 * cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Gain, Map};
    use crate::optics::screen::Screen;
    use crate::picture::{Drive, Evening, Filter, Overflow, Warp, srgb};

    /// A gain that bends, with all three colours apart.
    fn share([u, v]: [f64; 2]) -> [f32; 3] {
        let round = (u - 0.4).powi(2) + (v - 0.6).powi(2);
        [0.9 - 0.7 * round, 0.8 - 0.5 * round * v, 0.7 - 0.6 * u * u].map(|share| share as f32)
    }

    fn over_image(cells: usize) -> ImageGain {
        let node = |i: usize| {
            let (column, row) = (i % (cells + 1), i / (cells + 1));
            share([column as f64 / cells as f64, 1.0 - row as f64 / cells as f64])
        };
        let rgb = (0..(cells + 1).pow(2)).map(node).collect();
        ImageGain { nodes: Gain { width: cells + 1, height: cells + 1, rgb } }
    }

    #[test]
    fn pixels_are_parted_among_cells() {
        for (cells, width) in [(1, 1), (64, 1), (64, 63), (5, 1024), (256, 300), (7, 7)] {
            let firsts: Vec<usize> = (0..=cells).map(|cell| first_in(cell, cells, width)).collect();
            assert_eq!((firsts[0], firsts[cells]), (0, width));
            for cell in 0..cells {
                for x in firsts[cell]..firsts[cell + 1] {
                    let place = (x as f64 + 0.5) / width as f64 * cells as f64;
                    assert!(cell as f64 - 1e-9 <= place && place <= cell as f64 + 1.0 + 1e-9);
                }
            }
        }
    }

    /// Against the gain divided out of each display pixel by [`Evening`].
    #[test]
    fn dividing_before_the_warp_is_dividing_after_it() {
        let size = [300, 200];
        let frame: Vec<u8> = (0..size[0] * size[1])
            .flat_map(|i| {
                let (x, y) = ((i % size[0]) as f64 / 300.0, (i / size[0]) as f64 / 200.0);
                let wave = |a: f64, b: f64| (127.5 + 127.5 * (a * x + b * y).sin()) as u8;
                [wave(9.0, 2.0), wave(3.0, 8.0), wave(-5.0, 5.0), 255]
            })
            .collect();
        let map = Map::identity(500, 400);
        let warp = Warp::new(&map, size, Filter::Bilinear).unwrap();
        let rgb = map.uv.iter().map(|&uv| share(uv)).collect();
        let gain = Gain { width: 500, height: 400, rgb };
        for overflow in [Overflow::Fit, Overflow::Clip, Overflow::Soft] {
            // Blue first, as the show's frames are.
            let colours = [2, 1, 0];
            let each = Evening::for_white(&gain, overflow);
            let before = FrameEvening::new(&over_image(64), each.level(), colours);
            let screen = Screen::default();
            let mut light = LightFrame::default();
            let mut shown = vec![0; 500 * 400 * 4];
            let clipped = light.decode_evened(&frame, 4, size, &before).unwrap();
            let drive = Drive::of_evened(&screen, colours, overflow);
            warp.apply_light(&light, 4, &drive, &mut shown).unwrap();
            light.decode(&frame, 4).unwrap();
            let mut expected = shown.clone();
            let drive = Drive::of_screen(&screen, colours).with_evening(Some(each));
            warp.apply_light(&light, 4, &drive, &mut expected).unwrap();
            // One code at a rounding's edge; in the dark, where a step of light is 0.4 codes, no more.
            let worst = shown.iter().zip(&expected).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(worst <= Some(1), "{overflow:?}: {worst:?}");
            let differ = shown.iter().zip(&expected).filter(|(a, b)| a != b).count();
            assert!(differ * 12 < shown.len(), "{overflow:?}: {differ} of {}", shown.len());
            match overflow {
                Overflow::Fit => assert_eq!(clipped, 0.0),
                _ => assert!(clipped > 0.0 && clipped < 0.1, "{clipped}"),
            }
        }
    }

    #[test]
    fn what_is_above_white_is_interpolated_before_it_is_held_to_it() {
        // Two pixels, one with half of the level's gain: light 1 and 2 of white. A third of the way on it is 4/3, held to 1; two
        // codes of 0.2 light become 0.2667.
        let rgb = vec![[1.0; 3], [0.5; 3], [1.0; 3], [0.5; 3]];
        let gain = ImageGain { nodes: Gain { width: 2, height: 2, rgb } };
        let evening = FrameEvening::new(&gain, 1.0, [0, 1, 2]);
        let dark = srgb::encode_8(0.2);
        let frame = [255, dark, 0, 255, dark, 0];
        let mut light = LightFrame::default();
        let clipped = light.decode_evened(&frame, 3, [2, 1], &evening).unwrap();
        // The left pixel's centre has 1 / 0.75 of the level already (factors, not gains, are interpolated: 1.25).
        let unit = f32::from(i16::MAX) / HEADROOM;
        for (found, expected) in light.light.iter().zip([1.25, 1.75]) {
            assert!((f32::from(found[0]) / unit - expected).abs() < 1e-4, "{found:?}");
        }
        // Of six samples the two of white.
        assert!((clipped - 2.0 / 6.0).abs() < 1e-12);
    }

    #[test]
    fn no_gain_at_all_is_no_number_out_of_range() {
        let rgb = vec![[0.0, f32::NAN, 1e-30], [0.5; 3], [0.5; 3], [0.5; 3]];
        let gain = ImageGain { nodes: Gain { width: 2, height: 2, rgb } };
        let evening = FrameEvening::new(&gain, 0.5, [0, 1, 2]);
        assert!(evening.factors().iter().flatten().all(|f| (0.0..=1.0).contains(f)));
        let mut light = LightFrame::default();
        light.decode_evened(&[255; 4 * 9], 4, [3, 3], &evening).unwrap();
        assert!(light.light.iter().flatten().all(|&value| value >= 0));
        assert!(light.decode_evened(&[0; 5], 4, [3, 3], &evening).is_err());
        assert!(light.decode_evened(&[0; 18], 2, [3, 3], &evening).is_err());
    }
}
