use super::*;

/// By hand, for a picture of 8 x 4 pixels: u = 1/4 is its pixel 2's left edge, 1.5 from the first one's centre; v = 3/4 is a quarter down.
#[test]
fn maps_in_memory_are_those_of_their_files() {
    let mut map = Map::identity(4, 2);
    map.status[3] = Status::Folded;
    (map.uv[7], map.status[7]) = ([f64::NAN; 2], Status::Outside);
    map.uv[0] = [0.25, 0.75];
    let [x, y] = remap_coordinates(&map, [8, 4]);
    assert_eq!((x[0], y[0]), (1.5, 0.5));
    assert!(x[7].is_nan() && y[7].is_nan());
    let pixels = stmap_pixels(&map);
    assert_eq!(pixels[0], [0.25, 0.75, 0.0, 1.0]);
    assert_eq!(pixels[3][3], 0.0);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.exr");
    write_map(&map, [8, 4], Format::Exr, &path).unwrap();
    let file = decode_channels(&path, &std::fs::read(&path).unwrap(), 0.0).unwrap();
    for (c, name) in ["R", "G", "A"].into_iter().enumerate() {
        let channel: Vec<u32> = file.get(name).unwrap().iter().map(|x| x.to_bits()).collect();
        let ours: Vec<u32> =
            pixels.iter().map(|pixel| [pixel[0], pixel[1], pixel[3]][c].to_bits()).collect();
        assert_eq!(channel, ours, "{name}");
    }
    let path = folder.path().join("map.npy");
    write_map(&map, [8, 4], Format::OpenCv, &path).unwrap();
    let read = read_map(&path, Some(Format::OpenCv), Some([8, 4])).unwrap().map;
    let [again, _] = remap_coordinates(&read, [8, 4]);
    // Single precision there and back.
    assert!(again.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-5 || a.is_nan() && b.is_nan()));
}

mod others;
use proptest::prelude::*;
use std::io::Write as _;

/// A bent map with every status.
fn sample_map(width: usize, height: usize) -> Map {
    let mut map = Map::identity(width, height);
    for (i, uv) in map.uv.iter_mut().enumerate() {
        *uv = [uv[0] * uv[0], (uv[1] + 0.1 * uv[0] * (1.0 - uv[0])).min(1.0)];
        map.status[i] = match i % 7 {
            3 => Status::Folded,
            5 => Status::Outside,
            6 => Status::Blocked,
            _ => Status::Ok,
        };
        if i % 7 >= 5 {
            *uv = [f64::NAN; 2];
        }
    }
    map
}

const SOURCE: [usize; 2] = [640, 360];

/// Largest distance between the maps' uv along each axis; they must agree on which pixels have any.
fn distance(a: &Map, b: &Map) -> [f64; 2] {
    assert_eq!((a.width, a.height, a.uv.len()), (b.width, b.height, b.uv.len()));
    let mut worst = [0.0f64; 2];
    for (i, (p, q)) in a.uv.iter().zip(&b.uv).enumerate() {
        assert_eq!(p[0].is_nan(), q[0].is_nan(), "pixel {i}: {p:?} {q:?}");
        if !p[0].is_nan() {
            (0..2).for_each(|c| worst[c] = worst[c].max((p[c] - q[c]).abs()));
        }
    }
    worst
}

#[test]
fn every_format_comes_back_to_its_own_precision() {
    let folder = tempfile::tempdir().unwrap();
    let map = sample_map(37, 23);
    for format in Format::all() {
        let path = folder.path().join(format.file_name());
        let written = write_map(&map, SOURCE, format, &path).unwrap();
        assert!(written.files.iter().all(|file| file.is_file()), "{format}");
        let kept: Vec<Vec<u8>> = written.files.iter().map(|f| std::fs::read(f).unwrap()).collect();
        let twins = matches!(format, Format::Ffmpeg | Format::OpenCv);
        midair_peers::corpus::keep_map(format as u8, &kept[0], twins.then(|| &kept[1][..]));
        let read = read_map(&path, Some(format), Some(SOURCE)).unwrap();
        let step = match format {
            Format::Npy => [0.0; 2],
            // Half a unit in the last place below 1.
            Format::Exr | Format::Blender | Format::TouchDesigner => [2f64.powi(-25); 2],
            Format::ExrHalf => [2f64.powi(-12); 2],
            Format::Png16 | Format::TouchDesignerPng => [0.5 / 65535.0 + 1e-12; 2],
            Format::Ffmpeg => [0.5 / 640.0 + 1e-12, 0.5 / 360.0 + 1e-12],
            // Floats up to 640: half a unit in the last place is 2^-15 px.
            Format::OpenCv | Format::OpenCvYaml => [2f64.powi(-15) / 360.0; 2],
            // 1 - v is rounded below 1.
            Format::Mpcdi => [2f64.powi(-25) + 1e-16; 2],
        };
        let worst = distance(&map, &read.map);
        assert!(worst[0] <= step[0] && worst[1] <= step[1], "{format}: {worst:?} over {step:?}");
        let full = matches!(format, Format::Exr | Format::ExrHalf | Format::Npy);
        for (told, status) in read.map.status.iter().zip(&map.status) {
            if full {
                assert_eq!(told, status, "{format}");
            } else {
                assert_eq!(*told == Status::Ok, status.is_answered(), "{format}");
            }
        }
        assert_eq!(format == Format::ExrHalf, read.notes.iter().any(|note| note.contains("half")));
    }
    // Nothing but the files: no temporary one is left.
    let beside = ["NAME_y of ffmpeg and of opencv", "their masks", "status.npy"].len() + 2;
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 11 + beside);
}

