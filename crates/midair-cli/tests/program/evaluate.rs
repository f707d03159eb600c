//! `midair evaluate --paper`, at a handful of paths.

use super::{Bench, scene, waves};
use midair::picture::{Depth, write_still};

#[test]
fn the_papers_evaluation_is_redone_in_one_report() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("photos")).unwrap();
    write_still(&bench.path("photos/waves.png"), &waves(90, 90), Depth::Eight).unwrap();
    bench.write("photos/notes.txt", "not a picture");
    let arguments = ["evaluate", "--paper", "--images", "photos", "--out", "out", "--quick"];
    let arguments = [&arguments[..], &["--plate", "ideal", "--spp", "8", "--json"]].concat();
    let run = |cache: &str| {
        bench.command(&arguments).env("MIDAIR_CACHE", bench.path(cache)).output().unwrap()
    };
    let output = run("empty");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    // Three surfaces; the cube's slab shifts by what the closed form says: 4.7 mm of 16.8 pixels.
    assert_eq!(told["quality"].as_array().unwrap().len(), 3);
    let cube = &told["shapes"][0];
    assert_eq!(cube["surface"], "cube");
    let without = cube["views"][1]["exact"]["without"].as_f64().unwrap();
    assert!((without - 78.9).abs() < 2.0, "{cube}");
    // What noise alone leaves stands beside every likeness, and no view beats it but by noise.
    for row in told["quality"].as_array().unwrap() {
        let of = |condition: &str| row[condition]["ssim"].as_f64().unwrap();
        assert!(of("floor") > of("without") && of("floor") <= 1.0, "{row}");
    }
    for one in told["means"].as_array().unwrap() {
        let blurred = &one["mean"]["blurred_ssim"];
        assert!(blurred["with"].as_f64() > blurred["without"].as_f64(), "{one}");
        assert_eq!(blurred["better_with"], 1);
    }
    assert_eq!(told["published"]["displacement"][0]["without"], 78.87);
    // Without weights the report says so and goes on.
    assert!(told["quality"][0]["with"]["lpips"].is_null());
    let page = std::fs::read_to_string(bench.path("out/report.html")).unwrap();
    assert!(page.contains("LPIPS was not computed") && page.contains("midair weights"));
    // It stands on its own, and says what it takes for granted and where it differs.
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http"));
    for heading in ["Assumptions", "Where this differs from the paper", "Not measured"] {
        assert!(page.contains(heading), "{heading}");
    }
    let names = bench.names("out");
    assert!(names.contains(&"strip-cylinder-waves.png".to_owned()), "{names:?}");
    assert!(names.contains(&"lattice-cube-15.png".to_owned()), "{names:?}");
}

#[test]
fn a_folder_without_pictures_and_damaged_weights_are_refused() {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("photos")).unwrap();
    std::fs::create_dir_all(bench.path("cache/lpips")).unwrap();
    let arguments = ["evaluate", "--paper", "--images", "photos", "--out", "out"];
    let said = bench.refuse(&arguments);
    assert!(said.contains("photos") && said.contains("no picture"), "{said}");
    write_still(&bench.path("photos/waves.png"), &waves(30, 20), Depth::Eight).unwrap();
    bench.write("cache/lpips/lpips_alex.safetensors", b"nothing");
    let output =
        bench.command(&arguments).env("MIDAIR_CACHE", bench.path("cache")).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("lpips_alex.safetensors") && said.contains("midair weights"), "{said}");
    assert!(!bench.path("out").exists());
    assert!(bench.refuse(&["evaluate", "--images", "photos", "--out", "out"]).contains("SCENE"));
}

