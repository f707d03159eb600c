//! What becomes of files: none that is read is overwritten, none is half-made, links and modes stay.

use super::{BALL, Bench, set_up, waves};
use midair::map::Map;
use midair::map::format::{Format, write_map};
use midair::picture::{Depth, read_still, write_still};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A bench with a map, a picture and a scene.
fn furnished() -> Bench {
    let bench = Bench::new();
    write_map(&Map::identity(64, 48), [64, 48], Format::Exr, &bench.path("map.exr")).unwrap();
    write_still(&bench.path("p.png"), &waves(64, 48), Depth::Eight).unwrap();
    write_still(&bench.path("p.exr"), &waves(64, 48), Depth::Float).unwrap();
    bench.write("s.toml", set_up(&format!("[display]\nresolution = [64, 64]\n{BALL}")));
    bench
}

#[test]
fn no_command_writes_over_what_it_reads() {
    let bench = furnished();
    std::fs::create_dir(bench.path("X")).unwrap();
    let keep = |from: &str, to: &str| _ = std::fs::copy(bench.path(from), bench.path(to)).unwrap();
    keep("p.png", "X/display.png");
    keep("p.png", "1.png");
    let mut runs: Vec<(Vec<&str>, &str)> = vec![
        (vec!["apply", "map.exr", "p.exr", "map.exr"], "map.exr"),
        (vec!["apply", "map.exr", "p.png", "./p.png"], "p.png"),
        (vec!["apply", "map.exr", "%d.png", "./%d.png"], "1.png"),
        (vec!["view", "s.toml", "--display", "p.png", "--out", "p.png"], "p.png"),
        (vec!["compensate", "s.toml", "--image", "X/display.png", "--out", "X"], "X/display.png"),
        (vec!["map", "convert", "map.exr", "map.exr", "--to", "exr-half"], "map.exr"),
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("p.png", bench.path("soft.png")).unwrap();
        std::fs::hard_link(bench.path("p.png"), bench.path("hard.png")).unwrap();
        runs.push((vec!["apply", "map.exr", "p.png", "soft.png"], "p.png"));
        runs.push((vec!["apply", "map.exr", "soft.png", "p.png"], "p.png"));
        runs.push((vec!["apply", "map.exr", "p.png", "hard.png"], "p.png"));
    }
    let names = bench.names(".");
    for (arguments, read) in &runs {
        let before = std::fs::read(bench.path(read)).unwrap();
        let said = bench.refuse(arguments);
        assert!(said.contains("input") && said.contains("another name"), "{arguments:?}: {said}");
        assert!(std::fs::read(bench.path(read)).unwrap() == before, "{arguments:?}");
    }
    assert_eq!(bench.names("."), names);
    assert_eq!(bench.names("X"), ["display.png"]);
}

#[cfg(unix)]
#[test]
fn links_stay_links_and_modes_stay() {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let bench = furnished();
    bench.write("target.png", "old");
    std::fs::set_permissions(bench.path("target.png"), std::fs::Permissions::from_mode(0o640))
        .unwrap();
    symlink("target.png", bench.path("link.png")).unwrap();
    bench.succeed(&["apply", "map.exr", "p.png", "link.png"]);
    assert!(std::fs::symlink_metadata(bench.path("link.png")).unwrap().is_symlink());
    let written = read_still(&bench.path("target.png")).unwrap();
    assert_eq!((written.picture.width, written.picture.height), (64, 48));
    let mode = std::fs::metadata(bench.path("target.png")).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o640);
}

#[cfg(target_os = "linux")]
#[test]
fn names_need_not_be_unicode() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    let bench = furnished();
    let name = |bytes: &'static [u8]| bench.folder.path().join(OsStr::from_bytes(bytes));
    std::fs::copy(bench.path("p.png"), name(b"p\xff.png")).unwrap();
    let output = bench
        .command(&["apply", "map.exr"])
        .args([name(b"p\xff.png"), name(b"q\xff.png")])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let view = bench
        .command(&["view", "s.toml", "--size", "32x32", "--display"])
        .arg(name(b"q\xff.png"))
        .arg("--out")
        .arg(name(b"v\xff.png"))
        .output()
        .unwrap();
    assert!(view.status.success(), "{}", String::from_utf8_lossy(&view.stderr));
    assert!(name(b"q\xff.png").is_file() && name(b"v\xff.png").is_file());
}

