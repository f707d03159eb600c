//! The gain: what the simulator finds on the average, for the one path of each display pixel, in closed form.

use crate::map::{Gain, ImageGain, Map, pixel_centre};
use crate::picture::Picture;
use crate::transport::{Path, Setup, Step};
use rayon::prelude::*;

/// What is left of each display pixel's light at the viewpoint, along the path that the map compensates: Fresnel's losses (of a polarised display those of
/// its polarisation, by Jones calculus),
/// absorption, the mirrors' and the plate's. Radiance goes by the same factors (both ends are in air), so this is the luminance of
/// the mid-air image over the display's along its normal: what a measured display emits less aslant is part of it.
///
/// Light that reflections bring besides is left out: it is what the viewer sees as reflections.
pub fn gain(setup: &Setup, map: &Map) -> Gain {
    let of_pixel = |path: &mut Path, pixel: usize| -> Option<[f32; 3]> {
        Some(arriving(setup, map.answer(pixel)?, path)?.1.map(|share| share as f32))
    };
    let rgb = (0..map.uv.len())
        .into_par_iter()
        .map_init(Path::new, |path, pixel| of_pixel(path, pixel).unwrap_or([f32::NAN; 3]))
        .collect();
    Gain { width: map.width, height: map.height, rgb }
}

/// Cells along a side of the image that [`image_gain`] begins with.
const COARSE: usize = 64;
/// Cells along a block of the coarse grid, whose inner nodes tell how far the gain is from bilinear there.
const BLOCK: usize = 2;
/// What a coarse cell is divided into along a side where that is too far.
const FINER: usize = 4;
/// The largest difference, as a share of the gain, that a block's inner nodes may have from the bilinear surface through its corners.
/// With cells of half that size a smooth gain is interpolated with a quarter of the difference: 1e-3, which moves a code of 255 by 0.11
/// (a code goes with the power 1 / 2.4 of the light).
const BENT: f32 = 4e-3;

/// The gain over the image, interpolated to a thousandth of itself where it is smooth; see [`ImageGain`]. Where it is not (at borders, where
/// the path begins to meet other things, at kinks of a plate's efficiency) the grid is 256 x 256 cells and there is no bound: along the
/// outline of a ball, towards which Fresnel's share falls steeply, a band of about two cells is off by more than 0.002 of itself, and
/// with a slit-mirror plate besides a tenth of the ball's points. Nodes
/// beside the last answered ones are continued by the mean of their neighbours, so that interpolation goes on to the border.
pub fn image_gain(setup: &Setup) -> ImageGain {
    let mut work = ImageGainWork::new(setup.clone());
    loop {
        if let Some(gain) = work.go_on(usize::MAX) {
            return gain;
        }
    }
}

/// [`image_gain`] a few rows of its grid at a time, for those who have something more urgent to do in between.
#[derive(Debug)]
pub struct ImageGainWork {
    setup: Setup,
    /// The nodes of the grid that are known, whole rows from the top.
    rgb: Vec<[f32; 3]>,
    /// The coarse grid, once it is complete, and which of its blocks are too coarse.
    coarse: Option<(ImageGain, Vec<bool>)>,
}

impl ImageGainWork {
    /// Nothing is worked out yet.
    pub fn new(setup: Setup) -> Self {
        Self { setup, rgb: Vec::new(), coarse: None }
    }

    /// Works out so many rows more. The gain, once it is complete; after that it begins anew.
    pub fn go_on(&mut self, rows: usize) -> Option<ImageGain> {
        let line = self.cells() + 1;
        let start = self.rgb.len();
        let end = (line * line).min(start.saturating_add(rows.saturating_mul(line)));
        let more: Vec<[f32; 3]> = (start..end)
            .into_par_iter()
            .with_min_len(line)
            .map_init(Path::new, |path, i| self.node(path, [i % line, i / line]))
            .collect();
        self.rgb.extend(more);
        if end < line * line {
            return None;
        }
        let nodes = Gain { width: line, height: line, rgb: std::mem::take(&mut self.rgb) };
        if self.coarse.take().is_none() {
            let blocks = COARSE / BLOCK;
            let too_coarse: Vec<bool> = (0..blocks * blocks)
                .map(|b| is_bent(&nodes.rgb, [b % blocks, b / blocks]))
                .collect();
            if too_coarse.contains(&true) {
                self.coarse = Some((ImageGain { nodes }, too_coarse));
                return None;
            }
        }
        Some(ImageGain { nodes: continued(nodes) })
    }

    /// Cells along a side of the grid that is under way.
    fn cells(&self) -> usize {
        if self.coarse.is_some() { COARSE * FINER } else { COARSE }
    }

    fn node(&self, path: &mut Path, [column, row]: [usize; 2]) -> [f32; 3] {
        let cells = self.cells() as f64;
        let uv = [column as f64 / cells, 1.0 - row as f64 / cells];
        if let Some((coarse, too_coarse)) = &self.coarse {
            if column.is_multiple_of(FINER) && row.is_multiple_of(FINER) {
                return coarse.nodes.rgb[row / FINER * (COARSE + 1) + column / FINER];
            }
            let blocks = COARSE / BLOCK;
            // A node on the line between two blocks belongs to both.
            let around = |n: usize| {
                let side = BLOCK * FINER;
                let block = n / side;
                let first = if n.is_multiple_of(side) { block.saturating_sub(1) } else { block };
                first..=block.min(blocks - 1)
            };
            if !around(row).any(|y| around(column).any(|x| too_coarse[y * blocks + x])) {
                return coarse.at(uv);
            }
        }
        let found = arriving(&self.setup, uv, path);
        found.map_or([f32::NAN; 3], |(_, share)| share.map(|share| share as f32))
    }
}

