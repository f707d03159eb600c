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
#[path = "still_colours.rs"]
mod colours;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::format::write_channels;
    use image::{DynamicImage, ImageBuffer, ImageFormat};
    use proptest::prelude::*;
    use std::io::Cursor;
    use std::path::PathBuf;

    fn encoded(image: DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn decode(bytes: &[u8]) -> Result<Still, FileError> {
        decode_still(Path::new("picture.png"), bytes)
    }

    fn noise(i: u32) -> u16 {
        (i.wrapping_mul(2_654_435_761) >> 13) as u16
    }

    fn samples() -> Vec<Vec<u8>> {
        let rgb8 = ImageBuffer::from_fn(13, 7, |x, y| {
            image::Rgb([noise(x * 31 + y) as u8, (x * 19) as u8, (y * 36) as u8])
        });
        let rgba16 = ImageBuffer::from_fn(13, 7, |x, y| {
            image::Rgba([noise(x), noise(y), noise(x + y), noise(x * y)])
        });
        let grey = ImageBuffer::from_fn(9, 5, |x, y| image::Luma([(x * 20 + y) as u8]));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let ramp: Vec<f32> = (0..35).map(|i| i as f32 / 9.0).collect();
        let channels = vec![("R", ramp.clone()), ("G", ramp.clone()), ("B", ramp)];
        write_channels(&path, 7, 5, channels, false).unwrap();
        vec![
            encoded(rgb8.clone().into(), ImageFormat::Png),
            encoded(rgb8.into(), ImageFormat::Jpeg),
            encoded(DynamicImage::ImageRgba16(rgba16), ImageFormat::Png),
            encoded(grey.into(), ImageFormat::Png),
            std::fs::read(path).unwrap(),
        ]
    }

    #[test]
    fn a_png_says_how_large_its_pixels_are() {
        let picture = Picture::filled(3, 2, [0.5, 0.25, 0.125, 1.0]);
        let plain = encode_still(Path::new("a.png"), &picture, Depth::Eight).unwrap();
        let mut stated = plain.clone();
        state_pitch(&mut stated, [0.1, 0.0962]);
        // By another reader: 10 pixels to the millimetre, and 10.395.
        let reader = png::Decoder::new(std::io::Cursor::new(&stated)).read_info().unwrap();
        let dims = reader.info().pixel_dims.unwrap();
        assert_eq!((dims.xppu, dims.yppu, dims.unit), (10_000, 10_395, png::Unit::Meter));
        let read = |bytes: &[u8]| decode_still(Path::new("a.png"), bytes).unwrap().picture;
        assert_eq!(read(&stated), read(&plain));
        // What no file can hold is left out.
        let mut kept = plain.clone();
        for pitch in [[0.0, 1.0], [f64::NAN, 1.0], [1e9, 1.0]] {
            state_pitch(&mut kept, pitch);
            assert_eq!(kept, plain);
        }
    }

    #[test]
    fn every_kind_of_png_becomes_premultiplied_linear_light() {
        // Alpha 128 / 255 over the standard's own curve; grey spreads to three channels.
        let grey_alpha = ImageBuffer::from_pixel(2, 1, image::LumaA([188u8, 128]));
        let still = decode(&encoded(grey_alpha.into(), ImageFormat::Png)).unwrap();
        assert_eq!(still.depth, Depth::Eight);
        let light = (((188.0 / 255.0 + 0.055) / 1.055f64).powf(2.4) * 128.0 / 255.0) as f32;
        let [r, g, b, a] = still.picture.pixels[1];
        // One rounding of the table and one of the product.
        assert!((r - light).abs() < 1e-7 && r == g && g == b);
        assert_eq!(a, 128.0 / 255.0);

        let rgba = ImageBuffer::from_pixel(1, 1, image::Rgba([65535u16, 0, 30000, 0]));
        let still = decode(&encoded(DynamicImage::ImageRgba16(rgba), ImageFormat::Png)).unwrap();
        assert_eq!(still.depth, Depth::Sixteen);
        assert_eq!(still.picture.pixels, [[0.0; 4]]);
    }

    #[test]
    fn a_palette_is_looked_up() {
        // A 2 x 1 PNG of palette entries 1 and 0, written by hand with the `image` crate's
        // encoder out of the way: signature, IHDR (depth 8, colour type 3), PLTE, IDAT, IEND.
        let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
        let mut chunk = |kind: &[u8; 4], data: &[u8]| {
            png.extend((data.len() as u32).to_be_bytes());
            let body = [&kind[..], data].concat();
            let crc = body.iter().fold(!0u32, |crc, &byte| {
                (0..8).fold(crc ^ u32::from(byte), |c, _| (c >> 1) ^ (0xedb8_8320 * (c & 1)))
            });
            png.extend(&body);
            png.extend((!crc).to_be_bytes());
        };
        chunk(b"IHDR", &[0, 0, 0, 2, 0, 0, 0, 1, 8, 3, 0, 0, 0]);
        chunk(b"PLTE", &[255, 0, 0, 0, 255, 255]);
        // zlib: one stored block of 3 bytes (filter 0, entries 1 and 0) and its Adler-32.
        chunk(b"IDAT", &[0x78, 1, 1, 3, 0, 0xfc, 0xff, 0, 1, 0, 0, 5, 0, 2]);
        chunk(b"IEND", &[]);
        let still = decode(&png).unwrap();
        assert_eq!(still.picture.pixels, [[0.0, 1.0, 1.0, 1.0], [1.0, 0.0, 0.0, 1.0]]);
    }

    #[test]
    fn eight_and_sixteen_bit_files_come_back_as_they_were() {
        samples().iter().for_each(|bytes| midair_peers::corpus::keep("pictures", &[bytes]));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        for bytes in &samples()[..3] {
            let still = decode(bytes).unwrap();
            // Opaque, so that nothing is lost by leaving the alpha out.
            let mut picture = still.picture;
            picture.pixels.iter_mut().for_each(|pixel| pixel[3] = 1.0);
            write_still(&path, &picture, still.depth).unwrap();
            let back = read_still(&path).unwrap();
            assert_eq!(back.depth, still.depth);
            if still.depth == Depth::Eight {
                assert_eq!(back.picture, picture);
            } else {
                // Premultiplied light falls between codes: half a code of 1/65535 where the
                // slope of decoding is at most 2.4 / 1.055.
                for (a, b) in back.picture.pixels.iter().zip(&picture.pixels) {
                    assert!((0..3).all(|c| (a[c] - b[c]).abs() <= 1.2 / 65535.0));
                }
            }
        }
    }

    #[test]
    fn float_pictures_come_back_exactly_and_bad_samples_are_counted() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let mut picture = Picture::filled(3, 2, [0.25, 7.5, 1e-6, 1.0]);
        write_still(&path, &picture, Depth::Float).unwrap();
        let still = read_still(&path).unwrap();
        assert_eq!((still.picture, still.depth), (picture.clone(), Depth::Float));
        picture.pixels[1] = [f32::NAN, -1.0, f32::INFINITY, 1.0];
        write_still(&path, &picture, Depth::Float).unwrap();
        let still = read_still(&path).unwrap();
        assert_eq!(still.picture.pixels[1], [0.0, 0.0, 0.0, 1.0]);
        assert!(still.notes[0].contains("3 samples"), "{:?}", still.notes);
    }

    #[test]
    fn the_content_decides_the_kind_not_the_name() {
        let still = decode_still(Path::new("picture.exr"), &samples()[1]).unwrap();
        assert_eq!((still.picture.width, still.picture.height), (13, 7));
    }

    #[test]
    fn bad_files_are_named_with_place_and_remedy() {
        let png = &samples()[0];
        let check = |bytes: &[u8], words: &[&str]| {
            let message = decode(bytes).unwrap_err().to_string();
            let missing: Vec<_> = words.iter().filter(|word| !message.contains(**word)).collect();
            assert!(missing.is_empty(), "{message:?} lacks {missing:?}");
        };
        check(&png[..png.len() / 2], &["picture.png", "pixels", "export it again"]);
        check(&png[..20], &["picture.png", "header"]);
        check(b"", &["picture.png", "empty"]);
        check(b"GIF89a and more", &["picture.png", "not a PNG", "TIFF"]);
        // IHDR of 2^31 - 1 squared pixels and of none (with a checksum that the decoder may doubt).
        for size in [0x7fff_ffffu32, 0] {
            let mut hostile = png.clone();
            hostile[16..20].copy_from_slice(&size.to_be_bytes());
            hostile[20..24].copy_from_slice(&size.to_be_bytes());
            check(&hostile, &["picture.png", "header"]);
        }
        let missing = read_still(Path::new("no/such.png")).unwrap_err().to_string();
        assert!(missing.contains("no/such.png") && missing.contains("check the path"));
        let unknown =
            write_still(&PathBuf::from("a.bmp"), &Picture::filled(1, 1, [0.0; 4]), Depth::Eight);
        assert!(unknown.unwrap_err().to_string().contains(".png or .exr"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn mutated_files_are_read_or_refused_but_never_panic(
            which in 0usize..5,
            cut in 0.0f64..=1.0,
            changes in prop::collection::vec((0.0f64..1.0, any::<u8>()), 0..6),
        ) {
            let mut bytes = samples().swap_remove(which);
            for (place, value) in changes {
                let place = (place * bytes.len() as f64) as usize;
                bytes[place] = value;
            }
            if cut < 0.7 {
                bytes.truncate((bytes.len() as f64 * cut / 0.7) as usize);
            }
            match decode(&bytes) {
                Ok(Still { picture, .. }) => {
                    prop_assert_eq!(picture.pixels.len(), picture.width * picture.height);
                    prop_assert!(picture.pixels.iter().flatten().all(|v| v.is_finite() && *v >= 0.0));
                }
                Err(error) => prop_assert!(error.to_string().contains("picture.png"), "{error}"),
            }
        }

        #[test]
        fn random_bytes_are_refused(
            magic in prop::sample::select(vec![
                &b"\x89PNG\r\n\x1a\n"[..], b"\xff\xd8\xff", b"\x76\x2f\x31\x01\x02\0\0\0", b"",
            ]),
            tail in prop::collection::vec(any::<u8>(), 0..300),
        ) {
            prop_assert!(decode(&[magic, &tail].concat()).is_err());
        }
    }
}
