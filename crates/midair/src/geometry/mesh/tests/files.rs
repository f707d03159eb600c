//! Files as programs write them: each says the same body as a plain one.

use super::*;

mod gltf;

fn raw(bytes: &[u8], format: MeshFormat) -> RawMesh {
    midair_peers::corpus::keep("meshes", &[&[format as u8], bytes]);
    read(bytes, format, "test", None).unwrap_or_else(|e| panic!("{e} ({})", e.help))
}

/// The volume of a closed mesh file, with its number of triangles.
fn volume(bytes: &[u8], format: MeshFormat) -> (f64, usize) {
    let (mesh, mended) = closed(raw(bytes, format)).unwrap_or_else(|e| panic!("{e}"));
    assert!(mended.flipped_faces.is_empty(), "{:?}", mended.notes());
    (mesh.signed_volume(), mesh.triangles.len())
}

/// An L-shaped prism of volume 3 whose ends are one polygon each, the second corner of which is not convex.
const PRISM: &str = "v 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\n\
    v 1 1 1\nv 1 2 1\nv 0 2 1\nv 0 0 1\nv 2 0 1\nv 2 1 1\n\
    f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n\
    f 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";

#[test]
fn concave_faces_are_filled_and_no_more() {
    assert_eq!(volume(PRISM.as_bytes(), MeshFormat::Obj), (3.0, 20));
    let (mesh, _) = closed(raw(PRISM.as_bytes(), MeshFormat::Obj)).unwrap();
    assert!(!mesh.contains(Vec3::new(1.6, 1.6, 0.5)) && mesh.contains(Vec3::new(0.5, 1.6, 0.5)));
}

#[test]
fn corners_on_an_edge_stay_in_the_surface() {
    // The lower edge has a corner in its middle, which the face beside it has as well.
    let more = PRISM
        .replace("f 6 5 4 3 2 1\n", "v 1 0 0\nf 6 5 13 4 3 2 1\n")
        .replace("f 4 5 11 10\n", "f 4 13 5 11 10\n");
    let (volume, triangles) = volume(more.as_bytes(), MeshFormat::Obj);
    assert_eq!((volume, triangles), (3.0, 22));
}

#[test]
fn faces_that_cross_themselves_are_named() {
    let text = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nf 1 2 3 4\n";
    let error = read(text.as_bytes(), MeshFormat::Obj, "bow", None).unwrap_err();
    assert!(error.message.contains("face 1 (line 5) crosses itself"), "{error}");
}

#[test]
fn obj_is_read_as_exporters_write_it() {
    let plain = raw(obj_text().as_bytes(), MeshFormat::Obj);
    let text = obj_text();
    let first = text.find("f ").unwrap();
    let wide = |unit: fn(u16) -> [u8; 2]| -> Vec<u8> {
        format!("\u{feff}{text}").encode_utf16().flat_map(unit).collect()
    };
    for (what, bytes) in [
        ("a mark", format!("\u{feff}{text}").into_bytes()),
        ("UTF-16, little end first", wide(u16::to_le_bytes)),
        ("UTF-16, big end first", wide(u16::to_be_bytes)),
        ("Windows", text.replace('\n', "\r\n").into_bytes()),
        ("old Macintosh", text.replace('\n', "\r").into_bytes()),
        (
            "lines that go on",
            text.replace("f 5/1/1 6//1", "f 5/1/1 \\\n  6//1 \\\r\n").into_bytes(),
        ),
        ("a comment that does not", text.replace("o cube", "# C:\\models\\").into_bytes()),
        ("a name that does not", text.replace("o cube", "usemtl C:\\models\\").into_bytes()),
        ("comments behind", text.replace("\nv ", " # corner\nv ").into_bytes()),
        ("decimal commas", text.replace("0.5", "0,5").into_bytes()),
        ("exponents", text.replace("0.5", "5.0E-01").into_bytes()),
        ("colours behind", text.replace(" 0.5\n", " 0.5 0.1 0.2 0.3\n").into_bytes()),
        ("the old word for faces", text.replace("\nf ", "\nfo ").into_bytes()),
        ("faces first", format!("{}{}", &text[first..], &text[..first]).into_bytes()),
        ("Latin-1", [&b"o W\xfcrfel\n"[..], text.as_bytes()].concat()),
    ] {
        let found = raw(&bytes, MeshFormat::Obj);
        assert_eq!(found.positions, plain.positions, "{what}");
        assert_eq!(found.triangles, plain.triangles, "{what}");
    }
}

#[test]
fn obj_gives_normals_by_corner() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nvn nan 0 1\nvn 0 1 1\nf 1//1 2/7/-1 3\n";
    let raw = raw(text.as_bytes(), MeshFormat::Obj);
    let [a, b, c] = raw.normals[0];
    assert_eq!([a, b], [Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, 1.0, 1.0)]);
    assert!(!c.is_finite());
}

