//! `midair check`.

use super::{BALL, Bench, as_advised, scene, set_up};
use midair::picture::read_still;

#[test]
fn a_display_as_advised_covers_the_whole_image() {
    let bench = Bench::new();
    let cases = [
        set_up(&format!("[display]\nresolution = [64, 64]\n{BALL}")),
        // Too far to the left, turned in its plane.
        set_up(&format!(
            "[display]\nresolution = [64, 64]\nposition = [8.0, -150.0, -148.0]\n\
             rotation = [-90.0, 0.0, 25.0]\nsize = [15.0, 15.0]\n{BALL}"
        )),
        // Behind a mirror.
        std::fs::read_to_string(scene("ball-on-mirror.toml"))
            .unwrap()
            .replace("[display]", "[display]\n# as it is"),
    ];
    for text in cases {
        bench.write("before.toml", &text);
        let told = bench.json(&["check", "before.toml", "--size", "64x64"]);
        assert!(told["image"]["formed"].as_f64().unwrap() < 0.95, "{told}");
        assert!(!told["display"]["advice"].is_null(), "{told}");
        bench.write("after.toml", as_advised(&bench, &text));
        let told = bench.json(&["check", "after.toml", "--size", "64x64"]);
        assert_eq!(told["image"]["formed"], 1.0, "{told}");
        assert!(told["display"]["advice"].is_null());
    }
}

#[test]
fn what_is_not_formed_is_named_with_its_element() {
    let bench = Bench::new();
    // Through a cube turned by 45 degrees about the vertical, an eye far off to the side has light totally reflected.
    let cube = "[[element]]\nname = \"my cube\"\nshape = { kind = \"box\", size = [50.0, 50.0, 50.0] }\n\
                rotation = [0.0, 45.0, 0.0]\nmaterial = { ior = 1.49 }\n";
    let text = set_up(&format!("[display]\nresolution = [64, 64]\n{cube}"))
        .replace("size = [20.0, 20.0]", "size = [60.0, 60.0]");
    bench.write("cube.toml", text);
    let told = bench.json(&["check", "cube.toml"]);
    let image = &told["image"];
    let others = image["not_formed"].as_object().unwrap();
    let sum: f64 = others.values().map(|v| v.as_f64().unwrap()).sum();
    let formed = image["formed"].as_f64().unwrap() + image["folded"].as_f64().unwrap();
    assert!((sum + formed - 1.0).abs() < 1e-9, "{told}");
    let name = "total internal reflection in \"my cube\"";
    assert!(others[name].as_f64().unwrap() > 0.05, "{told}");
    let said = bench.succeed(&["check", "cube.toml"]);
    assert!(said.contains(name) && said.contains("check.png"), "{said}");
    let picture = read_still(&bench.path("check.png")).unwrap().picture;
    assert!(picture.width > 1000 && picture.height > 600);
}

#[test]
fn stray_images_are_placed_and_drawn_on_request() {
    let bench = Bench::new();
    let told = bench.json(&["check", &scene("ball.toml"), "--size", "64x64"]);
    // An ideal plate throws none.
    assert!(told["stray"].is_null(), "{told}");
    let told =
        bench.json(&["check", &scene("ball.toml"), "--size", "64x64", "--stray", "stray.png"]);
    let stray = &told["stray"];
    assert_eq!(stray["assumed_plate"], true);
    // The ball and the plate are symmetric about the middle: so are the two stray images.
    let covered = |kind: usize| stray["kinds"][kind]["covered"].as_f64().unwrap();
    assert!((covered(0) - covered(1)).abs() < 0.005 && covered(0) > 0.0, "{told}");
    assert!(stray["over_image_at_best"].as_f64() <= stray["over_image"].as_f64(), "{told}");
    let picture = read_still(&bench.path("stray.png")).unwrap().picture;
    // The view stands below the title, 384 pixels a side: the image in its middle, a quarter as wide; black around.
    let at = |x: usize, y: usize| picture.pixels[(y + 54) * picture.width + x + 24];
    assert!(at(192, 192)[1] > 0.1);
    assert!(at(2, 2)[1] == 0.0 && at(382, 382)[1] == 0.0);
    // Below stands what the colours mean.
    assert!(picture.height > 54 + 384 + 4 * 26 && picture.pixels[0][1] > 0.9);
}
