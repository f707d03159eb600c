//! From the bytes of any format to vertices and triangles.

use super::{MeshError, gltf, obj, off, ply, polygon, stl};
use crate::geometry::Vec3;
use std::path::Path;

/// The mesh formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// STL, text or binary.
    Stl,
    /// PLY, text or binary.
    Ply,
    /// OFF, text.
    Off,
    /// glTF 2.0, JSON or GLB.
    Gltf,
}

impl MeshFormat {
    /// By a path's extension, in any case.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            "ply" => Some(Self::Ply),
            "off" => Some(Self::Off),
            "gltf" | "glb" => Some(Self::Gltf),
            _ => None,
        }
    }
}

/// A mesh as its file has it: polygons cut into triangles, nothing mended.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct RawMesh {
    /// The vertices.
    pub positions: Vec<Vec3>,
    /// Indices into `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle the face of the file that it was cut from, in the file's numbering.
    pub faces: Vec<u32>,
    /// For each triangle the line of a text format that has its face; else empty.
    pub lines: Vec<u32>,
    /// For each triangle the normals that the file has at its corners, of any length and NaN where it has none; empty for a file without.
    pub normals: Vec<[Vec3; 3]>,
    /// The first triangle of the first polygon that crosses itself.
    pub(super) tangled: Option<usize>,
}

/// More triangles than this do not fit the memory that tracing them takes.
const MOST_TRIANGLES: usize = 20_000_000;
/// Coordinates beyond this overflow when areas and volumes are formed in single steps.
const MOST_COORDINATE: f64 = 1e30;

impl RawMesh {
    /// How messages call the face that a triangle came from.
    pub(super) fn face_name(&self, triangle: usize) -> String {
        let face = self.faces.get(triangle).copied().unwrap_or(0);
        match self.lines.get(triangle) {
            Some(line) => format!("face {face} (line {line})"),
            None => format!("face {face}"),
        }
    }

    /// Cuts a polygon into triangles.
    ///
    /// `indices` need not be in range: [`read`] checks them for every format.
    pub(super) fn push_polygon(&mut self, indices: &[u32], face: u32, line: Option<u32>) {
        self.push_polygon_with_normals(indices, &[], face, line);
    }

    /// As [`Self::push_polygon`], with a normal for each corner; none at all where the file has none for this face.
    pub(super) fn push_polygon_with_normals(
        &mut self,
        indices: &[u32],
        normals: &[Vec3],
        face: u32,
        line: Option<u32>,
    ) {
        let corners: Option<Vec<Vec3>> =
            indices.iter().map(|&v| self.positions.get(v as usize).copied()).collect();
        // An index out of range is refused when all is read.
        let fan = || (2..indices.len()).map(|k| [0, k - 1, k]).collect();
        let triangles = match corners.map(|corners| polygon::cut(&corners)) {
            Some(Ok(triangles)) => triangles,
            Some(Err(polygon::Tangled)) => {
                self.tangled.get_or_insert(self.triangles.len());
                fan()
            }
            None => fan(),
        };
        if !normals.is_empty() {
            self.normals.resize(self.triangles.len(), [NO_NORMAL; 3]);
        }
        for t in triangles {
            self.triangles.push(t.map(|k| indices[k]));
            self.faces.push(face);
            self.lines.extend(line);
            if !self.normals.is_empty() || !normals.is_empty() {
                self.normals.push(t.map(|k| normals.get(k).copied().unwrap_or(NO_NORMAL)));
            }
        }
    }
}

/// In the place of a normal that the file does not have.
pub(super) const NO_NORMAL: Vec3 = Vec3::new(f64::NAN, f64::NAN, f64::NAN);

/// Brings the bytes of a file that a mesh file names: a path relative to the mesh file's folder, never leading out of it.
pub type Beside<'a> = dyn Fn(&Path) -> std::io::Result<Vec<u8>> + 'a;

/// Reads a mesh from bytes. `file` names it in messages; `beside` brings the files that a glTF file keeps its buffers in, `None`: they are only
/// looked for in the file itself.
///
/// # Errors
/// What does not follow the format, announces more than it holds, has an index out of range or
/// a coordinate that is no finite number.
pub fn read(
    bytes: &[u8],
    format: MeshFormat,
    file: &str,
    beside: Option<&Beside<'_>>,
) -> Result<RawMesh, MeshError> {
    let raw = match format {
        MeshFormat::Obj => obj::read(bytes, file),
        MeshFormat::Stl => stl::read(bytes, file),
        MeshFormat::Ply => ply::read(bytes, file),
        MeshFormat::Off => off::read(bytes, file),
        MeshFormat::Gltf => gltf::read(bytes, file, beside),
    }?;
    if raw.triangles.is_empty() {
        return Err(MeshError::new(
            file,
            "has no faces",
            "export the model as a mesh of triangles or polygons",
        ));
    }
    too_many(raw.triangles.len(), file)?;
    for (i, triangle) in raw.triangles.iter().enumerate() {
        for &v in triangle {
            match raw.positions.get(v as usize) {
                None => {
                    return Err(MeshError::syntax(
                        file,
                        format!(
                            "{} refers to vertex {v} (counted from 0) of {}",
                            raw.face_name(i),
                            raw.positions.len()
                        ),
                    ));
                }
                Some(p) if p.to_array().iter().all(|x| x.abs() <= MOST_COORDINATE) => {}
                Some(p) => {
                    return Err(MeshError::new(
                        file,
                        format!(
                            "{} has a corner at [{}, {}, {}], vertex {v} (counted from 0)",
                            raw.face_name(i),
                            p.x,
                            p.y,
                            p.z
                        ),
                        "coordinates must be finite numbers: repair the vertex and export again",
                    ));
                }
            }
        }
    }
    if let Some(triangle) = raw.tangled {
        return Err(MeshError::new(
            file,
            format!("{} crosses itself, seen along its normal", raw.face_name(triangle)),
            "cut it into triangles (in Blender: Face > Triangulate Faces) and export again",
        ));
    }
    Ok(raw)
}

/// Refuses numbers of triangles that memory would not hold.
pub(super) fn too_many(triangles: usize, file: &str) -> Result<(), MeshError> {
    if triangles <= MOST_TRIANGLES {
        return Ok(());
    }
    Err(MeshError::new(
        file,
        format!("has {triangles} triangles, more than the {MOST_TRIANGLES} that are traced"),
        "simplify the mesh",
    ))
}