#[test]
fn the_same_run_writes_the_same_bytes() {
    let bench = furnished();
    // Above some 300 x 300 pixels a file has so many blocks that threads would finish them in another order each time.
    for out in ["a", "b", "c"] {
        bench.succeed(&[
            "compensate",
            "s.toml",
            "--out",
            out,
            "--size",
            "600x600",
            "--format",
            "exr,npy",
        ]);
    }
    for name in ["map.exr", "map.npy"] {
        let read = |out: &str| std::fs::read(bench.path(out).join(name)).unwrap();
        assert!(read("a") == read("b") && read("b") == read("c"), "{name}");
    }
}

#[test]
fn what_cannot_be_is_refused_before_the_work() {
    let bench = furnished();
    std::fs::create_dir(bench.path("taken.png")).unwrap();
    std::fs::create_dir_all(bench.path("out/map.exr")).unwrap();
    let said = bench.refuse(&["apply", "map.exr", "p.png", "taken.png"]);
    assert!(said.contains("taken.png") && said.contains("not a folder"), "{said}");
    // So large that the work itself would take minutes.
    let start = Instant::now();
    let said = bench.refuse(&[
        "compensate",
        "s.toml",
        "--out",
        "out",
        "--size",
        "8000x8000",
        "--method",
        "splat",
        "--spp",
        "9999",
    ]);
    assert!(said.contains("map.exr") && start.elapsed() < Duration::from_secs(20), "{said}");
    let said = bench.refuse(&["apply", "map.exr", "nosuch.png", "out.mkv"]);
    assert!(said.contains("no such file"), "{said}");
    for (name, meant) in
        [("f####.png", "f%04d.png"), ("f%4d.png", "f%04d.png"), ("f*.png", "f%04d.png")]
    {
        let said = bench.refuse(&["apply", "map.exr", name, "out.mkv"]);
        assert!(said.contains("no such file") && said.contains(meant), "{said}");
    }
    // A picture is one whatever it is called.
    std::fs::copy(bench.path("p.png"), bench.path("picture")).unwrap();
    bench.succeed(&["apply", "map.exr", "picture", "seen.png"]);
    bench.write("a.heic", b"\0\0\0\x18ftypheic");
    for out in ["o.png", "o.mp4"] {
        let said = bench.refuse(&["apply", "map.exr", "a.heic", out]);
        assert!(said.contains("a.heic") && said.contains("TIFF"), "{said}");
    }
}

#[cfg(unix)]
#[test]
fn what_a_killed_run_left_is_removed_by_the_next() {
    let bench = furnished();
    let mut run = bench
        .command(&[
            "compensate",
            "s.toml",
            "--out",
            "out",
            "--size",
            "512x512",
            "--method",
            "splat",
            "--spp",
            "100000",
        ])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    let hidden = || bench.path("out").is_dir() && !bench.names("out").is_empty();
    while !hidden() {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_millis(200));
    // A second one into the same place takes nothing away from it.
    bench.succeed(&["compensate", "s.toml", "--out", "out", "--size", "32x32"]);
    assert!(bench.names("out").iter().any(|name| name.starts_with(".midair-")));
    assert!(
        Command::new("kill").args(["-KILL", &run.id().to_string()]).status().unwrap().success()
    );
    run.wait().unwrap();
    assert!(bench.names("out").iter().any(|name| name.starts_with(".midair-")));
    bench.succeed(&["compensate", "s.toml", "--out", "out", "--size", "32x32"]);
    assert!(
        bench.names("out").iter().all(|name| !name.starts_with('.')),
        "{:?}",
        bench.names("out")
    );
}
