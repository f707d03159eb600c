//! Photographs as people take them: JPEG, PNG or TIFF of 8 or 16 bits, turned as the camera says.

use image::{DynamicImage, ImageDecoder as _, ImageReader};
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
        let mut image =
            DynamicImage::from_decoder(decoder).map_err(|error| unread(error.to_string()))?;
        image.apply_orientation(orientation);
        let grey = image.into_luma16();
        let (width, height) = (grey.width() as usize, grey.height() as usize);
        Ok(Self { width, height, codes: grey.into_raw() })
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
