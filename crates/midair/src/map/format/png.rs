//! PNG files of raw samples.

use super::{FileError, write_atomically};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::path::Path;

/// Writes samples in the machine's byte order as a PNG file.
pub(crate) fn write_png(
    path: &Path,
    width: usize,
    height: usize,
    bytes: &[u8],
    colour: ExtendedColorType,
) -> Result<(), FileError> {
    write_atomically(path, |writer| {
        let encoder =
            PngEncoder::new_with_quality(writer, CompressionType::Fast, FilterType::Adaptive);
        let result = if width == 0 || height == 0 {
            Err("the picture has no pixels".to_owned())
        } else {
            match encoder.write_image(bytes, width as u32, height as u32, colour) {
                Ok(()) => Ok(()),
                Err(image::ImageError::IoError(error)) => {
                    return Err(FileError::io(path, "write", error));
                }
                Err(error) => Err(error.to_string()),
            }
        };
        result.map_err(|problem| FileError::unsupported(path, problem, "give it a smaller size"))
    })
}
