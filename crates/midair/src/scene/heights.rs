//! Height samples from a picture.

use image::{DynamicImage, ImageReader, Limits};
use std::path::Path;

/// More pixels on a side than this are not a height-field that is traced.
const MOST_SIDE: u32 = 8192;

/// The samples of a grey picture, the top row first: 0 to 1 for 8 and 16 bit, as they are for
/// EXR. A picture in colour gives its first channel where the three are equal, else an error.
///
/// The error is a message that names the file.
pub(super) fn read(path: &Path) -> Result<Vec<Vec<f64>>, String> {
    let name = path.display();
    let mut reader = ImageReader::open(path)
        .and_then(ImageReader::with_guessed_format)
        .map_err(|e| format!("{name}: cannot be read: {e}"))?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_SIDE);
    limits.max_image_height = Some(MOST_SIDE);
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| format!("{name}: is no picture: {e}"))?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    if width < 2 || height < 2 {
        return Err(format!("{name}: has only {width} x {height} pixels"));
    }
    let samples = grey(picture)
        .ok_or_else(|| format!("{name}: is not grey: its colours stand for no height"))?;
    if let Some(at) = samples.iter().position(|s| !s.is_finite()) {
        return Err(format!(
            "{name}: pixel [{}, {}] is not a finite number",
            at % width,
            at / width
        ));
    }
    Ok(samples.chunks(width).map(<[f64]>::to_vec).collect())
}

/// One number per pixel; `None` for a picture with colours.
fn grey(picture: DynamicImage) -> Option<Vec<f64>> {
    let equal = |[r, g, b]: [f64; 3]| ((r == g && g == b) || r.is_nan()).then_some(r);
    match picture {
        DynamicImage::ImageLuma8(p) => Some(p.pixels().map(|p| f64::from(p[0]) / 255.0).collect()),
        DynamicImage::ImageLuma16(p) => {
            Some(p.pixels().map(|p| f64::from(p[0]) / 65535.0).collect())
        }
        DynamicImage::ImageLumaA8(_)
        | DynamicImage::ImageRgb8(_)
        | DynamicImage::ImageRgba8(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => picture
            .to_rgb16()
            .pixels()
            .map(|p| equal(p.0.map(|c| f64::from(c) / 65535.0)))
            .collect(),
        _ => picture.to_rgb32f().pixels().map(|p| equal(p.0.map(f64::from))).collect(),
    }
}
