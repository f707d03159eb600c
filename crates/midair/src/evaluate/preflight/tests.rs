//! Each finding by a scene made for it, its remedy by following it, and the example scenes by what is known of them.

use super::*;
use crate::map::{Accuracy, formation, invert};
use crate::scene::{Format, InMemory, Loaded, SceneEdit, load, load_text};
use std::path::Path;

mod image;

/// The paper's bench around a cube of 50 mm; each pair of texts is one replacement.
fn scene(changes: &[(&str, &str)]) -> String {
    let bench = "name = \"Bench\"
[viewpoint]
position = [0.0, 0.0, 800.0]
[image]
position = [0.0, 0.0, 0.0]
size = [30.0, 30.0]
[plate]
position = [0.0, 0.0, -150.0]
rotation = [-45.0, 0.0, 0.0]
size = [488.0, 488.0]
[display]
resolution = [300, 300]
[[element]]
name = \"cube\"
shape = { kind = \"box\", size = [50.0, 50.0, 50.0] }
material = { ior = 1.49 }
";
    changes.iter().fold(bench.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "{from:?}");
        text.replace(from, to)
    })
}

fn found_in(loaded: &Loaded) -> Preflight {
    let setup = Setup::new(loaded).unwrap();
    let (map, _) = invert(&setup, Accuracy::default());
    let formation = formation(&setup, &map, setup.view_size(96));
    preflight(&setup, &loaded.scene, &map, &formation)
}

fn found(text: &str) -> Preflight {
    found_in(&load_text(text, "bench.toml", Format::Toml, &InMemory::new()).unwrap())
}

/// The faults and warnings that there are, by kind.
fn wrong(preflight: &Preflight) -> Vec<Kind> {
    let grave = preflight.findings.iter().filter(|f| f.severity != Severity::Note);
    grave.map(|f| f.kind).collect()
}

fn one(preflight: &Preflight, kind: Kind) -> &Finding {
    let mut of_kind = preflight.findings.iter().filter(|f| f.kind == kind);
    let finding = of_kind.next().unwrap_or_else(|| panic!("{kind:?}: {:?}", preflight.findings));
    assert!(of_kind.next().is_none(), "{kind:?} twice: {:?}", preflight.findings);
    finding
}

/// The scene's text with a finding's lines written into it.
fn followed(text: &str, finding: &Finding) -> String {
    assert!(!finding.lines.is_empty(), "{finding:?}");
    let mut edit = SceneEdit::new(text, "bench.toml", Format::Toml).unwrap();
    for line in &finding.lines {
        edit.set(&line.key, line.value.clone()).unwrap();
    }
    edit.text().to_owned()
}

/// Follows a finding's lines and looks again: this kind is gone, and nothing else has come.
fn cured(text: &str, kind: Kind) {
    let before = found(text);
    let text = followed(text, one(&before, kind));
    let after = wrong(&found(&text));
    assert!(!after.contains(&kind), "{text}\n{after:?}");
    let known = wrong(&before);
    assert!(after.iter().all(|k| known.contains(k)), "{known:?} became {after:?}: {text}");
}

#[test]
fn a_sound_bench_has_nothing_to_mend() {
    let preflight = found(&scene(&[("[300, 300]", "[300, 300]\nsize = [32.0, 32.0]")]));
    assert_eq!(wrong(&preflight), []);
    assert_eq!((preflight.floating.offset, preflight.floating.tilt), (Some(0.0), 0.0));
    assert!(preflight.display.is_none());
    // Notes remain: how much light, and how many pixels. 30 mm of the image lie on a little less of 32 mm, as the slab brings them nearer.
    let pixels = preflight.pixels;
    assert!((270 * 270..300 * 300).contains(&pixels.lit), "{pixels:?}");
    let Some([left, right]) = pixels.columns else { panic!() };
    assert_eq!(left, 299 - right);
}

#[test]
fn a_cube_in_the_plate_and_a_plate_that_stands_clear() {
    // At 45 degrees and 30 mm behind its middle the plate goes through a cube of 50 mm.
    let text = scene(&[("-150.0", "-30.0")]);
    let preflight = found(&text);
    let finding = one(&preflight, Kind::StandingIn);
    assert_eq!(finding.severity, Severity::Fault);
    assert!(finding.sentence.contains("\"cube\" and the plate"), "{}", finding.sentence);
    cured(&text, Kind::StandingIn);
    // The cube's corner line is 25 sqrt(2) mm from its middle and the plate's plane D / sqrt(2): they touch at D = 50.
    for (distance, stands_in) in [("-49.5", true), ("-50.5", false)] {
        let preflight = found(&scene(&[("-150.0", distance)]));
        assert_eq!(wrong(&preflight).contains(&Kind::StandingIn), stands_in, "{distance}");
    }
}

