//! `midair apply`, with the real ffmpeg.

mod stopped;

use super::{BALL, Bench, set_up, waves};
use midair::map::format::{Format, read_map, write_map, write_map_and_gain};
use midair::map::{Gain, Map, Status};
use midair::picture::{Depth, display_image, read_still, srgb, write_still};
use midair_video::{Decoder, probe};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

pub fn ffmpeg(bench: &Bench, arguments: &str) {
    let output = Command::new("ffmpeg")
        .args(["-v", "error", "-y"])
        .args(arguments.split(' '))
        .current_dir(bench.folder.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Upside down and mirrored, with a hole at the left.
fn turned(width: usize, height: usize) -> Map {
    let mut map = Map::identity(width, height);
    for (i, uv) in map.uv.iter_mut().enumerate() {
        *uv = [1.0 - uv[0], 1.0 - uv[1]];
        if i % width < 6 {
            (*uv, map.status[i]) = ([f64::NAN; 2], Status::Outside);
        }
    }
    map
}

fn save(bench: &Bench, map: &Map) {
    write_map(map, [64, 48], Format::Exr, &bench.path("map.exr")).unwrap();
}

/// Every frame of a film, as 8-bit RGB, with its time in seconds.
pub fn frames(bench: &Bench, name: &str) -> Vec<(f64, Vec<u8>)> {
    let film = probe(&bench.path(name)).unwrap();
    let mut decoder = Decoder::new(&film, false).unwrap();
    let (mut frames, mut frame) = (Vec::new(), Vec::new());
    while let Some(timing) = decoder.next(&mut frame).unwrap() {
        frames.push((timing.seconds(), frame.clone()));
    }
    frames
}

pub fn said_by_ffprobe(bench: &Bench, name: &str, entries: &str) -> String {
    let output = Command::new("ffprobe")
        .args(["-v", "error", "-of", "csv=p=0", "-show_entries", entries, name])
        .current_dir(bench.folder.path())
        .output()
        .unwrap();
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_still_is_what_compensate_would_show() {
    let bench = Bench::new();
    let map = turned(64, 48);
    save(&bench, &map);
    for (depth, name) in
        [(Depth::Eight, "p.png"), (Depth::Sixteen, "q.png"), (Depth::Float, "r.exr")]
    {
        write_still(&bench.path(name), &waves(64, 48), depth).unwrap();
        bench.succeed(&["apply", "map.exr", name, "shown.png"]);
        let shown = read_still(&bench.path("shown.png")).unwrap();
        assert_eq!(shown.depth, if depth == Depth::Eight { Depth::Eight } else { Depth::Sixteen });
        let given = read_still(&bench.path(name)).unwrap().picture;
        let expected = display_image(&given, &map);
        for (a, b) in shown.picture.pixels.iter().zip(&expected.pixels) {
            for c in 0..3 {
                // Half a code of 8 bits, at the curve's steepest in light: 1/255/2 * 2.3.
                assert!((a[c] - b[c]).abs() < 0.005);
            }
        }
    }
    bench.succeed(&["apply", "map.exr", "r.exr", "shown.exr"]);
    assert_eq!(read_still(&bench.path("shown.exr")).unwrap().depth, Depth::Float);
}

/// The ring beyond the map's answers, which interpolation needs, is drawn by both; from files that hold u and v in single precision or better,
/// to the byte.
#[test]
fn apply_draws_what_compensate_drew() {
    let bench = Bench::new();
    // Larger than what the ball makes of the image, so that the coverage ends on the display.
    let display = "[display]\nresolution = [256, 256]\nsize = [60.0, 60.0]\n";
    bench.write("ball.toml", set_up(&format!("{display}{BALL}")));
    for (depth, name) in
        [(Depth::Eight, "p.png"), (Depth::Sixteen, "q.png"), (Depth::Float, "r.exr")]
    {
        write_still(&bench.path(name), &waves(200, 160), depth).unwrap();
    }
    let kinds = ["exr", "npy", "blender", "touchdesigner"];
    let maps = ["map.exr", "map.npy", "map-blender.exr", "map-touchdesigner.exr"];
    let mut compared = 0;
    for gain in [None, Some("fit"), Some("clip"), Some("soft")] {
        for (name, bleed) in [("p.png", "0"), ("q.png", "0"), ("r.exr", "0"), ("p.png", "5")] {
            let mut compensate = vec!["compensate", "ball.toml", "--image", name, "--out", "out"];
            let list = kinds.join(",");
            compensate.extend(["--bleed", bleed, "--format", &list]);
            gain.into_iter().for_each(|mode| compensate.extend(["--gain", mode]));
            bench.succeed(&compensate);
            let shown = read_still(&bench.path("out/display.png")).unwrap().picture;
            let map = read_map(&bench.path("out/map.exr"), None, None).unwrap().map;
            // The waves are nowhere black.
            let lit = shown.pixels.iter().filter(|pixel| pixel[1] > 0.0).count();
            let covered = map.status.iter().filter(|status| status.is_answered()).count();
            assert!(covered > 5000 && lit > covered + 200 && lit < 256 * 256, "{covered} {lit}");
            for (kind, map) in kinds.into_iter().zip(maps) {
                let map = format!("out/{map}");
                let mut apply = vec!["apply", &map, name, "shown.png", "--from", kind];
                match gain {
                    // Only this kind has a place for it.
                    Some(_) if kind != "exr" => continue,
                    Some(mode) => apply.extend(["--gain", mode]),
                    None => {}
                }
                bench.succeed(&apply);
                let [mut a, b] =
                    ["out/display.png", "shown.png"].map(|p| std::fs::read(bench.path(p)).unwrap());
                // A map knows nothing of millimetres: the chunk that says how large pixels are, behind the header, is the scene's alone.
                assert_eq!(a[37..41], *b"pHYs");
                a.drain(33..54);
                assert!(a == b, "{name} by {kind}, gain {gain:?}, bleed {bleed}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 4 * 4 + 3 * 4);
    // The others place image points more coarsely, but know as well where the image ends.
    let white = midair::picture::Picture::filled(8, 8, [1.0; 4]);
    write_still(&bench.path("white.png"), &white, Depth::Eight).unwrap();
    let all: Vec<String> = Format::all().map(|format| format.to_string()).collect();
    let list = all.join(",");
    bench.succeed(&[
        "compensate",
        "ball.toml",
        "--image",
        "white.png",
        "--out",
        "all",
        "--bleed",
        "4",
        "--format",
        &list,
    ]);
    let display = read_still(&bench.path("all/display.png")).unwrap().picture;
    for format in Format::all() {
        let map = format!("all/{}", format.file_name());
        bench.succeed(&["apply", &map, "white.png", "shown.png", "--from", format.name()]);
        assert_eq!(read_still(&bench.path("shown.png")).unwrap().picture, display, "{format}");
    }
}

#[test]
fn numbered_stills_are_done_one_by_one_and_gone_on_with() {
    let bench = Bench::new();
    save(&bench, &turned(64, 48));
    std::fs::create_dir(bench.path("in")).unwrap();
    for number in [3, 4, 7] {
        write_still(&bench.path(&format!("in/{number:03}.png")), &waves(64, 48), Depth::Eight)
            .unwrap();
    }
    bench.succeed(&["apply", "map.exr", "in/%03d.png", "out/f%02d.png"]);
    assert_eq!(bench.names("out"), ["f03.png", "f04.png", "f07.png"]);
    let said = bench.refuse(&["apply", "map.exr", "in/%03d.png", "out/f%02d.png", "--resume"]);
    assert!(said.contains("nothing to go on with"), "{said}");
    // A broken picture stops the work; mended, it is gone on with.
    bench.write("in/005.png", b"broken");
    let said = bench.refuse(&["apply", "map.exr", "in/%03d.png", "more/f%02d.png"]);
    assert!(said.contains("005.png"), "{said}");
    let before = std::fs::metadata(bench.path("more/f03.png")).unwrap().modified().unwrap();
    write_still(&bench.path("in/005.png"), &waves(64, 48), Depth::Eight).unwrap();
    let told = bench.json(&["apply", "map.exr", "in/%03d.png", "more/f%02d.png", "--resume"]);
    assert_eq!((&told["frames"], &told["resumed_frames"]), (&4.into(), &2.into()));
    assert_eq!(bench.names("more"), ["f03.png", "f04.png", "f05.png", "f07.png"]);
    assert_eq!(std::fs::metadata(bench.path("more/f03.png")).unwrap().modified().unwrap(), before);
}

#[test]
fn a_film_keeps_its_sound_its_times_and_its_colours() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = Bench::new();
    let map = turned(64, 48);
    save(&bench, &map);
    // Uneven times and a sound that begins with the picture; lossless, so that the warp is all that happens to it.
    ffmpeg(
        &bench,
        "-f lavfi -i testsrc2=size=64x48:rate=25:duration=2 -f lavfi -i sine=frequency=440:duration=2 \
         -vf select=not(eq(mod(n\\,5)\\,2)) -fps_mode vfr -c:v ffv1 -pix_fmt gbrp -c:a aac -metadata title=Waves in.mkv",
    );
    let told = bench.json(&[
        "apply", "map.exr", "in.mkv", "out.mkv", "--piece", "7", "--", "-c:v", "ffv1", "-pix_fmt",
        "gbrp",
    ]);
    assert_eq!(told["frames"], 40);
    let (given, shown) = (frames(&bench, "in.mkv"), frames(&bench, "out.mkv"));
    assert_eq!((given.len(), shown.len()), (40, 40));
    for ((time, frame), (shown_time, shown)) in given.iter().zip(&shown) {
        // Matroska counts milliseconds; pieces of 7 frames are set end to end.
        assert!((time - shown_time).abs() < 1.1e-3, "{time} {shown_time}");
        for i in 0..64 * 48 {
            // Turned by half a turn, pixel on pixel.
            let from = 64 * 48 - 1 - i;
            for c in 0..3 {
                // Column 5 is the ring beyond the map's answers.
                if i % 64 == 5 {
                    continue;
                }
                let expected = if i % 64 < 5 { 0 } else { frame[3 * from + c] };
                assert!(shown[3 * i + c].abs_diff(expected) <= 1, "{i} {c}");
            }
        }
    }
    // Sound is not coded again: the same packets.
    let packets = |name| {
        let text = said_by_ffprobe(&bench, name, "packet=size,codec_type");
        text.lines().filter(|line| line.contains("audio")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(packets("in.mkv").len() > 50);
    assert_eq!(packets("in.mkv"), packets("out.mkv"));
    assert!(said_by_ffprobe(&bench, "out.mkv", "format_tags=title").contains("Waves"));
    assert!(bench.names(".").iter().all(|name| !name.contains("pieces")));
    bench.succeed(&["apply", "map.exr", "in.mkv", "silent.mp4", "--no-audio"]);
    assert!(!said_by_ffprobe(&bench, "silent.mp4", "stream=codec_type").contains("audio"));
}

#[test]
fn means_are_means_of_light_at_8_and_at_10_bits() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = Bench::new();
    // Columns of black and white, seen half-way between them: half the light, which is code 188, not 128.
    let mut map = Map::identity(64, 48);
    for (i, uv) in map.uv.iter_mut().enumerate() {
        uv[0] = ((i % 64) as f64 + 1.0).min(63.5) / 64.0;
    }
    save(&bench, &map);
    for (name, coder) in [
        ("eight.mkv", "-c:v ffv1 -pix_fmt gbrp"),
        ("ten.mkv", "-c:v ffv1 -pix_fmt gbrp10le"),
        ("ten.mp4", "-c:v libx265 -x265-params lossless=1:log-level=none -pix_fmt yuv444p10le"),
    ] {
        ffmpeg(
            &bench,
            &format!(
                "-f lavfi -i color=black:size=64x48:rate=5:duration=1 -vf format=gbrp,geq=r=mod(X\\,2)*255:g=mod(X\\,2)*255:b=mod(X\\,2)*255 {coder} {name}"
            ),
        );
        let out = format!("out-{name}");
        let mut arguments = vec!["apply", "map.exr", name, &out, "--filter", "bilinear", "--"];
        arguments.extend(coder.split(' '));
        bench.succeed(&arguments);
        assert_eq!(probe(&bench.path(&out)).unwrap().deep, name.starts_with("ten"), "{name}");
        for (_, frame) in frames(&bench, &out) {
            for (i, pixel) in
                frame.as_chunks::<3>().0.iter().enumerate().filter(|(i, _)| i % 64 < 62)
            {
                // 10 bits and YUV round once more.
                assert!(
                    pixel.iter().all(|&code| code.abs_diff(srgb::encode_8(0.5)) <= 1),
                    "{name} {i}: {pixel:?}"
                );
            }
        }
    }
}

#[test]
fn films_are_made_of_pictures_and_pictures_of_films() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = Bench::new();
    save(&bench, &Map::identity(64, 48));
    std::fs::create_dir(bench.path("in")).unwrap();
    for number in 0..5 {
        let mut picture = waves(64, 48);
        picture.pixels.rotate_left(number * 7);
        write_still(&bench.path(&format!("in/{number:03}.png")), &picture, Depth::Eight).unwrap();
    }
    bench.succeed(&[
        "apply",
        "map.exr",
        "in/%03d.png",
        "film.mkv",
        "--rate",
        "12.5",
        "--",
        "-c:v",
        "ffv1",
        "-pix_fmt",
        "gbrp",
    ]);
    let times: Vec<f64> = frames(&bench, "film.mkv").iter().map(|(time, _)| *time).collect();
    assert_eq!(times.len(), 5);
    assert!(
        times.iter().enumerate().all(|(i, time)| (time - 0.08 * i as f64).abs() < 1.1e-3),
        "{times:?}"
    );
    bench.succeed(&["apply", "map.exr", "film.mkv", "back/%03d.png"]);
    assert_eq!(bench.names("back"), ["001.png", "002.png", "003.png", "004.png", "005.png"]);
    for number in 0..5 {
        // The identity and a lossless codec: the codes themselves.
        let given = read_still(&bench.path(&format!("in/{number:03}.png"))).unwrap().picture;
        let back = read_still(&bench.path(&format!("back/{:03}.png", number + 1))).unwrap().picture;
        assert!(given.pixels == back.pixels, "{number}");
    }
}

#[test]
fn a_maps_gain_is_divided_out_of_stills_and_films_and_survives_conversion() {
    let bench = Bench::new();
    let map = Map::identity(32, 24);
    // From left to right a half, three quarters, all of the light arrives; without blue's last tenth.
    let of = |i: usize| [0.5f32, 0.75, 1.0][(i % 32) / 11];
    let rgb: Vec<[f32; 3]> = (0..32 * 24).map(|i| [of(i), of(i), 0.9 * of(i)]).collect();
    let gain = Gain { width: 32, height: 24, rgb };
    write_map_and_gain(&map, Some(&gain), [32, 24], Format::Exr, &bench.path("map.exr")).unwrap();
    let half = midair::picture::Picture::filled(32, 24, [0.5, 0.5, 0.5, 1.0]);
    write_still(&bench.path("a.exr"), &half, Depth::Float).unwrap();

    // A still is as bright as it can be: its worst pixel, blue on the left, sends all that there is.
    let told = bench.json(&["apply", "map.exr", "a.exr", "even.exr"]);
    assert!(told["notes"][0].as_str().unwrap().contains("white is 90.0 %"), "{told}");
    let shown = read_still(&bench.path("even.exr")).unwrap().picture;
    for (pixel, gain) in shown.pixels.iter().zip(&gain.rgb) {
        for c in 0..3 {
            // Light 0.5 at level 0.45 / 0.5; half floats have 11 bits.
            assert!((pixel[c] * gain[c] - 0.45).abs() < 0.45 / 1024.0, "{pixel:?}");
        }
    }
    bench.json(&["apply", "map.exr", "a.exr", "plain.exr", "--no-gain"]);
    assert_eq!(read_still(&bench.path("plain.exr")).unwrap().picture, half);

    // Converted it is there still; where it has no place, that is said.
    bench.json(&["map", "convert", "map.exr", "half.exr", "--to", "exr-half"]);
    let kept = read_map(&bench.path("half.exr"), None, None).unwrap().gain.unwrap();
    let close = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).all(|c| (a[c] - b[c]).abs() < 1e-3);
    assert!(kept.rgb.iter().zip(&gain.rgb).all(close));
    let told =
        bench.json(&["map", "convert", "map.exr", "m.npy", "--to", "opencv", "--source", "32x24"]);
    assert!(told["notes"].to_string().contains("gain is left out"), "{told}");
    let output = bench
        .command(&["apply", "m_x.npy", "a.exr", "b.exr", "--from", "opencv", "--gain", "fit"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && said.contains("this map has no gain"), "{said}");

    // Numbered pictures and films are at the level of white, 0.45, whatever they show.
    write_still(&bench.path("n1.png"), &half, Depth::Eight).unwrap();
    write_still(&bench.path("n2.png"), &half, Depth::Eight).unwrap();
    let level = |pixels: &[[f32; 4]], tolerance: f32| {
        for (pixel, gain) in pixels.iter().zip(&gain.rgb) {
            for c in 0..3 {
                let seen = pixel[c] * gain[c];
                assert!((seen - 0.225).abs() < tolerance, "{pixel:?} {gain:?}");
            }
        }
    };
    bench.json(&["apply", "map.exr", "n%d.png", "s%d.png"]);
    // A code of sRGB near 0.25 to 0.5 is 0.004 to 0.006 of light; half of one each at reading and writing.
    level(&read_still(&bench.path("s2.png")).unwrap().picture.pixels, 0.006);
    if !midair_peers::ffmpeg() {
        return;
    }
    let to = ["apply", "map.exr", "n%d.png", "film.mkv", "--", "-c:v", "ffv1", "-pix_fmt", "gbrp"];
    bench.json(&to);
    let (_, film) = frames(&bench, "film.mkv").pop().unwrap();
    let pixels: Vec<[f32; 4]> = film
        .as_chunks::<3>()
        .0
        .iter()
        .map(|p| [srgb::decode_8(p[0]), srgb::decode_8(p[1]), srgb::decode_8(p[2]), 1.0])
        .collect();
    level(&pixels, 0.006);
}
