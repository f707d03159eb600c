//! The proof itself: `midair report` on the paper's set-ups.

use super::{Bench, scene};

/// The promise, at the size that it is made for: 0.02 pixels, and SSIM of 0.99.
#[test]
fn the_view_of_the_compensated_image_is_the_reference() {
    let scenes = [
        "paper/cube.toml",
        "paper/cylinder.toml",
        "paper/sphere.toml",
        "paper/bent-mirror-convex.toml",
        "paper/bent-mirror-concave.toml",
    ];
    for name in scenes {
        let bench = Bench::new();
        let scene = scene(name);
        let told = bench.json(&[
            "report",
            &scene,
            "--out",
            "out",
            "--size",
            "1024x1024",
            "--splat-spp",
            "0",
        ]);
        let compensated = &told["lattice"]["compensated"];
        let uncompensated = &told["lattice"]["uncompensated"];
        println!("{name}: {compensated} {} {}", told["likeness"], told["compared_share"]);
        let measured = compensated["measured"]["mean"].as_f64().unwrap();
        let exact = compensated["exact"]["mean"].as_f64().unwrap();
        assert!(measured <= 0.02, "{name}: {told}");
        assert!(exact <= 0.02, "{name}: {told}");
        assert!(uncompensated["exact"]["mean"].as_f64().unwrap() > 100.0 * exact, "{name}: {told}");
        let ssim = told["likeness"]["compensated"]["ssim"].as_f64().unwrap();
        assert!(ssim >= 0.99, "{name}: {told}");
        let best = told["likeness"]["optimal"]["psnr_db"].as_f64().unwrap();
        assert!(best > told["likeness"]["compensated"]["psnr_db"].as_f64().unwrap(), "{name}");
        assert!(best > told["likeness"]["scattered"]["psnr_db"].as_f64().unwrap(), "{name}");
    }
}

#[test]
fn a_report_stands_on_its_own() {
    let bench = Bench::new();
    let said = bench.succeed(&[
        "report",
        &scene("ball.toml"),
        "--out",
        "out",
        "--size",
        "128x128",
        "--splat-spp",
        "3",
    ]);
    assert!(said.contains("report.html"), "{said}");
    let page = std::fs::read_to_string(bench.path("out/report.html")).unwrap();
    assert!(page.starts_with("<!doctype html>"));
    for wanted in [
        "Acrylic ball",
        "Compensated",
        "Uncompensated",
        "Reference",
        "splat",
        "ideal",
        "data:image/png",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
    for outside in ["src=\"http", "href=\"http", "url(http", "@import", "<script"] {
        assert!(!page.contains(outside), "{outside}");
    }
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(bench.path("out/report.json")).unwrap()).unwrap();
    let field = |key: &str| report["brightness"]["white_field"][key].as_f64().unwrap();
    // Fresnel's losses grow towards the ball's rim.
    assert!(field("uncompensated") > 1.02 && field("compensated") < 1.005, "{report:#}");
    assert!(report["fringes"].is_null());
    // As `check --stray` has it.
    let told = bench.json(&["check", &scene("ball.toml"), "--size", "128x128", "--stray", "s.png"]);
    assert_eq!(report["stray"], told["stray"]);
    for name in ["gain.png", "white-uncompensated.png", "white-compensated.png", "stray.png"] {
        assert!(bench.path("out").join(name).exists(), "{name}");
    }
    let splat = &report["splat"];
    assert_eq!(splat["rays"], 128 * 128 * 3);
    // Three samples a pixel miss many.
    assert!(splat["holes"].as_u64().unwrap() > 100, "{splat}");
    assert!(splat["rms_error"].as_f64().unwrap() > report["error_bound"].as_f64().unwrap());
}

#[test]
fn a_report_tells_how_wide_colour_fringes_are() {
    let bench = Bench::new();
    let scene = scene("spot.toml");
    let said =
        bench.succeed(&["report", &scene, "--out", "out", "--size", "96x96", "--splat-spp", "0"]);
    assert!(said.contains("colour fringes"), "{said}");
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(bench.path("out/report.json")).unwrap()).unwrap();
    let mean = |key: &str| report["fringes"][key]["mean"].as_f64().unwrap();
    // Crown glass and a curved body: a tenth of a pixel at this size, of which maps of 96 pixels leave little.
    assert!(mean("one_map") > 10.0 * mean("per_channel"), "{}", report["fringes"]);
    assert!(bench.path("out/fringes-per-channel.png").exists());
}
