//! Pictures from and to arrays of samples, as other programs hold them in memory.

use super::{Picture, srgb};
use rayon::prelude::*;

/// A picture's samples: row by row from the top, the channels of a pixel side by side. One channel is grey, three are R, G, B, and a
/// fourth is alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Samples<'a> {
    /// 8-bit sRGB codes, not premultiplied, as PNG has them.
    Eight(&'a [u8]),
    /// 16-bit sRGB codes, not premultiplied.
    Sixteen(&'a [u16]),
    /// Linear light, premultiplied, as OpenEXR has it. What is negative or not finite is taken as 0.
    Light(&'a [f32]),
}

impl Picture {
    /// A picture of these samples; `None` where they are not `width` x `height` x `channels`, or the channels not 1, 3 or 4.
    pub fn of_samples(
        [width, height]: [usize; 2],
        channels: usize,
        samples: Samples,
    ) -> Option<Self> {
        let count = width.checked_mul(height)?.checked_mul(channels)?;
        let pixels = match samples {
            Samples::Eight(codes) => {
                pixels(count, channels, codes, srgb::decode_8, |a| f32::from(a) / 255.0, true)
            }
            Samples::Sixteen(codes) => {
                pixels(count, channels, codes, srgb::decode_16, |a| f32::from(a) / 65535.0, true)
            }
            Samples::Light(light) => {
                let sound =
                    |light: f32| if light.is_finite() && light >= 0.0 { light } else { 0.0 };
                pixels(count, channels, light, sound, |a| sound(a).min(1.0), false)
            }
        }?;
        Some(Self { width, height, pixels })
    }

    /// The picture's colours as 8-bit sRGB codes, each the nearest one: R, G, B side by side.
    pub fn codes_8(&self) -> Vec<u8> {
        self.colours(srgb::encode_8)
    }

    /// The picture's colours as 16-bit sRGB codes.
    pub fn codes_16(&self) -> Vec<u16> {
        self.colours(srgb::encode_16)
    }

    /// The picture's colours in linear light.
    pub fn light(&self) -> Vec<f32> {
        self.colours(|light| light)
    }

    fn colours<T: Copy + Send + Sync>(&self, of: impl Fn(f32) -> T + Sync) -> Vec<T> {
        let pixels = self.pixels.par_iter().with_min_len(1 << 14);
        let colours: Vec<[T; 3]> = pixels.map(|&[r, g, b, _]| [r, g, b].map(&of)).collect();
        colours.into_flattened()
    }
}

fn pixels<T: Copy + Sync>(
    count: usize,
    channels: usize,
    samples: &[T],
    light: impl Fn(T) -> f32 + Sync,
    alpha: impl Fn(T) -> f32 + Sync,
    premultiply: bool,
) -> Option<Vec<[f32; 4]>> {
    if samples.len() != count {
        return None;
    }
    let pixel = |samples: &[T]| -> [f32; 4] {
        match *samples {
            [grey] => {
                let grey = light(grey);
                [grey, grey, grey, 1.0]
            }
            [r, g, b] => [light(r), light(g), light(b), 1.0],
            [r, g, b, a] => {
                let a = alpha(a);
                let part = if premultiply { a } else { 1.0 };
                [light(r) * part, light(g) * part, light(b) * part, a]
            }
            _ => [0.0; 4],
        }
    };
    let known = matches!(channels, 1 | 3 | 4);
    known.then(|| samples.par_chunks_exact(channels).with_min_len(1 << 14).map(pixel).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Depth, decode_still, encode_still};
    use image::{DynamicImage, ImageBuffer, ImageFormat};
    use std::path::Path;

    fn codes(count: usize) -> Vec<u16> {
        (0..count as u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u16).collect()
    }

    /// A picture of samples is the picture of the file that holds them.
    #[test]
    fn samples_are_read_as_those_of_a_file() {
        let wide = codes(13 * 7 * 4);
        let narrow: Vec<u8> = wide.iter().map(|code| *code as u8).collect();
        let eight = |channels: usize| narrow[..13 * 7 * channels].to_vec();
        let sixteen = |channels: usize| wide[..13 * 7 * channels].to_vec();
        let grey = ImageBuffer::from_raw(13, 7, eight(1)).map(DynamicImage::ImageLuma8);
        let files = [
            (grey, Samples::Eight(&eight(1)), 1),
            (
                ImageBuffer::from_raw(13, 7, eight(3)).map(DynamicImage::ImageRgb8),
                Samples::Eight(&eight(3)),
                3,
            ),
            (
                ImageBuffer::from_raw(13, 7, eight(4)).map(DynamicImage::ImageRgba8),
                Samples::Eight(&eight(4)),
                4,
            ),
            (
                ImageBuffer::from_raw(13, 7, sixteen(3)).map(DynamicImage::ImageRgb16),
                Samples::Sixteen(&sixteen(3)),
                3,
            ),
            (
                ImageBuffer::from_raw(13, 7, sixteen(4)).map(DynamicImage::ImageRgba16),
                Samples::Sixteen(&sixteen(4)),
                4,
            ),
        ];
        for (image, samples, channels) in files {
            let mut bytes = std::io::Cursor::new(Vec::new());
            image.unwrap().write_to(&mut bytes, ImageFormat::Png).unwrap();
            let read = decode_still(Path::new("a.png"), bytes.get_ref()).unwrap().picture;
            assert_eq!(Picture::of_samples([13, 7], channels, samples), Some(read), "{channels}");
        }
    }

    #[test]
    fn codes_are_those_of_a_file() {
        let light: Vec<f32> = codes(11 * 5 * 3).iter().map(|c| f32::from(*c) / 60_000.0).collect();
        let picture = Picture::of_samples([11, 5], 3, Samples::Light(&light)).unwrap();
        assert_eq!(picture.light(), light);
        for depth in [Depth::Eight, Depth::Sixteen] {
            let file = encode_still(Path::new("a.png"), &picture, depth).unwrap();
            match image::load_from_memory(&file).unwrap() {
                DynamicImage::ImageRgb8(image) => assert_eq!(image.into_raw(), picture.codes_8()),
                DynamicImage::ImageRgb16(image) => assert_eq!(image.into_raw(), picture.codes_16()),
                other => panic!("{other:?}"),
            }
        }
        let odd = [f32::NAN, -1.0, f32::INFINITY];
        let picture = Picture::of_samples([1, 1], 3, Samples::Light(&odd)).unwrap();
        assert_eq!(picture.pixels, [[0.0, 0.0, 0.0, 1.0]]);
    }

    #[test]
    fn samples_that_do_not_fit_make_no_picture() {
        for (size, channels, count) in [([2, 2], 3, 11), ([2, 2], 2, 8), ([usize::MAX, 2], 3, 6)] {
            assert_eq!(Picture::of_samples(size, channels, Samples::Eight(&vec![0; count])), None);
        }
    }
}
