//! Photographs as people take them: JPEG, PNG or TIFF of 8 or 16 bits, turned as the camera says.

use image::imageops::{flip_horizontal, flip_vertical, rotate90, rotate180, rotate270};
use image::metadata::Orientation;
use image::{DynamicImage, ImageBuffer, ImageDecoder as _, ImageReader, Luma};
use midair::Error;
use midair::map::format::FileError;
use std::path::{Path, PathBuf};

/// A photograph's brightness.
#[derive(Clone, Debug)]
pub struct Photograph {
    /// Width, px.
    pub width: usize,
    /// Height, px.
    pub height: usize,
    /// Codes from 0 to 65535, row 0 at the top.
    pub codes: Vec<u16>,
}

impl Photograph {
    /// Reads a photograph and turns it as its Exif orientation asks.
    ///
    /// # Errors
    /// A file that cannot be read, or is no such picture.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let unread = |problem: String| {
            FileError::malformed(
                path,
                "picture",
                problem,
                "give JPEG, PNG or TIFF; convert raw files first",
            )
        };
        let reader = ImageReader::open(path)
            .and_then(ImageReader::with_guessed_format)
            .map_err(|error| FileError::io(path, "read", error))?;
        let mut decoder = reader.into_decoder().map_err(|error| unread(error.to_string()))?;
        let orientation = decoder.orientation().map_err(|error| unread(error.to_string()))?;
        let image =
            DynamicImage::from_decoder(decoder).map_err(|error| unread(error.to_string()))?;
        let grey = turned(grey(image), orientation);
        let (width, height) = (grey.width() as usize, grey.height() as usize);
        Ok(Self { width, height, codes: grey.into_raw() })
    }
}

type Grey = ImageBuffer<Luma<u16>, Vec<u16>>;

/// Brightness, as `image` weighs colours. Photographs are many, so what most of them are is converted and turned here, where it is optimised.
fn grey(image: DynamicImage) -> Grey {
    let (width, height) = (image.width(), image.height());
    let codes = match &image {
        DynamicImage::ImageLuma8(image) => {
            image.iter().map(|&code| 257 * u16::from(code)).collect()
        }
        DynamicImage::ImageRgb8(image) => image.pixels().map(|pixel| luma(pixel.0)).collect(),
        _ => return image.into_luma16(),
    };
    ImageBuffer::from_raw(width, height, codes).unwrap_or_default()
}

/// ITU-R BT.709's weights.
fn luma(rgb: [u8; 3]) -> u16 {
    let [r, g, b] = rgb.map(u32::from);
    // At most 65535: the weights' sum is 10000.
    (257 * (2126 * r + 7152 * g + 722 * b) / 10000) as u16
}

fn turned(grey: Grey, orientation: Orientation) -> Grey {
    match orientation {
        Orientation::NoTransforms => grey,
        Orientation::Rotate90 => rotate90(&grey),
        Orientation::Rotate180 => rotate180(&grey),
        Orientation::Rotate270 => rotate270(&grey),
        Orientation::FlipHorizontal => flip_horizontal(&grey),
        Orientation::FlipVertical => flip_vertical(&grey),
        Orientation::Rotate90FlipH => flip_horizontal(&rotate90(&grey)),
        Orientation::Rotate270FlipH => flip_horizontal(&rotate270(&grey)),
    }
}

/// The photographs in a folder, in the order of their names.
///
/// # Errors
/// A folder that cannot be read, or has none.
pub fn in_folder(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let entries =
        std::fs::read_dir(folder).map_err(|error| FileError::io(folder, "read", error))?;
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| FileError::io(folder, "read", error))?.path();
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        let known = path.extension().is_some_and(|extension| {
            ["jpg", "jpeg", "png", "tif", "tiff"].iter().any(|e| extension.eq_ignore_ascii_case(e))
        });
        if known && !hidden && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    if files.is_empty() {
        let problem = "there are no photographs in this folder (JPEG, PNG or TIFF)";
        let remedy = "put the photographs of one view and state there; convert raw files first";
        return Err(FileError::unsupported(folder, problem, remedy).into());
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::RgbImage;

    #[test]
    fn brightness_and_turns_are_those_of_the_decoder() {
        let colours = |x: u32, y: u32| [37 * x + 5 * y, 11 * x * y, 255 - 20 * x].map(|c| c as u8);
        let picture = RgbImage::from_fn(5, 4, |x, y| image::Rgb(colours(x, y)));
        let pictures = [picture.clone().into(), DynamicImage::from(picture).into_luma8().into()];
        for picture in pictures {
            let picture: DynamicImage = picture;
            for exif in 1..=8 {
                let orientation = Orientation::from_exif(exif).expect("there are eight");
                let ours = turned(grey(picture.clone()), orientation);
                let mut whole = picture.clone();
                whole.apply_orientation(orientation);
                let theirs = whole.into_luma16();
                assert_eq!(ours.dimensions(), theirs.dimensions());
                // It may round to 8 bits on the way.
                let near = |(a, b): (&u16, &u16)| a.abs_diff(*b) <= 257;
                assert!(ours.iter().zip(theirs.iter()).all(near), "{exif}: {ours:?} {theirs:?}");
            }
        }
    }
}
