use super::super::tests::scene_strategy;
use super::super::{SceneEdit, parse};
use super::*;
use proptest::prelude::*;

/// As people write: comments, another order than ours, keys within one line, numbers in several forms.
const BENCH: &str = "\
# The bench in room 4.
name='Bench'   # its name
[plate] # ASKA3D
  size = [488, 488]
  rotation = [ -45, 0x0, 0.0 ]   # measured twice
  position = [0, 0, -150]
viewpoint.position = [0.0,
    0.0,      # level with the cube
    8e2]

[image]
size = [30, 30]

# The cube
[[element]]
shape = { kind = \"box\", size = [50, 50, 50] } # from the shop
name = \"cube\"
material = { ior = 1.49 } # acrylic
rotation = [0, 15.8, 0]

[[element]]
[element.shape]
kind = \"sphere\" # a marble
radius = 8
[element.material]
glass = \"N-BK7\"
# end
";

fn bench() -> SceneEdit {
    // A dotted key cannot stand in another block: it belongs to the top.
    let viewpoint = BENCH.find("viewpoint.").unwrap()..BENCH.find("\n[image]").unwrap();
    let text = format!("{}{}", &BENCH[viewpoint.clone()], BENCH.replace(&BENCH[viewpoint], ""));
    SceneEdit::new(&text, "bench.toml", Format::Toml).unwrap()
}

/// The edited text against the same done by hand: each pair of texts is one replacement.
fn expect(edit: &SceneEdit, replaced: &[(&str, &str)]) {
    let expected = replaced.iter().fold(bench().text().to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "{from:?}");
        text.replace(from, to)
    });
    assert_eq!(edit.text(), expected);
    assert_eq!(*edit.scene(), parse(&expected, "bench.toml", Format::Toml).unwrap());
}

#[test]
fn values_change_and_nothing_else() {
    let mut edit = bench();
    edit.set("viewpoint.position", [1.5, 0.0, 800.0]).unwrap();
    edit.set("element.cube.rotation.y", 16.0).unwrap();
    edit.set("element.1.shape.radius", 7.25).unwrap();
    edit.set("plate.rotation.2", -0.25).unwrap();
    edit.set("element[0].material.ior", 1.5).unwrap();
    edit.set("name", "Bench \"A\"").unwrap();
    expect(
        &edit,
        &[
            ("[0.0,\n    0.0,      # level", "[1.5,\n    0.0,      # level"),
            ("rotation = [0, 15.8, 0]", "rotation = [0, 16.0, 0]"),
            ("radius = 8\n", "radius = 7.25\n"),
            ("[ -45, 0x0, 0.0 ]   #", "[ -45, 0x0, -0.25 ]   #"),
            ("ior = 1.49 }", "ior = 1.5 }"),
            ("name='Bench'   # its", "name='Bench \"A\"'   # its"),
        ],
    );
}

#[test]
fn keys_and_blocks_that_are_left_out_are_added() {
    let mut edit = bench();
    // One number of a list that is left to its default.
    edit.set("element.sphere.position.x", 12.0).unwrap();
    edit.set("display.resolution", [640, 480]).unwrap();
    edit.set("tracker.offset", [0.0, -30.0, 0.0]).unwrap();
    let scene = edit.scene();
    assert_eq!(scene.elements[1].pose.position, [12.0, 0.0, 0.0]);
    assert_eq!(scene.display.resolution, [640, 480]);
    assert_eq!(scene.tracker.unwrap().offset, [0.0, -30.0, 0.0]);
    // What stood there stands there still, line by line and in its order.
    let mut lines = edit.text().lines();
    for line in bench().text().lines() {
        assert!(lines.any(|new| new == line), "{line:?} is gone:\n{}", edit.text());
    }
}

