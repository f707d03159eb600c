//! `midair apply` on the kinds of film that people have; where ffmpeg is missing they are skipped with a note.

use super::apply::{ffmpeg, frames, said_by_ffprobe};
use super::{Bench, waves};
use midair::map::Map;
use midair::map::format::{Format, write_map};
use midair::picture::{Depth, read_still, srgb, write_still};
use std::process::{Command, Stdio};

/// A bench with a map that changes nothing.
fn bench() -> Bench {
    let bench = Bench::new();
    write_map(&Map::identity(64, 48), [64, 48], Format::Exr, &bench.path("map.exr")).unwrap();
    bench
}

const SOURCE: &str = "-f lavfi -i testsrc2=size=64x48:rate=25:duration=4";

fn length(bench: &Bench, name: &str) -> f64 {
    said_by_ffprobe(bench, name, "format=duration").trim().parse().unwrap()
}

#[test]
fn a_trimmed_film_is_what_its_edits_show() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    ffmpeg(&bench, &format!("{SOURCE} -c:v libx264 -g 25 whole.mp4"));
    // Cut between key frames without coding again: a list of edits hides what comes before.
    ffmpeg(&bench, "-ss 1.3 -i whole.mp4 -c copy trimmed.mp4");
    let told = bench.json(&["apply", "map.exr", "trimmed.mp4", "out.mp4"]);
    let shown = Command::new("ffmpeg")
        .args(["-v", "error", "-i", "trimmed.mp4", "-f", "framemd5", "-"])
        .current_dir(bench.folder.path())
        .output()
        .unwrap();
    let shown = String::from_utf8(shown.stdout).unwrap();
    let shown = shown.lines().filter(|line| !line.starts_with('#')).count();
    assert!((60..75).contains(&shown), "{shown}");
    assert_eq!(told["frames"], shown);
    assert!(said_by_ffprobe(&bench, "trimmed.mp4", "stream=nb_frames").trim() != shown.to_string());
}

#[test]
fn a_turned_film_is_shown_upright() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    ffmpeg(
        &bench,
        "-f lavfi -i testsrc2=size=48x64:rate=5:duration=1 -c:v libx264 -qp 0 -pix_fmt yuv444p flat.mp4",
    );
    ffmpeg(&bench, "-i flat.mp4 -c copy -metadata:s:v rotate=90 turned.mp4");
    // As ffmpeg itself shows it, pixel by pixel.
    ffmpeg(&bench, "-i turned.mp4 -c:v ffv1 -pix_fmt gbrp seen.mkv");
    bench.succeed(&[
        "apply",
        "map.exr",
        "turned.mp4",
        "out.mkv",
        "--",
        "-c:v",
        "ffv1",
        "-pix_fmt",
        "gbrp",
    ]);
    let (ours, theirs) = (frames(&bench, "out.mkv"), frames(&bench, "seen.mkv"));
    assert_eq!((ours.len(), ours[0].1.len()), (5, 64 * 48 * 3));
    for ((_, ours), (_, theirs)) in ours.iter().zip(&theirs) {
        // The same matrix; theirs is rounded by a quicker path of ffmpeg's.
        let far = ours.iter().zip(theirs).filter(|(a, b)| a.abs_diff(**b) > 3).count();
        assert!(far * 100 < ours.len(), "{far}");
    }
}

