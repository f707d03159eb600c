//! `midair compensate`.

use super::{BALL, Bench, scene, set_up, waves};
use midair::map::format::read_map;
use midair::map::{Map, Status, pixel_centre};
use midair::picture::{Depth, read_still, write_still};
use midair::scene::load;
use midair::transport::{Path, Setup};
use std::path::Path as FilePath;

fn ball(bench: &Bench) {
    bench.write("ball.toml", set_up(&format!("[display]\nresolution = [96, 64]\n{BALL}")));
}

fn map(bench: &Bench, name: &str) -> Map {
    read_map(&bench.path(name), None, None).unwrap().map
}

#[test]
fn it_writes_map_report_and_display_image_as_promised() {
    let bench = Bench::new();
    // A display twice the image: its outer half is outside.
    let display = "[display]\nresolution = [96, 64]\nsize = [40.0, 40.0]\n";
    bench.write("ball.toml", set_up(&format!("{display}{BALL}")));
    write_still(&bench.path("p.png"), &waves(80, 80), Depth::Eight).unwrap();
    let told = bench.json(&[
        "compensate",
        "ball.toml",
        "--image",
        "p.png",
        "--out",
        "a/out",
        "--format",
        "exr,npy,png16",
    ]);
    assert_eq!(
        bench.names("a/out"),
        ["display.png", "map.exr", "map.npy", "map.png", "report.json", "status.npy"]
    );
    let written: serde_json::Value =
        serde_json::from_slice(&std::fs::read(bench.path("a/out/report.json")).unwrap()).unwrap();
    for key in ["ok", "folded", "outside", "blocked"] {
        assert_eq!(written["status"][key], told["status"][key]);
    }
    assert!(written["error_bound"].as_f64().unwrap() <= 1e-5);
    assert!(written["rays"].as_u64().unwrap() > 0);
    assert!(written["timings_ms"]["map"].as_f64().unwrap() > 0.0);
    assert_eq!(written["size"], serde_json::json!([96, 64]));

    // status.npy holds the counts; map.npy its header, then doubles, NaN where the status says so.
    let status = std::fs::read(bench.path("a/out/status.npy")).unwrap();
    let status = &status[status.len() - 96 * 64..];
    let count = |code: u8| status.iter().filter(|&&s| s == code).count() as u64;
    assert_eq!(count(0), written["status"]["ok"].as_u64().unwrap());
    assert_eq!(count(2), written["status"]["outside"].as_u64().unwrap());
    assert!(count(0) > 1000 && count(2) > 1000, "{} {}", count(0), count(2));
    let npy = std::fs::read(bench.path("a/out/map.npy")).unwrap();
    let head = String::from_utf8_lossy(&npy[..128]).into_owned();
    assert!(head.contains("<f8") && head.contains("(64, 96, 2"), "{head}");
    let doubles: Vec<f64> = npy[npy.len() - 96 * 64 * 16..]
        .as_chunks::<8>()
        .0
        .iter()
        .map(|bytes| f64::from_le_bytes(*bytes))
        .collect();
    for (pair, &status) in doubles.chunks_exact(2).zip(status) {
        assert_eq!(pair[0].is_nan() && pair[1].is_nan(), status > 1);
    }

    // By the transport itself, the image point of each ok pixel leads back to that pixel.
    let setup = Setup::new(&load(&bench.path("ball.toml")).unwrap()).unwrap();
    for (index, pair) in doubles.chunks_exact(2).enumerate().filter(|(i, _)| status[*i] == 0) {
        let st = setup.transport([pair[0], pair[1]], &mut Path::new()).formed().unwrap();
        let centre = pixel_centre(index % 96, index / 96, 96, 64);
        // The bound of 1e-6 in uv, times the transport's slope, which is below 3 here.
        assert!((st[0] - centre[0]).hypot(st[1] - centre[1]) < 3e-6);
    }
    // The same in the other formats, to their precision: float32, and 1/65535.
    for (name, precision) in [("map.exr", 1e-7), ("map.png", 0.6 / 65535.0)] {
        let other = map(&bench, &format!("a/out/{name}"));
        for (index, pair) in doubles.chunks_exact(2).enumerate() {
            let uv = other.uv[index];
            if status[index] == 0 {
                assert!((uv[0] - pair[0]).abs() < precision && (uv[1] - pair[1]).abs() < precision);
            } else {
                assert!(!matches!(other.status[index], Status::Ok));
            }
        }
    }
    // Pixels without an answer are black, but for the ring beside those with one.
    let display = read_still(&bench.path("a/out/display.png")).unwrap().picture;
    let (width, height) = (display.width, display.height);
    let mut rim = 0;
    for (index, pixel) in display.pixels.iter().enumerate().filter(|(i, _)| status[*i] > 1) {
        let (x, y) = (index % width, index / width);
        let beside = (y.saturating_sub(1)..height.min(y + 2))
            .any(|y| (x.saturating_sub(1)..width.min(x + 2)).any(|x| status[y * width + x] <= 1));
        assert!(beside || pixel[..3] == [0.0; 3]);
        rim += usize::from(beside && pixel[..3] != [0.0; 3]);
    }
    assert!(rim > 0);
}

