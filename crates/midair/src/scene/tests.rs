//! The reader, the schema and the writer against each other and against what people get wrong.

use super::model::*;
use super::*;
use crate::geometry::Vec3;
use miette::Diagnostic;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use std::path::{Path, PathBuf};

const GOOD: &str = r#"
name = "Good"
[viewpoint]
position = [0.0, 0.0, 800.0]
[image]
size = [20, 20.0]
[plate]
position = [0.0, 0.0, -150.0]
rotation = [-45.0, 0.0, 0.0]
size = [488.0, 488.0]
[display]
resolution = [64, 32]
[[element]]
name = "ball"
shape = { kind = "sphere", radius = 25.0 }
material = { ior = 1.49 }
"#;

fn toml(text: &str) -> Result<Scene, SceneError> {
    midair_peers::corpus::keep("scenes", &[&[0], text.as_bytes()]);
    parse(text, "test.toml", Format::Toml)
}

/// The good scene with one text replaced by another.
fn with(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from:?} is not in the good scene");
    GOOD.replacen(from, to, 1)
}

#[test]
fn a_scene_reads_as_it_is_written() {
    let scene = toml(GOOD).unwrap();
    let expected = Scene {
        name: "Good".into(),
        max_interactions: 32,
        follow_total_reflection: false,
        viewpoint: [0.0, 0.0, 800.0],
        image: Rectangle { pose: Pose::default(), size: [20.0, 20.0] },
        plate: Plate {
            rectangle: Rectangle {
                pose: Pose { position: [0.0, 0.0, -150.0], rotation: [-45.0, 0.0, 0.0] },
                size: [488.0, 488.0],
            },
            model: PlateModel::Ideal,
            luminance: None,
        },
        display: Display {
            resolution: [64, 32],
            pose: None,
            size: None,
            wavelengths: [611.0, 549.0, 465.0],
            response: ResponseSource::Srgb,
            emission: None,
            polarisation: None,
            black: None,
            bits: None,
        },
        elements: vec![Element {
            name: "ball".into(),
            shape: Shape::Sphere { radius: 25.0 },
            pose: Pose::default(),
            material: Material::Refractive { index: Index::Constant(1.49), absorption: None },
            priority: None,
            hollow: None,
        }],
        tracker: None,
    };
    assert_eq!(scene, expected);
}

#[test]
fn json_of_the_same_shape_is_the_same_scene() {
    let json = r#"{"name": "Good", "viewpoint": {"position": [0, 0, 800]},
        "image": {"size": [20, 20]},
        "plate": {"position": [0, 0, -150], "rotation": [-45, 0, 0], "size": [488, 488.0]},
        "display": {"resolution": [64, 32]},
        "element": [{"name": "ball", "shape": {"kind": "sphere", "radius": 25},
                     "material": {"ior": 1.49}}]}"#;
    assert_eq!(parse(json, "a.json", Format::Json).unwrap(), toml(GOOD).unwrap());
    let absorbing = json.replace(r#"{"ior": 1.49}"#, r#"{"ior": 1.49, "absorption": [1, 2, 3]}"#);
    let scene = parse(&absorbing, "a.json", Format::Json).unwrap();
    let outside =
        with("material = { ior = 1.49 }", "material = { ior = 1.49 }\nabsorption = [1, 2, 3]");
    assert_eq!(scene, toml(&outside).unwrap());
}

#[test]
fn displays_are_described_as_people_know_them() {
    let display = |text: &str| toml(&with("resolution = [64, 32]", text)).unwrap().display;
    // Pixels in an inch, or a diagonal of 3 : 4 : 5; by hand.
    let by_ppi = display("resolution = [2540, 1270]\nppi = 254");
    let [w, h] = by_ppi.size.unwrap();
    assert!((w - 254.0).abs() < 1e-9 && (h - 127.0).abs() < 1e-9, "{w} {h}");
    let [w, h] = display("resolution = [400, 300]\ndiagonal_inches = 10").size.unwrap();
    assert!((w - 203.2).abs() < 1e-9 && (h - 152.4).abs() < 1e-9, "{w} {h}");
    let tablet = display("model = \"ipad-10.9\"");
    assert_eq!(tablet.resolution, [2360, 1640]);
    let upright = display("model = \"ipad-10.9\"\nportrait = true");
    assert_eq!(upright.resolution, [1640, 2360]);
    let ([w, h], [a, b]) = (tablet.size.unwrap(), upright.size.unwrap());
    assert_eq!([w, h], [b, a]);
    // A telephone stands as it is known, and lies if it is told to.
    assert_eq!(display("model = \"iphone-15\"").resolution, [1179, 2556]);
    assert_eq!(display("model = \"iphone-15\"\nportrait = false").resolution, [2556, 1179]);
    // Measured sides count more than a model's, and a model's size holds at any resolution.
    assert_eq!(display("model = \"ipad-10.9\"\nsize = [227.0, 158.0]").size, Some([227.0, 158.0]));
    assert_eq!(display("model = \"ipad-10.9\"\nresolution = [1180, 820]").size, Some([w, h]));
}

