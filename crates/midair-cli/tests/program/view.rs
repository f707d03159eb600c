//! `midair view`.

use super::{BALL, Bench, set_up, waves};
use midair::picture::{Depth, Picture, read_still, write_still};

fn difference(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.pixels.iter().zip(&b.pixels);
    let squares: f64 = pairs.map(|(a, b)| f64::from(a[1] - b[1]).powi(2)).sum();
    (squares / a.pixels.len() as f64).sqrt()
}

#[test]
fn a_compensated_display_shows_the_picture_from_its_viewpoint_only() {
    let bench = Bench::new();
    let display = "[display]\nresolution = [192, 192]\nsize = [24.0, 24.0]\n";
    bench.write("ball.toml", set_up(&format!("{display}{BALL}")));
    let picture = waves(96, 96);
    write_still(&bench.path("p.png"), &picture, Depth::Eight).unwrap();
    bench.succeed(&["compensate", "ball.toml", "--image", "p.png", "--out", "out"]);
    let view = |name: &str, more: &[&str]| {
        let mut arguments = vec![
            "view",
            "ball.toml",
            "--display",
            "out/display.png",
            "--out",
            name,
            "--size",
            "96x96",
        ];
        arguments.extend(more);
        let told = bench.json(&arguments);
        (read_still(&bench.path(name)).unwrap().picture, told)
    };
    let (right, told) = view("right.png", &[]);
    assert!(told["lit"].as_f64().unwrap() > 0.999, "{told}");
    // Two resamplings of waves of 20 pixels and more, and 8-bit codes.
    assert!(difference(&right, &picture) < 0.015, "{}", difference(&right, &picture));
    let (aside, _) = view("aside.png", &["--from", "-60,0,800"]);
    // From there the ball bends it: twice what the resamplings leave, and more.
    assert!(difference(&aside, &picture) > 0.02, "{}", difference(&aside, &picture));
    assert!(difference(&aside, &picture) > 2.0 * difference(&right, &picture));
    let (same, _) = view("same.exr", &["--from", "0,0,800", "--supersampling", "3"]);
    // The finer the sampling, the more it is a mean over the pixel, which the picture is not.
    assert!(difference(&same, &picture) < 0.015);
    // A window three times as wide has the image in its middle third, and darkness around.
    let (wide, told) = view("wide.png", &["--window", "3"]);
    assert_eq!(wide.pixels[0][..3], [0.0; 3]);
    assert!(told["lit"].as_f64().unwrap() < 0.2);
    let middle: f32 =
        wide.pixels[48 * 96 + 40..48 * 96 + 56].iter().map(|p| p[1]).sum::<f32>() / 16.0;
    assert!(middle > 0.1, "{middle}");
}

#[test]
fn left_out_the_views_size_has_the_images_proportions() {
    let bench = Bench::new();
    let scene =
        set_up("[display]\nresolution = [80, 80]\n").replace("[20.0, 20.0]", "[20.0, 10.0]");
    bench.write("wide.toml", scene);
    write_still(&bench.path("p.png"), &waves(80, 40), Depth::Eight).unwrap();
    let told = bench.json(&["view", "wide.toml", "--display", "p.png", "--out", "v.png"]);
    assert_eq!(told["size"], serde_json::json!([80, 40]));
}

