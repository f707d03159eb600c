//! Triangle meshes: reading, checking, mending, and their plain measures.
//!
//! [`load`] reads a file's bytes and hands back a mesh that is fit to trace, with a report of what was
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
mod smoothing;
mod stl;
#[cfg(test)]
mod tests;
mod text;
mod wedges;

pub use error::MeshError;
pub use mend::{Mended, Surface, mend};
pub use normals::Shading;
pub use read::{Beside, MeshFormat, RawMesh, read};
pub use smoothing::Moved;

use super::Vec3;
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

/// Reads, checks and mends a mesh from the bytes of a file; the format goes by the extension of `name`, which stands in messages.
///
/// The mesh has the normals that its file gives, but none is chosen yet: see [`TriangleMesh::with_creased_normals`].
///
/// # Errors
/// Bytes that cannot be understood, and surfaces that cannot be traced: see [`mend`].
pub fn load(
    bytes: &[u8],
    name: &Path,
    surface: Surface,
    beside: Option<&Beside<'_>>,
) -> Result<(TriangleMesh, Mended), MeshError> {
    let told = name.display().to_string();
    let format = MeshFormat::of(name).ok_or_else(|| MeshError::format(&told))?;
    mend(read(bytes, format, &told, beside)?, &told, surface)
}
