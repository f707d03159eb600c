//! Pictures and films of other proportions than the image's: `--fit`.

use super::apply::ffmpeg;
use super::{Bench, set_up};
use midair::picture::{Depth, Picture, read_still, write_still};

const WHITE: [f32; 4] = [1.0; 4];
const RED: [f32; 4] = [1.0, 0.0, 0.0, 1.0];

/// Twice as wide as high, its outer quarters red.
fn wide() -> Picture {
    let mut picture = Picture::filled(128, 64, WHITE);
    for (i, pixel) in picture.pixels.iter_mut().enumerate() {
        if !(32..96).contains(&(i % 128)) {
            *pixel = RED;
        }
    }
    picture
}

/// What is shown at the middle, near the left edge, and near the top, of a square display: `W`hite, `R`ed or `B`lack.
fn seen(picture: &Picture) -> String {
    let at = |x: f64, y: f64| {
        let (column, row) =
            ((x * picture.width as f64) as usize, (y * picture.height as f64) as usize);
        let [r, g, _, _] = picture.pixels[row * picture.width + column];
        if g > 0.8 {
            'W'
        } else if r > 0.8 {
            'R'
        } else {
            'B'
        }
    };
    [at(0.5, 0.5), at(0.1, 0.5), at(0.5, 0.1)].into_iter().collect()
}

/// By hand: stretched, a quarter at each side is red; contained, bars of a quarter lie above and below; covering, the red is cut off.
const WANTED: [(&str, &str); 3] = [("stretch", "WRW"), ("contain", "WRB"), ("cover", "WWW")];

#[test]
fn a_wide_picture_is_stretched_contained_or_cut_off() {
    let bench = Bench::new();
    // Without an object the display shows the picture as it is.
    bench.write("plain.toml", set_up("[display]\nresolution = [64, 64]\n"));
    write_still(&bench.path("wide.png"), &wide(), Depth::Eight).unwrap();
    for (fit, wanted) in WANTED {
        let told = bench.json(&[
            "compensate",
            "plain.toml",
            "--image",
            "wide.png",
            "--out",
            fit,
            "--fit",
            fit,
        ]);
        let shown = read_still(&bench.path(fit).join("display.png")).unwrap().picture;
        assert_eq!(seen(&shown), wanted, "{fit}");
        let note = told["notes"]
            .as_array()
            .unwrap()
            .iter()
            .any(|n| n.as_str().unwrap().contains("stretched"));
        assert_eq!(note, fit == "stretch", "{told}");
        let map = format!("{fit}/map.exr");
        let name = format!("{fit}.png");
        bench.succeed(&["apply", &map, "wide.png", &name, "--fit", fit, "--proportions", "1:1"]);
        let applied = read_still(&bench.path(&name)).unwrap().picture;
        assert_eq!(applied, shown, "{fit}");
    }
    let said = bench.refuse(&["apply", "cover/map.exr", "wide.png", "o.png", "--fit", "cover"]);
    assert!(said.contains("--proportions"), "{said}");
    let said = bench.refuse(&["compensate", "plain.toml", "--out", "o", "--fit", "cover"]);
    assert!(said.contains("--image"), "{said}");
}

#[test]
fn a_wide_film_is_stretched_contained_or_cut_off() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = Bench::new();
    bench.write("plain.toml", set_up("[display]\nresolution = [64, 64]\n"));
    bench.succeed(&["compensate", "plain.toml", "--out", "out"]);
    write_still(&bench.path("wide.png"), &wide(), Depth::Eight).unwrap();
    ffmpeg(&bench, "-loop 1 -i wide.png -frames:v 3 -c:v libx264 -qp 0 -pix_fmt yuv444p wide.mp4");
    for (fit, wanted) in WANTED {
        let pattern = format!("{fit}-%d.png");
        bench.succeed(&[
            "apply",
            "out/map.exr",
            "wide.mp4",
            &pattern,
            "--fit",
            fit,
            "--proportions",
            "20:20",
        ]);
        let shown = read_still(&bench.path(&format!("{fit}-2.png"))).unwrap().picture;
        assert_eq!(seen(&shown), wanted, "{fit}");
    }
}
