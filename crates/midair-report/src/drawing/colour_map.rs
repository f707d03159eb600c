//! A plate's character as pictures: numbers over two axes, in colours.

use midair::optics::plate::character::{Directions, PointSpread, Viewpoints};
use midair::optics::plate::{Class, luminance};
use midair::picture::Picture;

/// Numbers over two axes as a picture, with what its colours mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Linear light; what has no number is transparent.
    pub picture: Picture,
    /// The number shown by the first and by the last colour of [`colour_map`].
    pub range: [f64; 2],
}

/// The colour of a number in \[0, 1\] (held to it) in linear light: from dark violet over teal to light yellow,
/// in equal steps of lightness, so that it reads as well in grey and for colour-blind eyes.
///
/// A line in the lightness and hue of OKLab (Ottosson 2020): lightness 0.27 to 0.93, hue 305 to 105
/// degrees, chroma 0.13 or as much of it as sRGB holds.
pub fn colour_map(value: f64) -> [f32; 3] {
    let t = value.clamp(0.0, 1.0);
    let lightness = 0.27 + 0.66 * t;
    let (s, c) = (305.0 - 200.0 * t).to_radians().sin_cos();
    let colour = |chroma: f64| oklab_to_linear([lightness, chroma * c, chroma * s]);
    let shown = |rgb: [f64; 3]| rgb.iter().all(|v| (0.0..=1.0).contains(v));
    let (mut inside, mut outside) = (0.0, 0.13);
    if shown(colour(outside)) {
        inside = outside;
    } else {
        // Half a code of 8 bits is more than 2^-12 of the chroma.
        for _ in 0..12 {
            let middle = 0.5 * (inside + outside);
            if shown(colour(middle)) { inside = middle } else { outside = middle }
        }
    }
    colour(inside).map(|v| v.clamp(0.0, 1.0) as f32)
}