#[test]
fn json_keeps_its_layout() {
    let text = "{\n  \"viewpoint\": {\"position\": [0, 0.0,  8e2]},\n\t\"image\": { \"size\": [20, 20] },\n  \
                \"plate\": {\"size\": [90, 90], \"position\": [0, 0, -90]},\n  \
                \"element\": [{\"shape\": {\"kind\": \"sphere\", \"radius\": 5}, \"material\": {\"ior\": 1.5}}]\n}\n";
    let mut edit = SceneEdit::new(text, "a.json", Format::Json).unwrap();
    edit.set("viewpoint.position.x", 2.5).unwrap();
    edit.set("element.sphere.shape.radius", 6.0).unwrap();
    let expected = text.replace("[0, 0.0,  8e2]", "[2.5, 0.0,  8e2]");
    assert_eq!(edit.text(), expected.replace("\"radius\": 5", "\"radius\": 6.0"));
    edit.set("element.0.position.z", -1.0).unwrap();
    edit.set("tracker.position", [0.0, 300.0, 0.0]).unwrap();
    let scene = parse(edit.text(), "a.json", Format::Json).unwrap();
    assert_eq!(scene.elements[0].pose.position, [0.0, 0.0, -1.0]);
    assert_eq!(scene.tracker.unwrap().pose.position, [0.0, 300.0, 0.0]);
}

#[test]
fn what_cannot_be_set_is_told_and_leaves_the_text() {
    let mut edit = bench();
    let cases: [(&str, Setting, &[&str]); 11] = [
        ("element.cubo.rotation.x", 1.0.into(), &["no element cubo", "cube, sphere"]),
        ("element.2.rotation.x", 1.0.into(), &["no element 2"]),
        ("element", 1.0.into(), &["no element"]),
        ("viewpont.position", [0.0; 3].into(), &["`viewpont`", "`viewpoint`"]),
        ("viewpoint.position.w", 1.0.into(), &["`position`"]),
        ("viewpoint.position.3", 1.0.into(), &["the list has 3 numbers"]),
        ("viewpoint.position", [0.0; 2].into(), &["2 numbers where it needs 3"]),
        ("element.cube.material.ior", 0.5.into(), &["too small"]),
        ("element.cube.material.ior", f64::NAN.into(), &["not a finite number"]),
        ("display.position.x", 1.0.into(), &["`display.position.x`", "first"]),
        ("plate..size", [1.0; 2].into(), &["no path"]),
    ];
    for (path, value, parts) in cases {
        let error = edit.set(path, value).unwrap_err();
        let told = format!("{error} {}", error.help);
        assert!(parts.iter().all(|part| told.contains(part)), "{path}: {told}");
        assert!(told.contains("bench.toml"), "{told}");
    }
    assert_eq!(edit.text(), bench().text());
}

#[test]
fn elements_of_one_name_go_by_their_number() {
    let text = bench().text().replace("name = \"cube\"\n", "name = \"sphere\"\n");
    let mut edit = SceneEdit::new(&text, "bench.toml", Format::Toml).unwrap();
    let error = edit.set("element.sphere.rotation.x", 1.0).unwrap_err();
    assert!(error.message.contains("several elements"), "{error}");
    edit.set("element.1.rotation.x", 1.0).unwrap();
    assert_eq!(edit.scene().elements[1].pose.rotation[0], 1.0);
    let text = bench().text().replace("name = \"cube\"\n", "name = \"a.b [1]\"\n");
    let mut edit = SceneEdit::new(&text, "bench.toml", Format::Toml).unwrap();
    edit.set("element.\"a.b [1]\".rotation.x", 2.0).unwrap();
    assert_eq!(edit.scene().elements[0].pose.rotation[0], 2.0);
}

#[test]
fn a_changed_scene_goes_into_the_file() {
    let mut edit = bench();
    let mut scene = edit.scene().clone();
    scene.viewpoint[2] = 812.0;
    scene.elements[0].pose.rotation[1] = 15.9;
    edit.set_scene(&scene).unwrap();
    expect(&edit, &[("8e2]", "812.0]"), ("15.8", "15.9")]);
    // An absorption that stands beside the material stays there.
    let text = bench().text().replace("# acrylic\n", "# acrylic\nabsorption = 0.1 # grey\n");
    let mut edit = SceneEdit::new(&text, "bench.toml", Format::Toml).unwrap();
    let mut scene = edit.scene().clone();
    let crate::scene::model::Material::Refractive { absorption, .. } =
        &mut scene.elements[0].material
    else {
        panic!()
    };
    *absorption = Some([0.1, 0.2, 0.3]);
    edit.set_scene(&scene).unwrap();
    assert_eq!(edit.text(), text.replace("= 0.1 #", "= [0.1, 0.2, 0.3] #"));
    scene.elements.pop();
    assert!(edit.set_scene(&scene).unwrap_err().message.contains("other elements"));
}

