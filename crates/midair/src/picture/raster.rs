//! PNG, JPEG, TIFF, WebP and BMP as pictures in linear light.

use super::profile::{self, Encoding, Told, Transfer};
use super::{Depth, Picture, Still, srgb, tiff, wide};
use crate::map::format::{CUT, FileError, ImageBytes};
use image::{DynamicImage, ImageDecoder as _, ImageFormat};
use rayon::prelude::*;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// The kinds of file, with the name for messages.
const KINDS: [(ImageFormat, &str); 5] = [
    (ImageFormat::Png, "PNG"),
    (ImageFormat::Jpeg, "JPEG"),
    (ImageFormat::Tiff, "TIFF"),
    (ImageFormat::WebP, "WebP"),
    (ImageFormat::Bmp, "BMP"),
];

/// The kind of a file by its first bytes; `None` for others than these.
pub(super) fn kind(bytes: &[u8]) -> Option<ImageFormat> {
    // The library reads BigTIFF, but does not know it by its first bytes.
    let big = [&b"II\x2b\0"[..], b"MM\0\x2b"].iter().any(|start| bytes.starts_with(start));
    let format = if big { ImageFormat::Tiff } else { image::guess_format(bytes).ok()? };
    KINDS.iter().any(|(known, _)| *known == format).then_some(format)
}

/// Decodes a file of a known kind, turned as it says and with its colours in sRGB's primaries.
pub(super) fn decode(path: &Path, bytes: &[u8], format: ImageFormat) -> Result<Still, FileError> {
    // Decoders meet damaged files here; a panic in one is an error in the file.
    let decoded = catch_unwind(AssertUnwindSafe(|| samples(path, bytes, format)));
    let (image, told, more) = decoded.unwrap_or_else(|_| {
        Err(FileError::malformed(path, "pixels", "the data make no sense", "export it again"))
    })?;
    let depth = match image.color().bytes_per_pixel() / image.color().channel_count() {
        1 => Depth::Eight,
        2 => Depth::Sixteen,
        _ => Depth::Float,
    };
    let more = more.then(|| "it holds several pictures; the first is read".to_owned());
    let notes =
        told.note.iter().chain(&more).map(|note| format!("{}: {note}", path.display())).collect();
    Ok(Still { picture: linearise(image, &told.encoding), depth, notes })
}

/// Whether a file holds further pictures: pages of a TIFF, or those of a PNG or WebP that moves.
fn has_more(bytes: &[u8], format: ImageFormat) -> bool {
    match format {
        ImageFormat::Tiff => tiff::facts(bytes).is_some_and(|facts| facts.pages > 1),
        ImageFormat::Png => {
            let chunks = png::Decoder::new(Cursor::new(bytes)).read_info();
            chunks.is_ok_and(|chunks| chunks.info().animation_control.is_some())
        }
        // The extended header's flag (RFC 9649, section 2.7).
        ImageFormat::WebP => {
            bytes.get(12..16) == Some(&b"VP8X"[..])
                && bytes.get(20).is_some_and(|flags| flags & 2 != 0)
        }
        _ => false,
    }
}