#[test]
fn a_cover_is_no_film_and_alpha_is_black() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    ffmpeg(&bench, "-f lavfi -i color=red:size=64x48 -frames:v 1 cover.png");
    ffmpeg(&bench, &format!("{SOURCE} -c:v ffv1 -pix_fmt gbrp film.mkv"));
    ffmpeg(
        &bench,
        "-i cover.png -i film.mkv -map 0 -map 1 -c:v:0 mjpeg -c:v:1 libx264 -disposition:v:0 attached_pic covered.mp4",
    );
    let told = bench.json(&["apply", "map.exr", "covered.mp4", "out.mkv"]);
    assert_eq!(told["frames"], 100);

    // Colours behind alpha: as numbered pictures of the same.
    let mut picture = waves(64, 48);
    picture.pixels.iter_mut().for_each(|pixel| pixel[3] = 1.0);
    let alpha = |x: u32| [0u8, 128, 255][(x / 22) as usize % 3];
    let image = image_of(&picture, alpha);
    image.save(bench.path("a1.png")).unwrap();
    bench.succeed(&["apply", "map.exr", "a%d.png", "still%d.png"]);
    let still = read_still(&bench.path("still1.png")).unwrap().picture;
    for (name, coder) in [
        ("a.mov", "-c:v qtrle -pix_fmt argb"),
        ("b.mov", "-c:v png -pix_fmt rgba"),
        ("c.webm", "-c:v libvpx-vp9 -pix_fmt yuva420p -lossless 1"),
    ] {
        ffmpeg(&bench, &format!("-i a1.png {coder} {name}"));
        let told = bench
            .json(&["apply", "map.exr", name, "o.mkv", "--", "-c:v", "ffv1", "-pix_fmt", "gbrp"]);
        assert!(told["notes"].to_string().contains("transparent is black"), "{told}");
        let (_, frame) = frames(&bench, "o.mkv").remove(0);
        for (i, (ours, wanted)) in frame.as_chunks::<3>().0.iter().zip(&still.pixels).enumerate() {
            // YUV of a quarter of the colours is far from the picture's where it changes; where nothing shows it is black all the same.
            let far = if name == "c.webm" { 40 } else { 1 };
            let far = if alpha(i as u32 % 64) == 0 { 1 } else { far };
            for c in 0..3 {
                assert!(
                    ours[c].abs_diff(srgb::encode_8(wanted[c])) <= far,
                    "{name} {i}: {ours:?} {wanted:?}"
                );
            }
        }
    }
}

fn image_of(picture: &midair::picture::Picture, alpha: impl Fn(u32) -> u8) -> image::RgbaImage {
    image::RgbaImage::from_fn(64, 48, |x, y| {
        let [r, g, b, _] = picture.pixels[(y * 64 + x) as usize];
        image::Rgba([srgb::encode_8(r), srgb::encode_8(g), srgb::encode_8(b), alpha(x)])
    })
}

#[test]
fn the_new_film_says_which_matrix_it_has_whatever_the_options() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    // Untagged and small, so BT.601 by its size; shown at 720 rows, where players would take BT.709 for it.
    write_map(&Map::identity(320, 720), [64, 48], Format::Exr, &bench.path("tall.exr")).unwrap();
    ffmpeg(
        &bench,
        "-f lavfi -i color=0x30a0d0:size=64x48:rate=5:duration=1 -c:v libx264 -qp 0 -pix_fmt yuv444p sd.mp4",
    );
    for (name, options, tag) in [
        ("a.mkv", "-c:v libx264 -crf 10", "tv,smpte170m"),
        ("b.mov", "-c:v prores_ks -profile:v 3", "tv,smpte170m"),
        ("c.mkv", "-c:v libx264 -vf hflip -pix_fmt yuv420p", "tv,smpte170m"),
        ("d.mkv", "-c:v libx264 -pix_fmt yuvj420p", "pc,smpte170m"),
        ("e.mkv", "-c:v ffv1 -pix_fmt gbrp", "gbr"),
        // They say what they always say, or nothing; the codes have to follow.
        ("f.mov", "-c:v dnxhd -profile:v dnxhr_hq -pix_fmt yuv422p", "tv,bt709"),
        ("g.mp4", "-c:v mpeg4 -q:v 2", "unknown"),
    ] {
        let mut arguments = vec!["apply", "tall.exr", "sd.mp4", name, "--"];
        arguments.extend(options.split(' '));
        bench.succeed(&arguments);
        let said = said_by_ffprobe(&bench, name, "stream=color_range,color_space");
        assert!(said.contains(tag), "{name}: {said}");
        // What players show by the tag is what the source shows: one colour, which the other matrix or range would move by 8 and more.
        let source = &frames(&bench, "sd.mp4")[0].1[..3];
        let shown = &frames(&bench, name)[0].1;
        for pixel in shown.as_chunks::<3>().0 {
            // A step of limited-range chroma is up to 2.1 codes, and codecs lose a little of a flat field.
            assert!(
                (0..3).all(|c| pixel[c].abs_diff(source[c]) <= 4),
                "{name}: {pixel:?} {source:?}"
            );
        }
    }
}