/// Linear sRGB of a colour in OKLab (B. Ottosson, A perceptual color space for image processing, 2020).
fn oklab_to_linear([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

/// The luminance of the light that a plate passes in one way, over incidence (to the right) and azimuth
/// (upwards, as listed): squares of `cell` pixels, colours from 0 to 1.
pub fn shares_chart(directions: &Directions, class: Class, cell: usize) -> Chart {
    let shares = directions.shares.iter().map(|s| match class {
        Class::Real => s.real,
        Class::Stray => s.stray,
        Class::Through => s.through,
    });
    let values: Vec<f64> = shares.map(luminance).collect();
    chart(directions.incidence.len(), &values, [0.0, 1.0], cell)
}

/// The image's luminance over the viewer's azimuth (to the right) and elevation (upwards): squares of
/// `cell` pixels, colours from 0 to the largest.
pub fn viewpoints_chart(viewpoints: &Viewpoints, cell: usize) -> Chart {
    let values = &viewpoints.luminance;
    chart(viewpoints.azimuth.len(), values, [0.0, largest(values)], cell)
}

/// How a point's light spreads over a square of `size` mm about it: `bins` x `bins` squares of `cell` pixels, x to the
/// right and y upwards; colours from 0 to the largest share of the light in a square.
pub fn point_spread_chart(spread: &PointSpread, size: f64, bins: usize, cell: usize) -> Chart {
    let mut values = spread.histogram(size, bins);
    // Its top row comes first, a chart's bottom one does.
    let upright: Vec<f64> = values.chunks(bins.max(1)).rev().flatten().copied().collect();
    values.copy_from_slice(&upright);
    let range = [0.0, largest(&values)];
    chart(bins, &values, range, cell)
}

fn largest(values: &[f64]) -> f64 {
    // NaN, which has no colour, is passed over.
    values.iter().fold(0.0, |a: f64, &b| a.max(b))
}

/// Values in rows of `columns`, the bottom row first.
fn chart(columns: usize, values: &[f64], range: [f64; 2], cell: usize) -> Chart {
    let rows = values.len().checked_div(columns).unwrap_or(0);
    let mut picture = Picture::filled(columns * cell, rows * cell, [0.0; 4]);
    let span = range[1] - range[0];
    let colour = |value: f64| match value.is_nan() {
        true => [0.0; 4],
        false => {
            let t = if span > 0.0 { (value - range[0]) / span } else { 0.0 };
            let [r, g, b] = colour_map(t);
            [r, g, b, 1.0]
        }
    };
    let colours: Vec<[f32; 4]> = values.iter().map(|&v| colour(v)).collect();
    for (y, line) in picture.pixels.chunks_mut((columns * cell).max(1)).enumerate() {
        let row = rows - 1 - y / cell;
        for (x, pixel) in line.iter_mut().enumerate() {
            *pixel = colours[row * columns + x / cell];
        }
    }
    Chart { picture, range }
}

#[cfg(test)]
mod tests {
    use super::*;
    use midair::optics::plate::character::over_directions;
    use midair::optics::plate::{SlitMirror, SlitMirrorPlate};

    #[test]
    fn colours_rise_evenly_from_dark_to_light() {
        // OKLab's lightness of grey is the cube root of its light: known without the colour map.
        assert!(oklab_to_linear([0.5, 0.0, 0.0]).iter().all(|v| (v - 0.125).abs() < 1e-7));
        // sRGB's red is lightness 0.62796, a 0.22486, b 0.12585 (Ottosson's own table).
        let red = oklab_to_linear([0.627_96, 0.224_86, 0.125_85]);
        for (got, expected) in red.iter().zip([1.0, 0.0, 0.0]) {
            assert!((got - expected).abs() < 1e-4, "{red:?}");
        }
        let mut last = 0.0;
        for i in 0..=255 {
            let [r, g, b] = colour_map(f64::from(i) / 255.0).map(f64::from);
            let y = luminance([r, g, b]);
            assert!(y > last, "luminance falls at {i}");
            last = y;
        }
        assert!(last > 0.7 && luminance(colour_map(0.0).map(f64::from)) < 0.05);
        assert_eq!(colour_map(f64::INFINITY), colour_map(1.0));
    }

    #[test]
    fn charts_put_each_number_in_its_place() {
        let plate = SlitMirrorPlate::new(SlitMirror::default()).unwrap();
        let map = over_directions(&plate, &[0.0, 30.0, 45.0], &[0.0, 20.0]);
        let chart = shares_chart(&map, Class::Real, 4);
        assert_eq!((chart.picture.width, chart.picture.height), (12, 8));
        for (i, j) in [(0, 0), (2, 0), (1, 1), (2, 1)] {
            let [r, g, b] = colour_map(luminance(map.at(i, j).real));
            // The first azimuth is at the bottom; a place within each square.
            let pixel = chart.picture.pixels[(7 - 4 * j - 1) * 12 + 4 * i + 2];
            assert_eq!(pixel, [r, g, b, 1.0], "{i} {j}");
        }

        let seen = Viewpoints {
            azimuth: vec![-5.0, 5.0],
            elevation: vec![0.0, 9.0],
            luminance: vec![0.1, f64::NAN, 0.2, 0.4],
        };
        let chart = viewpoints_chart(&seen, 1);
        assert_eq!(chart.range, [0.0, 0.4]);
        let [r, g, b] = colour_map(0.5);
        assert_eq!(chart.picture.pixels[0], [r, g, b, 1.0]);
        assert_eq!(chart.picture.pixels[3], [0.0; 4]);

        // Light up and to the right of the point.
        let spread = PointSpread { light: vec![[0.3, 0.4, 2.0]], efficiency: 1.0 };
        let chart = point_spread_chart(&spread, 1.0, 2, 1);
        let [r, g, b] = colour_map(1.0);
        assert_eq!(chart.picture.pixels[1], [r, g, b, 1.0]);
        assert_ne!(chart.picture.pixels[3], [r, g, b, 1.0]);
        assert_eq!(chart.range, [0.0, 1.0]);
    }
}
