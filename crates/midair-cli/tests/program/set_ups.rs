//! `midair new`, `midair check` and `midair draw`: from the bench to the scene and back.

use super::{Bench, scene, set_up};

#[test]
fn a_new_scene_passes_its_check_and_is_drawn() {
    let bench = Bench::new();
    let said = bench.succeed(&["new", "cube", "--display", "iPad 10.9", "--name", "Bench 4"]);
    assert!(
        said.contains("wrote scene.toml") && said.contains("midair check scene.toml"),
        "{said}"
    );
    let told = bench.json(&["check", "scene.toml", "--size", "590x410"]);
    assert_eq!(told["scene"], "Bench 4");
    let findings = told["findings"].as_array().unwrap();
    assert!(
        findings.iter().all(|f| f["severity"] == "note") && findings.len() >= 2,
        "{findings:#?}"
    );
    let said = bench.succeed(&["check", "scene.toml", "--size", "590x410"]);
    assert!(said.contains("nothing found that has to be mended"), "{said}");
    let told = bench.json(&["draw", "scene.toml", "--picture", "picture.svg"]);
    assert_eq!(told["courses"], 5);
    for file in ["drawing.svg", "picture.svg"] {
        let svg = std::fs::read_to_string(bench.path(file)).unwrap();
        assert!(
            svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"") && svg.contains("Bench 4")
        );
    }
}

#[test]
fn new_asks_for_what_it_needs_and_overwrites_nothing() {
    let bench = Bench::new();
    // Standard input is no terminal here: nobody can be asked.
    for (arguments, part) in [
        (&["new"][..], "cube, bottle, mirror, bunny"),
        (&["new", "cube", "--plate", "aska3d-499"], "did you mean aska3d-488?"),
        (&["new", "cube", "--display", "ipad-10"], "did you mean ipad-10.9?"),
        (&["new", "cube", "--object", "400"], "give 15 to 244 mm"),
        (&["new", "bunny"], "--mesh"),
    ] {
        let said = bench.refuse(arguments);
        // Long messages are wrapped.
        let said =
            said.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        assert!(said.contains(part), "{arguments:?}: {said}");
        assert!(!bench.path("scene.toml").exists());
    }
    bench.write("scene.toml", "mine");
    assert!(bench.refuse(&["new", "cube"]).contains("scene.toml"));
    assert_eq!(std::fs::read_to_string(bench.path("scene.toml")).unwrap(), "mine");
    let own = [
        "new",
        "mirror",
        "--out",
        "own.toml",
        "--plate",
        "300x250",
        "--display",
        "800x600@160x120",
    ];
    let told = bench.json(&own);
    assert_eq!(told["plate"]["size"], serde_json::json!([300.0, 250.0]));
    assert_eq!(told["display"]["resolution"], serde_json::json!([800, 600]));
    bench.succeed(&["check", "own.toml", "--size", "80x60"]);
}

#[test]
fn a_mesh_is_found_from_wherever_the_scene_lies() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("scenes")).unwrap();
    std::fs::copy(scene("meshes/spot.obj"), bench.path("cow.obj")).unwrap();
    for out in ["here.toml", "scenes/there.toml"] {
        bench.succeed(&["new", "bunny", "--mesh", "cow.obj", "--out", out]);
        let told = bench.json(&["draw", out, "--out", "cow.svg"]);
        assert!(told["courses"].as_u64().unwrap() <= 5);
    }
}

#[test]
fn check_tells_what_is_wrong_with_its_lines_in_words_and_in_json() {
    let bench = Bench::new();
    let cube = "[[element]]\nname = \"cube\"\nshape = { kind = \"box\", size = [50.0, 50.0, 50.0] }\nmaterial = { ior = 1.49 }\n";
    let text = set_up(&format!("[display]\nresolution = [300, 300]\nsize = [32.0, 32.0]\n{cube}"))
        .replace("-150.0", "-30.0");
    bench.write("crowded.toml", &text);
    let said = bench.succeed(&["check", "crowded.toml"]);
    let at = said.find("fault: \"cube\" and the plate stand in one another").expect(&said);
    assert!(said[at..].contains("\n    [plate]\n    position = [0.0, "), "{said}");
    assert!(said.contains("1 fault") && !said.contains("pixels are ok"), "{said}");
    let told = bench.json(&["check", "crowded.toml"]);
    let finding = &told["findings"][0];
    assert_eq!((&finding["kind"], &finding["severity"]), (&"standing-in".into(), &"fault".into()));
    assert_eq!(finding["lines"][0]["key"], "plate.position");
    assert!(finding["lines"][0]["value"][2].as_f64().unwrap() < -30.0, "{finding}");
    assert!(
        told["light"]["mean"].as_f64().unwrap() > 0.1 && told["light"]["assumed_plate"] == true
    );
    assert_eq!(told["image"]["floating"]["tilt"], 0.0);
    assert!(told["display"]["pixels"]["lit"].as_u64().unwrap() > 10_000);
}

#[test]
fn drawings_are_svg_and_nothing_else() {
    let bench = Bench::new();
    let said = bench.refuse(&["draw", &scene("ball.toml"), "--out", "drawing.png"]);
    assert!(said.contains("SVG"), "{said}");
    for name in
        ["spot.toml", "water-surface.toml", "paper/bent-mirror-concave.toml", "glass-of-water.toml"]
    {
        bench.succeed(&["draw", &scene(name), "--picture", "picture.svg"]);
    }
}

#[test]
fn patterns_are_the_displays_pixels_and_say_their_size() {
    let bench = Bench::new();
    bench.succeed(&["new", "cube", "--display", "800x600@160x120"]);
    for kind in ["lattice", "ruler", "registration", "grey", "white"] {
        let told = bench.json(&["pattern", kind, "scene.toml"]);
        assert_eq!(told["pixel_pitch_mm"], serde_json::json!([0.2, 0.2]));
        let bytes = std::fs::read(bench.path("pattern.png")).unwrap();
        // 5 pixels to the millimetre are 5000 to the metre.
        let at = bytes.windows(4).position(|w| w == b"pHYs").unwrap();
        assert_eq!(bytes[at + 4..at + 13], [0, 0, 0x13, 0x88, 0, 0, 0x13, 0x88, 1]);
        let picture = midair::picture::read_still(&bench.path("pattern.png")).unwrap().picture;
        assert_eq!((picture.width, picture.height), (800, 600));
        assert!(picture.pixels.iter().any(|p| p[0] > 0.9));
    }
}

#[test]
fn tolerances_name_the_measure_that_needs_most_care() {
    let bench = Bench::new();
    let told = bench.json(&["tolerance", &scene("paper/cube.toml"), "--out", "tolerance.svg"]);
    let shifts = told["shifts"].as_array().unwrap();
    // Eye, display and plate: 3, 6 and 6 measures; the cube 6 and its index.
    assert_eq!(shifts.len(), 22);
    // A degree of the plate turns the image, 150 mm off, by two: 5.2 mm, more than anything else.
    assert!(
        shifts[0]["part"] == "plate" && (shifts[0]["mean"].as_f64().unwrap() - 5.2).abs() < 0.3,
        "{}",
        shifts[0]
    );
    let said = bench.succeed(&["tolerance", &scene("paper/cube.toml")]);
    assert!(
        said.contains("cube, refractive index, 0.01") && said.contains("no effect: "),
        "{said}"
    );
    assert!(std::fs::read_to_string(bench.path("tolerance.svg")).unwrap().contains("turned about"));
}