fn samples(
    path: &Path,
    bytes: &[u8],
    format: ImageFormat,
) -> Result<(DynamicImage, Told, bool), FileError> {
    let kind = KINDS.iter().find(|(known, _)| *known == format).map_or("picture", |known| known.1);
    let damaged = "it seems damaged, or of a rare kind: export it again";
    let file = ImageBytes { path, bytes, format, kind, damaged };
    if format == ImageFormat::Jpeg && !super::jpeg::is_whole(bytes) {
        let problem = "JPEG: it ends before its picture does";
        return Err(FileError::malformed(path, "pixels", problem, CUT));
    }
    let facts = if format == ImageFormat::Tiff { tiff::facts(bytes) } else { None };
    if facts.as_ref().is_some_and(|facts| facts.in_planes) {
        // The decoder hands the planes over one after the other, as if they were side by side.
        let problem = "TIFF: its colours are stored plane by plane";
        let remedy = "save it with the colours of each pixel side by side (planar configuration 1)";
        return Err(FileError::malformed(path, "header", problem, remedy));
    }
    let mut decoder = file.decoder()?;
    // The decoder reads tags of bytes; profiles are tags of undefined type.
    let icc = decoder.icc_profile().ok().flatten().or(facts.and_then(|facts| facts.profile));
    let image = file.upright(decoder)?;
    let mut told = profile::read(bytes, format, icc.as_deref(), !image.color().has_color());
    if depth_is_float(&image) && icc.is_none() {
        told = profile::linear();
    }
    Ok((image, told, has_more(bytes, format)))
}

fn depth_is_float(image: &DynamicImage) -> bool {
    matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_))
}

/// Decodes codes to light and premultiplies.
fn linearise(image: DynamicImage, encoding: &Encoding) -> Picture {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let pixels = match image {
        DynamicImage::ImageLuma8(image) => {
            spread(&image, &Codes::eight(encoding), |&[y]| [y; 3], |_| 1.0)
        }
        DynamicImage::ImageLumaA8(image) => {
            spread(&image, &Codes::eight(encoding), |&[y, _]| [y; 3], |&[_, a]| eighth(a))
        }
        DynamicImage::ImageRgb8(image) => {
            spread(&image, &Codes::eight(encoding), |&rgb: &[u8; 3]| rgb, |_| 1.0)
        }
        DynamicImage::ImageRgba8(image) => {
            spread(&image, &Codes::eight(encoding), |&[r, g, b, _]| [r, g, b], |&[.., a]| eighth(a))
        }
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            let image = image.into_rgba32f();
            spread(
                &image,
                &Codes::float(encoding),
                |&[r, g, b, _]| [r, g, b],
                |&[.., a]| {
                    if a.is_finite() { a.clamp(0.0, 1.0) } else { 0.0 }
                },
            )
        }
        // 16 bits, whatever the channels.
        other => {
            let image = other.into_rgba16();
            spread(
                &image,
                &Codes::sixteen(encoding),
                |&[r, g, b, _]| [r, g, b],
                |&[.., a]| f32::from(a) / 65535.0,
            )
        }
    };
    Picture { width, height, pixels }
}

fn eighth(alpha: u8) -> f32 {
    f32::from(alpha) / 255.0
}

/// How codes of type `T` become light.
struct Codes<'a, T> {
    encoding: &'a Encoding,
    /// Light of a code, without a profile.
    light: Box<dyn Fn(T) -> f32 + Send + Sync>,
    /// A code as a share of the largest one.
    share: fn(T) -> f32,
}

impl<'a> Codes<'a, u8> {
    fn eight(encoding: &'a Encoding) -> Self {
        let table: Vec<f32> =
            (0..=u8::MAX).map(|code| light(encoding, code.into(), 255.0)).collect();
        let light: Box<dyn Fn(u8) -> f32 + Send + Sync> = match encoding {
            Encoding::Srgb => Box::new(srgb::decode_8),
            _ => Box::new(move |code| table[usize::from(code)]),
        };
        Self { encoding, light, share: |code| f32::from(code) / 255.0 }
    }
}

impl<'a> Codes<'a, u16> {
    fn sixteen(encoding: &'a Encoding) -> Self {
        let table: Vec<f32> =
            (0..=u16::MAX).map(|code| light(encoding, code.into(), 65535.0)).collect();
        let light: Box<dyn Fn(u16) -> f32 + Send + Sync> = match encoding {
            Encoding::Srgb => Box::new(srgb::decode_16),
            _ => Box::new(move |code| table[usize::from(code)]),
        };
        Self { encoding, light, share: |code| f32::from(code) / 65535.0 }
    }
}