#[test]
fn a_display_in_the_cube_goes_to_its_place() {
    // Below the edge of a small plate, its front part in the cube.
    let text = scene(&[
        ("-150.0", "-60.0"),
        ("488.0, 488.0", "60.0, 60.0"),
        (
            "[300, 300]",
            "[300, 300]\nposition = [0.0, -24.0, -40.0]\nrotation = [-90.0, 0.0, 0.0]\nsize = [40.0, 40.0]",
        ),
    ]);
    let finding = one(&found(&text), Kind::StandingIn).clone();
    assert!(finding.sentence.contains("\"cube\" and the display"), "{}", finding.sentence);
    cured(&text, Kind::StandingIn);
}

#[test]
fn what_touches_does_not_stand_in_one_another() {
    // A cube on a mirror table, the image's lower edge on the table, the plate on its far edge.
    let text = "[viewpoint]\nposition = [0.0, 400.0, 700.0]\n[image]\nposition = [0.0, 15.0, 0.0]\nsize = [30.0, 30.0]\n\
        [plate]\nposition = [0.0, 150.0, -200.0]\nsize = [300.0, 300.0]\n[display]\nresolution = [128, 128]\n\
        [[element]]\nname = \"table\"\nshape = { kind = \"plane\", size = [400.0, 400.0] }\nrotation = [-90.0, 0.0, 0.0]\n\
        material = { mirror = true }\n[[element]]\nname = \"cube\"\nshape = { kind = \"box\", size = [50.0, 50.0, 50.0] }\n\
        position = [0.0, 25.0, 0.0]\nmaterial = { ior = 1.49 }\n";
    let kinds = wrong(&found(text));
    assert!(!kinds.contains(&Kind::StandingIn), "{kinds:?}");
    // Sunk by a millimetre: the cube in the table, and the image in it.
    let sunk = text
        .replace("[0.0, 25.0, 0.0]", "[0.0, 24.0, 0.0]")
        .replace("[0.0, 15.0, 0.0]", "[0.0, 14.0, 0.0]");
    let preflight = found(&sunk);
    let sentences: Vec<&str> = preflight
        .findings
        .iter()
        .filter(|f| f.kind == Kind::StandingIn)
        .map(|f| f.sentence.as_str())
        .collect();
    assert_eq!(sentences.len(), 2, "{sentences:?}");
    assert!(sentences.iter().any(|s| s.contains("image") && s.contains("table")));
    assert!(sentences.iter().any(|s| s.contains("cube") && s.contains("table")));
    let image =
        preflight.findings.iter().find(|f| f.sentence.starts_with("the image stands")).unwrap();
    let raised = found(&followed(&sunk, image));
    assert!(!raised.findings.iter().any(|f| f.sentence.starts_with("the image stands")));
}

#[test]
fn solids_that_cut_one_another_are_told_and_nested_ones_are_not() {
    let ball = |x: f64, radius: f64| {
        format!(
            "[[element]]\nname = \"my ball\"\nshape = {{ kind = \"sphere\", radius = {radius:?} }}\nposition = [{x:?}, 0.0, 0.0]\nmaterial = {{ ior = 1.33 }}\n"
        )
    };
    let with = |x: f64, radius: f64| scene(&[]) + &ball(x, radius);
    // Half out, wholly within, and beside: only the first cuts.
    for (x, radius, cuts) in [(25.0, 20.0, true), (0.0, 20.0, false), (45.5, 20.0, false)] {
        let kinds = wrong(&found(&with(x, radius)));
        assert_eq!(kinds.contains(&Kind::StandingIn), cuts, "{x} {kinds:?}");
    }
    cured(&with(25.0, 20.0), Kind::StandingIn);
}

#[test]
fn a_display_off_its_place_is_told_where_it_floats() {
    let display = |position: &str, rotation: &str| {
        scene(&[(
            "[300, 300]",
            &format!(
                "[300, 300]\nposition = {position}\nrotation = {rotation}\nsize = [32.0, 32.0]"
            ),
        )])
    };
    // Its place is (0, -150, -150), facing up. 50 mm lower its image floats 50 mm nearer to the viewer.
    for (position, rotation, offset, tilt) in [
        ("[0.0, -200.0, -150.0]", "[-90.0, 0.0, 0.0]", 50.0, 0.0),
        ("[0.0, -130.0, -150.0]", "[-90.0, 0.0, 0.0]", -20.0, 0.0),
        ("[0.0, -150.0, -150.0]", "[-80.0, 0.0, 0.0]", 0.0, 10.0),
    ] {
        let text = display(position, rotation);
        let preflight = found(&text);
        let floating = preflight.floating;
        assert!((floating.offset.unwrap() - offset).abs() < 1e-9, "{floating:?}");
        // An arc cosine near 1 has the square root of rounding: 1e-8 rad.
        assert!((floating.tilt - tilt).abs() < 1e-5, "{floating:?}");
        let sentence = &one(&preflight, Kind::OffPlace).sentence;
        assert_eq!(sentence.contains("50.0 mm before"), offset > 0.0, "{sentence}");
        assert_eq!(sentence.contains("20.0 mm behind"), offset < 0.0, "{sentence}");
        assert_eq!(sentence.contains("10.0 degrees"), tilt > 0.0, "{sentence}");
        cured(&text, Kind::OffPlace);
    }
    // Moved within its plane it floats where it should.
    let preflight = found(&display("[4.0, -150.0, -152.0]", "[-90.0, 0.0, 0.0]"));
    assert!(preflight.floating.is_in_place());
}

