//! `midair map`, and the maps that `midair compensate` writes.

use super::{BALL, Bench, set_up};
use midair::map::format::{Format, read_map, write_map};
use midair::map::{Map, Status};

const SOURCE: [usize; 2] = [640, 480];

/// A map that bends, with a hole.
fn sample() -> Map {
    let mut map = Map::identity(60, 40);
    for (i, uv) in map.uv.iter_mut().enumerate() {
        *uv = [uv[0] * (0.6 + 0.4 * uv[0]), 0.1 + 0.8 * uv[1]];
        if i % 60 > 50 {
            (*uv, map.status[i]) = ([f64::NAN; 2], Status::Blocked);
        }
    }
    map
}

fn save(bench: &Bench) -> Map {
    let map = sample();
    write_map(&map, SOURCE, Format::Npy, &bench.path("map.npy")).unwrap();
    map
}

fn worst(a: &Map, b: &Map) -> f64 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let mut worst = 0.0f64;
    for (p, q) in a.uv.iter().zip(&b.uv) {
        assert_eq!(p[0].is_nan(), q[0].is_nan());
        if p[0].is_finite() {
            worst = worst.max((p[0] - q[0]).abs()).max((p[1] - q[1]).abs());
        }
    }
    worst
}

#[test]
fn every_kind_is_converted_and_comes_back() {
    let bench = Bench::new();
    let map = save(&bench);
    for format in Format::all() {
        let (name, kind) = (format!("to/{}", format.file_name()), format.name());
        std::fs::create_dir_all(bench.path("to")).unwrap();
        let told =
            bench.json(&["map", "convert", "map.npy", &name, "--to", kind, "--source", "640x480"]);
        assert_eq!(told["kind"], kind);
        assert_eq!(told["size"], serde_json::json!([60, 40]));
        for file in told["files"].as_array().unwrap() {
            assert!(bench.path(file.as_str().unwrap()).is_file(), "{file}");
        }
        let back = format!("back-{kind}.npy");
        bench.succeed(&["map", "convert", &name, &back, "--from", kind, "--source", "640x480"]);
        let back = read_map(&bench.path(&back), None, None).unwrap().map;
        let step = match format {
            Format::Ffmpeg => 0.51 / 480.0,
            Format::ExrHalf => 1.0 / 4096.0,
            Format::Png16 | Format::TouchDesignerPng => 0.51 / 65535.0,
            // Floats of up to 640 px.
            Format::OpenCv | Format::OpenCvYaml => 6.2e-5 / 480.0,
            _ => 6e-8,
        };
        assert!(worst(&map, &back) <= step, "{kind}: {}", worst(&map, &back));
    }
    let notes = bench.json(&["map", "convert", "map.npy", "h.exr", "--to", "exr-half"]);
    assert!(notes["notes"][0].as_str().unwrap().contains("half floats"));
}

#[test]
fn what_is_missing_or_wrong_is_said() {
    let bench = Bench::new();
    save(&bench);
    let said = bench.refuse(&["map", "convert", "map.npy", "m.pgm"]);
    assert!(said.contains("--source") && said.contains("m.pgm"), "{said}");
    bench.succeed(&["map", "convert", "map.npy", "m.pgm", "--source", "640x480"]);
    let said = bench.refuse(&["map", "convert", "m.pgm", "m.exr"]);
    assert!(said.contains("--source") && said.contains("m.pgm"), "{said}");
    let said = bench.refuse(&["map", "convert", "map.npy", "m.tiff"]);
    assert!(said.contains("--to") && said.contains("m.tiff"), "{said}");
    let said = bench.refuse(&["map", "convert", "none.exr", "m.exr"]);
    assert!(said.contains("none.exr"), "{said}");
    let said = bench.refuse(&["map", "convert", "map.npy", "m.exr", "--to", "exrr"]);
    assert!(said.contains("exrr"), "{said}");
    assert!(!bench.path("m.exr").exists());
}

