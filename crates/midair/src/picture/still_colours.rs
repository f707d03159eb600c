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

fn channel(name: &str, value: f32) -> x::AnyChannel<x::FlatSamples> {
    x::AnyChannel::new(x::Text::new_or_panic(name), x::FlatSamples::F32(vec![value; 6]))
}

/// A part of 3 x 2 pixels with flat channels.
fn part(name: Option<&str>, channels: &[(&str, f32)]) -> x::Layer<x::AnyChannels<x::FlatSamples>> {
    let list = channels.iter().map(|&(name, value)| channel(name, value)).collect();
    let attributes = x::LayerAttributes {
        layer_name: name.map(x::Text::new_or_panic),
        ..x::LayerAttributes::default()
    };
    x::Layer::new((3, 2), attributes, x::Encoding::FAST_LOSSLESS, x::AnyChannels::sort(list))
}

fn exr(
    parts: Vec<x::Layer<x::AnyChannels<x::FlatSamples>>>,
    chromaticities: Option<[f32; 8]>,
) -> Vec<u8> {
    let mut image = x::Image::from_layers(
        x::ImageAttributes::new(x::IntegerBounds::from_dimensions((3, 2))),
        x::Layers::from(parts),
    );
    image.attributes.chromaticities = chromaticities.map(|c| x::attribute::Chromaticities {
        red: x::Vec2(c[0], c[1]),
        green: x::Vec2(c[2], c[3]),
        blue: x::Vec2(c[4], c[5]),
        white: x::Vec2(c[6], c[7]),
    });
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn exr_chromaticities_are_converted_white_to_white() {
    let aces = [0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767];
    let file = exr(vec![part(None, &[("R", 0.5), ("G", 0.2), ("B", 0.1)])], Some(aces));
    let still = read(&file);
    // By the matrix that colour-science prints for ACES2065-1 to sRGB by Bradford's adaptation, to four digits.
    let wanted = [0.9952, 0.1267, 0.0785];
    let pixel = still.picture.pixels[4];
    assert!((0..3).all(|c| (pixel[c] - wanted[c]).abs() < 2e-4), "{pixel:?}");
    assert!(still.notes[0].contains("chromaticities"), "{:?}", still.notes);
    let grey = exr(vec![part(None, &[("R", 0.5), ("G", 0.5), ("B", 0.5)])], Some(aces));
    assert!(read(&grey).picture.pixels[0][..3].iter().all(|l| (l - 0.5).abs() < 1e-5));
    // Those of sRGB need no word, and what spans nothing is told.
    let own = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
    assert!(
        read(&exr(vec![part(None, &[("R", 0.5), ("G", 0.2), ("B", 0.1)])], Some(own)))
            .notes
            .is_empty()
    );
    let none = read(&exr(vec![part(None, &[("R", 0.5), ("G", 0.2), ("B", 0.1)])], Some([0.0; 8])));
    assert!(
        none.notes[0].contains("passed over") && none.picture.pixels[0] == [0.5, 0.2, 0.1, 1.0]
    );
}

#[test]
fn a_picture_is_found_in_layers_parts_and_spellings() {
    let colours = |names: [&'static str; 3]| [(names[0], 0.5), (names[1], 0.25), (names[2], 0.125)];
    let [r, g, b] = [("R", 0.5), ("G", 0.25), ("B", 0.125)];
    let blender = [
        ("ViewLayer.Combined.R", 0.5),
        ("ViewLayer.Combined.G", 0.25),
        ("ViewLayer.Combined.B", 0.125),
        ("ViewLayer.Combined.A", 1.0),
        ("ViewLayer.DiffCol.R", 9.0),
        ("ViewLayer.DiffCol.G", 9.0),
        ("ViewLayer.DiffCol.B", 9.0),
        ("ViewLayer.Normal.X", 9.0),
        ("ViewLayer.Normal.Y", 9.0),
        ("ViewLayer.Normal.Z", 9.0),
        ("ViewLayer.Depth.Z", 9.0),
    ];
    let files = [
        vec![part(None, &[r, g, b])],
        vec![part(None, &colours(["r", "g", "b"]))],
        vec![part(None, &colours(["red", "green", "blue"]))],
        vec![part(
            None,
            &colours(["ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"]),
        )],
        vec![part(None, &blender)],
        // What Blender's compositor made stands beside what it was made of.
        vec![part(
            None,
            &[
                ("Composite.Combined.R", 0.5),
                ("Composite.Combined.G", 0.25),
                ("Composite.Combined.B", 0.125),
                ("ViewLayer.Combined.R", 9.0),
                ("ViewLayer.Combined.G", 9.0),
                ("ViewLayer.Combined.B", 9.0),
            ],
        )],
        vec![
            part(Some("left"), &[r, g, b]),
            part(Some("right"), &[("R", 9.0), ("G", 9.0), ("B", 9.0)]),
        ],
        vec![
            part(Some("specular"), &[("R", 9.0), ("G", 9.0), ("B", 9.0)]),
            part(Some("beauty"), &[r, g, b]),
        ],
        vec![part(None, &[r, g, b, ("diffuse.R", 9.0), ("diffuse.G", 9.0), ("diffuse.B", 9.0)])],
        vec![part(Some("depth"), &[("Z", 9.0)]), part(Some("rgba"), &[r, g, b])],
        vec![
            part(Some("depth"), &[("depth.Z", 9.0)]),
            part(Some("rgba"), &colours(["rgba.red", "rgba.green", "rgba.blue"])),
        ],
    ];
    for (i, file) in files.into_iter().enumerate() {
        let still = read(&exr(file, None));
        assert_eq!(still.picture.pixels, [[0.5, 0.25, 0.125, 1.0]; 6], "{i}");
    }
    // Which of several was read is told, even if it is the first.
    let two = [("left", 0.5), ("right", 0.25)];
    let two = two.map(|(name, light)| part(Some(name), &["R", "G", "B"].map(|c| (c, light))));
    assert!(read(&exr(two.to_vec(), None)).notes[0].contains("left"));
    for names in ["Y", "luminance.Y", "y"] {
        assert_eq!(
            read(&exr(vec![part(None, &[(names, 0.5)])], None)).picture.pixels,
            [[0.5, 0.5, 0.5, 1.0]; 6]
        );
    }
    let refused = |file: Vec<_>, words: &[&str]| {
        let message = decode_still(Path::new("a.exr"), &exr(file, None)).unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    // Several, and none of them called the picture.
    let two = ["key.R", "key.G", "key.B", "fill.R", "fill.G", "fill.B"].map(|name| (name, 0.5));
    refused(vec![part(None, &two)], &["several layers", "key", "fill"]);
    // A normal's y is no luminance, and a plain R without the others no picture.
    refused(vec![part(None, &["N.X", "N.Y", "N.Z"].map(|name| (name, 0.5)))], &["missing", "N.X"]);
    refused(vec![part(None, &[r, g])], &["channel B", "missing", "R"]);
    refused(vec![part(None, &[r, g, ("l.R", 0.5), ("l.G", 0.5), ("l.B", 0.5)])], &["channel B"]);
}

#[test]
fn a_map_is_found_in_layers_and_zeros_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.exr");
    let load = |file: Vec<_>| {
        std::fs::write(&path, exr(file, None)).unwrap();
        read_map(&path, Some(Format::Exr), None)
    };
    let [u, v] = [0.25, 0.75];
    for (i, file) in [
        vec![part(None, &[("R", u), ("G", v), ("B", 0.0)])],
        vec![part(None, &[("r", u), ("g", v)])],
        vec![part(None, &[("u", u), ("v", v)])],
        vec![part(None, &[("forward.u", u), ("forward.v", v)])],
        // Nuke's rgba goes along empty.
        vec![part(
            None,
            &[("R", 0.0), ("G", 0.0), ("B", 0.0), ("A", 0.0), ("forward.u", u), ("forward.v", v)],
        )],
        vec![part(Some("depth"), &[("Z", 0.5)]), part(Some("uv"), &[("R", u), ("G", v)])],
        vec![part(
            None,
            &[
                ("ViewLayer.UV.U", u),
                ("ViewLayer.UV.V", v),
                ("ViewLayer.UV.A", 1.0),
                ("ViewLayer.Combined.R", 0.5),
                ("ViewLayer.Combined.G", 0.5),
                ("ViewLayer.Combined.B", 0.5),
            ],
        )],
    ]
    .into_iter()
    .enumerate()
    {
        let map = load(file).unwrap().map;
        assert!(map.uv.iter().all(|uv| *uv == [0.25, 0.75]), "{i}: {:?}", map.uv[0]);
    }
    let refused = |file: Vec<_>, words: &[&str]| {
        let message = load(file).unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    refused(vec![part(None, &[("R", 0.0), ("G", 0.0), ("B", 1.0)])], &["R and G", "0 everywhere"]);
    refused(vec![part(None, &[("Z", 0.5)])], &["missing", "Z"]);
    let both = ["forward.u", "forward.v", "backward.u", "backward.v"].map(|name| (name, 0.5));
    refused(vec![part(None, &both)], &["several layers", "forward", "backward"]);
    let noted =
        load(vec![part(None, &[("R", u), ("G", v), ("forward.u", 0.5), ("forward.v", 0.5)])])
            .unwrap();
    assert!(noted.notes[0].contains("forward"), "{:?}", noted.notes);
}

#[test]
fn a_frame_of_absurd_size_is_refused_at_once() {
    let small = part(None, &[("R", 0.5), ("G", 0.5), ("B", 0.5)]);
    let file = |window: usize| {
        let attributes =
            x::ImageAttributes::new(x::IntegerBounds::from_dimensions((window, window)));
        let image = x::Image::from_layers(attributes, x::Layers::from(vec![small.clone()]));
        let mut bytes = Cursor::new(Vec::new());
        image.write().non_parallel().to_buffered(&mut bytes).unwrap();
        decode_still(Path::new("a.exr"), &bytes.into_inner())
    };
    let message = file(11_000).unwrap_err().to_string();
    assert!(message.contains("11000 x 11000") && message.contains("3 x 2"), "{message}");
    // A frame of a screen's size around a few pixels is cheap, and usual in compositing.
    assert_eq!(file(1000).unwrap().picture.width, 1000);
}
