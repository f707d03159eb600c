//! `midair view`.

use super::{BALL, Bench, set_up, waves};
use midair::media::{Depth, Picture, read_still, write_still};

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
    assert!(difference(&aside, &picture) > 0.03, "{}", difference(&aside, &picture));
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
