//! A grey picture, as measurements take it.

use crate::picture::{Picture, srgb};
use rayon::prelude::*;

/// One channel of a picture: row-major, row 0 at the top.
///
/// Values are display-encoded by the sRGB transfer function, IEC 61966-2-1) but for [`Plane::luminance`], black 0 and white 1,
/// not rounded to 8 bits: what an 8-bit PNG holds, divided by 255, before its rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` values, row 0 at the top.
    pub values: Vec<f32>,
}

/// Rec. 709 luma weights (ITU-R BT.709-6, item 3.2), applied to encoded values.
const LUMA: [f32; 3] = [0.2126, 0.7152, 0.0722];

impl Plane {
    /// A plane of one value.
    pub fn filled(width: usize, height: usize, value: f32) -> Self {
        Self { width, height, values: vec![value; width * height] }
    }

    /// A plane whose value at each pixel (column, row) is computed.
    pub fn from_fn(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> Self {
        let values = (0..height)
            .flat_map(|row| (0..width).map(move |column| (column, row)))
            .map(|(c, r)| value(c, r));
        Self { width, height, values: values.collect() }
    }

    /// Rec. 709 luma of the sRGB-encoded channels; the picture lies over black, and light
    /// outside \[0, 1\] is clamped as a display would.
    pub fn luma(picture: &Picture) -> Self {
        Self::of(picture, |pixel| {
            LUMA.iter().zip(pixel).map(|(weight, &light)| weight * srgb_encoded(light)).sum()
        })
    }

    /// Relative luminance in linear light (Rec. 709 weights), not clamped: for measuring where
    /// lines are, as the encoding would widen a pixel's partly covered edge.
    pub fn luminance(picture: &Picture) -> Self {
        Self::of(picture, |pixel| {
            let light: f32 = LUMA.iter().zip(pixel).map(|(weight, light)| weight * light).sum();
            if light.is_finite() { light } else { 0.0 }
        })
    }

    /// The sRGB-encoded red, green and blue channels, over black, clamped to \[0, 1\].
    pub fn channels(picture: &Picture) -> [Self; 3] {
        [0, 1, 2].map(|channel| Self::of(picture, |pixel| srgb_encoded(pixel[channel])))
    }

    fn of(picture: &Picture, value: impl Fn(&[f32; 4]) -> f32 + Sync + Send) -> Self {
        // An encoded value takes 50 ns: a task of less than a millisecond is not worth its start.
        let values = picture.pixels.par_iter().with_min_len(1 << 13).map(value);
        Self { width: picture.width, height: picture.height, values: values.collect() }
    }

    /// White less every value: dark lines become bright ones.
    pub fn inverted(&self) -> Self {
        let values = self.values.iter().map(|value| 1.0 - value).collect();
        Self { width: self.width, height: self.height, values }
    }

    /// The value at a pixel; panics outside the plane.
    pub fn at(&self, column: usize, row: usize) -> f32 {
        self.values[row * self.width + column]
    }
}

/// The encoded value of linear light clamped to \[0, 1\]; NaN is black.
fn srgb_encoded(light: f32) -> f32 {
    let light = if light.is_nan() { 0.0 } else { f64::from(light.clamp(0.0, 1.0)) };
    srgb::encode(light) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mid_grey_is_encoded_as_the_standard_says() {
        // 0.214041 of white is sRGB 0.5 (IEC 61966-2-1: ((0.5 + 0.055) / 1.055)^2.4).
        let picture = Picture::filled(1, 1, [0.214_041, 0.214_041, 0.214_041, 1.0]);
        // Single precision and six printed digits of the light value.
        assert!((Plane::luma(&picture).values[0] - 0.5).abs() < 2e-6);
    }

    #[test]
    fn luma_weighs_green_most_and_white_is_one() {
        let luma = |r, g, b| Plane::luma(&Picture::filled(1, 1, [r, g, b, 1.0])).values[0];
        assert!((luma(1.0, 1.0, 1.0) - 1.0).abs() < 1e-6);
        assert!((luma(1.0, 1.0, 0.0) - 0.9278).abs() < 1e-6, "yellow");
        assert!((luma(0.0, 0.0, 1.0) - 0.0722).abs() < 1e-6, "blue");
        assert_eq!(luma(-1.0, f32::NAN, 0.0), 0.0);
    }

    #[test]
    fn luminance_is_linear() {
        let picture = Picture::filled(1, 1, [2.0, 0.5, 0.0, 1.0]);
        assert!((Plane::luminance(&picture).values[0] - (0.4252 + 0.3576)).abs() < 1e-6);
    }

    #[test]
    fn channels_keep_their_order_and_place() {
        let mut picture = Picture::filled(3, 2, [0.0; 4]);
        picture.pixels[3 + 2] = [1.0, 0.214_041, 7.0, 1.0];
        let [red, green, blue] = Plane::channels(&picture);
        assert_eq!((red.at(2, 1), blue.at(2, 1)), (1.0, 1.0));
        assert!((green.at(2, 1) - 0.5).abs() < 2e-6);
        assert_eq!(red.values.iter().sum::<f32>(), 1.0);
    }
}
