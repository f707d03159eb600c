//! `midair calibrate`: from patterns and photographs to the scene as it really is.

use super::{Bench, scene};

/// The paper's cube with a display as coarse as small photographs show it.
fn coarse() -> String {
    let text = std::fs::read_to_string(scene("paper/cube.toml")).unwrap();
    text.replace("resolution = [1024, 1024]", "resolution = [256, 256]")
        .replace("size = [488.0, 488.0]", "size = [488.0, 488.0]\nmodel = \"slit-mirror\"")
}

#[test]
fn a_rehearsed_bench_is_calibrated_and_serves_the_other_commands() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("mine")).unwrap();
    bench.write("mine/cube.toml", coarse());
    let arguments = ["calibrate", "demo", "mine/cube.toml", "--width", "300", "--out", "rehearsal"];
    let told = bench.json(&arguments);
    let off = |which: &str| told["displacement_px_of_1024"][which]["mean"].as_f64().unwrap();
    // The closed loop: what the assumed scene leaves at the real bench, and what is left of it. A display pixel is four of 1024.
    assert!(off("assumed") > 10.0, "{told}");
    assert!(off("fitted") < 0.5 && off("model_free") < 4.0, "{}", told["displacement_px_of_1024"]);
    let rms = |key: &str| told["residual_px"][key].as_f64().unwrap();
    assert!(rms("rms") < 0.5 && rms("before") > rms("rms"), "{}", told["residual_px"]);
    let names = bench.names("rehearsal");
    for name in ["assumed.toml", "bench.toml", "calibration.json", "report.html", "scene.toml"] {
        assert!(names.iter().any(|known| known == name), "{names:?}");
    }
    // The fitted scene is a scene, with the user's own comments.
    let fitted = std::fs::read_to_string(bench.path("rehearsal/scene.toml")).unwrap();
    assert!(
        fitted.contains("# The paper's measurement of shape") && fitted.contains('±'),
        "{fitted}"
    );
    bench.succeed(&["check", "rehearsal/scene.toml", "--size", "32x32"]);

    // From the same photographs, by what was decoded of them alone, the same scene comes.
    bench.succeed(&["calibrate", "decode", "rehearsal/bench.toml", "--out", "decoded"]);
    let mut text = std::fs::read_to_string(bench.path("rehearsal/bench.toml")).unwrap();
    text = text.replace("scene = \"assumed.toml\"", "scene = \"rehearsal/assumed.toml\"");
    for state in ["empty", "object"] {
        for view in ["front", "right", "oblique"] {
            text = text.replace(
                &format!("{state} = \"{view}-{state}/\""),
                &format!("{state}_points = \"decoded/{view}-{state}.csv\""),
            );
        }
    }
    bench.write("points.toml", &text);
    let again = bench.json(&["calibrate", "fit", "points.toml", "--out", "fitted"]);
    for (a, b) in
        told["parameters"].as_array().unwrap().iter().zip(again["parameters"].as_array().unwrap())
    {
        assert_eq!(a["name"], b["name"]);
        let number = |p: &serde_json::Value, key: &str| p[key].as_f64().unwrap();
        // Points are written to a thousandth of a camera pixel.
        let off = (number(a, "value") - number(b, "value")).abs();
        assert!(off < 0.1 * number(a, "sigma"), "{a} {b}");
    }
    let map = bench.json(&[
        "calibrate",
        "map",
        "rehearsal/bench.toml",
        "--view",
        "right",
        "--out",
        "maps",
    ]);
    assert_eq!(map["size"], serde_json::json!([256, 256]));
    assert!(bench.names("maps").iter().any(|name| name == "map.exr"), "{map}");

    // What cannot be.
    let said = bench.refuse(&["calibrate", "map", "points.toml", "--out", "maps"]);
    assert!(said.contains("needs every pixel") && said.contains("object_points"), "{said}");
    let said =
        bench.refuse(&["calibrate", "map", "points.toml", "--view", "left", "--out", "maps"]);
    assert!(said.contains("`left`") && said.contains("front, right, oblique"), "{said}");
    let said =
        bench.refuse(&["calibrate", "fit", "points.toml", "--free", "sphere", "--out", "other"]);
    assert!(said.contains("`sphere`") && said.contains("cube"), "{said}");
    bench.write("decoded/front-object.csv", "x,y,s,t\n1,2,0.5,0.5\n");
    let said = bench.refuse(&["calibrate", "fit", "points.toml", "--out", "other"]);
    assert!(said.contains("`front`") && said.contains("12 are the least"), "{said}");
    // No scene file then.
    assert!(!bench.path("other").exists());
}

#[test]
fn patterns_are_drawn_in_the_display_s_own_pixels() {
    let bench = Bench::new();
    bench.write("cube.toml", coarse());
    let told = bench.json(&["calibrate", "patterns", "cube.toml", "--out", "patterns"]);
    let count = told["patterns"].as_u64().unwrap();
    let names = bench.names("patterns");
    assert!(names.iter().any(|name| name == "how-to.html"), "{names:?}");
    assert_eq!(names.iter().filter(|name| name.ends_with(".png")).count() as u64, count);
    let white = midair::picture::read_still(&bench.path("patterns/01-white.png")).unwrap();
    assert_eq!((white.picture.width, white.picture.height), (256, 256));
}