#[test]
fn with_no_element_the_display_shows_the_picture_itself() {
    let bench = Bench::new();
    bench.write("bare.toml", set_up("[display]\nresolution = [64, 64]\n"));
    for (depth, name) in [(Depth::Eight, "p.png"), (Depth::Sixteen, "p16.png")] {
        write_still(&bench.path(name), &waves(64, 64), depth).unwrap();
        bench.succeed(&["compensate", "bare.toml", "--image", name, "--out", "out"]);
        let given = read_still(&bench.path(name)).unwrap();
        let shown = read_still(&bench.path("out/display.png")).unwrap();
        assert_eq!(shown.depth, depth);
        for (a, b) in given.picture.pixels.iter().zip(&shown.picture.pixels) {
            for c in 0..3 {
                // The map is exact to 1e-6 of 1, 6e-5 of a pixel; a 16-bit code is 1.5e-5 wide and the waves rise by at
                // most 0.2 a pixel.
                assert!((a[c] - b[c]).abs() < 1e-4);
            }
        }
    }
    write_still(&bench.path("p.exr"), &waves(64, 64), Depth::Float).unwrap();
    bench.succeed(&["compensate", "bare.toml", "--image", "p.exr", "--out", "exr"]);
    assert_eq!(bench.names("exr"), ["display.exr", "display.png", "map.exr", "report.json"]);
    assert_eq!(read_still(&bench.path("exr/display.png")).unwrap().depth, Depth::Sixteen);
}

#[test]
fn size_is_the_displays_resolution() {
    let bench = Bench::new();
    ball(&bench);
    let told = bench.json(&["compensate", "ball.toml", "--out", "out", "--size", "40x30"]);
    assert_eq!(told["size"], serde_json::json!([40, 30]));
    let map = map(&bench, "out/map.exr");
    assert_eq!((map.width, map.height), (40, 30));
    // Without a picture there is no display image.
    assert_eq!(bench.names("out"), ["map.exr", "report.json"]);
}

#[test]
fn splat_is_there_beside_the_inverse_and_claims_no_bound() {
    let bench = Bench::new();
    ball(&bench);
    bench.succeed(&["compensate", "ball.toml", "--out", "inverse"]);
    let told = bench.json(&[
        "compensate",
        "ball.toml",
        "--out",
        "splat",
        "--method",
        "splat",
        "--spp",
        "64",
    ]);
    assert_eq!(told["method"], "splat");
    assert_eq!(told["rays"], 96 * 64 * 64);
    assert!(told["error_bound"].is_null());
    let (exact, splat) = (map(&bench, "inverse/map.exr"), map(&bench, "splat/map.exr"));
    let (mut sum, mut count) = (0.0, 0);
    for (a, b) in exact.uv.iter().zip(&splat.uv) {
        if a[0].is_finite() && b[0].is_finite() {
            sum += (a[0] - b[0]).hypot(a[1] - b[1]);
            count += 1;
        }
    }
    // Each splat pixel is a mean of some 64 samples spread over it: about 0.3 pixel / 8 off, of 96 pixels.
    assert!(
        count > 5000 && sum / f64::from(count) < 2.0 * 0.3 / 8.0 / 64.0,
        "{}",
        sum / f64::from(count)
    );
    let said = bench.refuse(&["compensate", "ball.toml", "--out", "x", "--spp", "64"]);
    assert!(said.contains("--method splat"), "{said}");
}

