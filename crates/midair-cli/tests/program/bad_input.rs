//! Wrong and hostile input: one message with file, place and remedy, exit code 2, nothing written.

use super::{BALL, Bench, set_up, waves};
use midair::picture::{Depth, write_still};
use std::process::Command;

/// Runs `compensate` on a scene that must be refused; the message must have all these words.
fn scene_is_refused(text: &str, words: &[&str]) {
    let bench = Bench::new();
    bench.write("wrong.toml", text);
    let said = bench.refuse(&["compensate", "wrong.toml", "--out", "out"]);
    for word in words {
        assert!(said.contains(word), "{word:?} is missing in\n{said}");
    }
    assert!(!bench.path("out").exists());
}

#[test]
fn scenes_that_are_wrong_are_refused_with_their_line() {
    let good = set_up(BALL);
    let with = |from: &str, to: &str| {
        assert!(good.contains(from));
        good.replace(from, to)
    };
    scene_is_refused(&with("radius", "raduis"), &["wrong.toml:11:", "raduis", "radius", "help"]);
    scene_is_refused(&with("25.0", "nan"), &["wrong.toml:11:", "help"]);
    scene_is_refused(&with("25.0", "0.0"), &["wrong.toml:11:", "help"]);
    scene_is_refused(&with("25.0", "\"25\""), &["wrong.toml:11:", "help"]);
    scene_is_refused(
        &with("size = [20.0, 20.0]", "size = [0.0, 20.0]"),
        &["wrong.toml:4:", "help"],
    );
    // The plate turned about: its back faces the viewer.
    scene_is_refused(&with("[-45.0, 0.0, 0.0]", "[135.0, 0.0, 0.0]"), &["wrong.toml:", "help"]);
    // The eye within the ball.
    scene_is_refused(&with("[0.0, 0.0, 800.0]", "[0.0, 0.0, 20.0]"), &["wrong.toml:2:", "help"]);
    scene_is_refused(&with("[[element]]", "[[element"), &["wrong.toml:"]);
    scene_is_refused("", &["wrong.toml", "help"]);
    scene_is_refused("\u{0}\u{1}", &["wrong.toml"]);
    scene_is_refused(
        &good.replace("[[element]]", "[display]\nresolution = [32768, 32768]\n[[element]]"),
        &["wrong.toml:10:", "pixels", "--size"],
    );
    scene_is_refused(
        &good.replace("kind = \"sphere\", radius = 25.0", "kind = \"mesh\", file = \"no.obj\""),
        &["wrong.toml:11:", "no.obj", "help"],
    );
}

