//! Maps in 16-bit PNG, and PNG files of samples.

use super::exr_channels::{MAX_PIXELS, check_size};
use super::{FileError, LoadedMap, Put, answer};
use crate::map::{Map, Status};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::metadata::Orientation;
use image::{
    DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageFormat, ImageReader,
};
use std::io::{Cursor, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// Decodes a PNG file from memory, turned as it says.
///
/// # Errors
/// [`FileError::Malformed`] where the bytes are cut short or damaged, or claim no or too many pixels.
pub(super) fn decode_samples(path: &Path, bytes: &[u8]) -> Result<DynamicImage, FileError> {
    // Decoders meet damaged files here; a panic in one is an error in the file.
    catch_unwind(AssertUnwindSafe(|| decode_unguarded(path, bytes))).unwrap_or_else(|_| {
        Err(FileError::malformed(path, "pixels", "the data make no sense", "export it again"))
    })
}

fn decode_unguarded(path: &Path, bytes: &[u8]) -> Result<DynamicImage, FileError> {
    let file = ImageBytes {
        path,
        bytes,
        format: ImageFormat::Png,
        kind: "PNG",
        damaged: "it seems damaged: export it again",
    };
    file.upright(file.decoder()?)
}

/// The bytes of an image file, not to be trusted.
#[derive(Clone, Copy)]
pub(crate) struct ImageBytes<'a> {
    /// Names the file in messages.
    pub path: &'a Path,
    /// All that it holds.
    pub bytes: &'a [u8],
    /// What it is.
    pub format: ImageFormat,
    /// The same in words.
    pub kind: &'a str,
    /// What helps where it cannot be decoded and is not cut short.
    pub damaged: &'a str,
}

/// What helps with a file that ends too soon.
pub(crate) const CUT: &str = "it seems cut short: copy or export it again";

impl<'a> ImageBytes<'a> {
    /// A decoder that has read the header, of no more pixels than the file can hold.
    ///
    /// # Errors
    /// [`FileError::Malformed`] where the header is cut short or damaged, or claims no or too many pixels.
    pub(crate) fn decoder(&self) -> Result<impl ImageDecoder + use<'a>, FileError> {
        let Self { path, bytes, format, kind, .. } = *self;
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        let mut limits = image::Limits::default();
        limits.max_alloc = Some(MAX_PIXELS * 8);
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(|error| self.fault("header", error))?;
        let (width, height) = decoder.dimensions();
        check_size(path, u64::from(width), u64::from(height))?;
        // Deflate packs at most 1032 bytes in one, and a palette's bit becomes three bytes; a JPEG
        // block of 64 pixels takes bits, too. A larger claim is a cut or hostile file.
        if format != ImageFormat::WebP && decoder.total_bytes() / 32768 > bytes.len() as u64 {
            let problem =
                format!("{kind}: {width} x {height} pixels cannot come from {} bytes", bytes.len());
            return Err(FileError::malformed(path, "header", problem, CUT));
        }
        Ok(decoder)
    }

    /// The samples, turned as the file says.
    ///
    /// # Errors
    /// [`FileError::Malformed`] where they are cut short or damaged.
    pub(crate) fn upright(
        &self,
        mut decoder: impl ImageDecoder,
    ) -> Result<DynamicImage, FileError> {
        let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
        let decoded = DynamicImage::from_decoder(decoder);
        let mut image = decoded.map_err(|error| self.fault("pixels", error))?;
        image.apply_orientation(orientation);
        Ok(image)
    }

    fn fault(&self, place: &str, error: image::ImageError) -> FileError {
        let remedy = match &error {
            image::ImageError::IoError(_) => CUT,
            _ => self.damaged,
        };
        FileError::malformed(self.path, place, format!("{}: {error}", self.kind), remedy)
    }
}

/// Encodes samples in the machine's byte order as PNG.
pub(crate) fn encode_png(
    writer: impl Write,
    path: &Path,
    (width, height): (usize, usize),
    bytes: &[u8],
    colour: ExtendedColorType,
) -> Result<(), FileError> {
    let unfit = |problem: String| FileError::unsupported(path, problem, "give it another size");
    let size = (u32::try_from(width).unwrap_or(0), u32::try_from(height).unwrap_or(0));
    if size.0 == 0 || size.1 == 0 {
        return Err(unfit(format!("a PNG of {width} x {height} pixels cannot be written")));
    }
    PngEncoder::new_with_quality(writer, CompressionType::Fast, FilterType::Adaptive)
        .write_image(bytes, size.0, size.1, colour)
        .map_err(|error| match error {
            image::ImageError::IoError(error) => FileError::io(path, "write", error),
            error => unfit(error.to_string()),
        })
}