/// Whether the inner nodes of a block of the coarse grid are not where its corners let one expect them.
fn is_bent(coarse: &[[f32; 3]], [column, row]: [usize; 2]) -> bool {
    let node = |x: usize, y: usize| &coarse[(row * BLOCK + y) * (COARSE + 1) + column * BLOCK + x];
    let all = || (0..=BLOCK).flat_map(|y| (0..=BLOCK).map(move |x| (x, y)));
    let answered = all().filter(|&(x, y)| Gain::is_answered(node(x, y))).count();
    if answered == 0 {
        return false;
    }
    let corner = |x: usize, y: usize, c: usize| node(x * BLOCK, y * BLOCK)[c];
    answered < (BLOCK + 1).pow(2)
        || all().any(|(x, y)| {
            let (s, t) = (x as f32 / BLOCK as f32, y as f32 / BLOCK as f32);
            (0..3).any(|c| {
                let across = |y: usize| (1.0 - s) * corner(0, y, c) + s * corner(1, y, c);
                let expected = (1.0 - t) * across(0) + t * across(1);
                let found = node(x, y)[c];
                !((found - expected).abs() <= BENT * found)
            })
        })
}

/// Two rings of nodes more than are answered: as far as a cell with an image point that is answered can reach.
fn continued(nodes: Gain) -> Gain {
    match nodes.rgb.iter().all(Gain::is_answered) {
        true => nodes,
        false => nodes.with_ring().with_ring(),
    }
}

/// Where on the display the viewer looks who looks at an image point, and which share of the light from there arrives.
fn arriving(setup: &Setup, uv: [f64; 2], path: &mut Path) -> Option<([f64; 2], [f64; 3])> {
    let st = setup.transport(uv, path).st()?;
    Some((st, share_along(setup, uv, path)?))
}

/// Which share of R, G, B arrives from the display along an image point's path.
pub(crate) fn share_along(setup: &Setup, uv: [f64; 2], path: &[Step]) -> Option<[f64; 3]> {
    let left = setup.remainder(setup.ray(uv), path)?;
    let real = setup
        .plate
        .real_share(setup.plate.rectangle.frame.to_local_direction(-left.at_plate.direction));
    let emitted = setup.emitted_against(left.at_display);
    Some([0, 1, 2].map(|c| left.share[c] * real[c] / left.faces * emitted[c]))
}

/// The view of a display with its losses, in closed form: one line of sight through each pixel of a view of the image. Transparent black
/// where nothing is formed or `shown`, of an image point uv and its display place st, is false.
pub fn faded_view(
    setup: &Setup,
    display: &Picture,
    [width, height]: [usize; 2],
    shown: impl Fn([f64; 2], [f64; 2]) -> bool + Sync,
) -> Picture {
    let of_pixel = |path: &mut Path, index: usize| -> Option<[f32; 4]> {
        let uv = pixel_centre(index % width, index / width, width, height);
        let (st, share) = arriving(setup, uv, path)?;
        if !shown(uv, st) {
            return None;
        }
        let [r, g, b, _] = display.emitted(st)?;
        let [r, g, b] = [r * share[0] as f32, g * share[1] as f32, b * share[2] as f32];
        Some([r, g, b, 1.0])
    };
    let pixels = (0..width * height)
        .into_par_iter()
        .map_init(Path::new, |path, index| of_pixel(path, index).unwrap_or_default())
        .collect();
    Picture { width, height, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::bench_setup::{ACRYLIC, element, setup, sphere};

    #[test]
    fn a_few_rows_at_a_time_the_gain_is_the_same() {
        // Smooth all over, which the coarse grid is enough for; and cut by the ball's outline, which takes the finer one too.
        for (image, cells) in [(20.0, COARSE), (60.0, COARSE * FINER)] {
            let setup = setup(image, vec![element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 0)]);
            let bits = |gain: &ImageGain| -> Vec<[u32; 3]> {
                gain.nodes.rgb.iter().map(|rgb| rgb.map(f32::to_bits)).collect()
            };
            let whole = image_gain(&setup);
            assert_eq!((whole.nodes.width, whole.nodes.height), (cells + 1, cells + 1));
            let mut work = ImageGainWork::new(setup);
            // Once more from the beginning.
            for _ in 0..2 {
                let mut steps = 1;
                let gain = loop {
                    if let Some(gain) = work.go_on(10) {
                        break gain;
                    }
                    steps += 1;
                };
                let fine = if cells > COARSE { (cells + 1).div_ceil(10) } else { 0 };
                assert_eq!(steps, (COARSE + 1).div_ceil(10) + fine);
                assert!(bits(&gain) == bits(&whole));
            }
        }
    }
}
