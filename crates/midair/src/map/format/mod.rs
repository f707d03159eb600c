//! The files that maps are kept in: one [`Format`] for each tool, [`write_map`] and [`read_map`].
//!
//! A map of either direction is a [`Map`]: G has a sample on each display pixel and leads into the image,
//! F has one on each image pixel and leads onto the display. What the samples lead into is called the
//! *source* here, as a remapping tool does.

mod error;
mod exr_channels;
mod exr_layers;
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
pub mod storage;

pub use error::FileError;
pub(crate) use error::io_remedy;
pub use exr_channels::{Channels, MAX_PIXELS, SampleKind, decode_channels, write_channels};
pub(crate) use exr_channels::{ExrFile, encode_channels};
pub(crate) use exr_layers::{PictureChannels, read_picture};
pub use kind::{Format, UnknownFormat};
pub(crate) use png::{CUT, ImageBytes, encode_png};

use super::{Gain, Map, Status};
use crate::files::write_bytes_atomically;
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

/// Takes the bytes of a file of this name.
pub type Put<'a> = dyn FnMut(&Path, &[u8]) -> Result<(), FileError> + 'a;

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
    put_map(map, gain, source, format, path, &mut write_bytes_atomically)
}

/// As [`write_map_and_gain`], with each file's name and bytes handed to `put`: for what has no disk.
///
/// ```
/// use midair::map::{Map, format};
///
/// # fn main() -> Result<(), midair::Error> {
/// let mut files = Vec::new();
/// let mut put = |name: &std::path::Path, bytes: &[u8]| {
///     files.push((name.to_owned(), bytes.to_owned()));
///     Ok(())
/// };
/// let map = Map::identity(4, 3);
/// format::put_map(&map, None, [4, 3], format::Format::Npy, "map.npy".as_ref(), &mut put)?;
/// assert_eq!(files[1].0.to_str(), Some("status.npy"));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`FileError`] where the map or source does not fit the format, and whatever `put` refuses.
pub fn put_map(
    map: &Map,
    gain: Option<&Gain>,
    source: [usize; 2],
    format: Format,
    path: &Path,
    put: &mut Put<'_>,
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
        Format::Exr => stmap::write(map, gain, path, false, put)?,
        Format::ExrHalf => {
            stmap::write(map, gain, path, true, put)?;
            let step = source[0].max(source[1]) as f64 / 2048.0;
            written.notes.push(format!(
                "half floats place image points in steps of up to {step:.2} source pixels; \
                 prefer 32-bit floats (exr)"
            ));
        }
        Format::Blender => stmap::write_blender(map, path, put)?,
        Format::TouchDesigner => stmap::write_touchdesigner(map, path, put)?,
        Format::Png16 | Format::TouchDesignerPng => {
            png::write_map_png(map, path, put)?;
            let step = source[0].max(source[1]) as f64 / 65535.0;
            if step > 1.0 / 16.0 {
                written.notes.push(format!(
                    "16 bits place image points in steps of {step:.2} source pixels"
                ));
            }
        }
        Format::Npy => written.files = npy::write(map, path, put)?,
        Format::Ffmpeg => {
            written.files = ffmpeg::write(map, source, path, put)?;
            written.notes.push("ffmpeg's remap takes the nearest source pixel only".to_owned());
        }
        Format::OpenCv => written.files = opencv::write_npy(map, source, path, put)?,
        Format::OpenCvYaml => opencv::write_yaml(map, source, path, put)?,
        Format::Mpcdi => mpcdi::write(map, source, path, put)?,
    }
    // Always, so that none of an earlier map stays there.
    if matches!(format, Format::Ffmpeg | Format::OpenCv) {
        let file = pair::coverage(path);
        png::write_coverage(map, &file, put)?;
        written.files.push(file);
    }
    Ok(written)
}

/// The map as cv2.remap takes it, for pictures of `source` pixels (width, height): columns and rows in the picture, 0 at the centre of the
/// top left pixel; NaN where there is no answer. In the order of the map's `uv`.
pub fn remap_coordinates(map: &Map, source: [usize; 2]) -> [Vec<f32>; 2] {
    [0, 1].map(|axis| opencv::coordinates(map, axis, source[axis]).collect())
}

/// The map as an STMap's pixels: R = u, G = v, B = 0, A = 1 where the status is ok, else 0; u and v are NaN where there is no answer.
pub fn stmap_pixels(map: &Map) -> Vec<[f32; 4]> {
    let pixel = |(&uv, &status): (&[f64; 2], &Status)| {
        let [u, v] = answer(uv).map_or([f32::NAN; 2], |uv| uv.map(|x| x as f32));
        [u, v, 0.0, f32::from(status == Status::Ok)]
    };
    map.uv.iter().zip(&map.status).map(pixel).collect()
}

/// How to read a map file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reading<'a> {
    /// Its format; without one the file's name decides: `.exr`, `.npy`, `.png`, `.pgm`, `.yml`, `.yaml`, `.xml` or `.json` (also with `.gz`), `.mpcdi`.
    pub format: Option<Format>,
    /// Width and height in pixels of what the map leads into, needed by the formats of absolute pixels ([`Format::Ffmpeg`], [`Format::OpenCv`],
    /// [`Format::OpenCvYaml`]).
    pub source: Option<[usize; 2]>,
    /// Which region of an MPCDI file; needed where it has several.
    pub region: Option<&'a str>,
}

