//! Every format gives the same cube; what cannot be read is named with its place; any damage is read or refused.

use super::*;

#[test]
fn every_format_gives_the_same_cube() {
    for (i, (format, bytes)) in samples().into_iter().enumerate() {
        midair_peers::corpus::keep("meshes", &[&[format as u8], &bytes]);
        let raw = read(&bytes, format, "cube", None).unwrap_or_else(|e| panic!("{i}: {e}"));
        assert_eq!(raw.triangles.len(), 12, "{i}");
        let (mesh, mended) = closed(raw).unwrap();
        assert!(mended.flipped_faces.is_empty(), "{i}: {:?}", mended.notes());
        assert_eq!(mesh.positions.len(), 8, "{i}");
        // Half and whole numbers are exact in every format.
        assert_eq!(mesh.signed_volume(), 1.0, "{i}");
        let half = Vec3::new(0.5, 0.5, 0.5);
        assert_eq!(mesh.bounds(), [-half, half], "{i}");
    }
}

#[test]
fn headers_that_claim_too_much_are_refused_at_once() {
    let million = 1_000_000_000u32;
    let mut stl = stl_bytes(b"x");
    stl[80..84].copy_from_slice(&million.to_le_bytes());
    let ply = |text: String| text.replace("vertex 8", "vertex 1000000000").into_bytes();
    let empty = b"ply\nformat binary_little_endian 1.0\nelement face 1000000000\nend_header\n";
    let list = b"ply\nformat binary_little_endian 1.0\nelement face 1\n\
        property list uint int vertex_indices\nend_header\n\xff\xff\xff\xff";
    let glb = String::from_utf8_lossy(&glb_bytes()).replace("\"count\":36", "\"count\":4000000000");
    let glb = glb[20..glb.find("]}BIN").map_or(glb.len(), |i| i + 2)].to_owned();
    let json = &glb[..glb.rfind('}').unwrap() + 1];
    for (format, bytes) in [
        (MeshFormat::Stl, stl),
        (MeshFormat::Ply, ply(ply_text())),
        (MeshFormat::Ply, empty.to_vec()),
        (MeshFormat::Ply, list.to_vec()),
        (MeshFormat::Off, off_text().replace("8 6 12", "8 1000000000 12").into_bytes()),
        (MeshFormat::Gltf, json.as_bytes().to_vec()),
    ] {
        let start = crate::clock::Stopwatch::start();
        let error = read(&bytes, format, "huge", None).unwrap_err();
        assert!(error.to_string().starts_with("huge: "), "{error}");
        // A thousand million of anything would take longer than this.
        assert!(start.elapsed().as_secs_f64() < 0.5, "{format:?}");
    }
}

#[test]
fn text_formats_name_line_and_face() {
    for (format, text, words) in [
        (MeshFormat::Obj, obj_text().replace("v 0.5 -0.5 -0.5", "v 0.5 -0.5"), "line 4"),
        (MeshFormat::Obj, obj_text().replace("f 5/1/1", "f 99/1/1"), "face 2 (line 12)"),
        (MeshFormat::Obj, obj_text().replace("f 5/1/1", "f -9/1/1"), "line 12"),
        (MeshFormat::Obj, obj_text().replace("f 5/1/1", "f x"), "line 12: a corner of face 2"),
        (MeshFormat::Off, off_text().replace("4 4 5 6 7", "4 4 5 6"), "line 12: face 1"),
        (MeshFormat::Off, off_text().replace("4 4 5 6 7", "4 4 5 6 8"), "face 1 (line 12)"),
        (MeshFormat::Ply, ply_text().replace("4 4 5 6 7", "4 4 5 6 8"), "face 1"),
        (MeshFormat::Ply, ply_text().replace("4 4 5 6 7", "4 4 5"), "ine 19"),
        (MeshFormat::Off, off_text().replace("\n0.5 0.5 0.5", "\nnan 0.5 0.5"), "NaN"),
        (MeshFormat::Obj, obj_text().replace("v 0.5 0.5 0.5", "v 1e999 0.5 0.5"), "inf"),
        (MeshFormat::Stl, stl_text().replace("vertex", "vortex"), "face 1"),
        (MeshFormat::Obj, "v 1 2 3\n".to_owned(), "no faces"),
        (MeshFormat::Obj, String::new(), "no faces"),
    ] {
        let error = read(text.as_bytes(), format, "bad", None).expect_err(words);
        assert!(error.message.contains(words), "{words:?} is not in {error}");
    }
}

