//! Real films through the real ffmpeg.

use super::*;
use std::process::Command;

fn noise(length: usize, seed: u32) -> Vec<u8> {
    (0..length as u32)
        .map(|i| (i ^ seed.wrapping_mul(977)).wrapping_mul(2_654_435_761).to_be_bytes()[0])
        .collect()
}

/// Uneven times, in units of 1001/30000 s.
const TICKS: [i64; 6] = [5, 6, 9, 10, 17, 18];
const BASE: [u64; 2] = [1001, 30000];

#[test]
fn frames_and_their_times_survive_a_lossless_codec_to_the_bit() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (deep, format, name) in [(false, "gbrp", "a.mov"), (true, "gbrp16le", "b.nut")] {
        let path = folder.path().join(name);
        let size = [37, 26];
        let options = ["-c:v", "ffv1", "-pix_fmt", format].map(str::to_owned);
        let colour = Colour::usual(26);
        let recipe = Recipe {
            size,
            deep,
            rate: [30000, 1001],
            colour: &colour,
            base: BASE,
            options: &options,
            coded: None,
        };
        let mut encoder = Encoder::new(&path, &recipe).unwrap();
        let length = 37 * 26 * if deep { 6 } else { 3 };
        for (i, ticks) in TICKS.into_iter().enumerate() {
            encoder.write(&noise(length, i as u32), Timing { ticks, base: BASE }).unwrap();
        }
        encoder.finish().unwrap();
        let film = probe(&path).unwrap();
        assert_eq!((film.size, film.deep), (size, deep), "{name}");
        let mut decoder = Decoder::new(&film, deep).unwrap();
        let mut frame = Vec::new();
        for (i, ticks) in TICKS.into_iter().enumerate() {
            let timing = decoder.next(&mut frame).unwrap().unwrap();
            // The film begins with its first frame; half a nanosecond of rounding, twice.
            let since = Timing { ticks: ticks - TICKS[0], base: BASE }.nanoseconds();
            assert!((timing.nanoseconds() - since).abs() <= 1, "{name}: {timing:?} {since}");
            assert_eq!(frame, noise(length, i as u32), "{name} {i}");
        }
        assert_eq!(decoder.next(&mut frame).unwrap(), None);
        assert_eq!(decoder.finish().unwrap(), Vec::<String>::new());
    }
}

#[test]
fn parts_are_joined_with_their_times_and_begin_where_they_should() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for extension in ["mp4", "mkv"] {
        let (colour, size) = (Colour::usual(48), [64, 48]);
        let recipe = Recipe {
            size,
            deep: false,
            rate: [30000, 1001],
            colour: &colour,
            base: BASE,
            options: &[],
            coded: None,
        };
        let mut parts = Vec::new();
        for (i, ticks) in TICKS.chunks(2).enumerate() {
            let path = folder.path().join(format!("{i}.{extension}"));
            let mut encoder = Encoder::new(&path, &recipe).unwrap();
            for &ticks in ticks {
                encoder
                    .write(&vec![40 * i as u8; 64 * 48 * 3], Timing { ticks, base: BASE })
                    .unwrap();
            }
            encoder.finish().unwrap();
            let next = TICKS.get(2 * i + 2).map(|next| next - ticks[0]);
            parts.push(Part {
                path,
                duration: next.map(|ticks| Timing { ticks, base: BASE }.seconds()),
            });
        }
        let target = folder.path().join(format!("joined.{extension}"));
        let start = Timing { ticks: TICKS[0], base: BASE }.seconds();
        let last = Timing { ticks: TICKS[5], base: BASE }.seconds();
        // The last picture stands for two seconds.
        let (end, frames) = (last + 2.0, 6);
        let rate = [25, 1];
        let joining = Joining { parts: &parts, start, last, end, frames, rate, extras: None };
        join(&joining, &folder.path().join("list.txt"), &target).unwrap();
        let whole = probe(&target).unwrap().end().unwrap();
        // Matroska counts milliseconds, and the length from 0; MP4 counts its beginning in milliseconds.
        // By the film's own clock, which begins with its first picture.
        assert!((whole - (end - start)).abs() < 2.1e-3, "{extension}: {whole} {end} {start}");
        let output = Command::new("ffprobe")
            .args(["-v", "error", "-show_entries", "frame=pts_time", "-of", "csv=p=0"])
            .arg(&target)
            .output()
            .unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        let lines =
            text.lines().map(|line| line.trim_end_matches(',')).filter(|line| !line.is_empty());
        let times: Vec<f64> = lines.map(|line| line.parse().unwrap()).collect();
        let wanted = TICKS.map(|ticks| Timing { ticks, base: BASE }.seconds());
        assert_eq!(times.len(), 6, "{extension}: {times:?}");
        // MP4 counts the beginning in milliseconds and what follows in the film's own units; Matroska all in milliseconds.
        assert!((times[0] - wanted[0]).abs() < 1.1e-3, "{extension}: {times:?}");
        for (time, wanted) in times.iter().zip(wanted.map(|time| time - wanted[0])) {
            let step = if extension == "mkv" { 1.1e-3 } else { 1e-5 };
            assert!((time - times[0] - wanted).abs() < step, "{extension}: {times:?} {wanted}");
        }
    }
}