/// As [`stl_text`] with other normals.
fn stl_with(normal: &str) -> String {
    stl_text().replace("normal 0 0 0", &format!("normal {normal}"))
}

#[test]
fn stl_is_read_as_exporters_write_it() {
    let plain = raw(stl_text().as_bytes(), MeshFormat::Stl);
    let mut long = stl_bytes(b"solid with a tail");
    long.extend(b"tail of another program");
    let mut unsaid = stl_bytes(b"streamed");
    unsaid[80..84].fill(0xff);
    for (what, bytes) in [
        ("no numbers for normals", stl_with("nan NaN -nan(ind)").into_bytes()),
        ("Microsoft's", stl_with("1.#QNAN -1.#IND 1.#INF").into_bytes()),
        ("no normals", stl_text().replace(" normal 0 0 0", "").into_bytes()),
        ("capitals", stl_text().to_uppercase().into_bytes()),
        ("a mark", format!("\u{feff}{}", stl_text()).into_bytes()),
        ("no name", stl_text().replace(" cube", "").into_bytes()),
        (
            "a name of STL's words",
            stl_text().replace("solid cube", "solid facet vertex").into_bytes(),
        ),
        (
            "one line",
            stl_text().replace('\n', " ").replace("solid cube ", "solid cube\n").into_bytes(),
        ),
        ("one line in all", stl_text().replace('\n', " ").into_bytes()),
        ("zeros behind", format!("{}\0\0\0", stl_text()).into_bytes()),
        (
            "a colour",
            stl_text().replace("solid cube\n", "solid cube\ncolor 0.5 0.5 0.5\n").into_bytes(),
        ),
        ("an end in two words", stl_text().replace("endsolid", "end solid").into_bytes()),
        ("a comment first", format!("; made by a program\n{}", stl_text()).into_bytes()),
        ("bytes behind", long),
        ("a number that was never filled in", unsaid),
    ] {
        let found = raw(&bytes, MeshFormat::Stl);
        assert_eq!(found.positions, plain.positions, "{what}");
        assert_eq!(found.triangles, plain.triangles, "{what}");
    }
}

#[test]
fn all_solids_of_an_stl_text_count() {
    let beside =
        stl_text().replace("vertex 0.5", "vertex 3.5").replace("vertex -0.5", "vertex 2.5");
    let text = stl_text() + &beside;
    assert_eq!(volume(text.as_bytes(), MeshFormat::Stl), (2.0, 24));
    assert_eq!(volume(text.replace('\n', " ").as_bytes(), MeshFormat::Stl), (2.0, 24));
    let cut = &text[..text.rfind("endfacet").unwrap()];
    assert!(read(cut.as_bytes(), MeshFormat::Stl, "cut", None).is_err());
    let unended = &text[..text.rfind("endsolid").unwrap()];
    let error = read(unended.as_bytes(), MeshFormat::Stl, "cut", None).unwrap_err();
    assert!(error.message.contains("face 24"), "{error}");
}

#[test]
fn relatives_of_off_are_read() {
    let plain = raw(off_text().as_bytes(), MeshFormat::Off);
    // Each vertex line with more numbers on it, at the end or behind the coordinates.
    let with = |header: &str, extra: &str| {
        let mut text = off_text().replacen("OFF", header, 1);
        for p in CUBE {
            let line = format!("{} {} {}\n", p[0], p[1], p[2]);
            text = text.replacen(&line, &format!("{} {extra}\n", line.trim_end()), 1);
        }
        text
    };
    for (what, text) in [
        ("colours", with("COFF", "255 0 0 255")),
        ("colours as shares", with("COFF", "0.1 0.2 0.3 1.0")),
        ("normals", with("NOFF", "0 0 1")),
        ("both", with("CNOFF", "0 0 1 255 0 0 255")),
        ("the other way", with("NCOFF", "0 0 1 255 0 0 255")),
        ("textures", with("STOFF", "0.5 0.5")),
        ("all", with("STCNOFF", "0 0 1 1 0 0 1 0.5 0.5")),
        ("homogeneous", with("4OFF", "1.0")),
        ("no word", off_text().replacen("OFF\n", "", 1)),
        ("comments", off_text().replace('\n', " # line\n\n# more\n")),
        ("colours of faces", off_text().replace("0 3 2 1", "0 3 2 1 200 100 50")),
        ("Windows", off_text().replace('\n', "\r\n")),
        ("counts beside the word", off_text().replacen("OFF\n", "OFF ", 1)),
        ("broken lines", off_text().replace(" 0.5 0.5\n", "\n0.5\n0.5\n")),
        ("a mark", format!("\u{feff}{}", off_text())),
        ("small letters", off_text().replacen("OFF", "off", 1)),
        ("one line", off_text().replace('\n', " ")),
        ("one line without a word", off_text().replacen("OFF\n", "", 1).replace('\n', " ")),
        ("one line of normals", with("NOFF", "0 0 1").replace('\n', " ")),
    ] {
        let found = raw(text.as_bytes(), MeshFormat::Off);
        assert_eq!(found.positions, plain.positions, "{what}");
        assert_eq!(found.triangles, plain.triangles, "{what}");
        let normals =
            what.contains("normals") || what == "both" || what == "all" || what == "the other way";
        assert_eq!(found.normals.len(), if normals { 12 } else { 0 }, "{what}");
        assert!(found.normals.iter().flatten().all(|n| *n == Vec3::new(0.0, 0.0, 1.0)));
    }
    for (text, word) in [
        (off_text().replacen("OFF", "OFF BINARY", 1), "binary form of OFF"),
        (off_text().replacen("OFF", "nOFF\n3", 1), "nOFF"),
        (off_text().replacen("OFF", "XOFF", 1), "COFF"),
    ] {
        let error = read(text.as_bytes(), MeshFormat::Off, "other", None).unwrap_err();
        assert!(error.message.contains(word), "{error}");
    }
}