#[test]
fn obj_counts_back_from_the_latest_vertex() {
    let negative = obj_text().replace("f 5/1/1 6//1 7 8/2", "f -4/1/1 -3//1 -2 -1/2");
    assert_ne!(negative, obj_text());
    let [a, b] =
        [negative, obj_text()].map(|t| read(t.as_bytes(), MeshFormat::Obj, "cube", None).unwrap());
    assert_eq!(a, b);
}

#[test]
fn gltf_refuses_what_it_cannot_read() {
    let json = |from: &str, to: &str| {
        let bytes = glb_bytes();
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        let text = String::from_utf8(bytes[20..20 + length].to_vec()).unwrap();
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    };
    // Zeros in place of the binary chunk, for the cases that are not about buffers.
    let zeros = format!("\"byteLength\":168,\"uri\":\"data:a;base64,{}\"", "A".repeat(224));
    let inline = |from: &str, to: &str| json(from, to).replace("\"byteLength\":168", &zeros);
    let draco = "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\"";
    let buffer = "\"byteLength\":168";
    for (text, word) in [
        (inline("\"asset\"", draco), "KHR_draco_mesh_compression"),
        (inline("\"2.0\"", "\"1.0\""), "version 2"),
        (inline("\"indices\":1", "\"indices\":1,\"mode\":7"), "mode 7"),
        (inline("\"indices\":1", "\"indices\":7"), "accessors 7"),
        (inline("\"indices\":1", "\"indices\":0"), "accessor 0 has a type"),
        (inline("\"count\":36", "\"count\":37"), "accessor 1 reaches outside"),
        (inline("\"byteOffset\":96", "\"byteOffset\":97"), "reaches outside"),
        (inline("\"children\":[1],", "\"children\":[1,1],"), "more than one parent"),
        (inline("\"children\":[1],", "\"children\":[0],"), "more than one parent"),
        (json(buffer, "\"byteLength\":168,\"uri\":\"../../etc/passwd\""), "elsewhere"),
        (json(buffer, "\"byteLength\":168,\"uri\":\"/etc/passwd\""), "elsewhere"),
        (json(buffer, "\"byteLength\":168,\"uri\":\"data:x;base64,!!\""), "data URI"),
        (json(buffer, "\"byteLength\":168,\"uri\":\"none.bin\""), "none.bin"),
        (json(buffer, buffer), "has no data"),
    ] {
        let beside = |name: &Path| std::fs::read(std::env::temp_dir().join(name));
        let error =
            read(text.as_bytes(), MeshFormat::Gltf, "model", Some(&beside)).expect_err(word);
        assert!(error.message.contains(word), "{word:?} is not in {error}");
        assert!(error.file == "model" && !error.help.is_empty());
    }
}

fn spot() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/meshes/spot.obj")
}

#[test]
fn obj_agrees_with_a_peer_on_spot() {
    let raw = read(&std::fs::read(spot()).unwrap(), MeshFormat::Obj, "spot", None).unwrap();
    let options = tobj::LoadOptions { single_index: false, ..tobj::LoadOptions::default() };
    let (models, _) = tobj::load_obj(spot(), &options).unwrap();
    let peer = &models[0].mesh;
    assert_eq!(models.len(), 1);
    let corners = |positions: &[f64], i: u32| -> [f64; 3] {
        positions[3 * i as usize..3 * i as usize + 3].try_into().unwrap()
    };
    let theirs: Vec<[f64; 3]> = peer.indices.iter().map(|&i| corners(&peer.positions, i)).collect();
    let ours: Vec<[f64; 3]> =
        raw.triangles.iter().flatten().map(|&i| raw.positions[i as usize].to_array()).collect();
    assert_eq!(ours, theirs);
}

