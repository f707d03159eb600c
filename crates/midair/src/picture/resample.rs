//! The display image of a still: the picture seen through the map.
//!
//! The filter is supersampling through the map's Jacobian. A display pixel covers a parallelogram
//! of the image, spanned by the Jacobian's columns; the picture is averaged over it on a grid no
//! coarser than the picture's pixels, each sample by Catmull-Rom interpolation. Against EWA
//! (Heckbert 1989), whose Gaussian blurs what it need not, this keeps magnified parts sharp, and its
//! cost follows the picture's area, not the worst pixel's ellipse.
//!
//! Where the map magnifies the parallelogram shrinks to a point, so that the interpolant alone speaks and
//! the identity returns the picture bit for bit; see [`extent`] for the passage between the two.

use super::{Picture, interpolate::Sampler};
use crate::map::Map;
use rayon::prelude::*;

/// Most samples along a side of a display pixel's footprint: beyond it the footprint is sampled
/// more coarsely than the picture (a display pixel there covers a hundred image pixels).
const MAX_SAMPLES: f64 = 128.0;

/// The display image that shows `picture` through `map`: linear light, premultiplied, of the map's size.
///
/// The picture covers image uv \[0, 1\]^2, v up; beyond its edge the edge goes on. Pixels that show nothing of the image
/// ([`Map::drawn`]) are black and transparent.
pub fn display_image(picture: &Picture, map: &Map) -> Picture {
    let mut pixels = vec![[0.0f32; 4]; map.width * map.height];
    if map.width > 0 && picture.width > 0 && picture.height > 0 {
        let sampler = Sampler::new(picture);
        let size = [picture.width, picture.height];
        pixels.par_chunks_mut(map.width).enumerate().for_each(|(row, line)| {
            for (column, pixel) in line.iter_mut().enumerate() {
                *pixel = display_pixel(&sampler, size, map, column, row);
            }
        });
    }
    Picture { width: map.width, height: map.height, pixels }
}

/// As [`display_image`], each of red, green and blue through its own map: the maps of the display's colours where indices
/// depend on the wavelength. A pixel is as opaque as its most opaque colour.
pub fn display_image_by_colour(picture: &Picture, maps: [&Map; 3]) -> Picture {
    let mut drawn = display_image(picture, maps[0]);
    for (c, map) in maps.into_iter().enumerate().skip(1) {
        let other = display_image(picture, map);
        for (pixel, other) in drawn.pixels.iter_mut().zip(other.pixels) {
            pixel[c] = other[c];
            pixel[3] = pixel[3].max(other[3]);
        }
    }
    drawn
}

/// What a display pixel covers of the picture, in the picture's pixels (x right, y down, 0 at the first
/// pixel's centre): a parallelogram about a point, and how many samples to average along its sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    centre: [f64; 2],
    across: [f64; 2],
    down: [f64; 2],
    n_across: usize,
    n_down: usize,
}

impl Footprint {
    /// The footprint of a pixel of `map` in a picture of `size` (width, height); none where nothing is drawn.
    #[inline]
    pub(crate) fn new(map: &Map, size: [usize; 2], column: usize, row: usize) -> Option<Self> {
        let [u, v] = map.drawn(column, row)?;
        let (width, height) = (size[0] as f64, size[1] as f64);
        let left = column.checked_sub(1).and_then(|column| map.drawn(column, row));
        let right = (column + 1 < map.width).then(|| map.drawn(column + 1, row)).flatten();
        let [du, dv] = derivative(left, [u, v], right);
        let (across, n_across) = footprint_side([du * width, -dv * height]);
        let above = row.checked_sub(1).and_then(|row| map.drawn(column, row));
        let below = (row + 1 < map.height).then(|| map.drawn(column, row + 1)).flatten();
        let [du, dv] = derivative(above, [u, v], below);
        let (down, n_down) = footprint_side([du * width, -dv * height]);
        let centre = [u * width - 0.5, (1.0 - v) * height - 0.5];
        Some(Self { centre, across, down, n_across, n_down })
    }

    /// How many samples to average.
    #[inline]
    pub(crate) fn count(&self) -> usize {
        self.n_across * self.n_down
    }

    /// The places at which to sample the picture.
    #[inline]
    pub(crate) fn samples(self) -> impl Iterator<Item = [f64; 2]> {
        let along = |i: usize, n: usize| (i as f64 + 0.5) / n as f64 - 0.5;
        (0..self.n_down).flat_map(move |j| {
            let b = along(j, self.n_down);
            (0..self.n_across).map(move |i| {
                let a = along(i, self.n_across);
                [0, 1].map(|c| self.centre[c] + a * self.across[c] + b * self.down[c])
            })
        })
    }
}

