//! Maps in MPCDI packages.

use super::*;

/// An MPCDI file of regions, each with the size that it is said to have and its warp's file.
fn mpcdi_of(profile: &str, regions: &[(&str, [usize; 2], Vec<u8>)]) -> Vec<u8> {
    let about: String = regions
        .iter()
        .map(|(id, [w, h], _)| format!("<region id=\"{id}\" Xresolution=\"{w}\" Yresolution=\"{h}\" x=\"0\" y=\"0\" xsize=\"1\" ysize=\"1\"/>"))
        .collect();
    let sets: String = regions
        .iter()
        .map(|(id, ..)| format!("<fileset region=\"{id}\"><geometryWarpFile><path>{id}.pfm</path></geometryWarpFile></fileset>"))
        .collect();
    let xml = format!(
        "<MPCDI profile=\"{profile}\" version=\"2.0\"><display><buffer>{about}</buffer></display><files>{sets}</files></MPCDI>"
    );
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let mut add = |name: &str, bytes: &[u8]| {
        archive.start_file(name, SimpleFileOptions::default()).unwrap();
        archive.write_all(bytes).unwrap();
    };
    add("mpcdi.xml", xml.as_bytes());
    for (id, _, warp) in regions {
        // Windows' archives tell names apart by their letters only.
        add(&format!("{}.PFM", id.to_uppercase()), warp);
    }
    archive.finish().unwrap().into_inner()
}

fn pfm(end: &str, shift: f64) -> Vec<u8> {
    let mut bytes = format!("PF{end}3 2{end}-1{end}").into_bytes();
    for uv in shares() {
        let [x, y] = uv.map_or([-1.0; 2], |[u, v]| [u + shift, 1.0 - v]);
        bytes.extend(floats(&[x, y, 0.0]));
    }
    bytes
}

#[test]
fn mpcdi_files_are_read_right_or_refused_by_name() {
    let one = |profile: &str, size: [usize; 2], warp: Vec<u8>, region: Option<&str>| {
        decode(
            "m.mpcdi",
            &[("m.mpcdi", mpcdi_of(profile, &[("left", size, warp)]))],
            None,
            None,
            region,
        )
    };
    check("line feeds", one("2d", [3, 2], pfm("\n", 0.0), None));
    check("Windows' line ends", one("2D", [3, 2], pfm("\r\n", 0.0), Some("left")));
    for (result, word) in [
        (one("3d", [3, 2], pfm("\n", 0.0), None), "profile `3d`"),
        (one("a3", [3, 2], pfm("\n", 0.0), None), "2D profile"),
        (one("2d", [1920, 1080], pfm("\n", 0.0), None), "coarse grid"),
        (
            one("2d", [3, 2], [pfm("\n", 0.0), vec![0]].concat(), None),
            "73 bytes are there, not the 72",
        ),
        (one("2d", [3, 2], pfm("\n", 0.0)[..80].to_vec(), None), "not the 72"),
        (one("2d", [3, 2], pfm("\n", 0.0), Some("right")), "no region right, but left"),
    ] {
        let message = result.unwrap_err();
        assert!(message.contains(word), "{message}");
    }
    let two =
        mpcdi_of("2d", &[("left", [3, 2], pfm("\n", 0.25)), ("right", [3, 2], pfm("\n", 0.0))]);
    let read = |region| decode("m.mpcdi", &[("m.mpcdi", two.clone())], None, None, region);
    check("the second region", read(Some("right")));
    let message = read(None).unwrap_err();
    assert!(message.contains("left, right") && message.contains("--region"), "{message}");
    let left = read(Some("left")).unwrap();
    assert!((left.uv[0][0] - 0.3125).abs() < 1e-7);
    // A quarter further than 0.9375 there is no picture.
    assert_eq!(left.status[1], Status::Outside);
}

#[test]
fn a_region_of_a_part_of_the_source_leads_into_that_part() {
    let of = |place: &str| {
        let mut package = mpcdi_of("2d", &[("left", [3, 2], pfm("\n", 0.0))]);
        replace_in_description(&mut package, "x=\"0\" y=\"0\" xsize=\"1\" ysize=\"1\"", place);
        decode("m.mpcdi", &[("m.mpcdi", package)], None, None, None)
    };
    let part = of("x=\"0.5\" y=\"0.25\" xsize=\"0.375\" ysize=\"0.5\"").unwrap();
    let mut compared = 0;
    for (told, uv) in part.uv.iter().zip(shares()) {
        let Some([u, v]) = uv else {
            assert!(told[0].is_nan());
            continue;
        };
        // From 0.25 to 0.75 below the upper edge is from 0.75 down to 0.25 in v.
        let wanted = [0.5 + 0.375 * u, 0.25 + 0.5 * v];
        assert!((0..2).all(|c| (told[c] - wanted[c]).abs() < 1e-7), "{told:?} {wanted:?}");
        compared += 1;
    }
    assert!(compared > 2);
    // Where nothing is said, the region is all of the source; other programs write XResolution.
    check("nothing said", of(""));
    for (place, word) in [
        ("x=\"left\"", "x=\"left\", which is no number"),
        ("xsize=\"0\"", "has no extent"),
        ("ysize=\"NaN\"", "no number"),
    ] {
        let message = of(place).unwrap_err();
        assert!(message.contains(word), "{message}");
    }
    let mut coarse = mpcdi_of("2d", &[("left", [1920, 1080], pfm("\n", 0.0))]);
    replace_in_description(&mut coarse, "Xresolution=\"1920\" Yres", "XResolution=\"1920\" YRes");
    let message = decode("m.mpcdi", &[("m.mpcdi", coarse)], None, None, None).unwrap_err();
    assert!(message.contains("coarse grid"), "{message}");
}

/// The package with other words in its description.
fn replace_in_description(package: &mut Vec<u8>, from: &str, to: &str) {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(package.as_slice())).unwrap();
    let mut changed = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for i in 0..archive.len() {
        let mut file = archive.by_index(i).unwrap();
        let mut bytes = Vec::new();
        std::io::Read::read_to_end(&mut file, &mut bytes).unwrap();
        let name = file.name().unwrap().into_owned();
        if name == "mpcdi.xml" {
            let text = String::from_utf8(bytes).unwrap();
            assert!(text.contains(from), "{text}");
            bytes = text.replace(from, to).into_bytes();
        }
        changed.start_file(name, SimpleFileOptions::default()).unwrap();
        changed.write_all(&bytes).unwrap();
    }
    *package = changed.finish().unwrap().into_inner();
}
