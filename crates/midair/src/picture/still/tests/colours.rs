//! Tests: colours and channels of stills come out as their files say.

use super::*;
use crate::map::format::{Format, read_map};
use exr::prelude as x;
use exr::prelude::WritableImage as _;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{DynamicImage, ExtendedColorType, ImageEncoder as _, ImageFormat, RgbImage};
use moxcms::ColorProfile;
use std::io::Cursor;

mod layers;

/// Codes of all kinds of colour, dark and bright.
fn codes() -> Vec<[u8; 3]> {
    let levels = [0u8, 9, 64, 140, 200, 255];
    (0..216).map(|i| [levels[i % 6], levels[i / 6 % 6], levels[i / 36]]).collect()
}

fn png(codes: &[[u8; 3]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(codes.as_flattened(), codes.len() as u32, 1, ExtendedColorType::Rgb8)
        .unwrap();
    bytes
}

/// The file with chunks behind its header.
fn with_chunks(png: &[u8], chunks: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    // Signature of 8 bytes, header chunk of 25.
    let mut bytes = png[..33].to_vec();
    for (kind, data) in chunks {
        let body = [&kind[..], data].concat();
        let crc = body.iter().fold(!0u32, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |c, _| (c >> 1) ^ (0xedb8_8320 * (c & 1)))
        });
        bytes.extend((data.len() as u32).to_be_bytes());
        bytes.extend(&body);
        bytes.extend((!crc).to_be_bytes());
    }
    bytes.extend(&png[33..]);
    bytes
}

fn read(bytes: &[u8]) -> Still {
    midair_peers::corpus::keep("pictures", &[bytes]);
    decode_still(Path::new("a.png"), bytes).unwrap()
}

/// Each pixel's light against what is expected of its codes.
fn compare(still: &Still, tolerance: f32, expected: impl Fn([f64; 3]) -> [f64; 3]) {
    assert_eq!(still.picture.pixels.len(), codes().len());
    for (pixel, code) in still.picture.pixels.iter().zip(codes()) {
        let wanted = expected(code.map(|code| f64::from(code) / 255.0));
        for c in 0..3 {
            let wanted = wanted[c].clamp(0.0, 1.0) as f32;
            assert!((pixel[c] - wanted).abs() <= tolerance, "{code:?}: {pixel:?} {wanted}");
        }
    }
}