/// One display pixel: the average of the picture over the pixel's footprint.
#[inline]
fn display_pixel(
    sampler: &Sampler,
    size: [usize; 2],
    map: &Map,
    column: usize,
    row: usize,
) -> [f32; 4] {
    let Some(footprint) = Footprint::new(map, size, column, row) else {
        return [0.0; 4];
    };
    let count = footprint.count();
    if count == 1 {
        return sampler.cubic(footprint.centre[0], footprint.centre[1]);
    }
    let mut sum = [0.0f32; 4];
    for [x, y] in footprint.samples() {
        let sample = sampler.cubic(x, y);
        for c in 0..4 {
            sum[c] += sample[c];
        }
    }
    let share = 1.0 / count as f32;
    sum.map(|total| total * share)
}

/// uv per display pixel along one axis, of a pixel and its neighbours: the central difference, one-sided at a border, 0 alone.
#[inline]
fn derivative(back: Option<[f64; 2]>, here: [f64; 2], ahead: Option<[f64; 2]>) -> [f64; 2] {
    let difference = |a: [f64; 2], b: [f64; 2]| [b[0] - a[0], b[1] - a[1]];
    match (back.map(|uv| difference(uv, here)), ahead.map(|uv| difference(here, uv))) {
        (None, None) => [0.0; 2],
        (Some(one), None) | (None, Some(one)) => one,
        (Some(back), Some(ahead)) => {
            let square = |d: [f64; 2]| d[0] * d[0] + d[1] * d[1];
            let (b, a) = (square(back), square(ahead));
            // Two branches of the map meet here: a step four times the other is no derivative.
            if b > 16.0 * a {
                ahead
            } else if a > 16.0 * b {
                back
            } else {
                [0.5 * (back[0] + ahead[0]), 0.5 * (back[1] + ahead[1])]
            }
        }
    }
}

/// A side of the footprint in image pixels, scaled to its [`extent`], and the samples along it.
fn footprint_side(side: [f64; 2]) -> ([f64; 2], usize) {
    let square = side[0] * side[0] + side[1] * side[1];
    if square <= 1.0 {
        return ([0.0; 2], 1);
    }
    let length = square.sqrt();
    let width = extent(length);
    // Over so short a side the average is the value at its middle: they differ by width^2 / 24 of the interpolant's second derivative, less than a
    // tenth of an 8-bit code. The difference of two uv in single precision takes as much for a step of more than 1.
    if !width.is_finite() || width < 1.0 / 32.0 {
        return ([0.0; 2], 1);
    }
    let scale = width / length;
    ([side[0] * scale, side[1] * scale], (width.ceil() + 1.0).min(MAX_SAMPLES) as usize)
}

