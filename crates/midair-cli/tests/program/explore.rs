//! `midair explore`: many set-ups, and the best of them.

use super::{BALL, Bench, set_up};

#[test]
fn values_are_varied_and_the_best_scene_is_written_with_its_files() {
    let bench = Bench::new();
    let gem = "v 9 9 9\nv 9 -9 -9\nv -9 9 -9\nv -9 -9 9\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
    std::fs::create_dir(bench.path("meshes")).unwrap();
    bench.write("meshes/gem.obj", gem);
    let gem = "[[element]]\nname = \"gem\"\nshape = { kind = \"mesh\", file = \"meshes/gem.obj\" } # mine\n\
               position = [0.0, 60.0, 0.0]\nmaterial = { ior = 1.49 }\n";
    bench.write("bench.toml", set_up(&format!("{BALL}{gem}")));
    let arguments = [
        "explore",
        "bench.toml",
        "--vary",
        "image.position.z=-10..10:3",
        "--vary",
        "image.size=10,60",
        "--resolution",
        "32",
        "--views",
        "1",
        "--out",
        "out/found",
    ];
    let told = bench.json(&arguments);
    let points = told["points"].as_array().unwrap();
    assert_eq!(points.len(), 6);
    // A larger image than the ball shows less of itself, and is not the best by its area alone.
    let formed = |i: usize| points[i]["formed"].as_f64().unwrap();
    assert!(formed(2) > 0.999 && formed(3) < 0.9, "{} {}", formed(2), formed(3));
    let csv = std::fs::read_to_string(bench.path("out/found/explore.csv")).unwrap();
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(&head[..3], ["image.position.z", "image.size", "formed"]);
    assert!(lines.clone().count() == 6 && lines.all(|line| line.split(',').count() == head.len()));
    let best = std::fs::read_to_string(bench.path("out/found/best.toml")).unwrap();
    assert!(best.contains("../../meshes/gem.obj") && best.contains("# mine"), "{best}");
    // It finds its mesh from there.
    let drawn = bench.json(&["draw", "out/found/best.toml", "--out", "drawing.svg"]);
    assert!(drawn["courses"].as_u64().unwrap() > 0, "{drawn}");
    let names = bench.names("out/found");
    for name in ["best-1.png", "best.toml", "explore.csv", "explore.json", "formed.png"] {
        assert!(names.iter().any(|known| known == name), "{names:?}");
    }
    // What is kept for an interruption is gone.
    assert_eq!(bench.names("out"), ["found"]);
}

#[test]
fn the_best_set_up_within_limits_is_searched_for() {
    let bench = Bench::new();
    bench.write("bench.toml", set_up(BALL));
    let told = bench.json(&[
        "explore",
        "bench.toml",
        "--best",
        "--limit",
        "image.size=5..80",
        "--resolution",
        "32",
        "--out",
        "found",
    ]);
    assert!(told["score"].as_f64().unwrap() >= told["score_before"].as_f64().unwrap());
    // Larger than the 20 mm that it had: around the ball, too, an image is formed.
    let size = told["best"]["values"][0].as_f64().unwrap();
    assert!(size > 20.0, "{size}");
}

#[test]
fn what_cannot_be_explored_is_refused_at_once() {
    let bench = Bench::new();
    bench.write("bench.toml", set_up(BALL));
    for (more, word) in [
        (&["--vary", "image.positoin.z=0..1:2"][..], "positoin"),
        (&["--vary", "image.position.z=0..1"], "PATH=FROM..TO:COUNT"),
        (
            &["--vary", "image.position.z=0..1:90000", "--vary", "image.size=1..2:90000"],
            "fewer values",
        ),
        (&["--best", "--limit", "image.size=9..8"], "PATH=FROM..TO"),
        (&["--best", "--limit", "viewpoint.position.z=-1..1"], "no set-up within the limits"),
        (&[], "--vary"),
    ] {
        let arguments =
            [&["explore", "bench.toml", "--out", "found", "--resolution", "16"], more].concat();
        let said = bench.refuse(&arguments);
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(word), "{more:?}: {said}");
    }
}
