//! `midair orbit` and `midair eyebox`.

use super::{BALL, Bench, set_up, waves};
use midair::map::format::read_map;
use midair::picture::{Depth, read_still, write_still};

fn ball(bench: &Bench) {
    bench.write("ball.toml", set_up(&format!("[display]\nresolution = [200, 200]\n{BALL}")));
}

#[test]
fn walking_around_with_a_fixed_map_and_with_one_that_follows() {
    let bench = Bench::new();
    ball(&bench);
    let told = bench.json(&["orbit", "ball.toml", "--out", "out", "--step", "15", "--frames", "5"]);
    let views = told["views"].as_array().unwrap();
    assert_eq!(
        views.iter().map(|v| v["azimuth"].as_f64().unwrap()).collect::<Vec<_>>(),
        [-15.0, 0.0, 15.0]
    );
    let mean = |i: usize, which: &str| views[i][which]["exact"]["mean"].as_f64().unwrap();
    for i in 0..3 {
        // A map's own displacement is that of interpolation between its pixels.
        assert!(mean(i, "tracked") < 0.05, "{told}");
        // The view's height and the eye's are the same on both sides.
        assert!((mean(0, "fixed") - mean(2, "fixed")).abs() < 0.02);
    }
    assert!(mean(1, "fixed") < 0.05 && mean(0, "fixed") > 1.0, "{told}");
    let names = bench.names("out");
    for name in
        ["orbit.html", "orbit.json", "displacement.svg", "strip-fixed.png", "strip-tracked.png"]
    {
        assert!(names.iter().any(|n| n == name), "{names:?}");
    }
    let strip = read_still(&bench.path("out/strip-fixed.png")).unwrap().picture;
    assert_eq!((strip.width, strip.height), (3 * 200 + 2 * 6, 200));
    let film = std::process::Command::new("ffmpeg").arg("-version").output().is_ok();
    assert_eq!(names.iter().any(|n| n == "orbit.mp4"), film);
    let said = bench.refuse(&["orbit", "ball.toml", "--out", "o", "--from", "5", "--to", "-5"]);
    assert!(said.contains("--from"), "{said}");
}

#[test]
fn one_map_for_two_eyes_leaves_less_than_the_noses() {
    let bench = Bench::new();
    ball(&bench);
    write_still(&bench.path("p.png"), &waves(64, 64), Depth::Eight).unwrap();
    let told = bench.json(&[
        "eyebox",
        "ball.toml",
        "--out",
        "out",
        "--image",
        "p.png",
        "--size",
        "100x100",
    ]);
    assert_eq!(told["viewpoints"].as_array().unwrap().len(), 2);
    assert_eq!(told["viewpoints"][0]["position"][0], -31.5);
    let rms = |which: &str| told["all"][which].as_f64().unwrap();
    assert!(
        rms("compromise_rms_mm") > 0.0 && rms("compromise_rms_mm") < rms("single_rms_mm"),
        "{told}"
    );
    assert_eq!(bench.names("out"), ["display.png", "map.exr", "report.json"]);
    let map = read_map(&bench.path("out/map.exr"), None, None).unwrap().map;
    assert_eq!((map.width, map.height), (100, 100));
    let told = bench.json(&[
        "eyebox",
        "ball.toml",
        "--out",
        "r",
        "--region",
        "100x50",
        "--grid",
        "3x2",
        "--size",
        "50x50",
    ]);
    assert_eq!(told["viewpoints"].as_array().unwrap().len(), 6);
    let told = bench.json(&[
        "eyebox",
        "ball.toml",
        "--out",
        "v",
        "--viewpoint",
        "0,0,800",
        "--size",
        "50x50",
    ]);
    // One viewpoint, the scene's own: nothing remains but the rounding of a mean of one.
    assert!(told["viewpoints"][0]["compromise_mm"]["max"].as_f64().unwrap() < 1e-12);
    bench.refuse(&["eyebox", "ball.toml", "--out", "x", "--ipd", "63", "--region", "10x10"]);
}
