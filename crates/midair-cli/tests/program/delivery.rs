//! Demo, schema, completions, manual pages; files that appear whole or not at all.

use super::{BALL, Bench, set_up};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

#[test]
fn the_demo_writes_everything_and_can_be_gone_on_from() {
    let bench = Bench::new();
    let said = bench.succeed(&["demo", "--size", "256x256"]);
    assert!(said.lines().count() <= 12 && said.contains("out/demo/report.html"), "{said}");
    for name in [
        "scene.toml",
        "picture.png",
        "display.png",
        "map.exr",
        "view-compensated.png",
        "view-uncompensated.png",
        "view-reference.png",
        "check.png",
        "report.json",
        "report.html",
    ] {
        assert!(bench.names("out/demo").iter().any(|n| n == name), "{name}");
    }
    bench.succeed(&["check", "out/demo/scene.toml", "--size", "64x64"]);
}

#[test]
fn the_schema_is_json_and_a_reader_may_go_away() {
    let bench = Bench::new();
    let schema: serde_json::Value = serde_json::from_str(&bench.succeed(&["schema"])).unwrap();
    assert!(schema["properties"]["viewpoint"].is_object());
    // A pipe whose reader is gone before anything is written.
    let mut child =
        bench.command(&["schema"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn completions_and_manual_pages_know_every_command() {
    let bench = Bench::new();
    let commands =
        ["demo", "compensate", "view", "check", "report", "schema", "completions", "man"];
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = bench.succeed(&["completions", shell]);
        assert!(commands.iter().all(|command| script.contains(command)), "{shell}");
    }
    bench.succeed(&["man", "--out", "man1"]);
    let names = bench.names("man1");
    assert!(names.contains(&"midair.1".to_owned()), "{names:?}");
    assert!(commands.iter().all(|c| names.contains(&format!("midair-{c}.1"))), "{names:?}");
    for command in commands {
        let help = bench.succeed(&[command, "--help"]);
        assert!(help.contains("Example") && help.contains("midair "), "{help}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing_behind() {
    let bench = Bench::new();
    bench.write("ball.toml", set_up(&format!("[display]\nresolution = [512, 512]\n{BALL}")));
    let mut child = bench
        .command(&[
            "compensate",
            "ball.toml",
            "--out",
            "new/out",
            "--method",
            "splat",
            "--spp",
            "100000",
        ])
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while !bench.path("new/out").exists() {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(20));
    }
    // The hidden folder for unfinished files is made right after its parent.
    std::thread::sleep(Duration::from_millis(200));
    assert!(
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success()
    );
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!bench.path("new/out").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_and_leaves_nothing_behind() {
    if !midair_peers::namespaces() {
        return;
    }
    let bench = Bench::new();
    bench.write("ball.toml", set_up(&format!("[display]\nresolution = [256, 256]\n{BALL}")));
    std::fs::create_dir(bench.path("disk")).unwrap();
    // A file system of 64 KiB in a namespace of its own: no root needed, gone with the process.
    let script = "mount -t tmpfs -o size=64k tmpfs disk && { \"$0\" compensate ball.toml --out disk/out; \
                  code=$?; find disk | wc -l; exit $code; }";
    let output = Command::new("unshare")
        .args([
            "--user",
            "--map-root-user",
            "--mount",
            "sh",
            "-c",
            script,
            env!("CARGO_BIN_EXE_midair"),
        ])
        .current_dir(bench.path(""))
        .output();
    let output = output.unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("free some disk space") && said.contains("map.exr"), "{said}");
    // Only the disk itself is left.
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "1");
}