fn curve(code: f64) -> f64 {
    if code <= 0.04045 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

/// CSS Color 4, section 18: Display P3 to XYZ and XYZ to sRGB, multiplied.
fn from_p3(light: [f64; 3]) -> [f64; 3] {
    let rows = [
        [1.224_940_18, -0.224_940_18, 0.0],
        [-0.042_056_95, 1.042_056_95, 0.0],
        [-0.019_637_55, -0.078_636_05, 1.098_273_60],
    ];
    rows.map(|row| (0..3).map(|c| row[c] * light[c]).sum())
}

#[test]
fn png_says_by_its_chunks_what_its_codes_are() {
    let plain = png(&codes());
    let gamma = |value: u32| (b"gAMA", value.to_be_bytes().to_vec());
    let chromaticities = |values: [u32; 8]| {
        (b"cHRM", values.iter().flat_map(|value| value.to_be_bytes()).collect::<Vec<u8>>())
    };
    // White, red, green, blue, in units of 1/100000.
    let p3 = chromaticities([31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000]);
    let own = chromaticities([31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000]);
    let points = |primaries: u8, transfer: u8| (b"cICP", vec![primaries, transfer, 0, 1]);
    // One rounding of a float in tables; in the matrix chromaticities of 24 bits, which its inversion makes ten times as much.
    let exact = 1e-6;
    let p3_matrix = 1e-5;
    compare(&read(&plain), exact, |code| code.map(curve));
    // Linear; the curve of old Macintoshes; what stands beside sRGB's chunk.
    compare(&read(&with_chunks(&plain, &[gamma(100_000)])), exact, |code| code);
    compare(&read(&with_chunks(&plain, &[gamma(55_556)])), 1e-5, |code| code.map(|c| c.powf(1.8)));
    let usual = with_chunks(&plain, &[gamma(45_455), own]);
    compare(&read(&usual), exact, |code| code.map(curve));
    assert!(read(&usual).notes.is_empty());
    // Other primaries, by either chunk.
    for chunk in [p3.clone(), points(12, 13)] {
        let still = read(&with_chunks(&plain, &[chunk]));
        compare(&still, p3_matrix, |code| from_p3(code.map(curve)));
        assert!(still.notes[0].contains("primaries"), "{:?}", still.notes);
    }
    // sRGB's chunk stands above gamma and primaries, code points above all.
    let above = with_chunks(&plain, &[(b"sRGB", vec![0]), gamma(100_000), p3.clone()]);
    compare(&read(&above), exact, |code| code.map(curve));
    let above = with_chunks(&plain, &[points(1, 8), (b"sRGB", vec![0]), gamma(45_455)]);
    compare(&read(&above), exact, |code| code);
    // Codes of films' range: 16 is black, 235 is white.
    let narrow = with_chunks(&plain, &[(b"cICP", vec![1, 13, 0, 0])]);
    compare(&read(&narrow), exact, |code| {
        code.map(|c| curve(((255.0 * c - 16.0) / 219.0).clamp(0.0, 1.0)))
    });
    // What is not known is told.
    let still = read(&with_chunks(&plain, &[points(1, 77)]));
    compare(&still, exact, |code| code.map(curve));
    assert!(still.notes[0].contains("77") && still.notes[0].contains("sRGB"), "{:?}", still.notes);
}

#[test]
fn pq_and_hlg_are_shown_by_the_stated_tone_mapping() {
    // BT.2408: reference white is 58 % of PQ and 75 % of HLG.
    for (transfer, white, dark) in [(16u8, 148u8, 80u8), (18, 191, 60)] {
        let grey = png(&[[white; 3], [dark; 3], [255; 3], [0; 3]]);
        let still = read(&with_chunks(&grey, &[(b"cICP", vec![9, transfer, 0, 1])]));
        assert!(still.notes[0].contains("203"), "{:?}", still.notes);
        let [white, dark, most, least] = [0, 1, 2, 3].map(|i| still.picture.pixels[i]);
        // BT.2390 from 1000 to 203 cd/m2 takes 203 to about 160.
        assert!((0.74..0.85).contains(&white[0]), "{white:?}");
        assert!(most.iter().all(|&l| (l - 1.0).abs() < 1e-6) && least[..3] == [0.0; 3]);
        assert!(white[0] == white[1] && white[1] == white[2]);
        // Below the knee nothing but the unit changes: PQ's and HLG's own light over 203 cd/m2 (ST 2084; BT.2100 with gamma 1.2).
        let code = f64::from(if transfer == 16 { 80 } else { 60 }) / 255.0;
        let wanted = match transfer {
            16 => {
                let e = code.powf(1.0 / 78.84375);
                ((e - 0.8359375).max(0.0) / (18.8515625 - 18.6875 * e)).powf(1.0 / 0.1593017578125)
                    * 10_000.0
            }
            _ => (code * code / 3.0).powf(1.2) * 1000.0,
        };
        assert!((f64::from(dark[0]) * 203.0 / wanted - 1.0).abs() < 1e-4, "{dark:?} {wanted}");
    }
}

#[test]
fn icc_profiles_are_obeyed_in_every_kind_of_file() {
    let codes = codes();
    let p3 = ColorProfile::new_display_p3().encode().unwrap();
    let image = RgbImage::from_raw(216, 1, codes.as_flattened().to_vec()).unwrap();
    let mut files = Vec::new();
    let mut bytes = Vec::new();
    let mut encoder = PngEncoder::new(&mut bytes);
    encoder.set_icc_profile(p3.clone()).unwrap();
    encoder.write_image(&image, 216, 1, ExtendedColorType::Rgb8).unwrap();
    files.push(bytes);
    let mut bytes = Vec::new();
    let mut encoder = image::codecs::webp::WebPEncoder::new_lossless(&mut bytes);
    encoder.set_icc_profile(p3.clone()).unwrap();
    encoder.write_image(&image, 216, 1, ExtendedColorType::Rgb8).unwrap();
    files.push(bytes);
    for file in files {
        let still = read(&file);
        // The profile's numbers are s15Fixed16 and its curves are taken at 14 bits: 1e-4 of light, in the matrix 1.4 times.
        compare(&still, 3e-4, |code| from_p3(code.map(curve)));
        assert!(
            still.notes[0].contains("P3") && still.notes[0].contains("converted"),
            "{:?}",
            still.notes
        );
    }
    // JPEG is lossy, so one flat colour of each: within two codes of rounding.
    for code in [[200u8, 40, 40], [30, 160, 60], [128, 128, 128]] {
        let flat = RgbImage::from_pixel(32, 32, image::Rgb(code));
        let mut bytes = Vec::new();
        let mut encoder = JpegEncoder::new_with_quality(&mut bytes, 100);
        encoder.set_icc_profile(p3.clone()).unwrap();
        encoder.encode(&flat, 32, 32, ExtendedColorType::Rgb8).unwrap();
        let pixel = read(&bytes).picture.pixels[100];
        let wanted = from_p3(code.map(|code| curve(f64::from(code) / 255.0)));
        for c in 0..3 {
            let code = |light: f64| srgb::encode(light.clamp(0.0, 1.0)) * 255.0;
            assert!(
                (code(f64::from(pixel[c])) - code(wanted[c])).abs() < 3.0,
                "{pixel:?} {wanted:?}"
            );
        }
    }
    // sRGB's own profile changes nothing and needs no word.
    let mut bytes = Vec::new();
    let mut encoder = PngEncoder::new(&mut bytes);
    encoder.set_icc_profile(ColorProfile::new_srgb().encode().unwrap()).unwrap();
    encoder.write_image(&image, 216, 1, ExtendedColorType::Rgb8).unwrap();
    assert_eq!(read(&bytes).picture, read(&png(&codes)).picture);
    assert!(read(&bytes).notes.is_empty());
    // A profile of grey for grey, a damaged one, one for other colours.
    let grey = image::GrayImage::from_fn(216, 1, |x, _| image::Luma([x as u8]));
    let with = |profile: Vec<u8>, samples: &[u8], colour: ExtendedColorType| {
        let mut bytes = Vec::new();
        let mut encoder = PngEncoder::new(&mut bytes);
        encoder.set_icc_profile(profile).unwrap();
        encoder.write_image(samples, 216, 1, colour).unwrap();
        read(&bytes)
    };
    let still = with(
        ColorProfile::new_gray_with_gamma(1.8).encode().unwrap(),
        &grey,
        ExtendedColorType::L8,
    );
    for (x, pixel) in still.picture.pixels.iter().enumerate() {
        let wanted = (x as f32 / 255.0).powf(1.8);
        assert!(
            pixel[..3].iter().all(|light| (light - wanted).abs() < 3e-4),
            "{x}: {pixel:?} {wanted}"
        );
    }
    let mut damaged = p3;
    damaged.truncate(200);
    for (profile, word) in [
        (damaged, "damaged"),
        (ColorProfile::new_gray_with_gamma(1.8).encode().unwrap(), "other colours"),
    ] {
        let still = with(profile, &image, ExtendedColorType::Rgb8);
        assert!(
            still.notes[0].contains(word) && still.notes[0].contains("sRGB"),
            "{:?}",
            still.notes
        );
        compare(&still, 1e-6, |code| code.map(curve));
    }
}

#[test]
fn tiff_webp_and_bmp_are_read_and_others_are_named() {
    let image =
        DynamicImage::from(RgbImage::from_raw(216, 1, codes().as_flattened().to_vec()).unwrap());
    for format in [ImageFormat::Tiff, ImageFormat::WebP, ImageFormat::Bmp] {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        let bytes = bytes.into_inner();
        assert_eq!(read(&bytes).picture, read(&png(&codes())).picture, "{format:?}");
        let cut = decode_still(Path::new("a"), &bytes[..bytes.len() * 2 / 3]);
        assert!(cut.is_err(), "{format:?}");
    }
    for bytes in [&b"GIF89a and more"[..], b"8BPS", b"\x00\x00\x00\x1cftypheic", b"P6 1 1 255 abc"]
    {
        let message = decode_still(Path::new("a.gif"), bytes).unwrap_err().to_string();
        assert!(
            message.contains("a.gif") && message.contains("TIFF") && message.contains("OpenEXR"),
            "{message}"
        );
    }
}

#[test]
fn a_cut_jpeg_is_refused() {
    let image =
        RgbImage::from_fn(64, 64, |x, y| image::Rgb([(x * 4) as u8, (y * 4) as u8, (x ^ y) as u8]));
    let mut bytes = Vec::new();
    JpegEncoder::new(&mut bytes).encode(&image, 64, 64, ExtendedColorType::Rgb8).unwrap();
    assert!(decode_still(Path::new("a.jpg"), &bytes).is_ok());
    for length in [bytes.len() / 2, bytes.len() - 2] {
        let message = decode_still(Path::new("a.jpg"), &bytes[..length]).unwrap_err().to_string();
        assert!(message.contains("a.jpg") && message.contains("cut short"), "{message}");
    }
}
