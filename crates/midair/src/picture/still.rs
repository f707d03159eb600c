//! Stills from and to files.

use super::colour::Primaries;
use super::{Picture, raster, srgb};
use crate::files::write_bytes_atomically;
use crate::map::format::{
    ExrFile, FileError, PictureChannels, encode_channels, encode_png, read_picture,
};
use image::ExtendedColorType;
use rayon::prelude::*;
use std::path::Path;

/// How finely a file's samples are graded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Depth {
    /// 8-bit sRGB.
    Eight,
    /// 16-bit sRGB.
    Sixteen,
    /// Linear floating point.
    Float,
}

/// A picture with what its file said about it.
#[derive(Clone, Debug)]
pub struct Still {
    /// The picture in linear light. A display emits light, so what is transparent shows black:
    /// the colours are premultiplied.
    pub picture: Picture,
    /// The depth of the file, so that 16 bits in give 16 bits out.
    pub depth: Depth,
    /// What was passed over or mended, one sentence each, for the user.
    pub notes: Vec<String>,
}

/// The kinds of picture that are read, for messages.
pub const READ: &str = "PNG, JPEG, TIFF, WebP, BMP or OpenEXR";

/// Whether a file's name is that of a picture of a kind that is read.
pub fn is_picture_name(path: &Path) -> bool {
    const ENDINGS: [&str; 8] = ["png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "exr"];
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    ENDINGS.iter().any(|known| extension.eq_ignore_ascii_case(known))
}

const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// Whether a file that begins with these bytes is a picture of a kind that is read.
pub fn is_picture(start: &[u8]) -> bool {
    start.starts_with(&EXR_MAGIC) || raster::kind(start).is_some()
}

/// Reads a PNG, JPEG, TIFF, WebP, BMP or OpenEXR file; the content decides which, not the name.
///
/// Colours are converted to sRGB's primaries and to linear light: by the file's ICC profile, by PNG's cICP, gAMA and cHRM, by OpenEXR's
/// chromaticities, else codes are taken as sRGB and floats as light with sRGB's primaries. PQ and HLG are brought into a display's range as
/// [`wide`](super::wide) says. A note tells what was converted, and what could not be. The first picture of an OpenEXR file is read: plain R, G and B
/// (or Y alone), else the one layer that holds them. OpenEXR samples that are negative or not finite become 0, and a
/// note counts them. An EXIF orientation is applied.
///
/// # Errors
/// [`FileError`] where the file cannot be read, is of no known kind, cut short or damaged, has no
/// pixels, or claims more than 2^27.
pub fn read_still(path: &Path) -> Result<Still, FileError> {
    let bytes = std::fs::read(path).map_err(|error| FileError::io(path, "read", error))?;
    decode_still(path, &bytes)
}

/// As [`read_still`], from the file's bytes; `path` is named in errors.
///
/// # Errors
/// As [`read_still`].
pub fn decode_still(path: &Path, bytes: &[u8]) -> Result<Still, FileError> {
    if bytes.is_empty() {
        return Err(FileError::malformed(path, "start", "the file is empty", "export it again"));
    }
    if bytes.starts_with(&EXR_MAGIC) {
        return decode_exr(path, bytes);
    }
    match raster::kind(bytes) {
        Some(format) => raster::decode(path, bytes, format),
        None => Err(FileError::malformed(
            path,
            "start",
            format!("this is not a {READ} picture"),
            "convert it to one of them",
        )),
    }
}

fn decode_exr(path: &Path, bytes: &[u8]) -> Result<Still, FileError> {
    let file = ExrFile::open(path, bytes)?;
    let PictureChannels { channels, colours, alpha, layer } = read_picture(path, &file)?;
    let [red, green, blue] = colours.map(|name| channels.get(&name).unwrap_or_default());
    let alpha = alpha.as_ref().and_then(|name| channels.get(name));
    let told = file.chromaticities().map(|[red, green, blue, white]| Primaries {
        red,
        green,
        blue,
        white,
    });
    let told = told.filter(|told| !told.is_srgb());
    let matrix = told.and_then(|told| told.to_srgb());
    let (mut mended, mut outside) = (0usize, 0usize);
    // EXR colours are premultiplied by the format's own rule.
    let pixels = (0..channels.width * channels.height)
        .map(|i| {
            let mut sound = |value: f32| {
                if value.is_finite() && value >= 0.0 {
                    value
                } else {
                    mended += 1;
                    0.0
                }
            };
            let alpha = alpha.map_or(1.0, |alpha| sound(alpha[i]).min(1.0));
            let light = [red[i], green[i], blue[i]];
            let [r, g, b] = match &matrix {
                // Colours beyond the file's own primaries may be within sRGB's.
                Some(matrix) if light.iter().all(|light| light.is_finite()) => {
                    let seen = matrix.apply(light);
                    // Roundings of a matrix of floats are no colours outside.
                    let most = seen.iter().copied().fold(0.0, f32::max);
                    outside += usize::from(seen.iter().any(|&light| light < -1e-4 * most));
                    seen.map(|light| light.max(0.0))
                }
                _ => light.map(sound),
            };
            [r, g, b, alpha]
        })
        .collect();
    let mut notes = Vec::new();
    let mut note = |text: String| notes.push(format!("{}: {text}", path.display()));
    if let Some(layer) = layer {
        note(format!("the picture is read from its layer {layer}"));
    }
    match (told, &matrix) {
        (Some(_), Some(_)) => {
            let more = match outside {
                0 => String::new(),
                n => format!("; {n} pixels lie outside them and are taken at their edge"),
            };
            note(format!("its primaries (chromaticities) are converted to those of sRGB{more}"));
        }
        (Some(_), None) => {
            note("its chromaticities span no colours and are passed over".to_owned());
        }
        _ => {}
    }
    if mended > 0 {
        note(format!("{mended} samples are negative or not finite and are taken as 0"));
    }
    let picture = Picture { width: channels.width, height: channels.height, pixels };
    Ok(Still { picture, depth: Depth::Float, notes })
}

/// Writes a picture as the display shows it: the premultiplied colours, so that what is
/// transparent is black; no alpha. The name decides the kind: `.png` (sRGB, 8 bits, or 16 for the
/// other depths, each code the nearest one) or `.exr` (linear 32-bit float).
///
/// # Errors
/// [`FileError::Unsupported`] for another name or an empty picture; [`FileError::Io`] where the
/// file cannot be written. In either case no file is left behind.
pub fn write_still(path: &Path, picture: &Picture, depth: Depth) -> Result<(), FileError> {
    write_bytes_atomically(path, &encode_still(path, picture, depth)?)
}

/// As [`write_still`], into memory: the bytes of a file that is called `path`.
///
/// # Errors
/// [`FileError::Unsupported`] as [`write_still`].
pub fn encode_still(path: &Path, picture: &Picture, depth: Depth) -> Result<Vec<u8>, FileError> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if extension.eq_ignore_ascii_case("exr") {
        let channel = |c: usize| picture.pixels.iter().map(|pixel| pixel[c]).collect();
        let channels = vec![("R", channel(0)), ("G", channel(1)), ("B", channel(2))];
        return encode_channels(path, picture.width, picture.height, channels, false);
    }
    if !extension.eq_ignore_ascii_case("png") {
        let problem = "pictures are written as PNG or OpenEXR";
        return Err(FileError::unsupported(path, problem, "end the name in .png or .exr"));
    }
    let (codes, colour): (Vec<u8>, _) = if depth == Depth::Eight {
        let codes = picture.pixels.par_iter().with_min_len(1 << 14);
        let codes = codes.map(|&[r, g, b, _]| [r, g, b].map(srgb::encode_8));
        (codes.collect::<Vec<_>>().into_flattened(), ExtendedColorType::Rgb8)
    } else {
        // The encoder takes 16-bit samples in the machine's byte order.
        let codes = picture.pixels.par_iter().with_min_len(1 << 12);
        let codes = codes.map(|&[r, g, b, _]| {
            [r, g, b].map(|light| srgb::encode_16(light).to_ne_bytes()).as_flattened().to_owned()
        });
        (codes.flatten_iter().collect(), ExtendedColorType::Rgb16)
    };
    let mut bytes = Vec::new();
    encode_png(&mut bytes, path, (picture.width, picture.height), &codes, colour)?;
    Ok(bytes)
}

