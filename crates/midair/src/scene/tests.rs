//! The reader, the schema and the writer against each other and against what people get wrong.

use super::model::*;
use super::*;
use crate::geometry::Vec3;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use std::path::{Path, PathBuf};

mod beside;
mod examples;
mod mistakes;
mod properties;

use examples::scenes;
use properties::JSON;
pub(super) use properties::scene_strategy;

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