/// Puts samples in the machine's byte order into a PNG file.
fn put_png(
    path: &Path,
    size: (usize, usize),
    samples: &[u8],
    colour: ExtendedColorType,
    put: &mut Put<'_>,
) -> Result<(), FileError> {
    let mut bytes = Vec::new();
    encode_png(&mut bytes, path, size, samples, colour)?;
    put(path, &bytes)
}

/// R = u, G = v, B = 0, alpha = whether the pixel has an answer; 65535 is 1.
pub(super) fn write_map_png(map: &Map, path: &Path, put: &mut Put<'_>) -> Result<(), FileError> {
    let mut samples = Vec::with_capacity(map.uv.len() * 8);
    for (uv, status) in map.uv.iter().zip(&map.status) {
        let code = |x: f64| (x.clamp(0.0, 1.0) * 65535.0).round() as u16;
        let [u, v] = answer(*uv).map_or([0; 2], |uv| uv.map(code));
        let alpha = if status.is_answered() { 65535u16 } else { 0 };
        samples.extend([u, v, 0, alpha].map(u16::to_ne_bytes).as_flattened());
    }
    put_png(path, (map.width, map.height), &samples, ExtendedColorType::Rgba16, put)
}

/// 255 where a pixel has an answer of its own, else 0.
pub(super) fn write_coverage(map: &Map, path: &Path, put: &mut Put<'_>) -> Result<(), FileError> {
    put_png(path, (map.width, map.height), &coverage(map), ExtendedColorType::L8, put)
}

/// Takes the answers of pixels that a mask leaves out for a continuation.
pub(super) fn read_coverage(map: &mut Map, path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let mask = decode_samples(path, bytes)?;
    let size = [mask.width() as usize, mask.height() as usize];
    if size != [map.width, map.height] {
        let problem = format!(
            "{} x {} pixels, but the map has {} x {}",
            size[0], size[1], map.width, map.height
        );
        let remedy = "write both from one map, or remove the mask";
        return Err(FileError::malformed(path, "header", problem, remedy));
    }
    uncover(map, mask.into_luma8().as_raw().iter().map(|&cover| cover > 0));
    Ok(())
}

/// Takes the answers of pixels that are not covered for a continuation.
pub(super) fn uncover(map: &mut Map, covered: impl Iterator<Item = bool>) {
    for (status, covered) in map.status.iter_mut().zip(covered) {
        if !covered && status.is_answered() {
            *status = Status::Outside;
        }
    }
}

/// See [`write_coverage`].
pub(super) fn coverage(map: &Map) -> Vec<u8> {
    map.status.iter().map(|&status| if status.is_answered() { 255 } else { 0 }).collect()
}

pub(super) fn read_map_png(path: &Path, bytes: &[u8]) -> Result<LoadedMap, FileError> {
    let image = decode_samples(path, bytes)?;
    if image.color().bytes_per_pixel() / image.color().channel_count() < 2 {
        let problem = "a map of 8 bits tells apart only 256 x 256 image points";
        return Err(FileError::malformed(path, "header", problem, "export it with 16 bits"));
    }
    if !image.color().has_color() {
        let problem = "a grey picture has no room for u and v";
        let remedy = "give a map with u in red and v in green";
        return Err(FileError::malformed(path, "header", problem, remedy));
    }
    let image = image.into_rgba16();
    let (width, height) = (image.width() as usize, image.height() as usize);
    let pixels = image.as_raw().as_chunks::<4>().0.iter();
    let (uv, status) = pixels
        .map(|&[u, v, _, alpha]| match (alpha, u, v) {
            (0, 0, 0) => ([f64::NAN; 2], Status::Outside),
            _ => (
                [f64::from(u) / 65535.0, f64::from(v) / 65535.0],
                if alpha > 0 { Status::Ok } else { Status::Outside },
            ),
        })
        .unzip();
    Ok(LoadedMap::new(Map { width, height, uv, status, error_bound: f64::INFINITY }))
}
