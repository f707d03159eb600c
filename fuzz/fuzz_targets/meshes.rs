//! Mesh files: read, mended, and with normals found, or refused by name.
#![no_main]

use libfuzzer_sys::fuzz_target;
use midair::geometry::mesh::{MeshFormat, Surface, mend, read};
use midair_fuzz::{chosen, reader, told};

fuzz_target!(|data: &[u8]| {
    const FORMATS: [MeshFormat; 5] =
        [MeshFormat::Obj, MeshFormat::Stl, MeshFormat::Ply, MeshFormat::Off, MeshFormat::Gltf];
    let Some((first, bytes)) = chosen(data) else { return };
    let format = FORMATS[usize::from(first) % FORMATS.len()];
    let surface = if first & 0x80 == 0 { Surface::Closed } else { Surface::Open };
    reader(|| {
        let mesh = read(bytes, format, "a.mesh", None).and_then(|raw| mend(raw, "a.mesh", surface));
        match mesh {
            Ok((mesh, mended)) => {
                assert!(
                    mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len())
                );
                assert!(mesh.positions.iter().all(|p| p.is_finite()));
                let count = mesh.triangles.len();
                let (mesh, _) = mesh.with_creased_normals(30.0);
                assert_eq!(mesh.normals.map(|normals| normals.len()), Some(count));
                let _ = mended.notes();
            }
            Err(error) => told(&error, "a.mesh"),
        }
    });
});
