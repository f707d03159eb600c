//! Triangle meshes: reading, checking, mending, and their plain measures.
//!
//! [`load`] reads a file and hands back a mesh that is fit to trace, with a report of what was
//! mended, or an error that names the file, the face and the remedy.

mod error;
mod gltf;
mod measure;
mod mend;
mod obj;
mod off;
mod ply;
mod read;
mod stl;
#[cfg(test)]
mod tests;

pub use error::MeshError;
pub use mend::{Mended, Surface, mend};
pub use read::{MeshFormat, RawMesh, read};

use super::Vec3;
use std::io::Read as _;
use std::path::Path;

/// A triangle mesh; lengths in its own unit.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct TriangleMesh {
    /// The vertices.
    pub positions: Vec<Vec3>,
    /// Indices into `positions`, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// One unit normal per vertex; `None`: each face's own.
    pub normals: Option<Vec<Vec3>>,
}

/// Meshes are read whole; a larger file is not one that this program can trace in memory.
const MOST_BYTES: u64 = 1 << 29;

/// Reads, checks and mends a mesh file; the format goes by the extension.
///
/// The mesh has no vertex normals: see [`TriangleMesh::smooth_normals`].
///
/// # Errors
/// Files that cannot be read or understood, and surfaces that cannot be traced: see [`mend`].
pub fn load(path: &Path, surface: Surface) -> Result<(TriangleMesh, Mended), MeshError> {
    let name = path.display().to_string();
    let format = MeshFormat::of(path).ok_or_else(|| MeshError::format(&name))?;
    let bytes = read_file(path).map_err(|cause| MeshError::open(&name, &cause))?;
    mend(read(&bytes, format, &name, path.parent())?, &name, surface)
}

/// A file's bytes, up to the limit; devices and pipes without end stop there too.
fn read_file(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(std::io::Error::other("the file is larger than 512 MiB"));
    }
    Ok(bytes)
}
