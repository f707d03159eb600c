//! What is wrong with a scene is named with its line and a remedy.

use super::*;

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
        assert!(!error.help.is_empty() && !error.text().is_empty());
    }
}

#[test]
fn the_span_is_the_offending_text() {
    let text = with("radius = 25.0", "radius = \"5 ells\"");
    let error = toml(&text).unwrap_err();
    assert_eq!(&text[error.span().unwrap()], "\"5 ells\"");
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