#[test]
fn the_last_picture_stands_as_long_as_in_the_source() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    for number in 1..=3 {
        write_still(&bench.path(&format!("s{number}.png")), &waves(64, 48), Depth::Eight).unwrap();
    }
    bench.write(
        "list.txt",
        "file s1.png\nduration 0.5\nfile s2.png\nduration 1\nfile s3.png\nduration 3\n",
    );
    ffmpeg(&bench, "-f concat -i list.txt -fps_mode passthrough -final_delay 300 slides.gif");
    let source = length(&bench, "slides.gif");
    assert!((source - 4.5).abs() < 0.1, "{source}");
    for name in ["o.mp4", "o.mov", "o.mkv", "o.webm"] {
        bench.succeed(&["apply", "map.exr", "slides.gif", name]);
        // Containers count in milliseconds or in the film's hundredths.
        assert!((length(&bench, name) - source).abs() < 0.02, "{name}: {}", length(&bench, name));
    }
    ffmpeg(&bench, &format!("{SOURCE} -c:v libx264 -bf 2 plain.mp4"));
    bench.succeed(&["apply", "map.exr", "plain.mp4", "p.mp4"]);
    for ((time, _), (wanted, _)) in frames(&bench, "p.mp4").iter().zip(&frames(&bench, "plain.mp4"))
    {
        // MP4 counts in the film's own units.
        assert!((time - wanted).abs() < 1e-4, "{time} {wanted}");
    }
    assert!((length(&bench, "p.mp4") - 4.0).abs() < 0.011, "{}", length(&bench, "p.mp4"));
}

#[test]
fn names_may_hold_any_sign_and_gaps_are_told() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    ffmpeg(
        &bench,
        "-f lavfi -i testsrc2=size=64x48:rate=5:duration=1 -f lavfi -i sine=duration=1 -c:v libx264 -c:a aac in#1.mp4",
    );
    std::fs::create_dir(bench.path("shot#4 50%d")).unwrap();
    for name in ["shot#3.mp4", "shot#4 50%d/out.mp4", "100%.mkv", "it's.mp4", "a:b.mkv"] {
        bench.succeed(&["apply", "map.exr", "in#1.mp4", name]);
        assert_eq!(frames(&bench, name).len(), 5, "{name}");
        assert!(
            said_by_ffprobe(&bench, &format!("file:{name}"), "stream=codec_type").contains("audio"),
            "{name}"
        );
    }
    for number in [1, 2, 4, 5] {
        write_still(&bench.path(&format!("f{number:04}.png")), &waves(64, 48), Depth::Eight)
            .unwrap();
    }
    // A Mac's shadow of a file is none of them.
    bench.write("._f0003.png", "not a picture");
    let told = bench.json(&["apply", "map.exr", "f%04d.png", "gap.mkv"]);
    assert_eq!(told["frames"], 4);
    assert!(told["notes"].to_string().contains("f0003.png"), "{told}");
}

#[test]
fn subtitles_come_along_or_are_told_and_sound_that_cannot_is_refused_at_once() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    bench.write("t.srt", "1\n00:00:00,100 --> 00:00:00,900\nHello\n");
    ffmpeg(
        &bench,
        "-f lavfi -i testsrc2=size=64x48:rate=5:duration=1 -f lavfi -i sine=duration=1 -i t.srt -c:v libx264 -c:a flac -c:s srt in.mkv",
    );
    for (name, kind) in [("o.mkv", "subrip"), ("o.mp4", "mov_text")] {
        bench.succeed(&["apply", "map.exr", "in.mkv", name]);
        let said = said_by_ffprobe(&bench, name, "stream=codec_name");
        assert!(said.contains(kind) && said.contains("flac"), "{name}: {said}");
    }
    let told = bench.json(&["apply", "map.exr", "in.mkv", "o.avi"]);
    assert!(told["notes"].to_string().contains("1 of 1 streams of subtitles"), "{told}");
    bench.succeed(&["apply", "map.exr", "in.mkv", "quiet.mkv", "--no-audio"]);
    assert!(!said_by_ffprobe(&bench, "quiet.mkv", "stream=codec_type").contains("subtitle"));
    // WebM takes no FLAC: said before a frame is made, and nothing is left.
    let said = bench.refuse(&["apply", "map.exr", "in.mkv", "o.webm"]);
    assert!(said.contains("o.webm") && said.contains("--no-audio"), "{said}");
    let left = std::fs::read_dir(bench.folder.path()).unwrap().flatten();
    let left: Vec<_> = left.map(|entry| entry.file_name()).collect();
    assert!(!left.iter().any(|name| name.to_string_lossy().contains("o.webm")), "{left:?}");
}

