//! OpenEXR: chromaticities, and what of its layers, parts and spellings is the picture or the map.

use super::*;

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
