//! glTF as exporters write it: quantised and sparse accessors, strips, nodes that turn, and what would change the shape.

use super::*;

// glTF, with its buffer in the file.

/// A document around one primitive: what is said of it, its accessors and views, and the buffer.
fn gltf(primitive: &str, accessors: &str, views: &str, buffer: &[u8], node: &str) -> String {
    use base64::Engine as _;
    let data = base64::engine::general_purpose::STANDARD_NO_PAD.encode(buffer);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0{node}}}],"meshes":[{{"primitives":[{{{primitive}}}]}}],
        "accessors":[{accessors}],"bufferViews":[{views}],
        "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{data}"}}]}}"#,
        buffer.len()
    )
}

fn cube_floats() -> Vec<u8> {
    CUBE.iter().flatten().flat_map(|&x| (x as f32).to_le_bytes()).collect()
}

fn cube_indices() -> Vec<u8> {
    cube().triangles.iter().flatten().map(|&i| i as u8).collect()
}

const POSITION: &str = r#""attributes":{"POSITION":0},"indices":1"#;

#[test]
fn gltf_accessors_of_every_kind_give_the_cube() {
    let expected = soup(&cube());
    let floats = r#"{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"}"#;
    let bytes = r#"{"bufferView":1,"componentType":5121,"count":36,"type":"SCALAR"}"#;
    let two = |first: usize, second: usize| {
        format!(
            r#"{{"buffer":0,"byteLength":{first}}},{{"buffer":0,"byteOffset":{first},"byteLength":{second}}}"#
        )
    };
    let plain = [cube_floats(), cube_indices()].concat();
    let check = |what: &str, json: String| {
        let found = raw(json.as_bytes(), MeshFormat::Gltf);
        assert_eq!(soup(&found), expected, "{what}");
    };
    check("plain", gltf(POSITION, &format!("{floats},{bytes}"), &two(96, 36), &plain, ""));
    let scaled = r#","matrix":[0,0,-0.5,0, 0,0.5,0,0, 0.5,0,0,0, 0,0,0,1]"#;
    // Signed bytes, normalised: 127 is 1, and both -127 and -128 are -1.
    let normalised: Vec<u8> =
        CUBE.iter().flatten().map(|&x| if x > 0.0 { 127u8 } else { 128 }).collect();
    let accessor =
        r#"{"bufferView":0,"componentType":5120,"normalized":true,"count":8,"type":"VEC3"}"#;
    let half = r#","scale":[0.5,0.5,0.5]"#;
    check(
        "normalised bytes",
        gltf(
            POSITION,
            &format!("{accessor},{bytes}"),
            &two(24, 36),
            &[normalised, cube_indices()].concat(),
            half,
        ),
    );
    // Unsigned 16-bit numbers as they are, in items of 8 bytes, brought to their place by the node.
    let padded: Vec<u8> = CUBE
        .iter()
        .flat_map(|p| p.iter().map(|&x| if x > 0.0 { 1000u16 } else { 0 }).chain([77]))
        .flat_map(u16::to_le_bytes)
        .collect();
    let views = r#"{"buffer":0,"byteLength":64,"byteStride":8},{"buffer":0,"byteOffset":64,"byteLength":36}"#
        .to_string();
    let accessor = r#"{"bufferView":0,"componentType":5123,"count":8,"type":"VEC3"}"#;
    let node = r#","scale":[0.001,0.001,0.001],"translation":[-0.5,-0.5,-0.5]"#;
    let quantised = gltf(
        POSITION,
        &format!("{accessor},{bytes}"),
        &views,
        &[padded, cube_indices()].concat(),
        node,
    );
    let required = quantised.replacen(
        "\"asset\"",
        r#""extensionsRequired":["KHR_mesh_quantization","KHR_materials_unlit","KHR_texture_transform"],"asset""#,
        1,
    );
    check("quantised", required);
    // Sparse: the first four corners stand, the others come in later, out of order.
    let mut halfway = cube_floats();
    halfway[48..].fill(0);
    let later: Vec<u8> = [5, 4, 7, 6]
        .iter()
        .flat_map(|&v: &usize| CUBE[v].iter().flat_map(|&x| (x as f32).to_le_bytes()))
        .collect();
    let accessor = r#"{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","sparse":{"count":4,
        "indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}}}"#;
    let views = format!(
        r#"{},{{"buffer":0,"byteOffset":132,"byteLength":4}},{{"buffer":0,"byteOffset":136,"byteLength":48}}"#,
        two(96, 36)
    );
    let buffer = [halfway, cube_indices(), vec![5, 4, 7, 6], later].concat();
    check("sparse", gltf(POSITION, &format!("{accessor},{bytes}"), &views, &buffer, ""));
    // All of it sparse: without a view, the rest is zeros.
    let all: Vec<u8> = (0..8u8).chain(cube_floats()).collect();
    let accessor = r#"{"componentType":5126,"count":8,"type":"VEC3","sparse":{"count":8,
        "indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":1}}}"#;
    let views = r#"{"buffer":0,"byteLength":8},{"buffer":0,"byteOffset":8,"byteLength":96},{"buffer":0,"byteOffset":104,"byteLength":36}"#;
    let bytes_at_2 = bytes.replace("\"bufferView\":1", "\"bufferView\":2");
    check(
        "zeros but for",
        gltf(
            POSITION,
            &format!("{accessor},{bytes_at_2}"),
            views,
            &[all, cube_indices()].concat(),
            "",
        ),
    );
    // A turned and mirroring node: z to x with half the size, x to -z; the cube stays a cube, its faces outward.
    let (mesh, mended) = closed(raw(
        gltf(POSITION, &format!("{floats},{bytes}"), &two(96, 36), &plain, scaled).as_bytes(),
        MeshFormat::Gltf,
    ))
    .unwrap();
    assert!((mesh.signed_volume() - 0.125).abs() < 1e-12 && mended.flipped_faces.is_empty());
    let mirrored =
        gltf(POSITION, &format!("{floats},{bytes}"), &two(96, 36), &plain, r#","scale":[1,1,-1]"#);
    assert_eq!(volume(mirrored.as_bytes(), MeshFormat::Gltf), (1.0, 12));
}

