//! `midair play` in a real window under Xvfb, with real UDP packets.

mod gain;
mod patterns;
mod x_screen;

use super::{BALL, Bench, set_up, waves};
use midair::geometry::Vec3;
use midair::map::{Accuracy, Gain, Map, bleed, invert};
use midair::picture::{
    Depth, Drive, Evening, Filter, LightFrame, Overflow, Warp, read_still, srgb, write_still,
};
use midair::scene::load;
use midair::transport::Setup;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::UdpSocket;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use x_screen::{SIDE, XScreen, end};

fn codes(picture: &midair::picture::Picture) -> Vec<u8> {
    picture.pixels.iter().flat_map(|p| [p[0], p[1], p[2]].map(srgb::encode_8)).collect()
}

/// The ball's scene, a picture, and what the display shows of it for an eye.
struct Stage {
    bench: Bench,
    setup: Setup,
    picture: Vec<u8>,
}

impl Stage {
    fn new() -> Self {
        Self::with("", BALL)
    }

    /// With more about the display, and a ball.
    fn with(display: &str, ball: &str) -> Self {
        let bench = Bench::new();
        bench.write(
            "ball.toml",
            set_up(&format!("[display]\nresolution = [{SIDE}, {SIDE}]\n{display}{ball}")),
        );
        write_still(&bench.path("p.png"), &waves(200, 160), Depth::Eight).unwrap();
        let picture = codes(&read_still(&bench.path("p.png")).unwrap().picture);
        let setup = Setup::new(&load(&bench.path("ball.toml")).unwrap()).unwrap();
        Self { bench, setup, picture }
    }

    fn shown_to(&self, x: f64, y: f64, z: f64) -> Vec<u8> {
        let setup = self.setup.with_viewpoint(Vec3::new(x, y, z));
        self.through(&invert(&setup, Accuracy::default()).0)
    }

    /// The map for an eye, going on by one ring, and the gain of each of its pixels.
    fn gain(&self, eye: Vec3) -> (Map, Gain) {
        let setup = self.setup.with_viewpoint(eye);
        let (map, _) = invert(&setup, Accuracy::default());
        let gain = midair::simulate::gain(&setup, &map);
        let known = |pixel: &usize| map.answer(*pixel).is_some();
        let mut ringed = gain.clone();
        for (i, rgb) in ringed.rgb.iter_mut().enumerate().filter(|(i, _)| !known(i)) {
            let around = |at: usize| at.saturating_sub(1)..(at + 2).min(SIDE);
            let beside = around(i / SIDE).flat_map(|y| around(i % SIDE).map(move |x| y * SIDE + x));
            let beside: Vec<_> = beside.filter(known).map(|pixel| gain.rgb[pixel]).collect();
            *rgb = [0, 1, 2]
                .map(|c| beside.iter().map(|rgb| rgb[c]).sum::<f32>() / beside.len() as f32);
        }
        (bleed(&map, 1), ringed)
    }

    /// What the display shows to an eye with the gain divided out of each of its pixels' light. White is as bright as the scene's own
    /// viewpoint allows.
    fn evened(&self, eye: Vec3) -> Vec<u8> {
        let own = self.gain(self.setup.viewpoint).1;
        let level = Evening::for_white(&own, Overflow::Fit).level() as f32;
        let (map, gain) = self.gain(eye);
        let light: Vec<f32> = self.picture.iter().map(|&code| srgb::decode_8(code)).collect();
        let mut shown = vec![0; SIDE * SIDE * 3];
        for (i, uv) in map.uv.iter().enumerate().filter(|(_, uv)| uv[0].is_finite()) {
            let [x, y] = [(uv[0] * 200.0 - 0.5, 199.0), ((1.0 - uv[1]) * 160.0 - 0.5, 159.0)]
                .map(|(at, last): (f64, f64)| at.clamp(0.0, last));
            let [(left, right), (above, below)] =
                [(x, 199), (y, 159)].map(|(at, last)| (at as usize, (at as usize + 1).min(last)));
            let [a, b] = [x.fract() as f32, y.fract() as f32];
            for c in 0..3 {
                let at = |column: usize, row: usize| light[(row * 200 + column) * 3 + c];
                let upper = (1.0 - a) * at(left, above) + a * at(right, above);
                let lower = (1.0 - a) * at(left, below) + a * at(right, below);
                let mean = (1.0 - b) * upper + b * lower;
                shown[3 * i + c] = srgb::encode_8((mean * level / gain.rgb[i][c]).min(1.0));
            }
        }
        shown
    }

