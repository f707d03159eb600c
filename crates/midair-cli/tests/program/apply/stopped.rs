//! Runs of `midair apply` that are killed or interrupted, and films that are cut, damaged or missing.

use super::*;

/// A run on a film of so many seconds, 30 frames each, in pieces of ten frames, caught once a piece is complete.
fn caught(bench: &Bench, seconds: u32, piece: &str) -> Child {
    save(bench, &turned(64, 48));
    ffmpeg(
        bench,
        &format!(
            "-f lavfi -i testsrc2=size=320x240:rate=30:duration={seconds} -c:v libx264 -preset ultrafast in.mp4"
        ),
    );
    let run = bench
        .command(&["apply", "map.exr", "in.mp4", "out.mp4", "--piece", "10"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let piece = bench.path(piece);
    let start = Instant::now();
    while !piece.exists() && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    run
}

#[test]
fn a_killed_run_leaves_no_film_and_is_gone_on_with() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = Bench::new();
    let second = ".out.mp4.midair-pieces/000001.json";
    let mut run = caught(&bench, 6, second);
    run.kill().unwrap();
    run.wait().unwrap();
    assert!(bench.path(second).exists() && !bench.path("out.mp4").exists());
    // Other work is not gone on with.
    let said =
        bench.refuse(&["apply", "map.exr", "in.mp4", "out.mp4", "--piece", "30", "--resume"]);
    assert!(said.contains("other work"), "{said}");
    let told = bench.json(&["apply", "map.exr", "in.mp4", "out.mp4", "--piece", "10", "--resume"]);
    assert_eq!(told["frames"], 180);
    assert!(told["resumed_frames"].as_u64().unwrap() >= 20);
    bench.succeed(&["apply", "map.exr", "in.mp4", "whole.mp4", "--piece", "10"]);
    let (resumed, whole) = (frames(&bench, "out.mp4"), frames(&bench, "whole.mp4"));
    assert_eq!(resumed.len(), 180);
    // To the bit: the pieces are the same.
    assert!(resumed == whole);
    let given = frames(&bench, "in.mp4");
    for ((time, _), (shown, _)) in given.iter().zip(&whole) {
        // MP4 counts in the film's own units of 1/15360 s.
        assert!((time - shown).abs() < 1e-4, "{time} {shown}");
    }
    assert!(bench.names(".").iter().all(|name| !name.contains("pieces")));
}

#[cfg(unix)]
#[test]
fn an_interrupt_says_how_to_go_on() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = Bench::new();
    let first = ".out.mp4.midair-pieces/000000.json";
    let run = caught(&bench, 20, first);
    let id = run.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    let output = run.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--resume"));
    assert!(!bench.path("out.mp4").exists() && bench.path(first).exists());
}

#[test]
fn cut_damaged_and_missing_films_are_told() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = Bench::new();
    save(&bench, &turned(64, 48));
    ffmpeg(
        &bench,
        "-f lavfi -i testsrc2=size=64x48:rate=25:duration=8 -c:v libx264 -movflags +faststart in.mp4",
    );
    let bytes = std::fs::read(bench.path("in.mp4")).unwrap();
    bench.write("cut.mp4", &bytes[..bytes.len() / 2]);
    let said = bench.refuse(&["apply", "map.exr", "cut.mp4", "out.mp4"]);
    assert!(
        said.contains("ends early") && said.contains("of 200") && said.contains("--keep-going"),
        "{said}"
    );
    assert!(!bench.path("out.mp4").exists());
    let told = bench.json(&["apply", "map.exr", "cut.mp4", "out.mp4", "--keep-going"]);
    let count = told["frames"].as_u64().unwrap();
    assert!((20..200).contains(&count), "{count}");
    assert_eq!(frames(&bench, "out.mp4").len() as u64, count);
    // Matroska does not count its frames, but tells how long it is.
    ffmpeg(&bench, "-i in.mp4 -c copy in.mkv");
    let bytes = std::fs::read(bench.path("in.mkv")).unwrap();
    bench.write("cut.mkv", &bytes[..bytes.len() / 2]);
    let said = bench.refuse(&["apply", "map.exr", "cut.mkv", "out.mkv"]);
    assert!(said.contains("ends early") && said.contains("of 8.0 s"), "{said}");
    bench.succeed(&["apply", "map.exr", "in.mkv", "out.mkv"]);
    // Without its index nothing can be read at all.
    bench.write("headless.mp4", &bytes[200..]);
    let said = bench.refuse(&["apply", "map.exr", "headless.mp4", "o.mp4"]);
    assert!(said.contains("headless.mp4"), "{said}");
    let said = bench.refuse(&["apply", "map.exr", "none.mp4", "o.mp4"]);
    assert!(said.contains("no such file"), "{said}");
    let said = bench.refuse(&["apply", "map.exr", "in.mp4", "o.mp4", "--", "-c:v", "nonsense"]);
    assert!(said.contains("nonsense"), "{said}");
    let said = bench.refuse(&["apply", "map.exr", "in.mp4", "no/o.mp4"]);
    assert!(said.contains("no/o.mp4"), "{said}");
    let said = bench.refuse(&["apply", "map.exr", "in.mp4", "in.mp4"]);
    assert!(said.contains("another name"), "{said}");
    let said = bench.refuse(&["apply", "map.exr", "in.mp4", "o.png"]);
    assert!(said.contains("%04d"), "{said}");
    // Without ffmpeg: how to get it.
    let output = bench
        .command(&["apply", "map.exr", "in.mp4", "o.mp4"])
        .env("PATH", "/nowhere")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(said.contains("not installed") && said.contains("install"), "{said}");
    assert!(!bench.path("o.mp4").exists());
}