proptest! {
    /// Any scene, with a comment after each line, becomes any other one with as many elements; the comments stay.
    #[test]
    fn any_scene_becomes_any_other(before in scene_strategy(), after in scene_strategy()) {
        let mut after = after;
        after.elements.extend(before.elements.iter().skip(after.elements.len()).cloned());
        after.elements.truncate(before.elements.len());
        // A unit without a name is written in millimetres.
        let mut number = 0;
        let commented: String = to_toml(&before)
            .lines()
            .map(|line| { number += 1; format!("{line} # note {number}\n") })
            .collect();
        let mut edit = SceneEdit::new(&commented, "a.toml", Format::Toml).unwrap();
        let after = parse_with_places(&to_toml(&after), "a.toml", Format::Toml).unwrap().0;
        edit.set_scene(&after).unwrap();
        prop_assert_eq!(edit.scene(), &after);
        // The comments of blocks, and of keys that every scene has.
        let stays = ["[", "name", "max_interactions", "follow", "resolution", "wavelengths", "shape", "material"];
        let kept = commented.lines().filter(|line| stays.iter().any(|key| line.starts_with(key)));
        let gone = |line: &&str| line.starts_with("[tracker]") && after.tracker.is_none();
        for line in kept.filter(|line| !gone(line)) {
            let note = &line[line.rfind("# note").unwrap()..];
            prop_assert!(edit.text().lines().any(|line| line.ends_with(note)), "{note}:\n{}", edit.text());
        }
    }
}

#[test]
fn values_are_read_as_they_were_written_or_by_default() {
    let edit = bench();
    let get = |path: &str| edit.get(path).unwrap();
    assert_eq!(get("viewpoint.position"), Some(Setting::from([0.0, 0.0, 800.0])));
    assert_eq!(get("plate.rotation.x"), Some(Setting::from(-45.0)));
    assert_eq!(get("element.cube.material.ior"), Some(Setting::from(1.49)));
    assert_eq!(get("element.1.material.glass"), Some(Setting::from("N-BK7")));
    assert_eq!(get("element.cube.shape.size[2]"), Some(Setting::from(50.0)));
    // By default; and what no default says.
    assert_eq!(get("display.resolution"), Some(Setting::from([1024i64, 1024])));
    assert_eq!(get("max_interactions"), Some(Setting::from(32i64)));
    assert_eq!(get("display.position"), None);
    for (path, unit) in [
        ("viewpoint.position.x", Some("mm")),
        ("element.cube.rotation.y", Some("degrees")),
        ("element.cube.material.ior", None),
        ("element.1.shape.radius", Some("mm")),
    ] {
        assert_eq!(edit.unit(path).unwrap(), unit, "{path}");
    }
    for (path, part) in [
        ("viewpoint.positon", "no such key"),
        ("element.cub.rotation", "the scene has cube"),
        ("viewpoint", "block"),
        ("element.cube", "block"),
        ("element.cube.rotation.3", "x, y and z"),
        ("name.x", "no list"),
        ("", "no path"),
    ] {
        let error = edit.get(path).unwrap_err();
        let told = format!("{error} {}", error.help);
        assert!(told.contains(part), "{path}: {told}");
    }
}

/// What is set is read back, for every key that a scene has.
#[test]
fn what_is_set_is_read_back() {
    let mut edit = bench();
    let mut read = 0;
    for (path, value) in [
        ("viewpoint.position", Setting::from([1.0, 2.0, 700.0])),
        ("element.cube.rotation.y", Setting::from(3.5)),
        ("display.resolution", Setting::from([64i64, 32])),
        ("follow_total_reflection", Setting::from(true)),
        ("element.0.priority", Setting::from(2i64)),
        ("display.gamma", Setting::from(2.2)),
        ("name", Setting::from("a \"name\"")),
    ] {
        edit.set(path, value.clone()).unwrap();
        assert_eq!(edit.get(path).unwrap(), Some(value), "{path}");
        read += 1;
    }
    assert_eq!(read, 7);
}