#[test]
fn optimal_comes_nearer_than_the_plain_filter() {
    let bench = Bench::new();
    ball(&bench);
    // Grey noise in steps: as much detail as the display can hold.
    let mut picture = waves(64, 64);
    let mut state = 1u32;
    for pixel in &mut picture.pixels {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        pixel[..3].fill(0.3 + 0.1 * (state >> 30) as f32);
    }
    write_still(&bench.path("p.png"), &picture, Depth::Eight).unwrap();
    let view_of = |folder: &str, more: &[&str]| {
        let mut arguments =
            vec!["compensate", "ball.toml", "--image", "p.png", "--out", folder, "--size", "64x64"];
        arguments.extend(more);
        bench.succeed(&arguments);
        let (display, out) = (format!("{folder}/display.png"), format!("{folder}.png"));
        bench.succeed(&[
            "view",
            "ball.toml",
            "--display",
            &display,
            "--out",
            &out,
            "--size",
            "64x64",
        ]);
        read_still(&bench.path(&out)).unwrap().picture
    };
    bench.write("bare.toml", set_up("[display]\nresolution = [64, 64]\n"));
    bench.succeed(&["compensate", "bare.toml", "--image", "p.png", "--out", "bare"]);
    bench.succeed(&[
        "view",
        "bare.toml",
        "--display",
        "bare/display.png",
        "--out",
        "reference.png",
    ]);
    let reference = read_still(&bench.path("reference.png")).unwrap().picture;
    let error = |view: &midair::picture::Picture| -> f64 {
        // The middle, which is formed.
        let at = |p: &midair::picture::Picture, i: usize| p.pixels[i][1];
        (0..64 * 64)
            .filter(|i| (16..48).contains(&(i % 64)) && (16..48).contains(&(i / 64)))
            .map(|i| f64::from(at(view, i) - at(&reference, i)).powi(2))
            .sum()
    };
    let (plain, optimal) = (error(&view_of("plain", &[])), error(&view_of("best", &["--optimal"])));
    assert!(optimal < 0.5 * plain, "{optimal} {plain}");
    bench.refuse(&["compensate", "ball.toml", "--out", "x", "--optimal"]);
}

#[test]
fn every_format_is_written_by_its_name() {
    let bench = Bench::new();
    ball(&bench);
    let names: Vec<&str> = midair::map::format::Format::all().map(|format| format.name()).collect();
    let list = names.join(",");
    bench.succeed(&["compensate", "ball.toml", "--out", "out", "--format", &list]);
    for format in midair::map::format::Format::all() {
        let path = bench.path("out").join(format.file_name());
        let stem = path.with_extension("").display().to_string();
        let there = path.exists()
            || FilePath::new(&format!("{stem}_x.pgm")).exists()
            || FilePath::new(&format!("{stem}_x.npy")).exists();
        assert!(there, "{}", format.name());
    }
    let said = bench.refuse(&["compensate", "ball.toml", "--out", "x", "--format", "png61"]);
    assert!(said.contains("png61") && said.contains("png16"), "{said}");
}

#[test]
fn the_repositorys_scenes_are_compensated() {
    let bench = Bench::new();
    for name in
        ["ball.toml", "lens.toml", "glass-of-water.toml", "water-surface.toml", "paper/cube.toml"]
    {
        let told = bench.json(&["compensate", &scene(name), "--out", "out", "--size", "64x64"]);
        assert!(told["status"]["ok"].as_u64().unwrap() > 500, "{name}: {told}");
    }
}