    fn through(&self, map: &Map) -> Vec<u8> {
        let warp = Warp::new(map, [200, 160], Filter::Bilinear).unwrap();
        let (mut light, mut shown) = (LightFrame::default(), vec![0; SIDE * SIDE * 3]);
        light.decode(&self.picture, 3).unwrap();
        warp.apply_light(&light, 3, &Drive::default(), &mut shown).unwrap();
        shown
    }
}

/// A port that nobody has.
fn free_port() -> u16 {
    UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

/// What opentrack sends of a place in mm: six little-endian doubles, x, y, z in cm and three angles.
fn opentrack([x, y, z]: [f64; 3]) -> Vec<u8> {
    let numbers = [x / 10.0, y / 10.0, z / 10.0, 0.0, 0.0, 0.0];
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

/// A code of difference where a weight of 14 bits falls the other way: the live map is solved to 2.5e-5 of the picture, and
/// the waves rise by less than 90 codes a pixel of 1/160.
const TOLERANCE: u8 = 2;

/// One code more for the gain's grid and its place before the warp.
const EVENED: u8 = TOLERANCE + 1;

#[test]
fn the_window_shows_the_display_image_and_obeys_keys() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    let show = screen.play(&stage.bench, &["ball.toml", "p.png"]);
    let compensated = stage.shown_to(0.0, 0.0, 800.0);
    screen.await_picture("compensated", &compensated, TOLERANCE);
    screen.focus();
    screen.key(&["u"]);
    let plain = stage.through(&Map::identity(SIDE, SIDE));
    screen.await_picture("uncompensated", &plain, TOLERANCE);
    screen.key(&["u"]);
    screen.await_picture("compensated again", &compensated, TOLERANCE);
    // Thirty mm to the right, and the map follows.
    for _ in 0..30 {
        screen.key(&["shift+Right"]);
    }
    screen.await_picture("nudged", &stage.shown_to(30.0, 0.0, 800.0), TOLERANCE);
    screen.key(&["s"]);
    let saved = stage.bench.path("ball-nudged.toml");
    let start = Instant::now();
    while !saved.exists() && start.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(load(&saved).unwrap().scene.viewpoint, [30.0, 0.0, 800.0]);
    // The user's file, with the changed number in its place.
    let text = std::fs::read_to_string(&saved).unwrap();
    let original = std::fs::read_to_string(stage.bench.path("ball.toml")).unwrap();
    let differing = text.lines().zip(original.lines()).filter(|(new, old)| new != old);
    assert_eq!((differing.count(), text.lines().count()), (1, original.lines().count()), "{text}");
    screen.key(&["Tab"]);
    for _ in 0..3 {
        screen.key(&["Up"]);
    }
    screen.key(&["ctrl+Right", "s"]);
    let start = Instant::now();
    loop {
        let pose = load(&saved).unwrap().scene.elements[0].pose;
        if pose.position == [0.0, 0.3, 0.0] && pose.rotation == [0.0, 0.1, 0.0] {
            break;
        }
        assert!(start.elapsed() < Duration::from_secs(20), "{pose:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
    screen.key(&["Escape"]);
    let output = show.wait_with_output().unwrap();
    assert!(output.status.success());
    assert!(String::from_utf8_lossy(&output.stdout).contains("ball-nudged.toml"));
}

/// Whether a graphics device can be had, be it in software; a note where not.
fn has_graphics(screen: &XScreen, stage: &Stage) -> bool {
    let arguments = ["ball.toml", "p.png", "--renderer", "gpu", "--for", "0.1"];
    let output = screen.command(&stage.bench, &arguments).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() || said.contains("no graphics device"), "{said}");
    if !output.status.success() {
        midair_peers::missing(midair_peers::Peer::Graphics, said.trim());
    }
    output.status.success()
}

/// A graphics device computes with the processor's integers: the windows are the same to the code.
#[test]
fn a_graphics_device_shows_what_the_processor_shows() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::with("gamma = 1.8\n", BALL);
    if !has_graphics(&screen, &stage) {
        return;
    }
    for more in [&[][..], &["--gain", "soft"]] {
        let shots = ["cpu", "gpu"].map(|renderer| {
            let arguments = [&["ball.toml", "p.png", "--renderer", renderer], more].concat();
            let mut show = screen.play(&stage.bench, &arguments);
            let shown = screen.await_stillness();
            // A window's keys and changes of size, on the device too.
            screen.focus();
            screen.key(&["l"]);
            let lattice = screen.await_change(&shown);
            screen.key(&["l"]);
            screen.await_picture("the picture again", &shown, 0);
            for side in ["200", "240"] {
                screen.xdotool(&["search", "--name", "midair", "windowsize", "--sync", side, side]);
            }
            screen.await_picture("its own size again", &shown, 0);
            assert!(show.try_wait().unwrap().is_none());
            end(show);
            (shown, lattice)
        });
        assert!(shots[0] == shots[1], "{more:?}: the pictures differ");
    }
}

#[test]
fn without_a_graphics_device_the_processor_shows_or_the_reason_is_told() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    // No drivers for the loader to find.
    let without = |renderer: &str| {
        let mut command = screen.command(
            &stage.bench,
            &["ball.toml", "p.png", "--renderer", renderer, "--for", "1", "--json"],
        );
        let none = stage.bench.path("no-driver.json");
        command.env("VK_DRIVER_FILES", &none).env("VK_ICD_FILENAMES", &none).output().unwrap()
    };
    let output = without("gpu");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("no graphics device") && said.contains("--renderer cpu"), "{said}");
    let output = without("auto");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["renderer"], "processor");
}

