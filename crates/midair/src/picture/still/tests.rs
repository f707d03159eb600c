//! Pictures are read as their files mean them, and written as they were read.

use super::*;
use crate::map::format::write_channels;
use image::{DynamicImage, ImageBuffer, ImageFormat};
use proptest::prelude::*;
use std::io::Cursor;
use std::path::PathBuf;

mod colours;

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