/// What people get wrong: the change to the good scene, the line to blame, and words that the
/// message and the remedy have to hold.
#[test]
fn mistakes_are_named_with_line_and_remedy() {
    let ball = "shape = { kind = \"sphere\", radius = 25.0 }";
    let shape = |text: &str| with(ball, &format!("shape = {{ {text} }}"));
    let material = |text: &str| with("{ ior = 1.49 }", &format!("{{ {text} }}"));
    let cases: Vec<(String, usize, &[&str], &[&str])> = vec![
        (with("radius", "radus"), 15, &["unknown key `radus`"], &["did you mean `radius`"]),
        (with("[viewpoint]", "[viewpont]"), 3, &["`viewpont`"], &["`viewpoint`"]),
        (with("size = [20, 20.0]\n", ""), 5, &["the image lacks the key `size`"], &["size ="]),
        (with("radius = 25.0", "radius = \"25\""), 15, &["a text"], &["millimetres", "25.0"]),
        (with("radius = 25.0", "radius = \"2.5 ells\""), 15, &["a text"], &["\"5 cm\""]),
        (with("radius = 25.0", "radius = [25.0]"), 15, &["a list", "a number"], &["radius = 50.0"]),
        (with("radius = 25.0", "radius = nan"), 15, &["not a finite number"], &["radius = 50.0"]),
        (with("radius = 25.0", "radius = inf"), 15, &["not a finite number"], &[]),
        (with("radius = 25.0", "radius = 0"), 15, &["is zero"], &["between"]),
        (with("radius = 25.0", "radius = -25.0"), 15, &["is negative: -25"], &["mm"]),
        (with("[20, 20.0]", "[20]"), 6, &["1 numbers where it needs 2"], &["size = [50.0, 50.0]"]),
        (with("[64, 32]", "[64, 0]"), 12, &["too small"], &["between 1 and 32768"]),
        (
            with("[64, 32]", "[64, 32]\nppi = 264\ndiagonal_inches = 9"),
            14,
            &["more than once"],
            &["keep one"],
        ),
        (with("[64, 32]", "[64, 32]\nmodel = \"ipad-10\""), 13, &["`ipad-10`"], &["`ipad-10.9`"]),
        (with("[64, 32]", "[64, 32769]"), 12, &["too large"], &["32768"]),
        (with("[64, 32]", "[64, 32.5]"), 12, &["`resolution` holds a number"], &["1024"]),
        (with("ior = 1.49", "ior = 0.9"), 16, &["too small"], &["between 1 and 5"]),
        (with("ior = 1.49", "ior = 6"), 16, &["too large"], &["between 1 and 5"]),
        (material("glass = \"BK8\""), 16, &["unknown glass `BK8`"], &["`BK7`", "cauchy"]),
        (material("reflectance = 0.5"), 16, &["needs one of"], &["exactly one"]),
        (material("ior = 1.5, mirror = true"), 16, &["more than one"], &["keep exactly one"]),
        (material("ior = 1.5, reflectance = 0.5"), 16, &["no meaning"], &["mirror = true"]),
        (material("mirror = true, absorption = 0.5"), 16, &["absorbs nothing"], &["reflectance"]),
        (material("cauchy = [1.5, 0.9]"), 16, &["indices of"], &["between 1 and 5"]),
        (shape("kind = \"spere\", radius = 1.0"), 15, &["`spere`"], &["did you mean `sphere`"]),
        (shape("kind = \"cube\", size = [1, 1, 1]"), 15, &["`cube`"], &["did you mean `box`"]),
        (with(ball, "shape = \"ball\""), 15, &["a text"], &["{ kind = \"sphere\", ... }"]),
        (with("{ ior = 1.49 }", "\"Acrylic\""), 16, &["a text"], &["{ glass = \"acrylic\" }"]),
        (with("{ ior = 1.49 }", "\"mirror\""), 16, &["a text"], &["{ mirror = true }"]),
        (with("ior = 1.49", "n = 1.49"), 16, &["unknown key `n`"], &["did you mean `ior`"]),
        (
            with("[image]", "[image]\nrotation = 30"),
            6,
            &["a whole number"],
            &["[0.0, 30.0, 0.0]", "vertical"],
        ),
        (with("[20, 20.0]", "20"), 6, &["a list of 2 numbers"], &["size = [20.0, 20.0]"]),
        (
            with("[0.0, 0.0, 800.0]", "[0.0, 0.0 800.0]"),
            4,
            &["a comma is missing"],
            &["`0.0, 800.0`"],
        ),
        (
            shape("kind = \"sphere\" radius = 25.0"),
            15,
            &["a comma is missing"],
            &["`\"sphere\", radius`"],
        ),
        (shape("radius = 1.0"), 15, &["lacks the key `kind`"], &["`sphere`"]),
        (shape("kind = \"plane\", size = [1, 1]"), 16, &["no inside"], &["mirror = true"]),
        (
            shape("kind = \"mesh\", file = \"a.obj\", unit = \"inch\""),
            15,
            &["`unit` cannot be `inch`"],
            &["did you mean `in`", "`cm`"],
        ),
        (
            shape("kind = \"height-field\", size = [1, 1], amplitude = 1, samples = [[0, 0], [0]]"),
            15,
            &["a row of `samples` has 1"],
            &["equally long"],
        ),
        (
            shape("kind = \"height-field\", size = [1, 1], amplitude = 1"),
            15,
            &["needs one of `file`, `samples`"],
            &[],
        ),
        (
            shape(
                "kind = \"height-field\", size = [1, 1], amplitude = 1, samples = [[0, 0], [0, -1]]",
            ),
            15,
            &["reaches down to -1"],
            &["depth of more than 1"],
        ),
        (with("name = \"Good\"", "max_interactions = 0"), 2, &["too small"], &["between 1"]),
        (with("radius = 25.0", "radius = 2.5cm"), 15, &[], &["write `radius = 25.0`"]),
        (
            with("position = [0.0, 0.0, 800.0]", "position = 800 mm"),
            4,
            &[],
            &["write `position = 800.0`"],
        ),
        (with("[image]", "[image"), 5, &[], &["TOML"]),
        (
            with("rotation = [-45.0", "pitch = 1.0\nrotation = [-45.0"),
            9,
            &["ideal plate"],
            &["slit-mirror"],
        ),
        (
            with("rotation = [-45.0", "rotation = [135.0"),
            9,
            &["plate faces away"],
            &["[-45.0, 0.0, 0.0]"],
        ),
        (with("800.0]", "-800.0]"), 4, &["image faces away"], &["+z"]),
        (with("800.0]", "20.0]"), 4, &["inside the element `ball`"], &["move the viewpoint"]),
        (
            with("rotation = [-45.0", "rotation = [-100.0"),
            9,
            &["plate faces away"],
            &["[80.0, 0.0, 0.0]"],
        ),
        (
            with("position = [0.0, 0.0, 800.0]", "position = [0.0, -900.0, 700.0]"),
            4,
            &["behind the plate"],
            &["+z"],
        ),
        (
            with("[64, 32]", "[64, 32]\nposition = [0, 100, 0]"),
            13,
            &["same side of the plate"],
            &["behind the plate"],
        ),
    ];
    for (text, line, message, help) in cases {
        let error = toml(&text).expect_err(&text);
        assert!(
            error.place.starts_with(&format!("test.toml:{line}:")),
            "{} instead of line {line} for {text}",
            error.place
        );
        for word in message {
            assert!(error.message.contains(word), "{word:?} is not in {:?}", error.message);
        }
        for word in help {
            assert!(error.help.contains(word), "{word:?} is not in {:?}", error.help);
        }
        assert!(!error.help.is_empty() && error.source_code().is_some());
    }
}

