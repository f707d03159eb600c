//! `midair measure lattice`: what photographs show.

use super::Bench;
use midair::measure::lattice::{LatticeStyle, draw_lattice};
use midair::picture::{Depth, Picture, write_still};

fn lattice(bench: &Bench, name: &str, [dx, dy]: [usize; 2], dark: bool) {
    let mut drawn = draw_lattice(400, 400, &LatticeStyle::default()).unwrap();
    if dark {
        drawn.pixels.iter_mut().for_each(|p| *p = [1.0 - p[0], 1.0 - p[1], 1.0 - p[2], 1.0]);
    }
    let ground = if dark { 1.0 } else { 0.0 };
    let mut photo = Picture::filled(480, 480, [ground, ground, ground, 1.0]);
    for row in 0..400 {
        let at = (row + dy + 20) * 480 + dx + 20;
        photo.pixels[at..at + 400].copy_from_slice(&drawn.pixels[row * 400..(row + 1) * 400]);
    }
    write_still(&bench.path(name), &photo, Depth::Eight).unwrap();
}

#[test]
fn intersections_are_told_as_json_csv_and_picture() {
    let bench = Bench::new();
    lattice(&bench, "photo.png", [0, 0], false);
    let told = bench.json(&["measure", "lattice", "photo.png", "--out", "out"]);
    assert_eq!(bench.names("out"), ["lattice.csv", "lattice.json", "lattice.png"]);
    assert_eq!(told["found"], 49);
    // The lattice's first line lies at 8 % of 400 pixels, 20 further in.
    let place = &told["intersections"][0]["place"];
    for axis in 0..2 {
        // Lines of 4 pixels, of which an 8-bit code tells the edge to a few hundredths.
        assert!((place[axis].as_f64().unwrap() - 52.0).abs() < 0.05, "{place}");
    }
    let csv = std::fs::read_to_string(bench.path("out/lattice.csv")).unwrap();
    assert_eq!(csv.lines().count(), 50);
    assert!(csv.starts_with("row,column,x,y\n0,0,5"), "{csv}");
    // Without a folder the table goes to standard output.
    let said = bench.succeed(&["measure", "lattice", "photo.png"]);
    assert!(said.contains("49 of 49") && said.contains("6,6,"), "{said}");
}

#[test]
fn displacement_is_told_and_a_moved_camera_taken_off() {
    let bench = Bench::new();
    lattice(&bench, "a.png", [0, 0], false);
    lattice(&bench, "b.png", [6, 8], false);
    let against = ["measure", "lattice", "b.png", "--against", "a.png"];
    let told = bench.json(&against);
    // 6 and 8 make 10; whole pixels, so that both are measured alike.
    assert!((told["against"]["mean"].as_f64().unwrap() - 10.0).abs() < 1e-3, "{told}");
    assert!((told["intersections"][3]["displacement"].as_f64().unwrap() - 10.0).abs() < 1e-3);
    for align in ["shift", "similarity", "perspective"] {
        let told = bench.json(&[&against[..], &["--align", align]].concat());
        assert!(told["against"]["max"].as_f64().unwrap() < 1e-3, "{align}: {told}");
    }
}

/// Lines that differ in number each way, lengths in mm, and a part of a lattice.
#[test]
fn lattices_of_other_counts_are_told_in_millimetres_and_in_part() {
    let bench = Bench::new();
    lattice(&bench, "a.png", [0, 0], false);
    lattice(&bench, "b.png", [3, 4], false);
    // The lattice's spacing is 14 % of 400 pixels: of 2.8 mm, 20 pixels to the mm.
    let told =
        bench.json(&["measure", "lattice", "b.png", "--against", "a.png", "--spacing", "2.8"]);
    assert!((told["pixels_per_mm"].as_f64().unwrap() - 20.0).abs() < 0.01, "{told}");
    assert!((told["against"]["mean_mm"].as_f64().unwrap() - 0.25).abs() < 1e-3, "{told}");
    // Seven lines across and five of seven down: columns 0 to 4 with some ground beside them.
    let whole = midair::picture::read_still(&bench.path("a.png")).unwrap().picture;
    let width = 20 + 32 + 4 * 56 + 26;
    let rows = whole.pixels.chunks(480).flat_map(|row| row[..width].to_vec());
    let part = Picture { width, height: 480, pixels: rows.collect() };
    write_still(&bench.path("part.png"), &part, Depth::Eight).unwrap();
    let told = bench.json(&["measure", "lattice", "part.png", "--lines", "5x7"]);
    assert_eq!((&told["found"], &told["lines"]), (&35.into(), &serde_json::json!([5, 7])));
    assert_eq!(told["intersections"][5]["row"], 1);
    let said = bench.refuse(&["measure", "lattice", "part.png"]);
    assert!(said.contains("5 x 7") && said.contains("--part"), "{said}");
    let told = bench.json(&["measure", "lattice", "part.png", "--part"]);
    assert_eq!((&told["found"], &told["lines"]), (&35.into(), &serde_json::json!([5, 7])));
    for wrong in ["1", "9x", "x", "7x41", "seven"] {
        let said = bench.refuse(&["measure", "lattice", "part.png", "--lines", wrong]);
        assert!(said.contains("9x6"), "{said}");
    }
}

#[test]
fn what_is_not_found_is_said_with_what_to_try() {
    let bench = Bench::new();
    lattice(&bench, "dark.png", [0, 0], true);
    let said = bench.refuse(&["measure", "lattice", "dark.png", "--out", "out"]);
    assert!(said.contains("dark.png") && said.contains("help"), "{said}");
    assert!(!bench.path("out").exists());
    assert_eq!(bench.json(&["measure", "lattice", "dark.png", "--dark"])["found"], 49);
    let said = bench.refuse(&["measure", "lattice", "dark.png", "--dark", "--lines", "5"]);
    assert!(said.contains("--lines"), "{said}");
    write_still(
        &bench.path("grey.png"),
        &Picture::filled(300, 300, [0.2, 0.2, 0.2, 1.0]),
        Depth::Eight,
    )
    .unwrap();
    let said = bench.refuse(&["measure", "lattice", "grey.png"]);
    assert!(said.contains("no lattice is seen") && said.contains("--dark"), "{said}");
    bench.refuse(&["measure", "lattice", "none.png"]);
    bench.refuse(&["measure", "lattice", "grey.png", "--align", "shift"]);
}