#[test]
fn meshes_that_are_cut_or_lie_are_refused() {
    let files: [(&str, &[u8]); 4] = [
        ("cut.ply", b"ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0"),
        ("huge.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\nelement face 1000000000\nproperty list uchar int vertex_indices\nend_header\n"),
        ("open.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("noise.stl", b"\x00\x01\x02noise"),
    ];
    for (name, bytes) in files {
        let bench = Bench::new();
        bench.write(name, bytes);
        let mesh = format!("kind = \"mesh\", file = \"{name}\"");
        bench.write("mesh.toml", set_up(BALL).replace("kind = \"sphere\", radius = 25.0", &mesh));
        let said = bench.refuse(&["compensate", "mesh.toml", "--out", "out"]);
        assert!(said.contains("mesh.toml:11:") && said.contains(name), "{said}");
        assert!(!bench.path("out").exists());
    }
}

#[test]
fn pictures_that_are_cut_or_none_are_refused() {
    let bench = Bench::new();
    bench.write("ball.toml", set_up(BALL));
    write_still(&bench.path("p.png"), &waves(64, 64), Depth::Eight).unwrap();
    let whole = std::fs::read(bench.path("p.png")).unwrap();
    bench.write("cut.png", &whole[..whole.len() / 2]);
    bench.write("empty.png", b"");
    bench.write("text.png", b"this is not a picture");
    for name in ["cut.png", "empty.png", "text.png", "missing.png", "."] {
        let said = bench.refuse(&["compensate", "ball.toml", "--image", name, "--out", "out"]);
        assert!(said.contains(name), "{said}");
        let said = bench.refuse(&["view", "ball.toml", "--display", name, "--out", "v.png"]);
        assert!(said.contains(name), "{said}");
        let said = bench.refuse(&["report", "ball.toml", "--image", name, "--out", "out"]);
        assert!(said.contains(name), "{said}");
    }
    assert_eq!(bench.names("."), ["ball.toml", "cut.png", "empty.png", "p.png", "text.png"]);
}

#[test]
fn mistakes_on_the_command_line_are_named() {
    let bench = Bench::new();
    bench.write("ball.toml", set_up(BALL));
    let cases: [(&[&str], &[&str]); 14] = [
        (&["compensate", "none.toml", "--out", "out"], &["none.toml"]),
        (&["compensate", ".", "--out", "out"], &["cannot be read"]),
        (&["compensate", "ball.toml", "--out", "out", "--size", "12"], &["--size", "1024x768"]),
        (&["compensate", "ball.toml", "--out", "out", "--size", "12*8"], &["--size", "1024x768"]),
        (&["compensate", "ball.toml", "--out", "out", "--size", "0x8"], &["--size", "from 1"]),
        (&["compensate", "ball.toml", "--out", "out", "--format", "nyp"], &["nyp", "npy"]),
        (
            &["compensate", "ball.toml", "--out", "out", "--method", "inverted"],
            &["inverted", "inverse"],
        ),
        (&["compensate", "ball.toml"], &["--out"]),
        (&["compensat", "ball.toml"], &["compensat", "compensate"]),
        (
            &["view", "ball.toml", "--display", "p.png", "--out", "v.bmp"],
            &["v.bmp", ".png or .exr"],
        ),
        (
            &["view", "ball.toml", "--display", "p.png", "--out", "v.png", "--from", "1,2"],
            &["--from", "0,0,800"],
        ),
        (
            &["view", "ball.toml", "--display", "p.png", "--out", "v.png", "--window", "0"],
            &["--window", "above 0"],
        ),
        (&["check", "ball.toml", "--out", "no/where/check.png"], &["check.png", "folder"]),
        (
            &["report", "ball.toml", "--out", "out", "--size", "30000x4000", "--splat-spp", "0"],
            &["too large", "smaller"],
        ),
    ];
    for (arguments, words) in cases {
        let said = bench.refuse(arguments);
        for word in words {
            assert!(said.contains(word), "{word:?} is missing for {arguments:?} in\n{said}");
        }
    }
    assert_eq!(bench.names("."), ["ball.toml"]);
}

#[test]
fn places_that_cannot_be_written_are_named() {
    let bench = Bench::new();
    bench.write("ball.toml", set_up(&format!("[display]\nresolution = [32, 32]\n{BALL}")));
    bench.write("file", b"in the way");
    let said = bench.refuse(&["compensate", "ball.toml", "--out", "file"]);
    assert!(said.contains("file"), "{said}");
    let said = bench.refuse(&["compensate", "ball.toml", "--out", "file/below"]);
    assert!(said.contains("file/below"), "{said}");
    std::fs::create_dir_all(bench.path("out/map.exr")).unwrap();
    let said = bench.refuse(&["compensate", "ball.toml", "--out", "out"]);
    assert!(said.contains("map.exr"), "{said}");
    assert_eq!(std::fs::read(bench.path("file")).unwrap(), b"in the way");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_may_not_be_written_is_told() {
    use std::os::unix::fs::PermissionsExt as _;
    if !midair_peers::namespaces() {
        return;
    }
    let bench = Bench::new();
    bench.write("ball.toml", set_up(&format!("[display]\nresolution = [8, 8]\n{BALL}")));
    std::fs::create_dir(bench.path("locked")).unwrap();
    let mode = std::fs::Permissions::from_mode(0o555);
    std::fs::set_permissions(bench.path("locked"), mode).unwrap();
    // In a namespace where it is nobody's, even the superuser's process may do no more than its folder's mode allows.
    let output = Command::new("unshare")
        .args(["--user", env!("CARGO_BIN_EXE_midair")])
        .args(["compensate", "ball.toml", "--out", "locked/out"])
        .current_dir(bench.path(""))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("locked/out") && said.contains("permission"), "{said}");
}
