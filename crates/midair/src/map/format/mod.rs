//! The files that maps are kept in: one [`Format`] for each tool, [`write_map`] and [`read_map`].
//!
//! A map of either direction is a [`Map`]: G has a sample on each display pixel and leads into the image,
//! F has one on each image pixel and leads onto the display. What the samples lead into is called the
//! *source* here, as a remapping tool does.

mod atomic;
mod error;
mod exr_channels;
mod ffmpeg;
mod kind;
#[cfg(feature = "mpcdi")]
mod mpcdi;
#[cfg(not(feature = "mpcdi"))]
#[path = "no_mpcdi.rs"]
mod mpcdi;
mod npy;
mod opencv;
mod pair;
mod png;
mod stmap;

pub use atomic::{write_atomically, write_bytes_atomically};
pub use error::FileError;
pub use exr_channels::{Channels, MAX_PIXELS, SampleKind, decode_channels, write_channels};
pub use kind::{Format, UnknownFormat};
pub(crate) use png::{decode_samples, write_png};

use super::{Gain, Map};
use std::path::{Path, PathBuf};

/// A map from a file.
#[derive(Clone, Debug)]
pub struct LoadedMap {
    /// The map; its error bound is infinite, as files do not tell it.
    pub map: Map,
    /// What is left of each pixel's light, where the file says so.
    pub gain: Option<Gain>,
    /// What the user should know, one sentence each.
    pub notes: Vec<String>,
}

impl LoadedMap {
    fn new(map: Map) -> Self {
        Self { map, gain: None, notes: Vec::new() }
    }
}

/// What was written.
#[derive(Clone, Debug, Default)]
pub struct Written {
    /// The files, the one that was asked for first.
    pub files: Vec<PathBuf>,
    /// What the user should know of the map in this format, one sentence each; the file is not named.
    pub notes: Vec<String>,
}

/// Writes a map. `source` is the width and height in pixels of what the map leads into; the formats of
/// absolute pixels need it. Formats of two files derive their names from `path`, see [`Format`].
/// Each file is whole or absent. Coverage and continuation (see [`Map`]) are kept apart in every format; [`Format::Ffmpeg`] and
/// [`Format::OpenCv`], which have no place for coverage, have a mask beside them, `NAME_coverage.png` (255 where there is an answer).
///
/// # Errors
/// [`FileError`] where a file cannot be written, or the map or source does not fit the format.
pub fn write_map(
    map: &Map,
    source: [usize; 2],
    format: Format,
    path: &Path,
) -> Result<Written, FileError> {
    write_map_and_gain(map, None, source, format, path)
}

