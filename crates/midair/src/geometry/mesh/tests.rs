//! Readers against one another and a peer, mending against meshes broken on purpose, measures against
//! closed forms, and all of them against damaged files.

use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;

mod bodies;
mod creases;
mod files;
mod formats;

/// A unit-edged cube about the origin: vertices and outward quads.
const CUBE: [[f64; 3]; 8] = [
    [-0.5, -0.5, -0.5],
    [0.5, -0.5, -0.5],
    [0.5, 0.5, -0.5],
    [-0.5, 0.5, -0.5],
    [-0.5, -0.5, 0.5],
    [0.5, -0.5, 0.5],
    [0.5, 0.5, 0.5],
    [-0.5, 0.5, 0.5],
];
const QUADS: [[u32; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

fn cube() -> RawMesh {
    let mut raw = RawMesh {
        positions: CUBE.iter().map(|&p| Vec3::from_array(p)).collect(),
        ..RawMesh::default()
    };
    for (face, quad) in (1u32..).zip(QUADS) {
        raw.push_polygon(&quad, face, None);
    }
    raw
}

/// Appends `other`, scaled and moved, turned inside out if asked.
fn append(raw: &mut RawMesh, other: &RawMesh, scale: f64, shift: Vec3, inside_out: bool) {
    let first = raw.positions.len() as u32;
    raw.positions.extend(other.positions.iter().map(|&p| p * scale + shift));
    for &[a, b, c] in &other.triangles {
        let face = raw.faces.len() as u32 + 1;
        let [b, c] = if inside_out { [c, b] } else { [b, c] };
        raw.push_polygon(&[a + first, b + first, c + first], face, None);
    }
}

/// A sphere of triangles: `n` rings of 2 `n` vertices, the poles many vertices at one place.
fn sphere(n: usize) -> RawMesh {
    let mut raw = RawMesh::default();
    let columns = 2 * n;
    for i in 0..=n {
        for j in 0..=columns {
            let (theta, phi) = (PI * i as f64 / n as f64, 2.0 * PI * j as f64 / columns as f64);
            raw.positions.push(Vec3::new(
                theta.sin() * phi.sin(),
                theta.cos(),
                theta.sin() * phi.cos(),
            ));
        }
    }
    let at = |i: usize, j: usize| (i * (columns + 1) + j) as u32;
    for i in 0..n {
        for j in 0..columns {
            let face = (raw.faces.len() / 2) as u32;
            raw.push_polygon(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], face, None);
        }
    }
    raw
}

fn closed(raw: RawMesh) -> Result<(TriangleMesh, Mended), MeshError> {
    mend(raw, "test", Surface::Closed)
}

#[test]
fn a_good_cube_stays_as_it_is() {
    let (mesh, mended) = closed(cube()).unwrap();
    assert!(mended.notes().is_empty(), "{:?}", mended.notes());
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 12));
    assert!((mesh.signed_volume() - 1.0).abs() < 1e-15);
    let half = Vec3::new(0.5, 0.5, 0.5);
    assert_eq!(mesh.bounds(), [-half, half]);
}