#[test]
fn spot_is_watertight_as_shipped() {
    let bytes = std::fs::read(spot()).unwrap();
    let (mesh, mended) = load(&bytes, &spot(), Surface::Closed, None).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (2930, 5856));
    // A closed surface of one piece without handles: Euler's number is 2.
    assert_eq!(mesh.positions.len() as i64 - 3 * 5856 / 2 + 5856, 2);
    assert!(mesh.signed_volume() > 0.0 && mended.flipped_faces.is_empty());
}

#[test]
fn unknown_formats_are_named() {
    for name in ["folder/model.fbx", "model"] {
        let error = load(b"v 0 0 0\n", Path::new(name), Surface::Closed, None).unwrap_err();
        assert!(error.to_string().starts_with(name), "{error}");
    }
}

/// What must hold for any bytes at all: a mesh that is fit to use, or a message that names the file.
fn fit_or_refused(bytes: &[u8], format: MeshFormat) -> Result<(), TestCaseError> {
    for surface in [Surface::Closed, Surface::Open] {
        match read(bytes, format, "some.mesh", None).and_then(|r| mend(r, "some.mesh", surface)) {
            Ok((mesh, _)) => {
                prop_assert!(
                    mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len())
                );
                prop_assert!(mesh.positions.iter().all(|p| p.is_finite()));
                prop_assert!(mesh.smooth_normals().iter().all(|n| (n.length() - 1.0).abs() < 1e-9));
                if surface == Surface::Closed {
                    prop_assert!(mesh.signed_volume() > 0.0);
                }
            }
            Err(error) => {
                prop_assert!(error.to_string().starts_with("some.mesh: "), "{}", error);
                prop_assert!(!error.help.is_empty() && error.to_string().len() < 2000, "{}", error);
            }
        }
    }
    Ok(())
}

const FORMATS: [MeshFormat; 5] =
    [MeshFormat::Obj, MeshFormat::Off, MeshFormat::Stl, MeshFormat::Ply, MeshFormat::Gltf];

proptest! {
    #[test]
    fn points_are_inside_the_cube_where_they_are(
        p in proptest::array::uniform3(-1.0..1.0f64), shift in proptest::array::uniform3(-50.0..50.0f64)
    ) {
        prop_assume!(p.iter().all(|x| (x.abs() - 0.5).abs() > 1e-9));
        let mut raw = RawMesh::default();
        let shift = Vec3::from_array(shift);
        append(&mut raw, &cube(), 1.0, shift, false);
        let (mesh, _) = closed(raw).unwrap();
        let inside = p.iter().all(|x| x.abs() < 0.5);
        prop_assert_eq!(mesh.contains(Vec3::from_array(p) + shift), inside);
    }

    /// Any faces turned, any vertices split: the cube comes back.
    #[test]
    fn any_winding_is_mended(flips in proptest::array::uniform12(any::<bool>())) {
        let mut raw = cube();
        for (t, &flip) in raw.triangles.iter_mut().zip(&flips) {
            if flip { t.swap(1, 2); }
        }
        let (mesh, mended) = closed(raw).unwrap();
        prop_assert_eq!(mended.flipped_faces.len(), flips.iter().filter(|f| **f).count());
        prop_assert!((mesh.signed_volume() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn random_bytes_are_refused_by_name(
        bytes in proptest::collection::vec(any::<u8>(), 0..400), format in prop::sample::select(FORMATS.to_vec())
    ) {
        fit_or_refused(&bytes, format)?;
    }

    #[test]
    fn damaged_files_are_fit_or_refused(
        sample in 0..8usize,
        edits in proptest::collection::vec(
            (any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..4u8, any::<u8>()), 1..4),
    ) {
        let (format, mut bytes) = samples().swap_remove(sample);
        for (a, b, what, value) in edits {
            if bytes.is_empty() { break; }
            let (a, b) = (a.index(bytes.len()), b.index(bytes.len()));
            match what {
                0 => bytes[a] = value,
                1 => bytes.truncate(a),
                2 => { let part = bytes[a.min(b)..a.max(b)].to_vec(); bytes.splice(a..a, part); }
                _ => bytes[a] ^= 1 << (value % 8),
            }
        }
        fit_or_refused(&bytes, format)?;
    }
}