#[test]
fn the_same_film_is_made_of_the_same_bytes() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    ffmpeg(
        &bench,
        "-f lavfi -i testsrc2=size=64x48:rate=5:duration=1 -f lavfi -i sine=duration=1 -c:v libx264 -c:a aac a.mp4",
    );
    for kind in ["mp4", "mov", "mkv"] {
        let made = [1, 2].map(|k| {
            let name = format!("{k}.{kind}");
            bench.succeed(&["apply", "map.exr", "a.mp4", &name]);
            std::fs::read(bench.path(&name)).unwrap()
        });
        assert!(made[0] == made[1], "{kind}");
    }
}

#[test]
fn a_broadcast_s_clock_and_an_avi_s_rate_are_kept() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    // Its clock begins at 1.4 s.
    ffmpeg(
        &bench,
        "-f lavfi -i testsrc2=size=64x48:rate=25:duration=1 -f lavfi -i sine=duration=1 -c:v libx264 -c:a aac a.ts",
    );
    assert!(said_by_ffprobe(&bench, "a.ts", "format=start_time").trim().starts_with("1.4"));
    for name in ["o.mp4", "o.mkv", "o.avi"] {
        bench.succeed(&["apply", "map.exr", "a.ts", name]);
        assert_eq!(frames(&bench, name).len(), 25, "{name}");
        // Sound is up to two of its own frames longer than the picture, and may begin one earlier.
        let told = length(&bench, name);
        assert!((0.99..1.08).contains(&told), "{name}: {told}");
    }
    let rate = said_by_ffprobe(&bench, "o.avi", "stream=avg_frame_rate");
    assert!(rate.starts_with("25/1"), "{rate}");
}

#[test]
fn films_of_a_wide_range_become_stills_by_the_stated_tone_mapping() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    // Reference white in 10 bits of limited range: 58 % and 75 % (BT.2408).
    for (name, transfer, code) in [("pq.mkv", "smpte2084", 0.58), ("hlg.mkv", "arib-std-b67", 0.75)]
    {
        let luma = 64.0 + 876.0 * code;
        ffmpeg(
            &bench,
            &format!(
                "-f lavfi -i color=black:size=64x48:rate=5:duration=0.4 -vf format=yuv420p10le,geq=lum={luma:.0}:cb=512:cr=512 -c:v ffv1 -colorspace bt2020nc -color_primaries bt2020 -color_trc {transfer} -color_range tv {name}"
            ),
        );
        let told = bench.json(&["apply", "map.exr", name, "w%d.png"]);
        assert!(told["notes"].to_string().contains("203"), "{told}");
        let pixel = read_still(&bench.path("w1.png")).unwrap().picture.pixels[100];
        // BT.2390 takes 203 to about 160 cd/m2; the codes of 10 bits are 2 % of light apart.
        assert!(pixel[..3].iter().all(|light| (0.74..0.85).contains(light)), "{name}: {pixel:?}");
        bench.json(&["apply", "map.exr", name, "w%d.exr"]);
        let pixel = read_still(&bench.path("w1.exr")).unwrap().picture.pixels[100];
        assert!(pixel[..3].iter().all(|light| (light - 1.0).abs() < 0.05), "{name}: {pixel:?}");
    }
}

#[cfg(unix)]
#[test]
fn two_runs_do_not_disturb_each_other() {
    if !midair_peers::ffmpeg() {
        return;
    }
    let bench = bench();
    ffmpeg(
        &bench,
        "-f lavfi -i testsrc2=size=320x240:rate=30:duration=30 -c:v libx264 -preset ultrafast in.mp4",
    );
    let mut first = bench
        .command(&["apply", "map.exr", "in.mp4", "out.mp4", "--piece", "30"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let piece = bench.path(".out.mp4.midair-pieces/000000.json");
    let start = std::time::Instant::now();
    while !piece.exists() && start.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let said = bench.refuse(&["apply", "map.exr", "in.mp4", "out.mp4", "--piece", "30"]);
    assert!(said.contains("another run"), "{said}");
    assert!(piece.exists());
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(
        bench.json(&["apply", "map.exr", "in.mp4", "out.mp4", "--piece", "30", "--resume"])["frames"]
            == 900
    );
}