/// As [`write_still`], with the width and height of a pixel in mm in the file, where it is a PNG: programs that print or lay out show it in
/// its true size.
///
/// # Errors
/// As [`write_still`].
pub fn write_still_of_pitch(
    path: &Path,
    picture: &Picture,
    depth: Depth,
    pitch: [f64; 2],
) -> Result<(), FileError> {
    let mut bytes = encode_still(path, picture, depth)?;
    state_pitch(&mut bytes, pitch);
    write_bytes_atomically(path, &bytes)
}

/// Puts a pHYs chunk (PNG, third edition, 11.3.4.3) before a PNG's pixels; leaves other files, and pitches that it cannot hold, as they are.
fn state_pitch(file: &mut Vec<u8>, pitch: [f64; 2]) {
    // The signature and IHDR: 8 bytes, and 4 + 4 + 13 + 4.
    const HEADER: usize = 33;
    // Pixels per metre are whole numbers.
    let per_metre = pitch.map(|mm| (1000.0 / mm).round());
    let held = per_metre.iter().all(|&count| (1.0..=f64::from(i32::MAX)).contains(&count));
    if !file.starts_with(b"\x89PNG") || file.len() < HEADER || !held {
        return;
    }
    let mut chunk = b"pHYs".to_vec();
    per_metre.iter().for_each(|&count| chunk.extend((count as u32).to_be_bytes()));
    // The unit is the metre.
    chunk.push(1);
    let mut crc = flate2::Crc::new();
    crc.update(&chunk);
    let mut whole = 9u32.to_be_bytes().to_vec();
    whole.extend(&chunk);
    whole.extend(crc.sum().to_be_bytes());
    file.splice(HEADER..HEADER, whole);
}

#[cfg(test)]
mod tests;