#[test]
fn the_span_is_the_offending_text() {
    let text = with("radius = 25.0", "radius = \"5 cm\"");
    let error = toml(&text).unwrap_err();
    assert_eq!(&text[error.span().unwrap()], "\"5 cm\"");
    let json = "{\n  \"name\": 5, \"näme\": 1}";
    let error = parse(json, "a.json", Format::Json).unwrap_err();
    let all: Vec<&SceneError> = std::iter::once(&error).chain(&error.others).collect();
    let named = all.iter().find(|e| e.message.contains("`name`")).unwrap();
    assert_eq!(named.place, "a.json:2:11");
    assert_eq!(&json[named.span().unwrap()], "5");
    assert!(all.iter().any(|e| e.message.contains("`näme`")));
}

#[test]
fn a_byte_order_mark_is_no_mistake() {
    assert_eq!(toml(&format!("\u{feff}{GOOD}")).unwrap(), toml(GOOD).unwrap());
    let json = parse(&format!("\u{feff}{JSON}"), "a.json", Format::Json).unwrap();
    assert_eq!(json, parse(JSON, "a.json", Format::Json).unwrap());
}

#[test]
fn every_fault_of_a_file_is_reported() {
    let text = with("radius = 25.0", "radius = 0.0").replace("[64, 32]", "[0, 32]");
    let error = toml(&text).unwrap_err();
    assert_eq!(error.others.len(), 1);
    assert!(error.place.contains(":12:") && error.others[0].place.contains(":15:"));
}

#[test]
fn json_is_strict() {
    for (text, word) in [
        ("{\"a\": 1, \"a\": 2}", "twice"),
        ("[1]", "object"),
        ("", "empty"),
        ("{\"a\": NaN}", ""),
        ("{\"a\": 1,}", ""),
        ("{\"viewpoint\": null}", ""),
    ] {
        let error = parse(text, "a.json", Format::Json).unwrap_err();
        assert!(error.to_string().starts_with("a.json"), "{error}");
        assert!(error.message.contains(word), "{text}: {}", error.message);
    }
}

/// Viewpoints just outside and just inside of each solid, from its equation.
#[test]
fn viewpoints_inside_solids_are_refused() {
    for (shape, inside, outside) in [
        ("kind = \"box\", size = [10, 10, 100]", 49.9, 50.1),
        ("kind = \"ellipsoid\", radii = [1, 2, 30]", 29.9, 30.1),
        ("kind = \"cylinder\", radius = 40, height = 10", 39.9, 40.1),
        // Half way up, the radius is the mean of 10 and 30.
        ("kind = \"cone\", radius = 30, top_radius = 10, height = 10", 19.9, 20.1),
        // A roof of 0.75 * 8 = 6 half way from 0.5 to 1 at the middle.
        (
            "kind = \"height-field\", size = [4, 4], amplitude = 8, samples = [[1, 1], [0.5, 0.5]]",
            5.9,
            6.1,
        ),
    ] {
        let text = with("kind = \"sphere\", radius = 25.0", shape);
        let at = |z: f64| text.replace("800.0]", &format!("{z:?}]"));
        let error = toml(&at(inside)).expect_err(shape);
        assert!(error.message.contains("inside"), "{error}");
        toml(&at(outside)).unwrap_or_else(|e| panic!("{shape}: {e}"));
    }
}