#[test]
fn a_ring_is_added_and_coverage_kept_apart() {
    let bench = Bench::new();
    let map = save(&bench);
    let told = bench.json(&["map", "convert", "map.npy", "wide.exr", "--bleed", "3"]);
    assert_eq!(told["status"]["ok"], 51 * 40);
    let wide = read_map(&bench.path("wide.exr"), None, None).unwrap().map;
    assert_eq!(wide.status, map.status);
    for (i, uv) in wide.uv.iter().enumerate() {
        assert_eq!(uv[0].is_finite(), i % 60 <= 53);
        // Straight on.
        let exact = sample_at(i);
        // The curve's second difference, 0.8 / 60^2, summed over three rings; float32.
        assert!(uv[0].is_nan() || (uv[0] - exact[0]).abs() < 7.0 * 0.8 / 3600.0);
        assert!(uv[1].is_nan() || (uv[1] - exact[1]).abs() < 1e-7);
    }
    bench.succeed(&[
        "map", "convert", "map.npy", "w.npy", "--to", "opencv", "--bleed", "3", "--source",
        "640x480",
    ]);
    // Back again, the ring is known for one.
    bench.succeed(&[
        "map", "convert", "w_x.npy", "back.exr", "--from", "opencv", "--source", "640x480",
    ]);
    let back = read_map(&bench.path("back.exr"), None, None).unwrap().map;
    // Of pixels without an answer a pair of arrays does not say why.
    let answered = |map: &midair::map::Map| -> Vec<bool> {
        map.status.iter().map(|status| status.is_answered()).collect()
    };
    assert_eq!(answered(&back), answered(&map));
}

fn sample_at(i: usize) -> [f64; 2] {
    let [s, t] = midair::map::pixel_centre(i % 60, i / 60, 60, 40);
    [s * (0.6 + 0.4 * s), 0.1 + 0.8 * t]
}

#[test]
fn turned_about_twice_it_is_the_map_again() {
    let bench = Bench::new();
    let map = save(&bench);
    let told =
        bench.json(&["map", "convert", "map.npy", "f.npy", "--forward", "--source", "200x150"]);
    assert_eq!(
        (&told["size"], &told["source"]),
        (&serde_json::json!([200, 150]), &serde_json::json!([60, 40]))
    );
    bench.succeed(&["map", "convert", "f.npy", "g.npy", "--reverse", "--source", "60x40"]);
    let back = read_map(&bench.path("g.npy"), None, None).unwrap().map;
    let mut compared = 0;
    for (a, b) in map.uv.iter().zip(&back.uv) {
        if a[0].is_finite() && b[0].is_finite() {
            // Bilinear cells of 1/60 and then of 1/200 under a second derivative of 0.8.
            assert!((a[0] - b[0]).abs() < 2.0 * 0.8 / 8.0 / 3600.0 && (a[1] - b[1]).abs() < 1e-9);
            compared += 1;
        }
    }
    assert!(compared > 48 * 38, "{compared}");
}

#[test]
fn compensate_writes_the_forward_map_too() {
    let bench = Bench::new();
    bench.write("ball.toml", set_up(&format!("[display]\nresolution = [96, 96]\n{BALL}")));
    bench.succeed(&[
        "compensate",
        "ball.toml",
        "--out",
        "out",
        "--forward",
        "--bleed",
        "2",
        "--format",
        "exr,opencv",
    ]);
    let names = bench.names("out");
    for name in [
        "forward.exr",
        "forward-opencv_x.npy",
        "forward-opencv_y.npy",
        "map.exr",
        "forward-opencv_coverage.png",
    ] {
        assert!(names.iter().any(|n| n == name), "{name}: {names:?}");
    }
    let [g, f] = ["map.exr", "forward.exr"]
        .map(|name| read_map(&bench.path("out").join(name), None, None).unwrap().map);
    // At the middle of the image, where F is smooth, G(F(uv)) = uv: the pixel that F names shows this image point.
    for i in (0..96 * 96).filter(|i| (30..66).contains(&(i % 96)) && (30..66).contains(&(i / 96))) {
        let uv = midair::map::pixel_centre(i % 96, i / 96, 96, 96);
        let (x, y) = midair::map::pixel_at(f.uv[i], 96, 96);
        let shown = g.uv[y * 96 + x];
        // Within the pixel: half of one each way, stretched by less than 2.
        assert!((shown[0] - uv[0]).abs() < 1.0 / 96.0 && (shown[1] - uv[1]).abs() < 1.0 / 96.0);
    }
}
