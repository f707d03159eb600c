//! Triangle meshes: reading, checking, mending, and their plain measures.
//!
//! [`load`] reads a file and hands back a mesh that is fit to trace, with a report of what was
//! mended, or an error that names the file, the face and the remedy.

pub(super) mod adjacency;
mod error;
mod gltf;
mod measure;
mod mend;
mod normals;
mod obj;
mod off;
pub(super) mod overlap;
mod ply;
mod polygon;
mod read;
mod stl;
#[cfg(test)]
mod tests;
mod text;
mod wedges;

pub use error::MeshError;
pub use mend::{Mended, Surface, mend};
pub use normals::Shading;
pub use read::{Beside, MeshFormat, RawMesh, read};

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
    /// For each triangle the normals at its corners, outward; between them their sum by the corners' weights has the normal's direction, so longer ones have more
    /// say, and one of length 0, at the tip of a cone, has none. `None`: each face's own.
    pub normals: Option<Vec<[Vec3; 3]>>,
    /// For each triangle the normals that the file gives at its corners, of any length and sense, NaN where it gives none; empty without any.
    pub given_normals: Vec<[Vec3; 3]>,
    /// For each triangle the closed body that it bounds, where bodies overlap or touch or one crosses itself; the solid is then what they wind around.
    pub bodies: Option<Vec<u32>>,
}

/// Meshes are read whole; a larger file is not one that this program can trace in memory.
const MOST_BYTES: u64 = 1 << 29;

/// Reads, checks and mends a mesh file; the format goes by the extension.
///
/// The mesh has the normals that its file gives, but none is chosen yet: see [`TriangleMesh::with_creased_normals`].
///
/// # Errors
/// Files that cannot be read or understood, and surfaces that cannot be traced: see [`mend`].
pub fn load(path: &Path, surface: Surface) -> Result<(TriangleMesh, Mended), MeshError> {
    let name = path.display().to_string();
    let format = MeshFormat::of(path).ok_or_else(|| MeshError::format(&name))?;
    let bytes = read_file(path).map_err(|cause| MeshError::open(&name, &cause))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let beside = |name: &Path| read_file(&folder.join(name));
    mend(read(&bytes, format, &name, Some(&beside))?, &name, surface)
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
