//! The patterns of a calibration, photographed by a command.

use super::x_screen::{SIDE, XScreen, pixels};
use super::{BALL, Stage};
use midair::picture::read_still;

/// A scene whose display has so many pixels along a side, and its patterns as `calibrate patterns` draws them: names and codes.
fn drawn(stage: &Stage) -> Vec<(String, Vec<u8>)> {
    stage.bench.succeed(&["calibrate", "patterns", "ball.toml", "--out", "patterns"]);
    let names = stage.bench.names("patterns");
    let pictures = names.iter().filter_map(|name| name.strip_suffix(".png"));
    pictures
        .map(|name| {
            let file = stage.bench.path(&format!("patterns/{name}.png"));
            (name.to_owned(), super::codes(&read_still(&file).unwrap().picture))
        })
        .collect()
}

/// The camera is a picture of the screen: what is on it while the command runs is the pattern's file, code for code.
#[test]
fn each_pattern_is_on_the_screen_when_its_photograph_is_taken() {
    let Some(screen) = XScreen::open() else { return };
    // Light that is not sRGB's, so that codes are told from light.
    let stage = Stage::with("gamma = 1.8\n", BALL);
    let drawn = drawn(&stage);
    // White, black, twelve stripes and sixteen sinusoids at the least.
    assert!(drawn.len() >= 30, "{}", drawn.len());
    std::fs::create_dir(stage.bench.path("taken")).unwrap();
    let camera =
        "sh -c 'xwd -root -silent > taken/$MIDAIR_PATTERN.xwd; echo taken; echo once >> taken/log'";
    let arguments = ["ball.toml", "patterns", "--shutter", camera, "--settle", "0.1", "--json"];
    let output = screen.command(&stage.bench, &arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // What the command says is not in ours.
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&told["patterns"], &told["photographed"]),
        (&drawn.len().into(), &drawn.len().into())
    );
    let log = std::fs::read_to_string(stage.bench.path("taken/log")).unwrap();
    assert_eq!(log.lines().count(), drawn.len());
    for (name, codes) in &drawn {
        let photograph = std::fs::read(stage.bench.path(&format!("taken/{name}.xwd"))).unwrap();
        assert!(pixels(&photograph) == *codes, "{name} is not what the screen showed");
    }
}

#[test]
fn a_photograph_that_fails_ends_the_show_and_is_named() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    let camera = "test $MIDAIR_PATTERN != 03-gray-s-2";
    let arguments = ["ball.toml", "patterns", "--shutter", camera, "--settle", "0.05"];
    let output = screen.command(&stage.bench, &arguments).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("03-gray-s-2, 3 of 30") && said.contains("exit status: 1"), "{said}");
}

#[test]
fn keys_show_one_pattern_after_the_other() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    let drawn = drawn(&stage);
    let show = screen.play(&stage.bench, &["ball.toml", "patterns"]);
    screen.await_picture("white", &drawn[0].1, 0);
    screen.focus();
    for (key, shown) in [("space", 1), ("Right", 2), ("Left", 1), ("Down", 2), ("space", 3)] {
        screen.key(&[key]);
        screen.await_picture(&drawn[shown].0, &drawn[shown].1, 0);
    }
    screen.key(&["Escape"]);
    let output = show.wait_with_output().unwrap();
    assert!(output.status.success());
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("4 of 30 patterns shown"), "{said}");
}

#[test]
fn by_time_they_come_by_themselves() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    let output = screen
        .command(&stage.bench, &["ball.toml", "patterns", "--each", "0.05", "--json"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&told["shown"], &told["photographed"]), (&30.into(), &serde_json::Value::Null));
}

#[test]
fn patterns_are_refused_where_they_would_not_be_pixel_by_pixel() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    // A window that somebody drags.
    let show = screen.play(&stage.bench, &["ball.toml", "patterns"]);
    screen.await_stillness();
    screen.xdotool(&["search", "--name", "midair", "windowsize", "--sync", "200", "220"]);
    let output = show.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("200 x 220") && said.contains(&format!("{SIDE} x {SIDE}")), "{said}");
    // A screen of 400 x 300, and a display of more rows.
    let text = std::fs::read_to_string(stage.bench.path("ball.toml")).unwrap();
    stage.bench.write("tall.toml", text.replace("[240, 240]", "[240, 320]"));
    let output = screen.command(&stage.bench, &["tall.toml", "patterns"]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("400 x 300") && said.contains("--list-displays"), "{said}");
    // What would change what the camera sees, or is about something else.
    for (more, said) in [(&["--size", "400x300"][..], "--size"), (&["--gain"], "--gain")] {
        let all = [&["play", "ball.toml", "patterns"], more].concat();
        assert!(stage.bench.refuse(&all).contains(said), "{more:?}");
    }
    let said = stage.bench.refuse(&["play", "ball.toml", "p.png", "--shutter", "true"]);
    assert!(said.contains("midair play SCENE patterns"), "{said}");
}
