//! From a render's linear light to files: PNG at a stated exposure, and EXR with all layers.

use super::{Light, Render};
use crate::map::format::{FileError, write_channels};
use crate::picture::{Depth, Picture, write_still};
use std::path::Path;

/// How bright a picture is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Exposure {
    /// The 99th percentile of the pixels' largest channels becomes white.
    #[default]
    Auto,
    /// Light is multiplied by this factor: 1 shows the display's white as white.
    Fixed(f64),
}

impl Exposure {
    /// The factor on linear light for this picture.
    ///
    /// Where less than one pixel in a hundred is lit, the brightest becomes white; a black picture
    /// stays as it is.
    pub fn factor(self, picture: &Picture) -> f64 {
        match self {
            Self::Fixed(factor) => factor,
            Self::Auto => {
                let largest = |&[r, g, b, _]: &[f32; 4]| r.max(g).max(b);
                let mut values: Vec<f32> = picture.pixels.iter().map(largest).collect();
                values.retain(|v| v.is_finite());
                if values.is_empty() {
                    return 1.0;
                }
                let place = (values.len() - 1) * 99 / 100;
                let percentile = *values.select_nth_unstable_by(place, f32::total_cmp).1;
                let brightest = values.into_iter().fold(0.0, f32::max);
                let white = if percentile > 0.0 { percentile } else { brightest };
                if white > 0.0 { 1.0 / f64::from(white) } else { 1.0 }
            }
        }
    }
}

/// A picture with its linear light multiplied by a factor; alpha as it was.
pub fn exposed(picture: &Picture, factor: f64) -> Picture {
    let mut exposed = picture.clone();
    for pixel in &mut exposed.pixels {
        for c in 0..3 {
            pixel[c] = (f64::from(pixel[c]) * factor) as f32;
        }
    }
    exposed
}

/// Writes a view as sRGB PNG, and returns the factor that its light was multiplied by.
///
/// # Errors
/// As [`write_still`].
pub fn write_png(
    path: &Path,
    view: &Picture,
    exposure: Exposure,
    depth: Depth,
) -> Result<f64, FileError> {
    let factor = exposure.factor(view);
    write_still(path, &exposed(view, factor), depth)?;
    Ok(factor)
}

/// Writes a render as one EXR file in linear light, 32-bit float: `R`, `G`, `B` of the light that is asked
/// for, which any viewer shows; `real.R` and so on, `stray.*` and `through.*` for the layers that add up to all light;
/// and `error.Y`, the standard error of each pixel's luminance.
///
/// # Errors
/// As [`write_channels`].
pub fn write_layers(path: &Path, render: &Render, light: Light) -> Result<(), FileError> {
    let all = render.view(light);
    let layers = &render.layers;
    let channel = |picture: &Picture, c: usize| picture.pixels.iter().map(|p| p[c]).collect();
    let channels = vec![
        ("R", channel(&all, 0)),
        ("G", channel(&all, 1)),
        ("B", channel(&all, 2)),
        ("error.Y", render.error.pixel.clone()),
        ("real.R", channel(&layers.real, 0)),
        ("real.G", channel(&layers.real, 1)),
        ("real.B", channel(&layers.real, 2)),
        ("stray.R", channel(&layers.stray, 0)),
        ("stray.G", channel(&layers.stray, 1)),
        ("stray.B", channel(&layers.stray, 2)),
        ("through.R", channel(&layers.through, 0)),
        ("through.G", channel(&layers.through, 1)),
        ("through.B", channel(&layers.through, 2)),
    ];
    write_channels(path, all.width, all.height, channels, false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::format::decode_channels;
    use crate::picture::read_still;
    use crate::simulate::{ErrorEstimate, Layers};

    fn grey(values: &[f32]) -> Picture {
        let pixels = values.iter().map(|&v| [v, 0.5 * v, 0.0, 1.0]).collect();
        Picture { width: values.len(), height: 1, pixels }
    }

    #[test]
    fn automatic_exposure_makes_the_99th_percentile_white() {
        let values: Vec<f32> = (0..=100).map(|i| i as f32 * 0.002).collect();
        // Of 101 values the 99th percentile is the hundredth: 0.198.
        let factor = Exposure::Auto.factor(&grey(&values));
        // Values are single precision.
        assert!((factor * 0.198 - 1.0).abs() < 1e-6, "{factor}");
        let mut spark = vec![0.0; 1000];
        spark[17] = 0.25;
        assert_eq!(Exposure::Auto.factor(&grey(&spark)), 4.0);
        assert_eq!(Exposure::Auto.factor(&grey(&[0.0; 9])), 1.0);
        assert_eq!(Exposure::Fixed(3.0).factor(&grey(&values)), 3.0);
    }

    #[test]
    fn files_hold_the_light_that_was_rendered() {
        let folder = tempfile::tempdir().unwrap();
        let render = Render {
            layers: Layers {
                real: grey(&[0.5, 0.1]),
                stray: grey(&[0.25, 0.0]),
                through: grey(&[0.125, 0.4]),
            },
            error: ErrorEstimate { pixel: vec![0.01, 0.02], noise: 0.015, of_mean: 0.01 },
            paths: 2,
            samples_per_pixel: [1, 1],
            mean_luminance: 0.5,
            complete: true,
        };
        let path = folder.path().join("view.exr");
        write_layers(&path, &render, Light::All).unwrap();
        let file = decode_channels(&path, &std::fs::read(&path).unwrap(), 0.0).unwrap();
        assert_eq!(file.get("R").unwrap()[0], 0.875);
        assert_eq!(file.get("G").unwrap()[0], 0.4375);
        assert_eq!(file.get("real.R").unwrap(), [0.5, 0.1]);
        assert_eq!(file.get("stray.R").unwrap(), [0.25, 0.0]);
        assert_eq!(file.get("through.G").unwrap(), [0.0625, 0.2]);
        assert_eq!(file.get("error.Y").unwrap(), [0.01, 0.02]);
        assert_eq!(file.channels.len(), 13);
        write_layers(&path, &render, Light::Stray).unwrap();
        let file = decode_channels(&path, &std::fs::read(&path).unwrap(), 0.0).unwrap();
        assert_eq!(file.get("R").unwrap()[0], 0.375);
        assert_eq!(file.get("real.R").unwrap(), [0.5, 0.1]);

        let path = folder.path().join("view.png");
        let factor =
            write_png(&path, &render.layers.real, Exposure::Fixed(2.0), Depth::Sixteen).unwrap();
        assert_eq!(factor, 2.0);
        let back = read_still(&path).unwrap().picture;
        // 16 bits of sRGB: steps of at most 3.4e-5 of linear light.
        for (got, expected) in back.pixels.iter().zip([[1.0, 0.5, 0.0], [0.2, 0.1, 0.0]]) {
            for c in 0..3 {
                assert!((got[c] - expected[c]).abs() < 3.4e-5);
            }
        }
    }
}