#[test]
fn what_ffmpeg_complains_of_is_passed_on() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    let message = |result: Result<Film, VideoError>| result.unwrap_err().to_string();
    assert!(message(probe(&path)).contains("No such file"));
    std::fs::write(&path, noise(5000, 1)).unwrap();
    assert!(message(probe(&path)).contains("Invalid data"));
    let colour = Colour::usual(48);
    let options = ["-c:v", "nonsense"].map(str::to_owned);
    let recipe = Recipe {
        size: [64, 48],
        deep: false,
        rate: [25, 1],
        colour: &colour,
        base: [1, 25],
        options: &options,
        coded: None,
    };
    // Asked for one frame first, before any work.
    let error = Encoder::new(&path, &recipe).err().unwrap().to_string();
    assert!(error.contains("nonsense") && error.contains("a.mp4"), "{error}");
}

#[test]
fn colours_come_back_within_the_roundings_of_yuv() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (deep, extension) in [(false, "mp4"), (true, "mp4")] {
        for height in [96usize, 720] {
            let path = folder.path().join(format!("c{height}.{extension}"));
            let colour = Colour::usual(height);
            let options: Vec<String> = if deep {
                "-c:v libx265 -x265-params lossless=1:log-level=none -pix_fmt yuv444p10le"
            } else {
                "-c:v libx264 -qp 0 -pix_fmt yuv444p"
            }
            .split(' ')
            .map(str::to_owned)
            .collect();
            let recipe = Recipe {
                size: [96, height],
                deep,
                rate: [25, 1],
                colour: &colour,
                base: [1, 25],
                options: &options,
                coded: None,
            };
            let mut encoder = Encoder::new(&path, &recipe).unwrap();
            let light = |i: usize, c: usize| ((i / 96 * 3 + i % 96 * (c + 1)) * 2 % 256) as u8;
            let codes: Vec<u8> =
                (0..96 * height).flat_map(|i| [0, 1, 2].map(|c| light(i, c))).collect();
            let frame = match deep {
                false => codes.clone(),
                true => {
                    codes.iter().flat_map(|&code| (u16::from(code) * 257).to_le_bytes()).collect()
                }
            };
            encoder.write(&frame, Timing { ticks: 0, base: [1, 25] }).unwrap();
            encoder.finish().unwrap();
            let film = probe(&path).unwrap();
            assert_eq!(film.colour.matrix, colour.matrix, "it says which matrix it has");
            assert_eq!(film.deep, deep);
            let mut back = Vec::new();
            let mut decoder = Decoder::new(&film, deep).unwrap();
            decoder.next(&mut back).unwrap().unwrap();
            let worst = (0..codes.len())
                .map(|i| match deep {
                    false => f64::from(back[i].abs_diff(codes[i])),
                    true => {
                        let code = u16::from_le_bytes([back[2 * i], back[2 * i + 1]]);
                        (f64::from(code) / 257.0 - f64::from(codes[i])).abs()
                    }
                })
                .fold(0.0, f64::max);
            // A step of limited-range chroma is 255/224 codes, times up to 1.86 into blue, half a step each way in
            // chroma and luma, and the rounding back; 10 bits are four times as fine.
            let bound = if deep { 0.8 } else { 3.0 };
            assert!(worst <= bound, "deep {deep}, {height} rows: {worst}");
        }
    }
}