#[test]
fn it_follows_opentrack_and_osc() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    for protocol in ["opentrack", "osc"] {
        let port = free_port();
        let track = format!("{protocol}:{port}");
        let show = screen.play(
            &stage.bench,
            &[
                "ball.toml",
                "p.png",
                "--track",
                &track,
                "--no-smoothing",
                "--predict",
                "0",
                "--tracker-position",
                "0,0,100",
            ],
        );
        screen.await_picture("at rest", &stage.shown_to(0.0, 0.0, 800.0), TOLERANCE);
        for [x, y, z] in [[40.0, 10.0, 650.0], [-35.0, 0.0, 720.0]] {
            let packet: Vec<u8> = if protocol == "opentrack" {
                opentrack([x, y, z])
            } else {
                let mut message = b"/midair/viewpoint\0\0\0,fff\0\0\0\0".to_vec();
                message.extend([x, y, z].iter().flat_map(|n| (*n as f32).to_be_bytes()));
                message
            };
            socket.send_to(&packet, ("127.0.0.1", port)).unwrap();
            screen.await_picture(protocol, &stage.shown_to(x, y, z + 100.0), TOLERANCE);
        }
        end(show);
    }
}

#[test]
fn frames_are_taken_from_standard_input() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    let mut show = screen.play(&stage.bench, &["ball.toml", "-", "--source-size", "200x160"]);
    let mut pipe = show.stdin.take().unwrap();
    let frame: Vec<u8> =
        stage.picture.as_chunks::<3>().0.iter().flat_map(|p| [p[0], p[1], p[2], 255]).collect();
    pipe.write_all(&vec![90; frame.len()]).unwrap();
    pipe.write_all(&frame).unwrap();
    screen.await_picture("standard input", &stage.shown_to(0.0, 0.0, 800.0), TOLERANCE);
    drop(pipe);
    end(show);
}

