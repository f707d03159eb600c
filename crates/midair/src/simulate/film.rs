//! What a render has gathered, and how sure it is.

use crate::optics::plate::{Class, luminance};
use crate::picture::Picture;

/// Independent randomised replications of the whole render: their spread tells the error.
pub(super) const REPLICATIONS: usize = 8;

/// A view by what the plate did to its light: linear light, alpha 1. Their sum is what is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The mid-air image.
    pub real: Picture,
    /// Stray images.
    pub stray: Picture,
    /// What is seen through the plate as through a window.
    pub through: Picture,
}

/// Which light is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Light {
    /// The mid-air image alone.
    Real,
    /// All but the mid-air image: stray images and what is seen through the plate.
    Stray,
    /// All light.
    #[default]
    All,
}

/// How far a render may be from what more paths would give: standard errors of luminance (weights
/// of Rec. ITU-R BT.709) of all light, from the spread of eight independent replications.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// Of each pixel, row 0 at the top. From eight values, it is itself uncertain by a quarter
    /// (1 / sqrt(2 (8 - 1)) of it). NaN where nothing was rendered.
    pub pixel: Vec<f32>,
    /// Root mean square of the pixels' standard errors: the noise of the picture.
    pub noise: f64,
    /// Standard error of the picture's mean luminance.
    pub of_mean: f64,
}

/// A render, whole or stopped early.
#[derive(Clone, Debug, PartialEq)]
pub struct Render {
    /// The view.
    pub layers: Layers,
    /// Its statistical error.
    pub error: ErrorEstimate,
    /// Paths followed.
    pub paths: u64,
    /// Paths through the pixel that has the fewest, and through the one that has the most: different only
    /// where a render was stopped.
    pub samples_per_pixel: [u32; 2],
    /// Mean luminance of all light, over the pixels that were rendered; NaN if none was.
    pub mean_luminance: f64,
    /// Whether all paths that were asked for were followed.
    pub complete: bool,
}

impl Render {
    /// The view by some of its light: linear, alpha 1.
    pub fn view(&self, light: Light) -> Picture {
        let Layers { real, stray, through } = &self.layers;
        let layers: &[&Picture] = match light {
            Light::Real => &[real],
            Light::Stray => &[stray, through],
            Light::All => &[real, stray, through],
        };
        let mut sum = layers[0].clone();
        for layer in &layers[1..] {
            for (pixel, more) in sum.pixels.iter_mut().zip(&layer.pixels) {
                for c in 0..3 {
                    pixel[c] += more[c];
                }
            }
        }
        sum
    }
}

/// What one pixel's new paths bring.
#[derive(Clone, Default)]
pub(super) struct Harvest {
    light: [[f64; 3]; 3],
    replication: [f64; REPLICATIONS],
}

impl Harvest {
    #[inline]
    pub(super) fn add(&mut self, replication: usize, class: Class, light: [f64; 3]) {
        let layer = &mut self.light[class as usize];
        for c in 0..3 {
            layer[c] += light[c];
        }
        self.replication[replication] += luminance(light);
    }
}

/// One row of the view under way.
pub(super) struct Row {
    /// Paths of each pixel in each replication.
    pub(super) done: u32,
    /// Sums over paths, of each pixel.
    pixels: Vec<Sums>,
}

#[derive(Clone, Default)]
struct Sums {
    /// By class, then colour.
    light: [[f32; 3]; 3],
    /// Luminance.
    replication: [f32; REPLICATIONS],
}

impl Row {
    pub(super) fn new(width: usize) -> Self {
        Self { done: 0, pixels: vec![Sums::default(); width] }
    }

    pub(super) fn width(&self) -> usize {
        self.pixels.len()
    }

    pub(super) fn add(&mut self, column: usize, harvest: &Harvest) {
        let sums = &mut self.pixels[column];
        for (layer, more) in sums.light.iter_mut().zip(&harvest.light) {
            for c in 0..3 {
                layer[c] += more[c] as f32;
            }
        }
        for (sum, more) in sums.replication.iter_mut().zip(&harvest.replication) {
            *sum += *more as f32;
        }
    }
}