/// A block of flint, tinted, in front of a display with a response of its own.
const TINTED: &str = "[display]\nresolution = [96, 96]\nsize = [40.0, 40.0]\ngamma = 1.8\nblack = 0.05\n\
    [[element]]\nshape = { kind = \"box\", size = [50.0, 50.0, 50.0] }\nrotation = [0.0, 30.0, 0.0]\n\
    material = { glass = \"SF10\" }\nabsorption = [0.002, 0.004, 0.008]\n";

#[test]
fn gain_colours_and_the_displays_response_are_taken_into_account() {
    let bench = Bench::new();
    bench.write("tinted.toml", set_up(TINTED));
    let white = midair::picture::Picture::filled(8, 8, [1.0; 4]);
    write_still(&bench.path("white.png"), &white, Depth::Eight).unwrap();
    let told = bench.json(&[
        "compensate",
        "tinted.toml",
        "--image",
        "white.png",
        "--out",
        "out",
        "--gain",
        "clip",
        "--per-channel",
    ]);
    let names =
        ["display.png", "map_b.exr", "map_g.exr", "map_r.exr", "map_rgb.exr", "report.json"];
    assert_eq!(bench.names("out"), names);
    let brightness = &told["brightness"];
    let [least, most] = ["least", "most"].map(|key| brightness["gain"][key].as_f64().unwrap());
    assert!(0.3 < least && least < most && most < 0.9, "{told}");
    // Only along the edges, where the three colours' regions differ by a pixel or two, is a colour dark.
    assert!(brightness["darker_than_black"].as_f64().unwrap() < 0.05, "{told}");
    assert!(told["colours"]["blue"]["status"]["ok"].as_u64().unwrap() > 1000);
    // In the middle of the map: what the display emits of each colour, through what is left of it, is the level.
    let display = read_still(&bench.path("out/display.png")).unwrap().picture;
    let level = brightness["gain"]["level"].as_f64().unwrap();
    for (c, name) in ["map_r.exr", "map_g.exr", "map_b.exr"].into_iter().enumerate() {
        let loaded = read_map(&bench.path(&format!("out/{name}")), None, None).unwrap();
        let gain = loaded.gain.expect("the map carries its gain");
        let pixel = (0..96 * 96)
            .filter(|&pixel| loaded.map.status[pixel] == Status::Ok)
            .nth(800)
            .expect("enough pixels");
        let code = midair::picture::srgb::encode(f64::from(display.pixels[pixel][c]));
        let emitted = 0.05 + 0.95 * code.powf(1.8);
        let seen = emitted * f64::from(gain.rgb[pixel][c]);
        // Half a step of 255 at a slope of 1.8, or the display's white.
        let clipped = code > 0.999 && seen < level;
        assert!(clipped || (seen - level).abs() < 0.005, "{seen} {level} {code}");
    }
    // Blue is the most absorbed: the display shows more of it than of red.
    let sum = |c: usize| display.pixels.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>();
    assert!(sum(2) > 1.05 * sum(0), "{} {}", sum(0), sum(2));
    let said =
        bench.succeed(&["compensate", "tinted.toml", "--image", "white.png", "--out", "plain"]);
    assert!(!said.contains("uniformity correction"));
}

#[test]
fn a_display_that_contradicts_itself_is_refused() {
    let bench = Bench::new();
    bench.write("two.csv", "code,light\n0,0\n255,1\n");
    let both = TINTED.replace("gamma = 1.8", "gamma = 1.8\nresponse = \"two.csv\"");
    bench.write("both.toml", set_up(&both));
    let said = bench.refuse(&["compensate", "both.toml", "--out", "out"]);
    assert!(said.contains("both a gamma and a measured response"), "{said}");
    bench.write("bad.csv", "code,light\n0,3\n255,1\n");
    let falling = TINTED.replace("gamma = 1.8", "response = \"bad.csv\"");
    bench.write("falling.toml", set_up(&falling));
    let said = bench.refuse(&["compensate", "falling.toml", "--out", "out"]);
    assert!(said.contains("bad.csv") && said.contains("line 3"), "{said}");
}
