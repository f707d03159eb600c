//! Maps as other tools write them.

use super::*;
use npyz::WriterBuilder;
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;

mod packages;

/// A map of these files, by their names.
fn decode(
    name: &str,
    files: &[(&str, Vec<u8>)],
    format: Option<Format>,
    source: Option<[usize; 2]>,
    region: Option<&str>,
) -> Result<Map, String> {
    let fetch = |path: &Path| {
        let found = files.iter().find(|(known, _)| Path::new(known) == path);
        found.map(|(_, bytes)| bytes.clone()).ok_or_else(|| std::io::ErrorKind::NotFound.into())
    };
    let reading = Reading { format, source, region };
    if let (Some(kind), [(_, first), rest @ ..]) =
        (format.or(Format::of_path(Path::new(name))), files)
    {
        let twin = rest.first().map(|(_, bytes)| bytes.as_slice());
        let twins = matches!(kind, Format::Ffmpeg | Format::OpenCv);
        let twin = twins.then(|| twin.unwrap_or_default());
        midair_peers::corpus::keep_map(kind as u8, first, twin);
    }
    decode_map(Path::new(name), &fetch, &reading).map(|l| l.map).map_err(|e| e.to_string())
}

/// A map of 3 x 2 pixels onto a source of 8 x 4: places in its pixels, and what they are as shares. One leads nowhere.
const PLACES: [[f64; 2]; 6] =
    [[0.0, 0.0], [7.0, 3.0], [1.5, 2.0], [-1.0, -1.0], [3.0, 1.0], [4.0, 0.25]];
const SMALL: [usize; 2] = [8, 4];

fn shares() -> Vec<Option<[f64; 2]>> {
    PLACES
        .iter()
        .map(|&[x, y]| (x >= 0.0).then_some([(x + 0.5) / 8.0, 1.0 - (y + 0.5) / 4.0]))
        .collect()
}

/// That a map leads where [`PLACES`] do.
fn check(what: &str, map: Result<Map, String>) {
    let map = map.unwrap_or_else(|e| panic!("{what}: {e}"));
    assert_eq!((map.width, map.height), (3, 2), "{what}");
    for ((uv, status), expected) in map.uv.iter().zip(&map.status).zip(shares()) {
        match expected {
            None => assert!(uv[0].is_nan() && *status == Status::Outside, "{what}: {uv:?}"),
            Some([u, v]) => {
                assert_eq!(*status, Status::Ok, "{what}");
                assert!((uv[0] - u).abs() < 1e-7 && (uv[1] - v).abs() < 1e-7, "{what}: {uv:?}");
            }
        }
    }
}

fn axis(k: usize) -> Vec<f64> {
    PLACES.iter().map(|p| p[k]).collect()
}

fn text_of(numbers: &[f64], gap: &str) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(gap)
}

/// A float matrix's bytes in OpenCV's base64: its type in 24 bytes, then the numbers.
fn packed(kind: &str, data: &[u8]) -> String {
    use base64::Engine as _;
    let mut bytes = format!("{kind:<24}").into_bytes();
    bytes.extend(data);
    base64::engine::general_purpose::STANDARD.encode(bytes)
}

fn floats(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect()
}

