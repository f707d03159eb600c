//! The proof itself: `midair report` on the paper's set-ups.

use super::{Bench, scene};
use std::path::Path;

/// A photograph of the LIVE1 set where it is there.
fn photograph() -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/live1");
    let mut names: Vec<_> =
        std::fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path()).collect();
    names.retain(|path| {
        path.extension().is_some_and(|e| ["png", "bmp", "jpg"].iter().any(|k| e == *k))
    });
    names.sort();
    names.first().map(|path| path.display().to_string())
}

/// The promise, at the size that it is made for: 0.02 pixels, and SSIM of 0.99.
#[test]
fn the_view_of_the_compensated_image_is_the_reference() {
    let photograph = photograph();
    if photograph.is_none() {
        println!("no photographs in ../shared/data/live1: the built-in picture stands in for them");
    }
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
        let mut arguments =
            vec!["report", &scene, "--out", "out", "--size", "1024x1024", "--splat-spp", "0"];
        if let Some(photograph) = &photograph {
            arguments.extend(["--image", photograph]);
        }
        let told = bench.json(&arguments);
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
    let splat = &report["splat"];
    assert_eq!(splat["rays"], 128 * 128 * 3);
    // Three samples a pixel miss many.
    assert!(splat["holes"].as_u64().unwrap() > 100, "{splat}");
    assert!(splat["rms_error"].as_f64().unwrap() > report["error_bound"].as_f64().unwrap());
}