/// How far to average, in image pixels, where a display pixel's step covers `step` image pixels.
///
/// At and below 1 not at all: the picture's own pixels already are averages of that width. From 2 on the
/// whole step. Between, the width whose square makes up what the picture's pixels lack, scaled to
/// meet the whole step at 2; so nothing jumps as the map passes from magnifying to minifying.
fn extent(step: f64) -> f64 {
    if step <= 1.0 { 0.0 } else { step.min((4.0 / 3.0 * (step * step - 1.0)).sqrt()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Status, bleed, pixel_centre};
    use proptest::prelude::*;

    fn picture(width: usize, height: usize, value: impl Fn(f64, f64) -> f32) -> Picture {
        let pixels = (0..width * height)
            .map(|i| {
                let [u, v] = pixel_centre(i % width, i / width, width, height);
                [value(u, v), 0.5 * value(v, u), 0.25, 1.0]
            })
            .collect();
        Picture { width, height, pixels }
    }

    fn map(width: usize, height: usize, uv: impl Fn(f64, f64) -> [f64; 2]) -> Map {
        let mut map = Map::identity(width, height);
        map.uv.iter_mut().for_each(|st| *st = uv(st[0], st[1]));
        map
    }

    #[test]
    fn the_identity_gives_the_picture_back_bit_for_bit() {
        for (width, height) in [(64, 48), (37, 101), (1, 1), (3, 2), (1000, 7)] {
            let noise =
                picture(width, height, |u, v| ((u * 991.0 + v * 7919.0).sin() + 1.0) as f32);
            assert_eq!(display_image(&noise, &Map::identity(width, height)), noise);
        }
    }

    #[test]
    fn a_constant_stays_constant_under_any_map() {
        let constant = Picture::filled(33, 17, [0.7, 0.2, 0.0, 1.0]);
        let bent = map(40, 30, |s, t| [s + 0.2 * (7.0 * t).sin(), 4.0 * t * t - s]);
        for pixel in display_image(&constant, &bent).pixels {
            // Each of up to a few hundred samples' sixteen weights sums to 1 within float rounding.
            assert!((0..4).all(|c| (pixel[c] - constant.pixels[0][c]).abs() < 1e-5));
        }
    }

    #[test]
    fn a_magnified_ramp_is_the_ramp() {
        let ramp = picture(32, 32, |u, v| (0.2 + 0.5 * u + 0.1 * v) as f32);
        // The middle third, so that no tap reaches the clamped edge.
        let zoom = map(100, 90, |s, t| [(1.0 + s) / 3.0, (1.0 + t) / 3.0]);
        let image = display_image(&ramp, &zoom);
        for (pixel, [u, v]) in image.pixels.iter().zip(&zoom.uv) {
            // Sixteen products of floats up to 1.
            assert!((f64::from(pixel[0]) - (0.2 + 0.5 * u + 0.1 * v)).abs() < 1e-6);
        }
    }

    #[test]
    fn a_minified_zone_plate_does_not_alias() {
        // Along each axis the frequency grows to 0.4 cycles a pixel; shown at a quarter of the size,
        // all beyond an eighth must vanish, not come back as rings.
        let (size, small) = (512, 128);
        let phase = |u: f64| 0.4 * std::f64::consts::PI * size as f64 * u * u;
        let plate = picture(size, size, |u, v| (0.5 + 0.5 * (phase(u) + phase(v)).cos()) as f32);
        let image = display_image(&plate, &map(small, small, |s, t| [s, t]));
        // The plate itself, not its pixels, averaged over each display pixel: the cosine of the sum is
        // a product of one-dimensional averages, each by 4096 samples (their square in two dimensions).
        let average = |wave: fn(f64) -> f64, pixel: usize| {
            let at = |k: usize| (pixel as f64 + (k as f64 + 0.5) / 4096.0) / small as f64;
            (0..4096).map(|k| wave(phase(at(k)))).sum::<f64>() / 4096.0
        };
        let cosines: Vec<f64> = (0..small).map(|i| average(f64::cos, i)).collect();
        let sines: Vec<f64> = (0..small).map(|i| average(f64::sin, i)).collect();
        let (mut worst, mut squares) = (0.0f64, 0.0);
        for (index, pixel) in image.pixels.iter().enumerate() {
            let (i, j) = (index % small, small - 1 - index / small);
            let exact = 0.5 + 0.5 * (cosines[i] * cosines[j] - sines[i] * sines[j]);
            let error = (f64::from(pixel[0]) - exact).abs();
            worst = worst.max(error);
            squares += error * error / (small * small) as f64;
        }
        println!("worst {worst:.4}, rms {:.4}", squares.sqrt());
        // Of an amplitude of 0.5 (point sampling errs by 0.35 rms): Catmull-Rom damps 0.25 cycles a pixel
        // by a tenth of what the box has left of it, and 5 x 5 samples leave a little of 0.4.
        assert!(worst < 0.02, "worst {worst}");
        assert!(squares.sqrt() < 0.005, "rms {}", squares.sqrt());
    }

    #[test]
    fn one_ring_beyond_the_answers_is_drawn_and_the_rest_is_black() {
        let white = Picture::filled(16, 16, [1.0; 4]);
        let mut holed = Map::identity(16, 16);
        let hole = |column: usize, row: usize| (3..10).contains(&column) && (5..11).contains(&row);
        for index in 0..256 {
            if hole(index % 16, index / 16) {
                (holed.uv[index], holed.status[index]) = ([f64::NAN; 2], Status::Outside);
            }
        }
        // A continuation is for other tools.
        for map in [bleed(&holed, 2), holed] {
            for (index, pixel) in display_image(&white, &map).pixels.iter().enumerate() {
                // The hole without its outermost pixels.
                let dark = (4..9).contains(&(index % 16)) && (6..10).contains(&(index / 16));
                assert_eq!(*pixel, if dark { [0.0; 4] } else { [1.0; 4] }, "{index}");
            }
        }
    }

    #[test]
    fn a_turned_map_turns_the_picture() {
        let noise = picture(20, 20, |u, v| ((u * 91.0 + v * 719.0).sin() + 1.0) as f32);
        let quarter = map(20, 20, |s, t| [t, 1.0 - s]);
        let image = display_image(&noise, &quarter);
        for row in 0..20 {
            for column in 0..20 {
                // u = t: the column counts rows from the bottom; 1 - v = s: the row counts columns.
                assert_eq!(image.pixels[row * 20 + column], noise.pixels[column * 20 + 19 - row]);
            }
        }
    }

    proptest! {
        #[test]
        fn the_extent_is_continuous_and_grows(step in 0.0f64..6.0) {
            let ahead = extent(step + 1e-6);
            prop_assert!(ahead >= extent(step));
            // The square root starts steeply: sqrt(8/3 * 1e-6) is its largest step.
            prop_assert!(ahead - extent(step) < 2e-3);
        }

        #[test]
        fn hostile_maps_stay_finite_and_within_the_picture(
            uv in prop::collection::vec((-3.0f64..3.0, -3.0f64..3.0), 12),
        ) {
            let noise = picture(8, 8, |u, v| ((u * 91.0 + v * 719.0).sin() + 1.0) as f32);
            let mut wild = Map::identity(4, 3);
            for (target, (u, v)) in wild.uv.iter_mut().zip(uv) {
                *target = [u, v];
            }
            for pixel in display_image(&noise, &wild).pixels {
                prop_assert!(pixel.iter().all(|value| (0.0..=2.0).contains(value)));
            }
        }
    }
}