#[test]
fn display_without_element_is_the_image_through_the_plate() {
    // By hand: the plate's plane is y + z = -150; the image's centre lies 150 / sqrt 2 before it, so the
    // display's is (0, -150, -150). Up turns to -z, the normal faces the plate: up.
    let placed = toml(GOOD).unwrap().display_rectangle();
    let near = |a: Vec3, b: [f64; 3]| (a - Vec3::from_array(b)).length() < 1e-12 * 150.0;
    assert!(near(placed.frame.origin, [0.0, -150.0, -150.0]), "{placed:?}");
    assert!(near(placed.frame.axes[0], [1.0, 0.0, 0.0]));
    assert!(near(placed.frame.axes[1], [0.0, 0.0, -1.0]));
    assert!(near(placed.frame.axes[2], [0.0, 1.0, 0.0]));
    assert_eq!(placed.size, [20.0, 20.0]);
}

#[test]
fn display_behind_a_mirror_runs_against_the_image() {
    // By hand: an image at height 30 on a level mirror has its mirror image at -30, upside down; through the
    // upright plate at z = -200 that stands at z = -400; its front faces +z, so x = (-y) cross z = -x.
    let path = scenes().join("paper/bent-mirror-convex.toml");
    let scene = load(&path).unwrap().scene;
    let placed = scene.display_rectangle();
    let near = |a: Vec3, b: [f64; 3]| (a - Vec3::from_array(b)).length() < 1e-12 * 400.0;
    assert!(near(placed.frame.origin, [0.0, -30.0, -400.0]), "{placed:?}");
    assert!(near(placed.frame.axes[0], [-1.0, 0.0, 0.0]));
    assert!(near(placed.frame.axes[1], [0.0, -1.0, 0.0]));
    assert!(near(placed.frame.axes[2], [0.0, 0.0, 1.0]));
}

proptest! {
    /// The line identity without elements: the ray from the viewpoint through any image point, turned
    /// by the plate, meets the display at that very st.
    #[test]
    fn without_elements_every_pixel_shows_at_its_own_place(
        u in 0.0..1.0, v in 0.0..1.0, tilt in -20.0..20.0, turn in -20.0..20.0, roll in -180.0..180.0,
        plate in -65.0..-25.0, eye in (-100.0..100.0, -100.0..100.0, 300.0..900.0),
    ) {
        let mut scene = toml(GOOD).unwrap();
        scene.elements.clear();
        scene.image.pose.rotation = [tilt, turn, roll];
        scene.plate.rectangle.pose.rotation = [plate, turn, tilt];
        let eye = Vec3::new(eye.0, eye.1, eye.2);
        let [w, h] = scene.image.size;
        let local = Vec3::new((u - 0.5) * w, (v - 0.5) * h, 0.0);
        let point = scene.image.pose.frame().to_world(local);
        let d = point - eye;
        let plate = scene.plate.rectangle.pose.frame();
        let n = plate.normal();
        let hit = eye + d * ((plate.origin - eye).dot(n) / d.dot(n));
        let out = n * (2.0 * d.dot(n)) - d;
        let display = scene.display_rectangle();
        let m = display.frame.normal();
        let end = hit + out * ((display.frame.origin - hit).dot(m) / out.dot(m));
        let st = display.frame.to_local(end);
        // Lengths of hundreds of mm, grazing angles to 1 in 10: 1e-10 is a thousand ulp.
        prop_assert!((st - local).length() < 1e-10, "{st:?} is not {local:?}");
    }

    #[test]
    fn what_is_saved_reads_back(scene in scene_strategy()) {
        let text = to_toml(&scene);
        let (read, _) = parse_with_places(&text, "saved.toml", Format::Toml)
            .map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        prop_assert_eq!(read, scene);
    }

    #[test]
    fn any_text_is_read_or_refused_by_name(text in "\\PC*", json: bool) {
        refused_by_name(&text, json)?;
    }

    /// A valid file with some bytes changed, cut or doubled.
    #[test]
    fn any_damage_is_read_or_refused_by_name(
        json: bool,
        cuts in proptest::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..4u8, any::<char>()), 1..5),
    ) {
        let mut text: Vec<char> = if json { JSON.chars().collect() } else { GOOD.chars().collect() };
        for (a, b, what, c) in cuts {
            let (a, b) = (a.index(text.len()), b.index(text.len()));
            match what {
                0 => text[a] = c,
                1 => text.truncate(a.max(1)),
                2 => { let part = text[a.min(b)..a.max(b)].to_vec(); text.splice(a..a, part); }
                _ => { text.remove(a); if text.is_empty() { text.push(' ') } }
            }
        }
        refused_by_name(&text.into_iter().collect::<String>(), json)?;
    }
}

const JSON: &str = r#"{"viewpoint":{"position":[0,0,800]},"image":{"size":[20,20]},"plate":
{"position":[0,0,-150],"rotation":[-45,0,0],"size":[488,488]},"element":[{"shape":{"kind":"sphere","radius":25},
"material":{"ior":1.49}}]}"#;