#[test]
fn a_plate_at_40_degrees_with_the_display_left_at_45s_is_told() {
    let text = scene(&[
        ("[-45.0", "[-40.0"),
        (
            "[300, 300]",
            "[300, 300]\nposition = [0.0, -150.0, -150.0]\nrotation = [-90.0, 0.0, 0.0]\nsize = [60.0, 60.0]",
        ),
    ]);
    let preflight = found(&text);
    // A plate turned by 5 degrees turns what it mirrors by 10.
    assert!((preflight.floating.tilt - 10.0).abs() < 1e-5, "{:?}", preflight.floating);
    cured(&text, Kind::OffPlace);
}

#[test]
fn lengths_in_another_unit_are_told_with_the_likely_one() {
    let inches = scene(&[("[488.0, 488.0]", "[19.2, 19.2]")]);
    let finding = one(&found(&inches), Kind::Unit).clone();
    let remedy = finding.remedy.unwrap();
    assert!(
        remedy.contains("centimetres (192 x 192 mm)") && remedy.contains("inches (487.68"),
        "{remedy}"
    );
    // All in centimetres: one finding for all.
    let all = "[viewpoint]\nposition = [0.0, 0.0, 80.0]\n[image]\nsize = [2.0, 2.0]\n[plate]\nposition = [0.0, 0.0, -15.0]\n\
        rotation = [-45.0, 0.0, 0.0]\nsize = [30.0, 30.0]\n[display]\nresolution = [64, 64]\n";
    let preflight = found(all);
    let finding = one(&preflight, Kind::Unit);
    assert!(finding.sentence.contains("measured in centimetres"), "{}", finding.sentence);
    // A mesh in metres.
    let mut text = String::from("OFF\n4 4 0\n");
    for corner in ["0 0 0", "0.05 0 0", "0 0.05 0", "0 0 0.05"] {
        text += corner;
        text += "\n";
    }
    text += "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mesh.off"), text).unwrap();
    let file = folder.path().join("scene.toml");
    let mesh = (
        "shape = { kind = \"box\", size = [50.0, 50.0, 50.0] }",
        "shape = { kind = \"mesh\", file = \"mesh.off\" }",
    );
    std::fs::write(&file, scene(&[mesh])).unwrap();
    let preflight = found_in(&load(&file).unwrap());
    let unit = one(&preflight, Kind::Unit);
    assert_eq!(unit.lines_as_toml(), "[[element]]   # cube.shape\nunit = \"m\"\n");
}

#[test]
fn an_eye_in_an_object_is_told_of_a_set_up_that_a_program_made() {
    let loaded = load_text(&scene(&[]), "bench.toml", Format::Toml, &InMemory::new()).unwrap();
    let setup =
        Setup::new(&loaded).unwrap().with_viewpoint(crate::geometry::Vec3::new(0.0, 0.0, 20.0));
    let found = object::findings(&setup);
    assert!(found.iter().any(|f| f.kind == Kind::EyeInside && f.severity == Severity::Fault));
}

fn example(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name)
}

/// What the example scenes are known to have: pixels that are not square, as their files say; images that stick out or reflect totally in a
/// mesh; displays of the image's size that an object's distortion asks more of.
#[test]
fn the_example_scenes_have_no_false_finding() {
    let mut looked_at = 0;
    let mut others = Vec::new();
    for (name, known) in [
        ("ball.toml", vec![]),
        ("ball-on-mirror.toml", vec![Kind::NotFormed]),
        ("glass-of-water.toml", vec![Kind::NotFormed]),
        ("lens.toml", vec![]),
        ("plate.toml", vec![]),
        ("spot.toml", vec![Kind::NotFormed, Kind::SticksOut]),
        ("water-surface.toml", vec![]),
        ("paper/bent-mirror-concave.toml", vec![Kind::PixelShape]),
        ("paper/bent-mirror-convex.toml", vec![Kind::PixelShape]),
        ("paper/bent-mirror-quality-concave.toml", vec![Kind::NotFormed, Kind::PixelShape]),
        ("paper/bent-mirror-quality-convex.toml", vec![Kind::PixelShape]),
        ("paper/cube.toml", vec![]),
        ("paper/cylinder.toml", vec![Kind::PixelShape]),
        ("paper/sphere.toml", vec![]),
    ] {
        let mut loaded = load(&example(name)).unwrap();
        // A quarter of the pixels along each side: a mesh's map takes long.
        loaded.scene.display.resolution = loaded.scene.display.resolution.map(|side| side / 4);
        let found = found_in(&loaded);
        let mut kinds = wrong(&found);
        kinds.dedup();
        if kinds != known {
            let grave = found.findings.iter().filter(|f| f.severity != Severity::Note);
            let told: Vec<&str> = grave.map(|f| f.sentence.as_str()).collect();
            others.push(format!("{name}: {told:?}"));
        }
        looked_at += 1;
    }
    assert!(others.is_empty(), "{others:#?}");
    assert_eq!(looked_at, 14);
}