#[test]
fn a_scene_of_ones_own_is_evaluated_at_the_azimuths_that_are_asked_for_and_gone_on_with() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("photos")).unwrap();
    write_still(&bench.path("photos/a.png"), &waves(60, 60), Depth::Eight).unwrap();
    let scene = scene("paper/cube.toml");
    let fixed = ["evaluate", &scene, "--images", "photos", "--out", "out", "--quick"];
    let arguments = [&fixed[..], &["--spp", "4", "--azimuths", "-10,2.5"]].concat();
    let run = |more: &[&str]| {
        let all = [&arguments[..], more].concat();
        let output = bench.command(&all).env("MIDAIR_CACHE", bench.path("empty")).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let told: serde_json::Value = serde_json::from_str(&run(&["--json"])).unwrap();
    // A slab of 50 mm and n = 1.49, seen by a camera 3300 mm away at an angle a to its faces, shifts the line of sight by
    // t (sin a - tan a' cos a), a' after Snell; the cube is turned by 15.8 degrees.
    let views = told["shapes"][0]["views"].as_array().unwrap();
    assert_eq!(views.len(), 2);
    for (view, azimuth) in views.iter().zip([-10.0f64, 2.5]) {
        assert_eq!(view["azimuth"], azimuth);
        let a = (15.8 - azimuth).to_radians();
        let shift = 50.0 * (a.sin() - a.cos() * (a.sin() / 1.49).asin().tan());
        let found = view["exact"]["without"].as_f64().unwrap() / 16.8;
        // The lattice's intersections are seen at angles that differ by half a degree of some twenty.
        assert!((found / shift - 1.0).abs() < 0.06, "{view} {shift}");
    }
    assert!(told.get("published").is_none());
    let names = bench.names("out");
    for end in ["-10.png", "+2.5.png", "likeness.csv", "displacement.csv", "report.html"] {
        assert!(names.iter().any(|name| name.ends_with(end)), "{end}: {names:?}");
    }
    let csv = std::fs::read_to_string(bench.path("out/displacement.csv")).unwrap();
    assert_eq!(csv.lines().count(), 3, "{csv}");
    let page = std::fs::read_to_string(bench.path("out/report.html")).unwrap();
    assert!(!page.contains("78.87") && !page.contains("The paper"));
    // There is nothing left to go on with.
    let resumed = [&arguments[..], &["--resume"]].concat();
    assert!(bench.refuse(&resumed).contains("nothing to go on with"));
}

#[test]
fn other_ways_to_fill_the_display_stand_beside_the_exact_map() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("photos")).unwrap();
    write_still(&bench.path("photos/a.png"), &waves(200, 200), Depth::Eight).unwrap();
    let text = std::fs::read_to_string(scene("paper/cube.toml")).unwrap();
    let text = text.replace("resolution = [1024, 1024]", "resolution = [256, 256]");
    bench.write("cube.toml", text);
    let told = bench.json(&[
        "evaluate",
        "cube.toml",
        "--images",
        "photos",
        "--out",
        "out",
        "--quick",
        "--spp",
        "4",
        "--azimuths",
        "0",
        "--plate",
        "slit-mirror",
        "--compare",
    ]);
    let ways = told["ways"][0]["ways"].as_array().unwrap();
    let of = |name: &str, key: &str| {
        let way = ways.iter().find(|way| way["name"].as_str().unwrap().starts_with(name));
        way.unwrap_or_else(|| panic!("{name}: {told}"))[key].as_f64().unwrap()
    };
    // The slab's shift in closed form: 4.7 mm of 16.8 pixels. It is nearly the same everywhere, so that a homography makes it good.
    let t = 50.0
        * (15.8f64.to_radians().sin()
            - 15.8f64.to_radians().cos() * (15.8f64.to_radians().sin() / 1.49).asin().tan());
    let as_is = of("as it is", "displacement");
    assert!((as_is / (16.8 * t) - 1.0).abs() < 0.06, "{as_is} {t}");
    assert!(of("homography", "displacement") < 0.05 * as_is);
    // Structured light: within half a display pixel, of 256 over the display.
    let display = told["ways"][0]["intersections"].as_u64().unwrap();
    assert!(display > 20 && of("structured light", "displacement") < 0.05 * as_is, "{told}");
    assert!(of("exact map", "displacement") < of("the paper's samples", "displacement"));
    assert!(of("exact map", "displacement") < 0.1);
    assert!(of("exact map", "ssim") > of("as it is", "ssim"));
    assert!(of("best display image", "psnr") >= of("exact map", "psnr") - 0.01);
    let csv = std::fs::read_to_string(bench.path("out/ways.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + ways.len(), "{csv}");
    let page = std::fs::read_to_string(bench.path("out/report.html")).unwrap();
    assert!(page.contains("Other ways to fill the display") && page.contains("differentiable"));
}