/// Brings a file's bytes: a map's own, and those of the second file where a format has two.
pub type Fetch<'a> = dyn Fn(&Path) -> std::io::Result<Vec<u8>> + 'a;

fn fetched(path: &Path, fetch: &Fetch<'_>) -> Result<Vec<u8>, FileError> {
    fetch(path).map_err(|error| FileError::io(path, "read", error))
}

/// Reads a map from a file: see [`decode_map`].
///
/// # Errors
/// As [`decode_map`].
pub fn read_map(
    path: &Path,
    format: Option<Format>,
    source: Option<[usize; 2]>,
) -> Result<LoadedMap, FileError> {
    decode_map(path, &|file| std::fs::read(file), &Reading { format, source, region: None })
}

/// Reads a map whose files `fetch` brings. Values outside of 0 to 1, as OpenCV's -1, lead into no picture: their pixels are outside.
///
/// # Errors
/// [`FileError`] where a file is missing, cut short or not what it should be, or more has to be said of how to read it.
pub fn decode_map(
    path: &Path,
    fetch: &Fetch<'_>,
    reading: &Reading<'_>,
) -> Result<LoadedMap, FileError> {
    let Some(format) = reading.format.or_else(|| Format::of_path(path)) else {
        let problem = "its name does not tell which kind of map it is";
        let remedy =
            "end it in .exr, .npy, .png, .pgm, .yml, .xml, .json or .mpcdi, or name the format";
        return Err(FileError::unsupported(path, problem, remedy));
    };
    let absolute = || match reading.source {
        Some(source) if !source.contains(&0) => Ok(source),
        _ => Err(FileError::SourceUnknown { path: path.to_owned() }),
    };
    let bytes = || fetched(path, fetch);
    let mut loaded = match format {
        Format::Exr | Format::ExrHalf => stmap::read(path, &bytes()?, stmap::Cover::A)?,
        Format::Blender => stmap::read(path, &bytes()?, stmap::Cover::B)?,
        Format::TouchDesigner => stmap::read(path, &bytes()?, stmap::Cover::A)?,
        Format::Png16 | Format::TouchDesignerPng => png::read_map_png(path, &bytes()?)?,
        Format::Npy => npy::read(path, fetch)?,
        Format::Ffmpeg => ffmpeg::read(path, fetch, absolute()?)?,
        Format::OpenCv => opencv::read_npy(path, fetch, absolute()?)?,
        Format::OpenCvYaml => opencv::read_storage(path, &bytes()?, reading.source)?,
        Format::Mpcdi => mpcdi::read(path, &bytes()?, reading.region)?,
    };
    if matches!(format, Format::Ffmpeg | Format::OpenCv) {
        let file = pair::coverage(path);
        if let Ok(bytes) = fetch(&file) {
            png::read_coverage(&mut loaded.map, &file, &bytes)?;
        }
    }
    keep_within_source(path, &mut loaded.map)?;
    Ok(loaded)
}

/// What rounding may add to a place on the source's edge.
const EDGE: f64 = 1e-6;

/// Takes pixels whose answer lies off the source as outside. Where they are no answers but a ring around them, they stay.
fn keep_within_source(path: &Path, map: &mut Map) -> Result<(), FileError> {
    let within = |uv: [f64; 2]| uv.iter().all(|x| (-EDGE..=1.0 + EDGE).contains(x));
    // Beyond twice the source nothing is aimed at: such values are places in pixels.
    let pixels = |uv: [f64; 2]| uv.iter().any(|x| *x > 2.0);
    let (mut kept, mut in_pixels) = (0usize, 0usize);
    let mut first = None;
    let mut lead_anywhere = false;
    for (uv, status) in map.uv.iter_mut().zip(&mut map.status) {
        if !status.is_answered() {
            continue;
        }
        lead_anywhere |= *uv != [0.0; 2];
        if within(*uv) {
            kept += 1;
        } else {
            in_pixels += usize::from(pixels(*uv));
            // The most telling one.
            first = first.filter(|&first| pixels(first) || !pixels(*uv)).or(Some(*uv));
            (*uv, *status) = ([f64::NAN; 2], Status::Outside);
        }
    }
    if kept > 1 && !lead_anywhere {
        let problem = "u and v are 0 everywhere, which is no map";
        let remedy = "export the map into the first two channels";
        return Err(FileError::malformed(path, "values", problem, remedy));
    }
    // Places in pixels, taken for shares, would make a map of next to nothing.
    let none = kept == 0 && first.is_some_and(|uv| uv.iter().any(|x| *x > 1.0));
    match first.filter(|_| none || in_pixels > kept) {
        Some([u, v]) => Err(FileError::malformed(
            path,
            "values",
            format!("{kept} of them lie within 0 to 1; others are {u} and {v}"),
            "give u and v as shares of the source; for places in its pixels say --from opencv",
        )),
        None => Ok(()),
    }
}

/// uv where there are any: an answer, or what [`bleed`](super::bleed) put in its place.
fn answer(uv: [f64; 2]) -> Option<[f64; 2]> {
    uv.iter().all(|x| x.is_finite()).then_some(uv)
}

#[cfg(test)]
mod tests;