/// As [`write_map`], with the map's gain where the format has a place for it: [`Format::Exr`] and [`Format::ExrHalf`], as channels
/// gain.R, gain.G, gain.B. The gain is of the map's size.
///
/// # Errors
/// As [`write_map`].
pub fn write_map_and_gain(
    map: &Map,
    gain: Option<&Gain>,
    source: [usize; 2],
    format: Format,
    path: &Path,
) -> Result<Written, FileError> {
    if gain.is_some_and(|gain| gain.rgb.len() != map.uv.len()) {
        let problem = "its gain is of another size than the map";
        return Err(FileError::unsupported(path, problem, "work the gain out anew"));
    }
    let pixels = map.width.checked_mul(map.height);
    if pixels.is_none_or(|n| n == 0 || n != map.uv.len() || n != map.status.len()) {
        let problem = format!("a map of {} x {} pixels cannot be written", map.width, map.height);
        return Err(FileError::unsupported(path, problem, "give it at least one pixel"));
    }
    if source.contains(&0) {
        let problem = format!("a source of {} x {} pixels has no place", source[0], source[1]);
        return Err(FileError::unsupported(path, problem, "give the source's size in pixels"));
    }
    let mut written = Written { files: vec![path.to_owned()], notes: Vec::new() };
    match format {
        Format::Exr => stmap::write(map, gain, path, false)?,
        Format::ExrHalf => {
            stmap::write(map, gain, path, true)?;
            let step = source[0].max(source[1]) as f64 / 2048.0;
            written.notes.push(format!(
                "half floats place image points in steps of up to {step:.2} source pixels; \
                 prefer 32-bit floats (exr)"
            ));
        }
        Format::Blender => stmap::write_blender(map, path)?,
        Format::TouchDesigner => stmap::write_touchdesigner(map, path)?,
        Format::Png16 | Format::TouchDesignerPng => {
            png::write_map_png(map, path)?;
            let step = source[0].max(source[1]) as f64 / 65535.0;
            if step > 1.0 / 16.0 {
                written.notes.push(format!(
                    "16 bits place image points in steps of {step:.2} source pixels"
                ));
            }
        }
        Format::Npy => written.files = npy::write(map, path)?,
        Format::Ffmpeg => {
            written.files = ffmpeg::write(map, source, path)?;
            written.notes.push("ffmpeg's remap takes the nearest source pixel only".to_owned());
        }
        Format::OpenCv => written.files = opencv::write_npy(map, source, path)?,
        Format::OpenCvYaml => opencv::write_yaml(map, source, path)?,
        Format::Mpcdi => mpcdi::write(map, source, path)?,
    }
    // Always, so that none of an earlier map stays there.
    if matches!(format, Format::Ffmpeg | Format::OpenCv) {
        let file = pair::coverage(path);
        png::write_coverage(map, &file)?;
        written.files.push(file);
    }
    Ok(written)
}

/// Reads a map. Without a `format` the file's name decides: `.exr`, `.npy`, `.png`, `.pgm`, `.yml`
/// or `.yaml`, `.mpcdi`. `source`, the width and height in pixels of what the map leads into, is
/// needed by the formats of absolute pixels ([`Format::Ffmpeg`], [`Format::OpenCv`]).
///
/// # Errors
/// [`FileError`] where a file is missing, cut short or not what it should be, or `source` is needed.
pub fn read_map(
    path: &Path,
    format: Option<Format>,
    source: Option<[usize; 2]>,
) -> Result<LoadedMap, FileError> {
    let Some(format) = format.or_else(|| Format::of_path(path)) else {
        let problem = "its name does not tell which kind of map it is";
        let remedy = "end it in .exr, .npy, .png, .pgm, .yml or .mpcdi, or name the format";
        return Err(FileError::unsupported(path, problem, remedy));
    };
    let absolute = || match source {
        Some(source) if !source.contains(&0) => Ok(source),
        _ => Err(FileError::SourceUnknown { path: path.to_owned() }),
    };
    let mut loaded = match format {
        Format::Exr | Format::ExrHalf => stmap::read(path, &read_bytes(path)?, stmap::Cover::A)?,
        Format::Blender => stmap::read(path, &read_bytes(path)?, stmap::Cover::B)?,
        Format::TouchDesigner => stmap::read(path, &read_bytes(path)?, stmap::Cover::A)?,
        Format::Png16 | Format::TouchDesignerPng => png::read_map_png(path, &read_bytes(path)?)?,
        Format::Npy => npy::read(path)?,
        Format::Ffmpeg => ffmpeg::read(path, absolute()?)?,
        Format::OpenCv => opencv::read_npy(path, absolute()?)?,
        Format::OpenCvYaml => opencv::read_yaml(path, &read_bytes(path)?, source)?,
        Format::Mpcdi => mpcdi::read(path, &read_bytes(path)?)?,
    };
    if matches!(format, Format::Ffmpeg | Format::OpenCv) {
        let file = pair::coverage(path);
        if file.exists() {
            png::read_coverage(&mut loaded.map, &file)?;
        }
    }
    Ok(loaded)
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    std::fs::read(path).map_err(|error| FileError::io(path, "read", error))
}

/// uv where there are any: an answer, or what [`bleed`](super::bleed) put in its place.
fn answer(uv: [f64; 2]) -> Option<[f64; 2]> {
    uv.iter().all(|x| x.is_finite()).then_some(uv)
}

#[cfg(test)]
mod tests;