fn yaml(name: &str, kind: &str, data: &str) -> String {
    format!("{name}: !!opencv-matrix\n   rows: 2\n   cols: 3\n   dt: {kind}\n   data: {data}\n")
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn file_storages_of_every_form_are_read() {
    let [x, y] = [axis(0), axis(1)];
    let list = |numbers: &[f64]| format!("[ {} ]", text_of(numbers, ", "));
    let binary = |numbers: &[f64]| {
        let text = packed("1f", &floats(numbers));
        let (first, second) = text.split_at(40);
        format!("!!binary |\n      {first}\n      {second}")
    };
    let both: Vec<f64> = PLACES.concat();
    let head = "%YAML 1.2\n---\n";
    let pair =
        |a: &str, b: &str| format!("{head}{}{}", yaml(a, "f", &list(&x)), yaml(b, "f", &list(&y)));
    let named = |[a, b]: [&str; 2]| (format!("{a} and {b}"), "m.yml", pair(a, b).into_bytes());
    let mut files = vec![
        named(["map1", "map2"]),
        named(["mapx", "mapy"]),
        named(["map_x", "map_y"]),
        named(["mapX", "mapY"]),
        named(["xmap", "ymap"]),
        (
            "base64".into(),
            "m.yaml",
            format!("{head}{}{}", yaml("map1", "f", &binary(&x)), yaml("map2", "f", &binary(&y))).into(),
        ),
        ("pairs".into(), "m.yml", format!("{head}{}", yaml("anything", "\"2f\"", &list(&both))).into()),
        (
            "doubles beside a camera".into(),
            "m.yml",
            format!(
                "{head}camera: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1, 0, 0, 0, 1, 0, 0, 0, 1 ]\n{}{}",
                yaml("mapx", "d", &list(&x)),
                yaml("mapy", "d", &list(&y))
            )
            .into(),
        ),
    ];
    let xml = |attribute: &str, data: [String; 2]| {
        let of = |name: &str, data: &str| {
            format!(
                "<{name} type_id=\"opencv-matrix\"><rows>2</rows>\n<cols>3</cols><dt>f</dt>\n<data{attribute}>\n {data}</data></{name}>\n"
            )
        };
        format!(
            "<?xml version=\"1.0\"?>\n<opencv_storage>\n{}{}</opencv_storage>\n",
            of("mapx", &data[0]),
            of("mapy", &data[1])
        )
    };
    let spaced = [&x, &y].map(|numbers| text_of(numbers, "\n "));
    let packed_pair = [&x, &y].map(|numbers| packed("1f", &floats(numbers)));
    files.push(("XML".into(), "m.xml", xml("", spaced.clone()).into()));
    files.push((
        "XML in base64".into(),
        "m.xml",
        xml(" type_id=\"binary\"", packed_pair.clone()).into(),
    ));
    let json = |data: [String; 2]| {
        let of = |data: &str| {
            format!(
                "{{\"type_id\":\"opencv-matrix\",\"rows\":2,\"cols\":3,\"dt\":\"f\",\"data\":{data}}}"
            )
        };
        format!("{{\"map1\":{},\"map2\":{}}}", of(&data[0]), of(&data[1]))
    };
    files.push(("JSON".into(), "m.json", json([list(&x), list(&y)]).into()));
    // OpenCV writes what JSON does not have.
    let nowhere = [&x, &y].map(|numbers| list(numbers).replace("-1", ".Nan"));
    files.push(("JSON with no number".into(), "m.json", json(nowhere).into()));
    files.push((
        "JSON in base64".into(),
        "m.json",
        json(packed_pair.map(|p| format!("\"$base64${p}\""))).into(),
    ));
    files.push(("packed".into(), "m.yml.gz", gzip(pair("map1", "map2").as_bytes())));
    files.push(("packed XML".into(), "m.xml.gz", gzip(xml("", spaced).as_bytes())));
    // Fixed coordinates: whole pixels, and the fractions in steps of 1/32, five bits each.
    let whole: Vec<f64> = PLACES.iter().flatten().map(|c| c.floor()).collect();
    let fractions: Vec<f64> = PLACES
        .iter()
        .map(|[x, y]| 32.0 * (32.0 * (y - y.floor())) + 32.0 * (x - x.floor()))
        .collect();
    let fixed = format!(
        "{head}{}{}",
        yaml("map1", "\"2s\"", &list(&whole)),
        yaml("map2", "w", &list(&fractions))
    );
    files.push((
        "fixed".into(),
        "m.yml",
        fixed.replace("map1", "first").replace("map2", "second").into(),
    ));
    files.push(("fixed".into(), "m.yml", fixed.into()));
    assert_eq!(files.len(), 17);
    for (what, name, bytes) in files {
        check(&what, decode(name, &[(name, bytes)], None, Some(SMALL), None));
    }
}

#[test]
fn file_storages_that_are_not_clear_are_told_about() {
    let one = |text: String, word: &str| {
        let message =
            decode("m.yml", &[("m.yml", text.into())], None, Some(SMALL), None).unwrap_err();
        assert!(message.contains(word), "{message}");
    };
    let matrix = |name: &str, kind: &str| yaml(name, kind, "[ 1, 2, 3, 4, 5, 6 ]");
    one(matrix("left", "f") + &matrix("right", "f"), "left (3 x 2, 1 channels), right");
    one(
        matrix("map1", "f")
            + &matrix("map2", "f").replace("rows: 2\n   cols: 3", "rows: 1\n   cols: 6"),
        "map1 is 3 x 2",
    );
    one(matrix("map1", "f"), "which of them");
    one("a: 1\n".into(), "none");
    one(matrix("map1", "2q") + &matrix("map2", "f"), "`2q`");
    one(matrix("map1", "f").replace(" ]", ""), "do not end");
    one(matrix("map1", "2f"), "12 numbers, are announced, 6");
    let cut = gzip(matrix("map1", "f").as_bytes());
    let message = decode("m.yml.gz", &[("m.yml.gz", cut[..20].to_vec())], None, Some(SMALL), None)
        .unwrap_err();
    assert!(message.contains("gzip"), "{message}");
}

fn npy_of<T: npyz::AutoSerialize>(
    shape: &[u64],
    order: npyz::Order,
    values: impl IntoIterator<Item = T>,
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = npyz::WriteOptions::new()
        .default_dtype()
        .order(order)
        .shape(shape)
        .writer(&mut bytes)
        .begin_nd()
        .unwrap();
    writer.extend(values).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn arrays_of_every_order_and_type_are_read() {
    let known: Vec<[f64; 2]> = shares().into_iter().map(|uv| uv.unwrap_or([-1.0; 2])).collect();
    let half = |x: f64| half::f16::from_f64(x);
    let columns = |c: usize| (0..6).map(move |i| i / 2 + 3 * (i % 2)).map(move |at: usize| (at, c));
    let fortran: Vec<f64> = (0..2).flat_map(columns).map(|(at, c)| known[at][c]).collect();
    let c = npyz::Order::C;
    for (what, bytes) in [
        ("doubles", npy_of(&[2, 3, 2], c, known.concat())),
        ("floats", npy_of(&[2, 3, 2], c, known.concat().into_iter().map(|x| x as f32))),
        ("Fortran order", npy_of(&[2, 3, 2], npyz::Order::Fortran, fortran)),
        // Sixteenths are exact in half floats.
        ("half floats", npy_of(&[2, 3, 2], c, known.concat().into_iter().map(half))),
    ] {
        check(what, decode("g.npy", &[("g.npy", bytes)], None, None, None));
    }
    let whole = PLACES.iter().flatten().map(|c| c.floor() as i16);
    let fractions =
        PLACES.iter().map(|[x, y]| (1024.0 * (y - y.floor()) + 32.0 * (x - x.floor())) as u16);
    let fixed = vec![
        ("map1.npy", npy_of(&[2, 3, 2], c, whole)),
        ("map2.npy", npy_of(&[2, 3], c, fractions)),
    ];
    for name in ["map1.npy", "map1.npy,map2.npy"] {
        check(name, decode(name, &fixed, Some(Format::OpenCv), Some(SMALL), None));
    }
    let stacked =
        vec![("both.npy", npy_of(&[2, 3, 2], c, PLACES.concat().into_iter().map(|x| x as f32)))];
    check("stacked", decode("both.npy", &stacked, Some(Format::OpenCv), Some(SMALL), None));
    let pair =
        vec![("mapx.npy", npy_of(&[2, 3], c, axis(0))), ("mapy.npy", npy_of(&[2, 3], c, axis(1)))];
    check("twins", decode("mapy.npy", &pair, Some(Format::OpenCv), Some(SMALL), None));
}

#[test]
fn pgm_texts_and_twins_of_other_names_are_read() {
    let text = |numbers: &[u32]| {
        let rows: Vec<String> = numbers.iter().map(u32::to_string).collect();
        format!("P2\n# made by hand\n3 2\n65535\n{}\n", rows.join(" ")).into_bytes()
    };
    let files = |x: &'static str, y: &'static str| {
        vec![(x, text(&[0, 7, 1, 65535, 3, 9])), (y, text(&[0, 3, 2, 65535, 1, 1]))]
    };
    let expected = [[0.0, 0.0], [7.0, 3.0], [1.0, 2.0], [-1.0; 2], [3.0, 1.0], [-1.0; 2]];
    for (name, pair) in [
        ("m.pgm", files("m_x.pgm", "m_y.pgm")),
        ("m_y.pgm", files("m_x.pgm", "m_y.pgm")),
        ("xmap.pgm", files("xmap.pgm", "ymap.pgm")),
        ("columns.pgm,rows.pgm", files("columns.pgm", "rows.pgm")),
    ] {
        let map = decode(name, &pair, Some(Format::Ffmpeg), Some(SMALL), None).unwrap();
        for (uv, [x, y]) in map.uv.iter().zip(expected) {
            match x < 0.0 {
                true => assert!(uv[0].is_nan()),
                false => assert_eq!(*uv, [(x + 0.5) / 8.0, 1.0 - (y + 0.5) / 4.0]),
            }
        }
    }
    let short = vec![("m_x.pgm", text(&[0, 7])), ("m_y.pgm", text(&[0, 3, 2, 5, 1, 0]))];
    assert!(decode("m.pgm", &short, None, Some(SMALL), None).unwrap_err().contains("2 of 6"));
    let large =
        vec![("m_x.pgm", text(&[0, 7, 70000, 1, 1, 1])), ("m_y.pgm", text(&[0, 3, 2, 5, 1, 0]))];
    assert!(decode("m.pgm", &large, None, Some(SMALL), None).unwrap_err().contains("65535"));
}

#[test]
fn values_off_the_source_lead_nowhere_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    for format in [
        Format::Exr,
        Format::Blender,
        Format::TouchDesigner,
        Format::Npy,
        Format::OpenCv,
        Format::OpenCvYaml,
        Format::Mpcdi,
    ] {
        let mut map = Map::identity(4, 4);
        for (at, uv) in [(1, [-1.0, -1.0]), (2, [0.5, 1.25]), (5, [1.001, 0.5]), (6, [0.5, -0.25])]
        {
            map.uv[at] = uv;
        }
        // On the edge is on the picture.
        (map.uv[8], map.uv[9]) = ([0.0, 1.0], [1.0, 0.0]);
        let path: PathBuf = folder.path().join(format.file_name());
        write_map(&map, SOURCE, format, &path).unwrap();
        let read = read_map(&path, Some(format), Some(SOURCE)).unwrap().map;
        for (at, status) in read.status.iter().enumerate() {
            let off = [1, 2, 5, 6].contains(&at);
            assert_eq!(
                *status,
                if off { Status::Outside } else { Status::Ok },
                "{format}: pixel {at}"
            );
            assert_eq!(read.uv[at][0].is_nan(), off, "{format}: pixel {at}");
        }
    }
}

#[test]
fn places_in_pixels_are_no_shares_and_grey_is_no_map() {
    let folder = tempfile::tempdir().unwrap();
    let pixels = npy_of(&[1, 2, 2], npyz::Order::C, [3.0, 40.0, 100.0, 7.0]);
    let message = decode("p.npy", &[("p.npy", pixels)], None, None, None).unwrap_err();
    assert!(message.contains("opencv") && message.contains("3 and 40"), "{message}");
    // A few of them lie within 0 to 1.
    let pixels = npy_of(&[2, 2, 2], npyz::Order::C, [0.5, 0.5, 100.0, 7.0, 3.0, 40.0, 30.0, 20.0]);
    let message = decode("p.npy", &[("p.npy", pixels)], None, None, None).unwrap_err();
    assert!(message.contains("1 of them") && message.contains("100 and 7"), "{message}");
    let zeros = npy_of(&[2, 2, 2], npyz::Order::C, [0.0; 8]);
    let message = decode("z.npy", &[("z.npy", zeros)], None, None, None).unwrap_err();
    assert!(message.contains("0 everywhere"), "{message}");
    let path = folder.path().join("grey.png");
    image::ImageBuffer::<image::Luma<u16>, _>::from_pixel(4, 4, image::Luma([30000u16]))
        .save(&path)
        .unwrap();
    let message = read_map(&path, None, None).unwrap_err().to_string();
    assert!(message.contains("grey"), "{message}");
}