fn refused_by_name(text: &str, json: bool) -> Result<(), TestCaseError> {
    let format = if json { Format::Json } else { Format::Toml };
    if let Err(error) = parse(text, "some.file", format) {
        prop_assert!(error.to_string().starts_with("some.file"), "{}", error);
        prop_assert!(!error.help.is_empty());
        // The whole message stays readable whatever the file holds.
        prop_assert!(error.to_string().len() < 2000, "{}", error);
    }
    Ok(())
}

#[test]
fn depth_and_size_do_not_overwhelm() {
    for text in ["[".repeat(100_000), "a=".to_owned() + &"[".repeat(100_000)] {
        assert!(toml(&text).is_err());
        assert!(parse(&text, "a.json", Format::Json).is_err());
    }
    let json = "{\"a\":".repeat(100_000);
    assert!(parse(&json, "a.json", Format::Json).is_err());
    let many: String = (0..50_000).map(|i| format!("k{i} = 1\n")).collect();
    assert!(toml(&many).unwrap_err().others.len() < 100);
}

/// The good scene with the ball replaced by the cow of the examples, or by another file.
fn with_mesh(folder: &Path, file: &Path) -> PathBuf {
    let shape = format!("kind = \"mesh\", file = '{}', scale = 40", file.display());
    let path = folder.join("mesh.toml");
    std::fs::write(&path, with("kind = \"sphere\", radius = 25.0", &shape)).unwrap();
    path
}

#[test]
fn a_mesh_comes_with_the_scene_in_millimetres() {
    let folder = tempfile::tempdir().unwrap();
    let spot = std::fs::canonicalize(scenes().join("meshes/spot.obj")).unwrap();
    let path = with_mesh(folder.path(), &spot);
    let loaded = load(&path).unwrap();
    let Asset::Mesh { mesh, .. } = &loaded.assets[0] else { panic!("no mesh") };
    let [low, high] = mesh.bounds();
    // The file's own height is 0.953646 + 0.736784.
    assert!((high.y - low.y - 40.0 * 1.69043).abs() < 1e-9);
    assert_eq!(mesh.normals.as_ref().unwrap().len(), mesh.triangles.len());
    assert!(loaded.notes.iter().any(|note| note.contains("normals: smooth up to 30 degrees")));

    // An eye in the cow's middle.
    let text = std::fs::read_to_string(&path).unwrap().replace("800.0]", "12.0]");
    std::fs::write(&path, text).unwrap();
    let error = load(&path).unwrap_err();
    assert!(error.message.contains("inside the element"), "{error}");
}

#[test]
fn what_is_wrong_with_a_mesh_is_said_at_the_scene_s_line() {
    let folder = tempfile::tempdir().unwrap();
    let spot = std::fs::read_to_string(scenes().join("meshes/spot.obj")).unwrap();
    let cut = &spot[..spot.len() - 200];
    std::fs::write(folder.path().join("cut.obj"), cut).unwrap();
    let error = load(&with_mesh(folder.path(), Path::new("cut.obj"))).unwrap_err();
    assert!(error.place.contains("mesh.toml:15:"), "{error}");
    assert!(error.message.contains("cut.obj") && error.message.contains("face"), "{error}");

    let flipped = spot.replacen("f ", "f 1 2 3\nf ", 1);
    std::fs::write(folder.path().join("extra.obj"), flipped).unwrap();
    let error = load(&with_mesh(folder.path(), Path::new("extra.obj"))).unwrap_err();
    assert!(error.message.contains("face 1 (line"), "{error}");

    let error = load(&with_mesh(folder.path(), Path::new("none.ply"))).unwrap_err();
    assert!(error.message.contains("none.ply"), "{error}");
}

#[test]
fn scene_files_that_cannot_be_read_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.toml");
    let error = load(&missing).unwrap_err();
    assert_eq!(error.place, missing.display().to_string());
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, b"name = 1\nname = \xff\n").unwrap();
    let error = load(&binary).unwrap_err();
    assert!(error.message.contains("line 2") && error.message.contains("UTF-8"), "{error}");
    assert!(load(folder.path()).is_err());
}

/// Writes a picture and loads the good scene with a height-field of it.
fn with_heights(picture: &image::DynamicImage, name: &str) -> Result<Loaded, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    picture.save(folder.path().join(name)).unwrap();
    let shape = format!("kind = \"height-field\", file = '{name}', size = [9, 9], amplitude = 2");
    let text = with("kind = \"sphere\", radius = 25.0", &shape);
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    load(&path)
}