#[test]
fn light_by_light_a_view_has_layers_and_says_its_error() {
    let bench = Bench::new();
    bench.write("bare.toml", set_up("[display]\nresolution = [32, 32]\n"));
    write_still(&bench.path("p.png"), &Picture::filled(4, 4, [0.5; 4]), Depth::Eight).unwrap();
    let told = bench.json(&[
        "view",
        "bare.toml",
        "--display",
        "p.png",
        "--out",
        "v.exr",
        "--out",
        "v.png",
        "--size",
        "24x24",
        "--plate",
        "slit-mirror",
        "--spp",
        "60",
        "--aperture",
        "4",
        "--exposure",
        "2.5",
    ]);
    assert_eq!(told["complete"], true);
    // Eight replications each get as many.
    assert_eq!(told["samples_per_pixel"], serde_json::json!([64, 64]));
    assert_eq!(told["paths"], 24 * 24 * 64);
    assert_eq!(told["exposure"], 2.5);
    let (linear, shown) =
        (read_still(&bench.path("v.exr")).unwrap(), read_still(&bench.path("v.png")).unwrap());
    // sRGB codes of 8 bits are steps of at most 1 % of white.
    for (a, b) in linear.picture.pixels.iter().zip(&shown.picture.pixels) {
        assert!((2.5 * a[1] - b[1]).abs() < 0.01, "{a:?} {b:?}");
    }
    let bytes = std::fs::read(bench.path("v.exr")).unwrap();
    let exr = midair::map::format::decode_channels(&bench.path("v.exr"), &bytes, 0.0).unwrap();
    let mean = |channel: &str| {
        let light = exr.get(channel).unwrap();
        f64::from(light.iter().sum::<f32>()) / light.len() as f64
    };
    let layers = ["real.G", "stray.G", "through.G"].map(mean);
    assert!(
        layers[0] > 0.05 && (layers.iter().sum::<f64>() - mean("G")).abs() < 1e-6,
        "{layers:?}"
    );
    let (luminance, error) = (told["luminance"].as_f64().unwrap(), &told["error"]);
    assert!((luminance - mean("G")).abs() < 1e-5, "{luminance}");
    let (of_mean, of_pixel) = (error["mean"].as_f64().unwrap(), error["pixel"].as_f64().unwrap());
    // Pixels are independent: the mean of 576 is 24 times as sure as one.
    assert!(of_mean > 0.0 && of_pixel > 5.0 * of_mean, "{error}");

    // What is shown is chosen; the layers stay.
    let arguments =
        ["view", "bare.toml", "--display", "p.png", "--out", "s.exr", "--size", "24x24"];
    let told = bench.json(
        &[&arguments[..], &["--plate", "slit-mirror", "--spp", "64", "--light", "real"]].concat(),
    );
    assert!(told["exposure"].is_null());
    let real = read_still(&bench.path("s.exr")).unwrap().picture;
    let mean = real.pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / 576.0;
    assert!((mean - layers[0]).abs() < 0.02, "{mean} {layers:?}");
}

#[test]
fn what_no_viewer_can_be_is_refused() {
    let bench = Bench::new();
    bench.write("bare.toml", set_up(""));
    write_still(&bench.path("p.png"), &waves(8, 8), Depth::Eight).unwrap();
    let view = ["view", "bare.toml", "--display", "p.png", "--out", "v.png"];
    for (more, message) in [
        (&["--aperture", "-1"][..], "length from 0"),
        (&["--focus", "0"], "focus is 0"),
        (&["--exposure", "bright"], "give auto, or a number"),
        (&["--spp", "0"], "--spp"),
        (&["--plate", "slit"], "slit-mirror"),
        (&["--spp", "8", "--supersampling", "3"], "cannot be used with"),
    ] {
        let said = bench.refuse(&[&view[..], more].concat());
        assert!(said.contains(message), "{said}");
    }
    assert!(!bench.path("v.png").exists());
}

#[cfg(unix)]
#[test]
fn an_interrupted_view_keeps_what_it_has() {
    let bench = Bench::new();
    bench.write("ball.toml", set_up(BALL));
    write_still(&bench.path("p.png"), &waves(64, 64), Depth::Eight).unwrap();
    let mut command = bench.command(&[
        "view",
        "ball.toml",
        "--display",
        "p.png",
        "--out",
        "v.png",
        "--size",
        "64x64",
        "--spp",
        "4000000",
        "--json",
    ]);
    let piped = std::process::Stdio::piped();
    let child = command.stdout(piped).stderr(std::process::Stdio::null()).spawn().unwrap();
    // The preview is there soon, long before the end (4000000 paths through 4096 pixels take an hour).
    let start = std::time::Instant::now();
    while !bench.path("v.png").exists() {
        assert!(start.elapsed().as_secs() < 60, "no preview");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let preview = read_still(&bench.path("v.png")).unwrap().picture;
    assert!(preview.pixels.iter().any(|p| p[1] > 0.3));
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["complete"], false);
    let held = told["samples_per_pixel"][0].as_u64().unwrap();
    assert!((8..4_000_000).contains(&held), "{told}");
    assert!(read_still(&bench.path("v.png")).is_ok());
    assert_eq!(bench.names("."), ["ball.toml", "p.png", "v.png"]);
}