#[test]
fn a_bled_ring_survives_with_its_coverage_apart() {
    let folder = tempfile::tempdir().unwrap();
    let mut map = Map::identity(20, 20);
    for i in 0..400 {
        if i % 20 < 6 {
            (map.uv[i], map.status[i]) = ([f64::NAN; 2], Status::Outside);
        }
    }
    let bled = crate::map::bleed(&map, 2);
    for format in Format::all() {
        let path = folder.path().join(format.file_name());
        let files = write_map(&bled, SOURCE, format, &path).unwrap().files;
        let read = read_map(&path, Some(format), Some(SOURCE)).unwrap().map;
        // The coarsest are ffmpeg's whole pixels, half of one of 360.
        assert!(distance(&bled, &read).iter().all(|&d| d < 0.501 / 360.0), "{format}");
        assert_eq!(read.status, map.status, "{format}");
        for i in 0..400 {
            assert_eq!(read.answer(i).is_some(), i % 20 >= 6, "{format}");
            assert_eq!(read.continuation(i).is_some(), (4..6).contains(&(i % 20)), "{format}");
        }
        if matches!(format, Format::Ffmpeg | Format::OpenCv) {
            let mask = files.last().unwrap();
            for (pixel, status) in image::open(mask).unwrap().into_luma8().iter().zip(&map.status) {
                assert_eq!(*pixel, if status.is_answered() { 255 } else { 0 }, "{format}");
            }
            image::GrayImage::new(3, 4).save(mask).unwrap();
            let error = read_map(&path, Some(format), Some(SOURCE)).unwrap_err().to_string();
            assert!(error.contains("_coverage.png") && error.contains("3 x 4"), "{error}");
            // Maps of others have none beside.
            std::fs::remove_file(mask).unwrap();
            let read = read_map(&path, Some(format), Some(SOURCE)).unwrap().map;
            assert!((0..400).all(|i| read.answer(i).is_some() == (i % 20 >= 4)), "{format}");
        }
    }
}