#[test]
fn heights_are_read_from_pictures() {
    use image::{DynamicImage, ImageBuffer, Luma, Rgb};
    let eight = ImageBuffer::from_fn(3, 2, |x, y| Luma([(100 * y + 50 * x) as u8]));
    let sixteen = ImageBuffer::from_fn(3, 2, |x, y| Luma([(10_000 * y + 1_000 * x) as u16]));
    let float = ImageBuffer::from_fn(3, 2, |x, y| Rgb([y as f32 * 2.0 - x as f32 * 0.25; 3]));
    let expected = |f: &dyn Fn(f64, f64) -> f64| {
        (0..2)
            .map(|y| (0..3).map(|x| f(f64::from(x), f64::from(y))).collect::<Vec<f64>>())
            .collect::<Vec<_>>()
    };
    let rows = |loaded: Loaded| match &loaded.assets[0] {
        Asset::Heights(heights) => heights.rows().to_vec(),
        other => panic!("{other:?}"),
    };
    let read = with_heights(&DynamicImage::ImageLuma8(eight), "a.png").unwrap();
    assert_eq!(rows(read), expected(&|x, y| (100.0 * y + 50.0 * x) / 255.0));
    let read = with_heights(&DynamicImage::ImageLuma16(sixteen), "a.png").unwrap();
    assert_eq!(rows(read), expected(&|x, y| (1e4 * y + 1e3 * x) / 65535.0));
    let read = with_heights(&DynamicImage::ImageRgb32F(float.clone()), "a.exr").unwrap();
    assert_eq!(rows(read), expected(&|x, y| y * 2.0 - x * 0.25));

    let colour = ImageBuffer::from_fn(2, 2, |x, _| Rgb([x as u8, 0, 0]));
    let error = with_heights(&DynamicImage::ImageRgb8(colour), "a.png").unwrap_err();
    assert!(error.message.contains("a.png") && error.message.contains("not grey"), "{error}");
    let mut hole = float;
    hole.put_pixel(2, 1, Rgb([f32::NAN; 3]));
    let error = with_heights(&DynamicImage::ImageRgb32F(hole), "a.exr").unwrap_err();
    assert!(error.message.contains("pixel [2, 1]"), "{error}");
    let thin = ImageBuffer::from_pixel(5, 1, Luma([7u8]));
    let error = with_heights(&DynamicImage::ImageLuma8(thin), "a.png").unwrap_err();
    assert!(error.message.contains("5 x 1"), "{error}");
}

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn scene_files() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = ["", "paper"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(scenes().join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    assert!(files.len() >= 13, "{files:?}");
    files
}

#[test]
fn every_example_loads() {
    for path in scene_files() {
        match load(&path) {
            Ok(loaded) => {
                assert_eq!(loaded.assets.len(), loaded.scene.elements.len());
            }
            Err(error) if path.ends_with("bunny.toml") => {
                // The mesh is not shipped: the message names it, at the line that asks for it.
                assert!(error.message.contains("bunny.ply"), "{error}");
                assert!(error.place.contains("bunny.toml:"), "{error}");
            }
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn every_example_follows_the_schema() {
    let schema = schema();
    jsonschema::meta::validate(&schema).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    for path in scene_files() {
        let text = std::fs::read_to_string(&path).unwrap();
        let value = json_of(&text);
        if let Err(error) = validator.validate(&value) {
            panic!("{}: {error}", path.display());
        }
    }
    for (from, to) in [
        ("radius = 25.0", "radus = 25.0"),
        ("radius = 25.0", "radius = 0.0"),
        ("size = [20, 20.0]\n", ""),
        ("ior = 1.49", "ior = 1.49, mirror = true"),
        ("[64, 32]", "[64]"),
    ] {
        assert!(!validator.is_valid(&json_of(&with(from, to))), "{to} is valid");
    }
}

/// TOML text as JSON, by the tree.
fn json_of(text: &str) -> serde_json::Value {
    fn value(node: &tree::Node) -> serde_json::Value {
        match &node.value {
            Value::Flag(f) => (*f).into(),
            Value::Integer(i) => (*i).into(),
            Value::Number(n) => (*n).into(),
            Value::Text(t) => t.clone().into(),
            Value::List(list) => list.iter().map(value).collect(),
            Value::Table(table) => table.iter().map(|e| (e.key.clone(), value(&e.node))).collect(),
            Value::Other(_) => serde_json::Value::Null,
        }
    }
    value(&tree::parse(&SceneText::new("a", text), text, Format::Toml).unwrap())
}

#[test]
fn schema_and_reader_know_the_same_keys() {
    // What a scene with everything in it is written with are the keys that the reader reads; the schema
    // has those, and the ones that stand for several of them.
    fn schema_keys(schema: &serde_json::Value, keys: &mut std::collections::BTreeSet<String>) {
        match schema {
            serde_json::Value::Object(object) => {
                if let Some(properties) = object.get("properties").and_then(|p| p.as_object()) {
                    keys.extend(properties.keys().cloned());
                }
                object.values().for_each(|v| schema_keys(v, keys));
            }
            serde_json::Value::Array(list) => list.iter().for_each(|v| schema_keys(v, keys)),
            _ => {}
        }
    }
    let mut known = std::collections::BTreeSet::new();
    schema_keys(&schema(), &mut known);
    let mut written = std::collections::BTreeSet::new();
    fn keys(node: &tree::Node, written: &mut std::collections::BTreeSet<String>) {
        match &node.value {
            Value::Table(table) => {
                for entry in table {
                    written.insert(entry.key.clone());
                    keys(&entry.node, written);
                }
            }
            Value::List(list) => list.iter().for_each(|n| keys(n, written)),
            _ => {}
        }
    }
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    for _ in 0..200 {
        let scene = scene_strategy().new_tree(&mut runner).unwrap().current();
        let text = to_toml(&scene);
        keys(&tree::parse(&SceneText::new("a", &text), &text, Format::Toml).unwrap(), &mut written);
    }
    written.insert("$schema".into());
    // A display described so is written by its size and resolution.
    written.extend(["diagonal_inches", "portrait", "ppi"].map(String::from));
    // Swept, hollow and opaque elements are written and read in tests of their own.
    let solids = "aspheric_back aspheric_front conic fill opaque open outline profile smooth thickness tube wall";
    written.extend(solids.split(' ').map(String::from));
    assert_eq!(known, written);
}

fn numbers<const N: usize>(range: std::ops::Range<f64>) -> impl Strategy<Value = [f64; N]> {
    proptest::collection::vec(range, N).prop_map(|v| v.try_into().unwrap())
}

fn pose_strategy() -> impl Strategy<Value = Pose> {
    (numbers::<3>(-1e6..1e6), numbers::<3>(-360.0..360.0))
        .prop_map(|(position, rotation)| Pose { position, rotation })
}

fn rectangle_strategy() -> impl Strategy<Value = Rectangle> {
    (pose_strategy(), numbers::<2>(1e-6..1e6)).prop_map(|(pose, size)| Rectangle { pose, size })
}

fn shape_strategy() -> impl Strategy<Value = Shape> {
    let length = 1e-6..1e6f64;
    let facing = prop_oneof![Just(Facing::Convex), Just(Facing::Concave)];
    prop_oneof![
        length.clone().prop_map(|radius| Shape::Sphere { radius }),
        numbers::<3>(length.clone()).prop_map(|radii| Shape::Ellipsoid { radii }),
        numbers::<3>(length.clone()).prop_map(|size| Shape::Box { size }),
        numbers::<2>(length.clone())
            .prop_map(|[radius, height]| Shape::Cylinder { radius, height }),
        numbers::<3>(length.clone()).prop_map(|[radius, top_radius, height]| Shape::Cone {
            radius,
            top_radius,
            height
        }),
        numbers::<2>(length.clone()).prop_map(|size| Shape::Plane { size }),
        (numbers::<3>(length.clone()), facing.clone()).prop_map(|([radius, a, b], facing)| {
            Shape::CylinderMirror { radius, size: [a, b], facing }
        }),
        (numbers::<2>(length.clone()), facing).prop_map(|([radius, diameter], facing)| {
            Shape::SphereMirror { radius, diameter, facing }
        }),
        (
            prop_oneof![
                "[^\\x00]{1,20}".prop_map(|f| HeightSource::File(f.into())),
                (2..4usize, 2..4usize)
                    .prop_flat_map(|(w, h)| proptest::collection::vec(
                        proptest::collection::vec(-10.0..10.0f64, w),
                        h
                    ))
                    .prop_map(HeightSource::Samples),
            ],
            numbers::<4>(length)
        )
            .prop_map(|(source, [w, h, amplitude, depth])| Shape::HeightField {
                source,
                size: [w, h],
                amplitude,
                depth
            }),
        (
            "[^\\x00]{1,20}",
            1e-9..1e9f64,
            prop::sample::select(tree::UNITS.to_vec()),
            prop_oneof![
                (0.0..180.0f64).prop_map(|crease_angle| Normals::Auto { crease_angle }),
                Just(Normals::Smooth),
                Just(Normals::Flat)
            ]
        )
            .prop_map(|(file, scale, (_, unit), normals)| Shape::Mesh {
                file: file.into(),
                scale,
                unit,
                normals
            }),
    ]
}

fn material_strategy() -> impl Strategy<Value = Material> {
    let index = prop_oneof![
        (1.0..5.0).prop_map(Index::Constant),
        (1.2..2.0, 0.0..0.02).prop_map(|(a, b)| Index::Cauchy(a, b)),
        prop::sample::select(crate::optics::glass::names().collect::<Vec<_>>())
            .prop_map(|name| Index::Glass(name.to_owned())),
        "[^\\x00]{1,20}".prop_map(|file| Index::File(file.into())),
    ];
    prop_oneof![
        (index, prop::option::of(numbers::<3>(0.0..10.0)))
            .prop_map(|(index, absorption)| Material::Refractive { index, absorption }),
        numbers::<3>(0.0..1.0).prop_map(|reflectance| Material::Mirror { reflectance }),
    ]
}

fn element_strategy() -> impl Strategy<Value = Element> {
    (any::<String>(), shape_strategy(), pose_strategy(), material_strategy(), any::<Option<i32>>())
        .prop_map(|(name, shape, pose, material, priority)| Element {
            name,
            shape,
            pose,
            material,
            priority,
            hollow: None,
        })
}

pub(super) fn scene_strategy() -> impl Strategy<Value = Scene> {
    let lengths = (numbers::<2>(1e-6..1e6), 0.0..1e3, 0.0..0.99);
    let slit = (lengths, -360.0..360.0, numbers::<3>(0.0..1.0), 1.0..5.0).prop_map(
        |(([pitch, layer_depth], cover_glass, share), azimuth, reflectance, ior)| {
            PlateModel::SlitMirror(SlitMirror {
                pitch,
                layer_depth,
                azimuth,
                reflectance,
                ior,
                absorption: reflectance.map(|r| 0.01 * r),
                cover_glass,
                mirror_thickness: share * pitch,
            })
        },
    );
    let display = (
        (1..=32768usize, 1..=32768usize),
        proptest::option::of(pose_strategy()),
        proptest::option::of(numbers::<2>(1e-6..1e6)),
        (
            numbers::<3>(380.0..780.0),
            prop_oneof![
                Just(ResponseSource::Srgb),
                (0.2..10.0).prop_map(ResponseSource::Gamma),
                Just(ResponseSource::File("bench.csv".into()))
            ],
            proptest::option::of(numbers::<3>(0.0..0.5)),
            proptest::option::of(1..=16u32),
        ),
    )
        .prop_map(|((w, h), pose, size, (wavelengths, response, black, bits))| {
            let emission = bits.map(|_| "angles.csv".into());
            let polarisation = bits.map(|bits| f64::from(bits) * 7.5 - 60.0);
            Display {
                resolution: [w, h],
                pose,
                size,
                wavelengths,
                response,
                emission,
                polarisation,
                black,
                bits,
            }
        });
    (
        (any::<String>(), 1..=10_000usize, any::<bool>(), numbers::<3>(-1e6..1e6)),
        rectangle_strategy(),
        (rectangle_strategy(), prop_oneof![Just(PlateModel::Ideal), slit]),
        display,
        (
            proptest::collection::vec(element_strategy(), 0..4),
            proptest::option::of((pose_strategy(), numbers::<3>(-1e6..1e6))),
        ),
    )
        .prop_map(|(top, image, (rectangle, model), display, (elements, tracker))| Scene {
            name: top.0,
            max_interactions: top.1,
            follow_total_reflection: top.2,
            viewpoint: top.3,
            image,
            plate: Plate { rectangle, model, luminance: Some("bench.csv".into()) },
            display,
            elements,
            tracker: tracker.map(|(pose, offset)| Tracker { pose, offset }),
        })
}

/// A scene in memory, with nothing that a file would hold.
fn loaded(text: &str) -> Loaded {
    let (scene, places) = parse_with_places(text, "test.toml", Format::Toml).unwrap();
    with_files(scene, places, &InMemory::new()).unwrap()
}

#[test]
fn a_changed_scene_is_held_to_what_a_file_is_held_to() {
    // Each change of the scene in memory, and the change of the text that says the same.
    type Change = fn(&mut Scene);
    let ball = |to: &str| with("radius = 25.0", to);
    let cases: [(Change, String); 9] = [
        (|s| s.viewpoint = [0.0, 0.0, 20.0], with("800.0]", "20.0]")),
        (|s| s.viewpoint = [0.0, 0.0, -10.0], with("800.0]", "-10.0]")),
        (|s| s.viewpoint[0] = 2e6, with("[0.0, 0.0, 800.0]", "[2e6, 0.0, 800.0]")),
        (|s| s.viewpoint[1] = f64::NAN, with("[0.0, 0.0, 800.0]", "[0.0, nan, 800.0]")),
        (
            |s| s.plate.rectangle.pose.rotation[0] = 135.0,
            with("[-45.0, 0.0, 0.0]", "[135.0, 0.0, 0.0]"),
        ),
        (|s| s.image.size[0] = -1.0, with("[20, 20.0]", "[-1.0, 20.0]")),
        (|s| s.elements[0].shape = Shape::Sphere { radius: 0.0 }, ball("radius = 0.0")),
        (|s| s.elements[0].shape = Shape::Sphere { radius: 900.0 }, ball("radius = 900.0")),
        (
            |s| {
                s.elements[0].material =
                    Material::Refractive { index: Index::Constant(9.0), absorption: None }
            },
            with("ior = 1.49", "ior = 9.0"),
        ),
    ];
    let good = loaded(GOOD);
    validate(&good).unwrap();
    for (change, text) in cases {
        let mut changed = good.clone();
        change(&mut changed.scene);
        let (told, expected) = (validate(&changed).unwrap_err(), toml(&text).unwrap_err());
        assert_eq!((&told.message, &told.help), (&expected.message, &expected.help));
        // The line in the file that the scene came from.
        let line = |error: &SceneError| error.place.split(':').nth(1).map(str::to_owned);
        assert_eq!(line(&told), line(&expected), "{}", told.place);
    }
}

#[test]
fn an_eye_may_be_where_a_file_may_say_it_is() {
    let good = loaded(GOOD);
    let mut counts = [0, 0];
    // A grid over the set-up: before and behind the plate, the image and the ball, and in it.
    for i in 0..11 * 11 * 11 {
        let eye = [i % 11, i / 11 % 11, i / 121].map(|i| f64::from(i - 5) * 40.0 + 3.0);
        let written = toml(&with("[0.0, 0.0, 800.0]", &format!("{eye:?}"))).map_err(|e| e.message);
        let asked = validate_viewpoint(&good, Vec3::from_array(eye)).map_err(|e| e.message);
        counts[usize::from(asked.is_ok())] += 1;
        assert_eq!(asked, written.map(|_| ()), "{eye:?}");
    }
    assert!(counts.iter().all(|&count| count > 200), "{counts:?}");
    for wrong in [f64::NAN, f64::INFINITY, 2e6] {
        assert!(validate_viewpoint(&good, Vec3::new(0.0, wrong, 800.0)).is_err());
    }
}
