//! Maps of all formats: answers that lie on their source, or refused by name.
#![no_main]

use libfuzzer_sys::fuzz_target;
use midair::map::format::{Format, Reading, decode_map};
use midair_fuzz::{chosen, reader, told};
use std::path::Path;

fuzz_target!(|data: &[u8]| {
    let Some((first, bytes)) = chosen(data) else { return };
    let formats: Vec<Format> = Format::all().collect();
    let format = formats[usize::from(first) % formats.len()];
    // Where there are two files, the first says how long it is.
    let twins = matches!(format, Format::Ffmpeg | Format::OpenCv);
    let [one, other] = match bytes {
        [a, b, c, rest @ ..] if twins => {
            let length = usize::from(*a) | usize::from(*b) << 8 | usize::from(*c) << 16;
            let (one, other) = rest.split_at(length.min(rest.len()));
            [one, other]
        }
        _ => [bytes, &[][..]],
    };
    let [file, twin] = match format {
        Format::Ffmpeg => ["a_x.pgm", "a_y.pgm"],
        Format::OpenCv => ["a_x.npy", "a_y.npy"],
        _ => ["a.map", ""],
    };
    let fetch = |path: &Path| match path.to_str() {
        Some(name) if name == file => Ok(one.to_vec()),
        Some(name) if name == twin && !other.is_empty() => Ok(other.to_vec()),
        _ => Err(std::io::ErrorKind::NotFound.into()),
    };
    reader(|| {
        let reading = Reading { format: Some(format), source: Some([32, 24]), region: None };
        match decode_map(Path::new(file), &fetch, &reading) {
            Ok(loaded) => {
                let map = loaded.map;
                assert_eq!(map.uv.len(), map.width * map.height);
                assert_eq!(map.status.len(), map.uv.len());
                for pixel in 0..map.uv.len() {
                    // The edge and what rounding adds to it.
                    let on = |uv: [f64; 2]| uv.iter().all(|x| (-1e-5..=1.0 + 1e-5).contains(x));
                    assert!(map.answer(pixel).is_none_or(on));
                }
            }
            Err(error) => told(&error, "a"),
        }
    });
});
