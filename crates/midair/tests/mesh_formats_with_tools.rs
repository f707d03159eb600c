//! Mesh files that another program writes: its own figures for the body against ours.
//!
//! The program is asked for through midair-peers.

use midair::geometry::mesh::{Surface, load};
use std::process::Command;

const SCRIPT: &str = "
import sys, trimesh
folder = sys.argv[1] + '/'
bodies = {
    'box': trimesh.creation.box((3, 2, 1)),
    'capsule': trimesh.creation.capsule(height=4, radius=1.5),
    'ring': trimesh.creation.annulus(2, 3, 1),
    'pair': trimesh.util.concatenate([
        trimesh.creation.icosphere(3, 2), trimesh.creation.box((1, 1, 1)).apply_translation((5, 0, 0))]),
}
for name, body in bodies.items():
    forms = {
        'plain.obj': body.export(file_type='obj', include_normals=False),
        'normals.obj': body.export(file_type='obj', include_normals=True),
        'binary.stl': body.export(file_type='stl'),
        'text.stl': body.export(file_type='stl_ascii'),
        'binary.ply': body.export(file_type='ply', vertex_normal=True),
        'text.ply': body.export(file_type='ply', encoding='ascii'),
        'plain.off': body.export(file_type='off'),
        'one.glb': trimesh.Scene(body).export(file_type='glb'),
    }
    for form, data in forms.items():
        with open(folder + name + '-' + form, 'wb') as file:
            file.write(data if isinstance(data, bytes) else data.encode())
    for part, data in trimesh.Scene(body).export(file_type='gltf').items():
        with open(folder + (name + '-many.gltf' if part == 'model.gltf' else part), 'wb') as file:
            file.write(data)
    with open(folder + name + '-many.gltf') as file:
        text = file.read()
    # Each body's buffers under names of their own.
    import json, os
    model = json.loads(text)
    for buffer in model['buffers']:
        uri = name + ' ' + buffer['uri']
        os.rename(folder + buffer['uri'], folder + uri)
        buffer['uri'] = uri.replace(' ', '%20')
    with open(folder + name + '-many.gltf', 'w') as file:
        json.dump(model, file)
    for form in list(forms) + ['many.gltf']:
        print(name + '-' + form, len(body.faces), repr(float(body.volume)))
";

#[test]
fn trimesh_s_files_are_the_bodies_that_it_says() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(python).args(["-c", SCRIPT]).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8(output.stdout).unwrap();
    let mut files = 0;
    for line in told.lines() {
        let [name, faces, volume] = line.split(' ').collect::<Vec<_>>().try_into().unwrap();
        let file = folder.path().join(name);
        let bytes = std::fs::read(&file).unwrap();
        let (mesh, mended) = load(&bytes, &file, Surface::Closed, None).unwrap();
        let volume: f64 = volume.parse().unwrap();
        assert_eq!(mesh.triangles.len(), faces.parse::<usize>().unwrap(), "{name}");
        // Texts have eight digits, binary files single precision.
        assert!((mesh.signed_volume() / volume - 1.0).abs() < 1e-5, "{name}");
        assert!(mended.flipped_faces.is_empty() && mended.overlaps.is_empty(), "{name}");
        // And its normals stand as the faces do: no mesh is smooth over a box's edges.
        let (_, shading) = mesh.with_creased_normals(30.0);
        let sharp = match name.split('-').next() {
            Some("box" | "pair") => 12,
            Some("capsule") => 0,
            // Four rims of 32 edges.
            _ => 128,
        };
        assert_eq!(shading.sharp_edges, sharp, "{name}");
        files += 1;
    }
    assert_eq!(files, 4 * 9);
}