#[test]
fn gltf_strips_and_fans_are_the_triangles_that_they_mean() {
    let floats = r#"{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"}"#;
    let primitive = |accessor: usize, mode: u8| {
        format!(r#""attributes":{{"POSITION":0}},"indices":{accessor},"mode":{mode}"#)
    };
    let strips: Vec<u8> = STRIPS.concat().iter().map(|&i| i as u8).collect();
    let lengths = STRIPS.map(<[i32]>::len);
    let accessor = |offset: usize, count: usize| {
        format!(
            r#"{{"bufferView":1,"byteOffset":{offset},"componentType":5121,"count":{count},"type":"SCALAR"}}"#
        )
    };
    let accessors = [
        floats.to_owned(),
        accessor(0, lengths[0]),
        accessor(lengths[0], lengths[1]),
        accessor(lengths[0] + lengths[1], lengths[2]),
    ];
    let primitives = (1..=3).map(|k| primitive(k, 5)).collect::<Vec<_>>().join("},{");
    let views = format!(
        r#"{{"buffer":0,"byteLength":96}},{{"buffer":0,"byteOffset":96,"byteLength":{}}}"#,
        strips.len()
    );
    let buffer = [cube_floats(), strips].concat();
    let json = gltf(&primitives, &accessors.join(","), &views, &buffer, "");
    let found = raw(json.as_bytes(), MeshFormat::Gltf);
    let meant =
        RawMesh { positions: cube().positions, triangles: from_strips(), ..RawMesh::default() };
    assert_eq!(soup(&found), soup(&meant));
    assert_eq!(volume(json.as_bytes(), MeshFormat::Gltf), (1.0, 12));
    // Two fans about opposite corners fill the cube: around corner 0 and around corner 6.
    let fans: Vec<u8> = vec![0, 3, 2, 1, 5, 4, 7, 3, 6, 5, 1, 2, 3, 7, 4, 5];
    let accessors = [floats.to_owned(), accessor(0, 8), accessor(8, 8)];
    let primitives = format!("{}}},{{{}", primitive(1, 6), primitive(2, 6));
    let views = views.replace(&format!("{}}}", lengths.iter().sum::<usize>()), "16}");
    let json = gltf(&primitives, &accessors.join(","), &views, &[cube_floats(), fans].concat(), "");
    assert_eq!(volume(json.as_bytes(), MeshFormat::Gltf), (1.0, 12));
}

#[test]
fn gltf_finds_its_buffer_by_what_the_uri_means() {
    let bytes = r#"{"bufferView":1,"componentType":5121,"count":36,"type":"SCALAR"}"#;
    let floats = r#"{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"}"#;
    let views = r#"{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":36}"#;
    let buffer = [cube_floats(), cube_indices()].concat();
    let inside = gltf(POSITION, &format!("{floats},{bytes}"), views, &buffer, "");
    let from = inside.find("data:").unwrap();
    let to = from + inside[from..].find('"').unwrap();
    let with = |uri: &str| format!("{}{uri}{}", &inside[..from], &inside[to..]);
    for (uri, name) in [
        ("my%20mesh.bin", "my mesh.bin"),
        ("my mesh.bin", "my mesh.bin"),
        ("%C3%BC/100%25.bin", "ü/100%.bin"),
        ("./a.bin", "./a.bin"),
    ] {
        let beside = |path: &Path| {
            assert_eq!(path, Path::new(name));
            Ok(buffer.clone())
        };
        let found = read(with(uri).as_bytes(), MeshFormat::Gltf, "model", Some(&beside)).unwrap();
        assert_eq!(soup(&found), soup(&cube()), "{uri}");
    }
    let never = |_: &Path| -> std::io::Result<Vec<u8>> { panic!("it is not to be read") };
    for uri in ["%2e%2e/secret", "..%2fsecret", "%2Fetc%2Fpasswd", ""] {
        assert!(
            read(with(uri).as_bytes(), MeshFormat::Gltf, "model", Some(&never)).is_err(),
            "{uri}"
        );
    }
    // Every byte as %XX is a data URI as well.
    let percent: String = buffer.iter().map(|byte| format!("%{byte:02x}")).collect();
    let found =
        raw(with(&format!("data:application/octet-stream,{percent}")).as_bytes(), MeshFormat::Gltf);
    assert_eq!(soup(&found), soup(&cube()));
}

#[test]
fn gltf_normals_follow_the_surface_through_any_node() {
    // A triangle in the plane x + z = 1, its normal given; the node stretches x threefold and mirrors y.
    let points = [[1.0f32, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
    let normals = [[1.0f32, 0.0, 1.0]; 3];
    let bytes: Vec<u8> =
        points.iter().chain(&normals).flatten().flat_map(|x| x.to_le_bytes()).collect();
    let accessors = r#"{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"}"#;
    let views = r#"{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":36}"#;
    let json = gltf(
        r#""attributes":{"POSITION":0,"NORMAL":1}"#,
        accessors,
        views,
        &bytes,
        r#","scale":[3,-1,1]"#,
    );
    let raw = raw(json.as_bytes(), MeshFormat::Gltf);
    let [a, b, c] = raw.triangles[0].map(|v| raw.positions[v as usize]);
    let face = (b - a).cross(c - a).normalized();
    let given = raw.normals[0][0].normalized();
    assert!((given.dot(face).abs() - 1.0).abs() < 1e-12, "{given:?} {face:?}");
    // The plane is now x / 3 + z = 1: the normal is along (1/3, 0, 1).
    assert!((given - Vec3::new(1.0, 0.0, 3.0).normalized()).length() < 1e-12);
}

#[test]
fn gltf_refuses_what_would_change_the_shape() {
    let floats = r#"{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"}"#;
    let bytes = r#"{"bufferView":1,"componentType":5121,"count":36,"type":"SCALAR"}"#;
    let views = r#"{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":36}"#;
    let buffer = [cube_floats(), cube_indices()].concat();
    let make = |primitive: &str, node: &str| {
        gltf(&format!("{POSITION}{primitive}"), &format!("{floats},{bytes}"), views, &buffer, node)
    };
    let targets = r#","targets":[{"POSITION":0}]"#;
    for (json, word) in [
        (make(targets, r#","weights":[0.5]"#), "morph"),
        (make("", r#","skin":0"#), "skins"),
        (make("", r#","extensions":{"EXT_mesh_gpu_instancing":{}}"#), "instances"),
        (
            make("", "").replacen(
                "\"asset\"",
                r#""extensionsRequired":["EXT_meshopt_compression"],"asset""#,
                1,
            ),
            "EXT_meshopt_compression",
        ),
        (make("", r#","extensions":{"KHR_node_visibility":{"visible":false}}"#), "no faces"),
    ] {
        let error = read(json.as_bytes(), MeshFormat::Gltf, "model", None).expect_err(word);
        assert!(error.message.contains(word), "{error}");
    }
    // Targets without weight leave the shape as it is.
    let found = raw(make(targets, r#","weights":[0]"#).as_bytes(), MeshFormat::Gltf);
    assert_eq!(soup(&found), soup(&cube()));
    // A library of meshes has no scene.
    let without = make("", "").replace("\"scene\":0,\"scenes\":[{\"nodes\":[0]}],", "");
    assert_eq!(soup(&raw(without.as_bytes(), MeshFormat::Gltf)), soup(&cube()));
}