#[test]
fn measures_of_a_fine_sphere_are_the_sphere_s() {
    let n = 64;
    let (mesh, mended) = closed(sphere(n)).unwrap();
    // Poles: each a ring of 2n + 1 vertices, and a seam of n + 1 doubled ones. At one pole the corners of a quad stand at one place to the last digit and
    // make one triangle; at the other, where sin(pi) is not quite 0, the triangle between them collapses.
    assert_eq!(mended.merged_vertices, 2 * 2 * n + (n - 1));
    assert_eq!(mended.collapsed_faces.len(), 2 * n);
    assert!(mended.flipped_faces.is_empty());
    // Inscribed facets lose a relative 3/2 of the squared half angle pi / 2n, at most, two ways.
    let volume = mesh.signed_volume();
    let loss = 2.0 * (PI / n as f64).powi(2);
    assert!(volume < 4.0 / 3.0 * PI && volume > 4.0 / 3.0 * PI * (1.0 - loss), "{volume}");
    // The normals of a sphere are its positions; angle weights on these regular rings err by the
    // squared half angle at most.
    for (p, n) in mesh.positions.iter().zip(mesh.smooth_normals()) {
        assert!((*p - n).length() < loss, "{p:?} {n:?}");
        assert!((n.length() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn angle_weighted_normals_of_a_cube_are_its_diagonals() {
    // However the quads are cut, each face has 90 degrees at each corner: exactly the diagonal. Weights by
    // area or count would lean towards faces that are cut there.
    let (mesh, _) = closed(cube()).unwrap();
    for (p, n) in mesh.positions.iter().zip(mesh.smooth_normals()) {
        assert!((p.normalized() - n).length() < 1e-15);
    }
}

#[test]
fn flipped_faces_are_turned_and_named() {
    let mut raw = cube();
    raw.triangles[4].swap(0, 1);
    let (mesh, mended) = closed(raw).unwrap();
    assert_eq!(mended.flipped_faces, ["face 3"]);
    assert!(mended.notes()[0].contains("face 3"));
    assert!((mesh.signed_volume() - 1.0).abs() < 1e-15);

    let mut raw = cube();
    raw.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let (mesh, mended) = closed(raw).unwrap();
    assert!(mended.inside_out && mended.notes()[0].contains("inside out"));
    assert!((mesh.signed_volume() - 1.0).abs() < 1e-15);
}

#[test]
fn duplicate_vertices_are_merged_by_place() {
    // A soup of separate triangles, each corner off by less than the tolerance.
    let good = cube();
    let mut raw = RawMesh::default();
    for (i, t) in good.triangles.iter().enumerate() {
        let first = raw.positions.len() as u32;
        for (k, &v) in t.iter().enumerate() {
            // The diagonal is sqrt 3, the tolerance 1.7e-9: errors of 8e-10 differ by less.
            let off = 4e-10 * [1.0, -1.0][(i + k) % 2];
            raw.positions.push(good.positions[v as usize] + Vec3::new(off, -off, off));
        }
        raw.push_polygon(&[first, first + 1, first + 2], i as u32, None);
    }
    raw.positions.push(Vec3::new(9.0, 9.0, 9.0));
    raw.positions.pop();
    let (mesh, mended) = closed(raw).unwrap();
    assert_eq!(mesh.positions.len(), 8);
    assert_eq!(mended.merged_vertices, 36 - 8);
    assert!((mesh.signed_volume() - 1.0).abs() < 1e-8);
}

#[test]
fn unused_vertices_and_repeated_faces_are_said() {
    let mut raw = cube();
    raw.positions.push(Vec3::new(0.1, 0.2, 0.3));
    raw.push_polygon(&[2, 3, 0], 7, None);
    let (mesh, mended) = closed(raw).unwrap();
    assert_eq!((mended.unused_vertices, mesh.positions.len()), (1, 8));
    assert_eq!(mended.repeated_faces, ["face 7"]);
    assert_eq!(mended.notes().len(), 2);
}

#[test]
fn holes_are_named_by_face_and_edge_and_allowed_for_mirrors() {
    let mut raw = cube();
    raw.triangles.remove(11);
    raw.faces.remove(11);
    let error = closed(raw.clone()).unwrap_err();
    assert!(error.message.contains("not watertight"), "{error}");
    assert!(error.message.contains("face 2 ") && error.message.contains("3 open edges"), "{error}");
    assert!(error.help.contains("close the holes"));
    let (mesh, _) = mend(raw, "test", Surface::Open).unwrap();
    assert_eq!(mesh.triangles.len(), 11);
}

#[test]
fn degenerate_faces_are_named() {
    // A corner in the middle of an edge, on one side only: a sliver of no area closes the gap.
    let mut raw = cube();
    raw.positions.push(Vec3::new(0.0, -0.5, -0.5));
    // Face 3 has the edge 0-1; cut it there, and fill with the sliver 0, 1, 8.
    raw.triangles[4] = [0, 8, 5];
    raw.faces[4] = 3;
    raw.push_polygon(&[8, 1, 5], 3, None);
    raw.push_polygon(&[0, 1, 8], 7, None);
    let error = closed(raw).unwrap_err();
    assert!(error.message.contains("face 7 is degenerate"), "{error}");
}

#[test]
fn edges_of_more_than_two_faces_are_named() {
    let mut raw = cube();
    raw.push_polygon(&[0, 1, 6], 7, None);
    let error = closed(raw).unwrap_err();
    assert!(error.message.contains("more than one other"), "{error}");
    assert!(error.message.contains("face 7"), "{error}");
}

#[test]
fn one_sided_surfaces_are_refused() {
    // The projective plane on six vertices: closed, every edge of two faces, one side.
    let mut raw = RawMesh {
        positions: (0..6)
            .map(|i| {
                let a = f64::from(i);
                Vec3::new(a.cos() * (1.0 + a), a.sin() * 2.0, (a * a).sin())
            })
            .collect(),
        ..RawMesh::default()
    };
    let faces = [
        [0, 1, 2],
        [0, 2, 3],
        [0, 3, 4],
        [0, 4, 5],
        [0, 5, 1],
        [1, 2, 4],
        [2, 3, 5],
        [3, 4, 1],
        [4, 5, 2],
        [5, 1, 3],
    ];
    for (i, face) in faces.iter().enumerate() {
        raw.push_polygon(face, i as u32, None);
    }
    let error = closed(raw).unwrap_err();
    assert!(error.message.contains("only one side"), "{error}");
}

#[test]
fn hollows_face_inward_and_islands_outward() {
    for inside_out in [false, true] {
        let mut raw = cube();
        append(&mut raw, &cube(), 0.5, Vec3::ZERO, inside_out);
        append(&mut raw, &cube(), 0.25, Vec3::ZERO, inside_out);
        append(&mut raw, &cube(), 1.0, Vec3::new(3.0, 0.0, 0.0), inside_out);
        let (mesh, mended) = closed(raw).unwrap();
        assert_eq!(mended.hollows, 1);
        let expected = 1.0 - 0.125 + 0.015625 + 1.0;
        assert!((mesh.signed_volume() - expected).abs() < 1e-14);
        assert!(mesh.contains(Vec3::new(0.4, 0.0, 0.01)));
        assert!(!mesh.contains(Vec3::new(0.2, 0.0, 0.01)));
        assert!(mesh.contains(Vec3::new(0.1, 0.0, 0.01)));
    }
}

#[test]
fn overlapping_pieces_stay_outward() {
    let mut raw = cube();
    append(&mut raw, &cube(), 1.0, Vec3::new(0.4, 0.3, 0.2), false);
    let (mesh, mended) = closed(raw).unwrap();
    assert_eq!(mended.notes().len(), 1);
    assert!(mended.notes()[0].contains("that of face 1 and that of face 13"));
    assert!((mesh.signed_volume() - 2.0).abs() < 1e-14);
}

#[test]
fn a_flat_closed_piece_encloses_nothing() {
    // Two squares back to back, cut along different diagonals.
    let mut raw = RawMesh {
        positions: CUBE[..4].iter().map(|&p| Vec3::from_array(p)).collect(),
        ..RawMesh::default()
    };
    for (i, t) in [[0, 1, 2], [0, 2, 3], [1, 0, 3], [1, 3, 2]].iter().enumerate() {
        raw.push_polygon(t, i as u32, None);
    }
    let error = closed(raw).unwrap_err();
    assert!(error.message.contains("no volume"), "{error}");
}

/// One square seen from both sides: its faces lie upon one another, as a wall's do, but there are no solids that it parts.
#[test]
fn a_sheet_with_two_sides_is_no_solid() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 3 2 1\nf 4 3 1\n";
    let raw = read(text.as_bytes(), MeshFormat::Obj, "sheet.obj", None).unwrap();
    let error = mend(raw, "sheet.obj", Surface::Closed).unwrap_err();
    assert!(error.to_string().contains("not watertight"), "{error}");
}

fn obj_text() -> String {
    let mut text = String::from("# cube\no cube\n");
    CUBE.iter().for_each(|[x, y, z]| text += &format!("v {x} {y} {z}\n"));
    QUADS.iter().for_each(|q| {
        let q = q.map(|i| i + 1);
        text += &format!("f {}/1/1 {}//1 {} {}/2\n", q[0], q[1], q[2], q[3]);
    });
    text
}

fn off_text() -> String {
    let mut text = String::from("OFF\n8 6 12\n");
    CUBE.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    QUADS.iter().for_each(|q| text += &format!("4 {} {} {} {}\n", q[0], q[1], q[2], q[3]));
    text
}

fn stl_bytes(name: &[u8]) -> Vec<u8> {
    let raw = cube();
    let mut bytes = name.to_vec();
    bytes.resize(80, b' ');
    bytes.extend((raw.triangles.len() as u32).to_le_bytes());
    for t in &raw.triangles {
        bytes.extend([0u8; 12]);
        for &v in t {
            let p = raw.positions[v as usize];
            p.to_array().iter().for_each(|&x| bytes.extend((x as f32).to_le_bytes()));
        }
        bytes.extend([0u8; 2]);
    }
    bytes
}

fn stl_text() -> String {
    let raw = cube();
    let mut text = String::from("solid cube\n");
    for t in &raw.triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for &v in t {
            let p = raw.positions[v as usize];
            text += &format!("vertex {} {} {}\n", p.x, p.y, p.z);
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid cube\n"
}

fn ply_text() -> String {
    let mut text = String::from(
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n\
         property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n",
    );
    CUBE.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    QUADS.iter().for_each(|q| text += &format!("4 {} {} {} {}\n", q[0], q[1], q[2], q[3]));
    text
}

fn ply_bytes() -> Vec<u8> {
    let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement vertex 8\nproperty double x\n\
        property double y\nproperty double z\nproperty uchar red\nelement face 6\n\
        property list uchar uint vertex_index\nend_header\n"
        .to_vec();
    for p in CUBE {
        p.iter().for_each(|x| bytes.extend(x.to_be_bytes()));
        bytes.push(200);
    }
    for q in QUADS {
        bytes.push(4);
        q.iter().for_each(|i| bytes.extend(i.to_be_bytes()));
    }
    bytes
}

/// The cube as GLB, of edge 0.5 and moved, with nodes that scale and move it back; one mirrors.
fn glb_bytes() -> Vec<u8> {
    let raw = cube();
    let mut blob = Vec::new();
    for p in CUBE {
        p.iter().for_each(|x| blob.extend((*x as f32 * 0.5 + 1.0).to_le_bytes()));
    }
    for t in &raw.triangles {
        // The mirroring node turns the faces: the file has them inside out in space.
        t.iter().for_each(|&i| blob.extend((i as u16).to_le_bytes()));
    }
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"children":[1],"scale":[2,2,-2]}},{{"mesh":0,"translation":[-1,-1,-1]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "buffers":[{{"byteLength":{}}}],
        "bufferViews":[{{"buffer":0,"byteLength":96}},{{"buffer":0,"byteOffset":96,"byteLength":72}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3",
        "min":[0.75,0.75,0.75],"max":[1.25,1.25,1.25]}},
        {{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}}]}}"#,
        blob.len()
    );
    let mut json = json.into_bytes();
    while json.len() % 4 != 0 {
        json.push(b' ');
    }
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2u32.to_le_bytes());
    bytes.extend((12 + 8 + json.len() as u32 + 8 + blob.len() as u32).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((blob.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(blob);
    bytes
}

/// The cube in every format.
fn samples() -> Vec<(MeshFormat, Vec<u8>)> {
    vec![
        (MeshFormat::Obj, obj_text().into()),
        (MeshFormat::Off, off_text().into()),
        (MeshFormat::Stl, stl_bytes(b"solid binary all the same")),
        (MeshFormat::Stl, stl_bytes(b"other")),
        (MeshFormat::Stl, stl_text().into()),
        (MeshFormat::Ply, ply_text().into()),
        (MeshFormat::Ply, ply_bytes()),
        (MeshFormat::Gltf, glb_bytes()),
    ]
}