#[test]
fn the_stmap_says_what_the_tools_expect() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.exr");
    write_map(&Map::identity(4, 2), SOURCE, Format::Exr, &path).unwrap();
    let file = decode_channels(&path, &std::fs::read(&path).unwrap(), 0.0).unwrap();
    // Corner-based: (x + 0.5) / W, and the first row is the top one, v = (1.5) / 2.
    assert_eq!(file.get("R").unwrap()[..4], [0.125, 0.375, 0.625, 0.875]);
    assert_eq!(file.get("G").unwrap(), [0.75, 0.75, 0.75, 0.75, 0.25, 0.25, 0.25, 0.25]);
    assert!(file.channels.iter().all(|channel| channel.1 == SampleKind::Float));
    let map = sample_map(7, 1);
    write_map(&map, SOURCE, Format::Exr, &path).unwrap();
    let file = decode_channels(&path, &std::fs::read(&path).unwrap(), 0.0).unwrap();
    assert_eq!(file.get("A").unwrap(), [1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
    assert_eq!(file.get("status").unwrap(), [0.0, 0.0, 0.0, 1.0, 0.0, 2.0, 3.0]);
    assert!(file.get("R").unwrap()[5].is_nan());
}

#[test]
fn absolute_formats_count_pixels_from_the_top_left() {
    let folder = tempfile::tempdir().unwrap();
    let map = Map::identity(4, 2);
    let path = folder.path().join("m.pgm");
    write_map(&map, [4, 2], Format::Ffmpeg, &path).unwrap();
    let bytes = std::fs::read(folder.path().join("m_y.pgm")).unwrap();
    assert_eq!(bytes, b"P5\n4 2\n65535\n\0\0\0\0\0\0\0\0\0\x01\0\x01\0\x01\0\x01");
    let path = folder.path().join("m.npy");
    write_map(&map, [4, 2], Format::OpenCv, &path).unwrap();
    let read = |name: &str| {
        let path = folder.path().join(name);
        npy::decode_array(&path, &std::fs::read(&path).unwrap(), 2).unwrap().numbers
    };
    assert_eq!(read("m_x.npy"), [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0]);
    assert_eq!(read("m_y.npy"), [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
}

#[test]
fn what_is_wrong_is_said_with_file_place_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let check = |result: Result<LoadedMap, FileError>, words: &[&str]| {
        let message = result.unwrap_err().to_string();
        for word in words {
            assert!(message.contains(word), "{message:?} lacks {word:?}");
        }
    };
    check(read_map(&at("map.tiff"), None, None), &["map.tiff", "name the format"]);
    check(read_map(&at("map.exr"), None, None), &["map.exr", "check the path"]);
    let map = sample_map(8, 8);
    write_map(&map, SOURCE, Format::Ffmpeg, &at("m.pgm")).unwrap();
    check(read_map(&at("m.pgm"), None, None), &["m.pgm", "give the picture's width"]);
    let pgm = std::fs::read(at("m_x.pgm")).unwrap();
    std::fs::write(at("m_x.pgm"), &pgm[..60]).unwrap();
    check(read_map(&at("m.pgm"), None, Some(SOURCE)), &["m_x.pgm", "of 128 bytes"]);
    std::fs::write(at("m_x.pgm"), "P5 4000000000 4000000000 65535 ").unwrap();
    check(read_map(&at("m.pgm"), None, Some(SOURCE)), &["m_x.pgm", "over the limit"]);
    image::RgbImage::new(4, 4).save(at("eight.png")).unwrap();
    check(read_map(&at("eight.png"), None, None), &["eight.png", "16 bits"]);
    write_map(&map, SOURCE, Format::Npy, &at("map.npy")).unwrap();
    let put_status = |shape: &[u64], code: u8| {
        let path = at("status.npy");
        let bytes = npy::encode_array(&path, shape, std::iter::repeat_n(code, 64)).unwrap();
        std::fs::write(path, bytes).unwrap();
    };
    put_status(&[8, 8], 9);
    check(read_map(&at("map.npy"), None, None), &["status.npy", "column 0, row 0", "9"]);
    put_status(&[4, 16], 0);
    check(read_map(&at("map.npy"), None, None), &["status.npy", "one map"]);
    let header = b"\x93NUMPY\x01\0\x76\0{'descr': '<f8', 'fortran_order': False, 'shape': (9999, 9999, 2), }";
    let mut huge = header.to_vec();
    huge.resize(127, b' ');
    huge.push(b'\n');
    std::fs::File::create(at("huge.npy")).unwrap().write_all(&huge).unwrap();
    check(read_map(&at("huge.npy"), None, None), &["huge.npy", "cut short"]);
    let error = write_map(&map, [70000, 10], Format::Ffmpeg, &at("w.pgm")).unwrap_err();
    assert!(error.to_string().contains("16 bits"));
    assert!(write_map(&Map::identity(0, 4), SOURCE, Format::Exr, &at("e.exr")).is_err());
    assert!(write_map(&map, [0, 4], Format::OpenCv, &at("e.npy")).is_err());
    let nowhere = at("none/map.exr");
    assert!(write_map(&map, SOURCE, Format::Exr, &nowhere).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn damaged_files_are_read_or_refused_but_never_panic(
        which in 0usize..11,
        cut in 0.0f64..=1.5,
        changes in prop::collection::vec((0.0f64..1.0, any::<u8>()), 0..6),
    ) {
        let format = Format::all().nth(which).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(format.file_name());
        let written = write_map(&sample_map(9, 5), [60, 40], format, &path).unwrap();
        let mut bytes = std::fs::read(&written.files[0]).unwrap();
        for (place, value) in changes {
            let place = (place * bytes.len() as f64) as usize;
            bytes[place] = value;
        }
        if cut < 1.0 {
            bytes.truncate((bytes.len() as f64 * cut) as usize);
        }
        std::fs::write(&written.files[0], bytes).unwrap();
        match read_map(&path, Some(format), Some([60, 40])) {
            Ok(LoadedMap { map, .. }) => {
                prop_assert_eq!(map.uv.len(), map.width * map.height);
                for (uv, status) in map.uv.iter().zip(&map.status) {
                    prop_assert!(answer(*uv).is_some() || !status.is_answered());
                }
            }
            Err(error) => {
                let named = error.to_string().contains(&folder.path().display().to_string());
                prop_assert!(named, "{error}");
            }
        }
    }
}

#[test]
fn the_gain_travels_with_the_map() {
    let folder = tempfile::tempdir().unwrap();
    let map = Map::identity(7, 5);
    let mut rgb: Vec<[f32; 3]> = (0..35).map(|i| [i as f32 / 35.0, 0.5, 0.25]).collect();
    rgb[3] = [f32::NAN; 3];
    let gain = Gain { width: 7, height: 5, rgb };
    let file = folder.path().join("map.exr");
    write_map_and_gain(&map, Some(&gain), [7, 5], Format::Exr, &file).unwrap();
    let loaded = read_map(&file, None, None).unwrap();
    assert_eq!(loaded.map.status, map.status);
    let found = loaded.gain.unwrap();
    assert_eq!((found.width, found.height), (7, 5));
    for (a, b) in found.rgb.iter().zip(&gain.rgb) {
        assert!(a == b || (a[0].is_nan() && b[0].is_nan()), "{a:?} {b:?}");
    }
    write_map(&map, [7, 5], Format::Exr, &file).unwrap();
    assert_eq!(read_map(&file, None, None).unwrap().gain, None);
    let other = Gain { width: 1, height: 1, rgb: vec![[1.0; 3]] };
    let refused = write_map_and_gain(&map, Some(&other), [7, 5], Format::Exr, &file);
    assert!(refused.unwrap_err().to_string().contains("another size"));
}