/// The corners of each triangle in space, the lowest first: how triangles are numbered does not matter.
fn soup(raw: &RawMesh) -> Vec<[[i64; 3]; 3]> {
    let key = |v: u32| raw.positions[v as usize].to_array().map(|x| (x * 1e6).round() as i64);
    let mut soup: Vec<_> = raw
        .triangles
        .iter()
        .map(|t| {
            let mut t = t.map(key);
            let lowest = (0..3).min_by_key(|&k| t[k]).unwrap();
            t.rotate_left(lowest);
            t
        })
        .collect();
    soup.sort_unstable();
    soup
}

/// The cube's twelve triangles as strips: around four sides, and two lids.
const STRIPS: [&[i32]; 3] = [&[4, 0, 5, 1, 6, 2, 7, 3, 4, 0], &[0, 3, 1, 2], &[4, 5, 7, 6]];

/// The same triangles one by one, by the definition of a strip.
fn from_strips() -> Vec<[u32; 3]> {
    let mut found = Vec::new();
    for strip in STRIPS {
        for k in 0..strip.len() - 2 {
            let [a, b, c] = [strip[k], strip[k + 1], strip[k + 2]].map(|i| i as u32);
            found.push(if k % 2 == 0 { [a, b, c] } else { [b, a, c] });
        }
    }
    found
}

#[test]
fn ply_strips_are_the_triangles_that_they_mean() {
    let mut text = ply_text();
    text.truncate(text.find("4 0 3 2 1").unwrap());
    let strips: Vec<String> =
        STRIPS.iter().map(|s| s.iter().map(i32::to_string).collect::<Vec<_>>().join(" ")).collect();
    let list = strips.join(" -1 ");
    let count = list.split(' ').count();
    let text = text.replace("element face 6", "element tristrips 1") + &format!("{count} {list}\n");
    let found = raw(text.as_bytes(), MeshFormat::Ply);
    assert_eq!(found.triangles, from_strips());
    assert_eq!(volume(text.as_bytes(), MeshFormat::Ply), (1.0, 12));
}

#[test]
fn ply_text_may_be_laid_out_freely_but_not_be_short() {
    let plain = raw(ply_text().as_bytes(), MeshFormat::Ply);
    let (header, body) =
        ply_text().split_once("end_header\n").map(|(h, b)| (h.to_owned(), b.to_owned())).unwrap();
    let words: Vec<&str> = body.split_whitespace().collect();
    let one_line = format!("{header}end_header\n{}\n", words.join(" "));
    let each_its_own = format!("{header}end_header\n{}\n", words.join("\n"));
    let blank = format!("{header}end_header\n{}\n", body.replace('\n', "\n\n"));
    let windows = ply_text().replace('\n', "\r\n");
    for text in [one_line, each_its_own, blank, windows] {
        let found = raw(text.as_bytes(), MeshFormat::Ply);
        assert_eq!((&found.positions, &found.triangles), (&plain.positions, &plain.triangles));
    }
    let short = format!("{header}end_header\n{}\n", words[..words.len() - 1].join("\n"));
    assert!(read(short.as_bytes(), MeshFormat::Ply, "short", None).is_err());
}

#[test]
fn ply_gives_normals() {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property float nx\nproperty float ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_index\nend_header\n";
    let text = format!("{header}0 0 0 0 0 1\n1 0 0 0 1 0\n0 1 0 1 0 0\n3 0 1 2\n");
    let axis = |k: usize| Vec3::from_array(std::array::from_fn(|i| f64::from(u8::from(i == k))));
    assert_eq!(raw(text.as_bytes(), MeshFormat::Ply).normals, [[axis(2), axis(1), axis(0)]]);
}