/// The picture that rows make, where each of their samples took this many paths.
pub(super) fn develop(rows: &[&Row], paths_each: usize, complete: bool) -> Render {
    let (width, height) = (rows[0].pixels.len(), rows.len());
    let dark = Picture::filled(width, height, [0.0, 0.0, 0.0, 1.0]);
    let mut layers = [dark.clone(), dark.clone(), dark];
    let mut pixel_error = Vec::with_capacity(width * height);
    let (mut squares, mut rendered, mut paths) = (0.0, 0u64, 0);
    let mut means = [0.0; REPLICATIONS];
    for (row, line) in rows.iter().enumerate() {
        paths += u64::from(line.done) * (REPLICATIONS * width * paths_each) as u64;
        let each = 1.0 / f64::from(line.done);
        for (column, sums) in line.pixels.iter().enumerate() {
            if line.done == 0 {
                pixel_error.push(f32::NAN);
                continue;
            }
            for (layer, light) in layers.iter_mut().zip(&sums.light) {
                let pixel = &mut layer.pixels[row * width + column];
                for c in 0..3 {
                    pixel[c] = (f64::from(light[c]) * each / REPLICATIONS as f64) as f32;
                }
            }
            let values = sums.replication.map(|sum| f64::from(sum) * each);
            for (mean, value) in means.iter_mut().zip(values) {
                *mean += value;
            }
            let error = standard_error(values);
            squares += error * error;
            rendered += 1;
            pixel_error.push(error as f32);
        }
    }
    let [real, stray, through] = layers;
    let done = || rows.iter().map(|row| row.done * REPLICATIONS as u32);
    let samples_per_pixel = [done().min().unwrap_or(0), done().max().unwrap_or(0)];
    let mean_luminance = means.iter().sum::<f64>() / (REPLICATIONS as f64 * rendered as f64);
    let error = ErrorEstimate {
        pixel: pixel_error,
        noise: (squares / rendered as f64).sqrt(),
        of_mean: standard_error(means.map(|sum| sum / rendered as f64)),
    };
    let layers = Layers { real, stray, through };
    Render { layers, error, paths, samples_per_pixel, mean_luminance, complete }
}

/// The standard error of the mean of independent values.
fn standard_error<const N: usize>(values: [f64; N]) -> f64 {
    let n = N as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (square / (n * (n - 1.0))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standard_error_is_the_textbooks() {
        // Mean 5, squares 9 + 1 + 1 + 1 + 0 + 0 + 4 + 16 = 32: sqrt(32 / 7 / 8).
        let values = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0];
        assert!((standard_error(values) - (32.0f64 / 56.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn light_goes_to_its_layer_and_layers_add_up() {
        let mut row = Row::new(2);
        let mut harvest = Harvest::default();
        harvest.add(0, Class::Real, [8.0, 0.0, 0.0]);
        harvest.add(1, Class::Stray, [0.0, 16.0, 0.0]);
        harvest.add(7, Class::Through, [0.0, 0.0, 32.0]);
        row.add(1, &harvest);
        row.done = 2;
        let render = develop(&[&row, &Row::new(2)], 1, false);
        // Two paths in each of eight replications; the second row is not rendered.
        assert_eq!(render.paths, 32);
        assert_eq!(render.samples_per_pixel, [0, 16]);
        // Luminance 0.5 * 0.2126 + 0.7152 + 2 * 0.0722 in one of two pixels; kept in single precision.
        assert!((render.mean_luminance - 0.482_95).abs() < 1e-6, "{}", render.mean_luminance);
        assert_eq!(render.layers.real.pixels[1], [0.5, 0.0, 0.0, 1.0]);
        assert_eq!(render.layers.stray.pixels[1], [0.0, 1.0, 0.0, 1.0]);
        assert_eq!(render.layers.through.pixels[1], [0.0, 0.0, 2.0, 1.0]);
        assert_eq!(render.view(Light::All).pixels[1], [0.5, 1.0, 2.0, 1.0]);
        assert_eq!(render.view(Light::Stray).pixels[1], [0.0, 1.0, 2.0, 1.0]);
        assert_eq!(render.view(Light::Real).pixels[0], [0.0, 0.0, 0.0, 1.0]);
        assert!(render.error.pixel[2].is_nan() && render.error.pixel[0] == 0.0);
        // Only one of the two rendered pixels has any error.
        let noise = f64::from(render.error.pixel[1]) / 2f64.sqrt();
        // Kept in single precision.
        assert!((render.error.noise - noise).abs() < 1e-6 * noise);
    }
}