#[test]
fn latency_is_measured_from_packet_to_screen() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    let show = screen.play(&stage.bench, &["ball.toml", "p.png", "--bench", "--json"]);
    let output = show.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let told = &told["latency_ms"];
    let number = |name: &str| told[name].as_f64().unwrap();
    assert_eq!(number("sent"), 300.0);
    assert!(number("shown") > 10.0 && number("shown") <= 300.0, "{told}");
    // A viewpoint is on the screen after its map, and not before.
    assert!(number("map_median") > 0.0 && number("map_median") <= number("median"), "{told}");
    assert!(
        number("median") <= number("percentile_99") && number("percentile_99") <= number("max"),
        "{told}"
    );
}

#[test]
fn what_a_scene_would_refuse_is_refused_live_and_told() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    let port = free_port();
    let track = format!("opentrack:{port}");
    let show = screen.play(&stage.bench, &["ball.toml", "p.png", "--track", &track, "--json"]);
    let home = stage.shown_to(0.0, 0.0, 800.0);
    screen.await_picture("at rest", &home, TOLERANCE);
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    // In the ball, and packets that are no readings.
    socket.send_to(&opentrack([1.0, 2.0, 3.0]), ("127.0.0.1", port)).unwrap();
    socket.send_to(&[0; 24], ("127.0.0.1", port)).unwrap();
    // Words over the upper rows; below them the last map's picture.
    let told = screen.await_change(&home);
    let below = 3 * SIDE * SIDE / 2..;
    let worst = told[below.clone()].iter().zip(&home[below]).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst.unwrap() <= TOLERANCE, "off by {worst:?}");
    screen.focus();
    screen.key(&["Escape"]);
    let output = show.wait_with_output().unwrap();
    assert!(output.status.success());
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["packets"]["readings"], 1, "{told}");
    assert_eq!(told["packets"]["others"], 1, "{told}");
}

#[test]
fn the_terminal_has_what_matters_and_nothing_else() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    let port = free_port();
    let track = format!("osc:{port}");
    let mut command =
        screen.command(&stage.bench, &["ball.toml", "p.png", "--track", &track, "--for", "4"]);
    // What drivers' libraries complain of.
    let output = command.env_remove("XDG_RUNTIME_DIR").output().unwrap();
    assert!(output.status.success());
    let said = String::from_utf8_lossy(&output.stderr);
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines.len(), 2, "{said}");
    assert!(lines[0].contains("not to scale") && lines[0].contains("--fullscreen"), "{said}");
    assert!(lines[1].contains("nothing comes from a tracker"), "{said}");
}

#[test]
fn screens_are_listed_by_their_numbers() {
    let Some(screen) = XScreen::open() else { return };
    let stage = Stage::new();
    let output = screen.command(&stage.bench, &["--list-displays", "--json"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["displays"][0]["size"], serde_json::json!([400, 300]), "{told}");
    let wrong = ["ball.toml", "p.png", "--display", "7"];
    let output = screen.command(&stage.bench, &wrong).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("no screen 7") && said.contains("400 x 300"), "{said}");
}

#[test]
fn what_is_missing_is_told() {
    let stage = Stage::new();
    let run = |arguments: &[&str]| {
        let mut all = vec!["play"];
        all.extend(arguments);
        let mut command = stage.bench.command(&all);
        let output = command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let said = run(&["ball.toml", "p.png"]);
    assert!(said.contains("no window can be opened") && said.contains("xvfb-run"), "{said}");
    assert!(run(&["ball.toml", "none.mp4"]).contains("no such file"));
    assert!(run(&["ball.toml", "-"]).contains("--source-size"));
    assert!(run(&["ball.toml", "p.png", "--track", "opentrak:1"]).contains("opentrack:4242"));
}