impl<'a> Codes<'a, f32> {
    /// Floats are light already, but for a profile that says otherwise.
    fn float(encoding: &'a Encoding) -> Self {
        let finite = |value: f32| if value.is_finite() { value.max(0.0) } else { 0.0 };
        Self { encoding, light: Box::new(finite), share: finite }
    }
}

/// Light of a code, by the encoding's curve; `most` is the largest code.
fn light(encoding: &Encoding, code: f64, most: f64) -> f32 {
    match encoding {
        Encoding::Curve { transfer, narrow: true, .. } => {
            // 16 and 219 of codes of 8 bits, and multiples of them by powers of two (ITU-T H.273, 8.3).
            let unit = (most + 1.0) / 256.0;
            let share = (code - 16.0 * unit) / (219.0 * unit);
            transfer.decode(share.clamp(0.0, 1.0)) as f32
        }
        Encoding::Curve { transfer, .. } => transfer.decode(code / most) as f32,
        Encoding::Srgb | Encoding::Icc { .. } => srgb::decode(code / most) as f32,
    }
}

/// Pixels at a time: enough to be worth a task.
const RUN: usize = 1 << 13;

fn spread<T: Copy + Sync, const N: usize>(
    samples: &[T],
    codes: &Codes<T>,
    colour: impl Fn(&[T; N]) -> [T; 3] + Send + Sync,
    alpha: impl Fn(&[T; N]) -> f32 + Send + Sync,
) -> Vec<[f32; 4]> {
    let pixels = samples.as_chunks::<N>().0;
    let mut shown = vec![[0.0; 4]; pixels.len()];
    shown.par_chunks_mut(RUN).zip(pixels.par_chunks(RUN)).for_each(|(shown, pixels)| {
        let premultiplied = |[r, g, b]: [f32; 3], pixel: &[T; N]| {
            let alpha = alpha(pixel);
            [r * alpha, g * alpha, b * alpha, alpha]
        };
        let light = |pixel: &[T; N]| colour(pixel).map(|code| (codes.light)(code));
        match codes.encoding {
            Encoding::Srgb => shown.iter_mut().zip(pixels).for_each(|(shown, pixel)| {
                *shown = premultiplied(light(pixel), pixel);
            }),
            Encoding::Curve { transfer, matrix, .. } => {
                shown.iter_mut().zip(pixels).for_each(|(shown, pixel)| {
                    let seen = of_curve(light(pixel), *transfer, matrix.as_ref());
                    *shown = premultiplied(seen, pixel);
                });
            }
            Encoding::Icc { transform, grey } => {
                let shares = |pixel: &[T; N]| colour(pixel).map(codes.share);
                let given: Vec<f32> = match grey {
                    true => pixels.iter().map(|pixel| shares(pixel)[0]).collect(),
                    false => pixels.iter().flat_map(shares).collect(),
                };
                let mut seen = vec![0.0; pixels.len() * 3];
                // Its only errors are lengths that do not fit.
                let _ = transform.transform(&given, &mut seen);
                for ((shown, pixel), seen) in
                    shown.iter_mut().zip(pixels).zip(seen.as_chunks::<3>().0)
                {
                    *shown = premultiplied(seen.map(in_range), pixel);
                }
            }
        }
    });
    shown
}

fn of_curve(
    light: [f32; 3],
    transfer: Transfer,
    matrix: Option<&super::colour::ToSrgb>,
) -> [f32; 3] {
    if let Some(curve) = transfer.wide() {
        let light = wide::display_light(curve, light.map(f64::from)).map(|light| light as f32);
        return wide::shown(matrix.map_or(light, |matrix| matrix.apply(light)));
    }
    matrix.map_or(light, |matrix| matrix.apply(light).map(in_range))
}

/// Codes end at the display's white, and so does what they are converted to.
fn in_range(light: f32) -> f32 {
    light.clamp(0.0, 1.0)
}
