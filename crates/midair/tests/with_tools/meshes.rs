//! Mesh files that another program writes: its own figures for the body against ours.
//!
//! The program is asked for through midair-peers.

use midair::geometry::mesh::{MeshFormat, Surface, load};
use midair::geometry::{Crossing, MeshSurface, Ray, Search, Vec3};
use std::path::Path;
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
        if let Some(format) = MeshFormat::of(&file) {
            midair_peers::corpus::keep("meshes", &[&[format as u8], &bytes]);
        }
        let beside = |name: &Path| std::fs::read(folder.path().join(name));
        let (mesh, mended) = load(&bytes, &file, Surface::Closed, Some(&beside)).unwrap();
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

const UNIONS: &str = "
import sys, numpy, trimesh
folder = sys.argv[1] + '/'
box = lambda size, place=(0, 0, 0): trimesh.creation.box(size).apply_translation(place)
ball = lambda radius, place: trimesh.creation.icosphere(2, radius).apply_translation(place)
bodies = {
    'cross': [box((4, 1, 1)), box((1, 4, 1.05)), box((1.02, 1.07, 4))],
    'flush': [box((4, 1, 1)), box((1, 4, 1))],
    'on-a-face': [box((2, 2, 2)), box((1, 1, 1), (0.1, 0.2, 1.5))],
    'balls': [ball(1.2, (0, 0, 0)), ball(1.2, (1, 0, 0)), ball(1.2, (0.5, 0.9, 0))],
    'through': [box((4, 4, 1)), trimesh.creation.cylinder(0.8, 3, sections=24)],
}
for name, parts in bodies.items():
    trimesh.util.concatenate(parts).export(folder + name + '-parts.ply')
    trimesh.boolean.union(parts, engine='manifold').export(folder + name + '-union.ply')
    print(name)
";

/// Where a ray from outside crosses a surface, each place found from the one before, as a path finds them.
fn crossings(surface: &MeshSurface, ray: &Ray) -> Vec<f64> {
    let (mut found, mut at, mut face) = (Vec::new(), 0.0, None);
    loop {
        let wanted = if found.len().is_multiple_of(2) { Crossing::Enter } else { Crossing::Leave };
        let on = Ray { origin: ray.at(at), direction: ray.direction };
        let search = Search { crossing: Some(wanted), after: 0.0, standing_on: face };
        let Some(hit) = surface.nearest(&on, search) else { return found };
        (at, face) = (at + hit.t, Some(hit.face));
        found.push(at);
        assert!(found.len() < 50);
    }
}

#[test]
fn bodies_in_one_file_are_the_union_that_manifold3d_makes_of_them() {
    let Some(python) = midair_peers::python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(python).args(["-c", UNIONS]).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8(output.stdout).unwrap();
    let (mut bodies, mut compared) = (0, 0);
    for name in told.lines() {
        let [parts, union] = ["parts", "union"].map(|kind| {
            let file = folder.path().join(format!("{name}-{kind}.ply"));
            load(&std::fs::read(&file).unwrap(), &file, Surface::Closed, None).unwrap()
        });
        assert!(!parts.1.overlaps.is_empty() && union.1.overlaps.is_empty(), "{name}");
        let [parts, union] = [parts, union].map(|(mesh, _)| MeshSurface::new(&mesh));
        let mut apart = 0;
        for k in 0..2000 {
            let f = |a: f64| (f64::from(k) * a).fract() - 0.5;
            let origin = Vec3::new(9.0 * f(0.754_877_666), 9.0 * f(0.569_840_291), 20.0);
            let target =
                Vec3::new(4.0 * f(0.618_033_989), 4.0 * f(0.414_213_562), f(0.236_067_977));
            let ray = Ray { origin, direction: (target - origin).normalized() };
            let [ours, theirs] = [&parts, &union].map(|surface| crossings(surface, &ray));
            // Corners in single precision, 1e-7 of 20, along a ray that grazes by no less than a tenth.
            let near = |(a, b): (&f64, &f64)| (a - b).abs() < 2e-5;
            let alike = ours.len() == theirs.len() && ours.iter().zip(&theirs).all(near);
            apart += usize::from(!alike);
            compared += ours.len();
        }
        // Rays that graze a surface, or meet where two faces nearly lie upon one another.
        assert!(apart <= 4, "{name}: {apart} of 2000 rays");
        bodies += 1;
    }
    assert!(bodies == 5 && compared > 5000, "{compared}");
}
