//! glTF 2.0: the triangles of the default scene, with its nodes' transforms.
//!
//! The container (GLB) and the buffers are read here and not by the library: its own readers
//! panic on lengths that do not fit.

use super::read::too_many;
use super::{MeshError, RawMesh, read_file};
use crate::geometry::Vec3;
use ::gltf::accessor::{Accessor, DataType, Dimensions};
use ::gltf::buffer::Source;
use ::gltf::mesh::{Mode, Primitive};
use ::gltf::{Document, Gltf, Semantic};
use base64::Engine as _;
use std::path::{Component, Path};

pub(super) fn read(bytes: &[u8], file: &str, folder: Option<&Path>) -> Result<RawMesh, MeshError> {
    let (json, blob) = chunks(bytes, file)?;
    let document = Gltf::from_slice(json)
        .map_err(|e| {
            let cause: String = e.to_string().chars().take(200).collect();
            MeshError::syntax(file, format!("is not valid glTF: {cause}"))
        })?
        .document;
    let needed: Vec<&str> = document.extensions_required().collect();
    if !needed.is_empty() {
        return Err(unsupported(file, &format!("the extensions {}", needed.join(", "))));
    }
    let buffers = document
        .buffers()
        .map(|buffer| match buffer.source() {
            Source::Bin => blob.map(<[u8]>::to_vec).ok_or_else(|| {
                MeshError::syntax(file, format!("buffer {} has no data", buffer.index()))
            }),
            Source::Uri(uri) => fetch(uri, file, folder),
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mut raw = RawMesh::default();
    walk(&document, &buffers, file, &mut raw)?;
    Ok(raw)
}

fn unsupported(file: &str, what: &str) -> MeshError {
    MeshError::new(
        file,
        format!("needs {what}, which are not read here"),
        "export plain triangles: uncompressed, with skins and morphs applied",
    )
}

/// The JSON and the binary chunk; a file that does not start with the GLB magic is all JSON.
fn chunks<'a>(bytes: &'a [u8], file: &str) -> Result<(&'a [u8], Option<&'a [u8]>), MeshError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let word = |at: usize| {
        bytes
            .get(at..at + 4)
            .and_then(|b| <[u8; 4]>::try_from(b).ok())
            .map(|b| u32::from_le_bytes(b) as usize)
    };
    let short = || MeshError::syntax(file, "ends within its header or a chunk");
    if word(4).ok_or_else(short)? != 2 {
        return Err(MeshError::syntax(file, "is not version 2 of GLB"));
    }
    let mut at = 12;
    let mut chunk = |kind: &[u8; 4]| -> Result<&'a [u8], MeshError> {
        let length = word(at).ok_or_else(short)?;
        let found = bytes.get(at + 4..at + 8).ok_or_else(short)?;
        let data = bytes.get(at + 8..(at + 8).saturating_add(length)).ok_or_else(short)?;
        if found != kind {
            return Err(MeshError::syntax(file, "has its chunks in the wrong order"));
        }
        at += 8 + length;
        Ok(data)
    };
    let json = chunk(b"JSON")?;
    let blob = if 20 + json.len() < bytes.len() { Some(chunk(b"BIN\0")?) } else { None };
    Ok((json, blob))
}

/// A buffer's bytes from a data URI, or from a file in or below `folder`.
fn fetch(uri: &str, file: &str, folder: Option<&Path>) -> Result<Vec<u8>, MeshError> {
    let shown: String = uri.chars().take(60).collect();
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded);
        return encoded
            .and_then(|e| base64::engine::general_purpose::STANDARD.decode(e).ok())
            .ok_or_else(|| MeshError::syntax(file, format!("has a bad data URI: {shown}")));
    }
    let path = Path::new(uri);
    // A model must not read whatever file it names.
    let below = path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    match folder {
        Some(folder) if below && !uri.contains(':') => {
            let path = folder.join(path);
            read_file(&path).map_err(|e| MeshError::open(&path.display().to_string(), &e))
        }
        _ => Err(MeshError::new(
            file,
            format!("has a buffer elsewhere: {shown}"),
            "put it beside the glTF file, or export as GLB",
        )),
    }
}

type Matrix = [[f64; 4]; 4];

/// Collects the triangles of every node of the default scene; without one, of the first.
fn walk(
    document: &Document,
    buffers: &[Vec<u8>],
    file: &str,
    raw: &mut RawMesh,
) -> Result<(), MeshError> {
    let identity: Matrix = [[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.], [0., 0., 0., 1.]];
    let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) else {
        return Err(MeshError::new(file, "has no scene", "export the model within a scene"));
    };
    let mut visited = vec![false; document.nodes().len()];
    let mut open: Vec<_> = scene.nodes().map(|node| (node, identity)).collect();
    // Nodes are visited in the file's order: faces are numbered along it.
    open.reverse();
    while let Some((node, parent)) = open.pop() {
        // The format wants trees: a node met twice would be a cycle or a copy without end.
        match visited.get_mut(node.index()) {
            Some(seen) if !*seen => *seen = true,
            _ => {
                return Err(MeshError::syntax(
                    file,
                    format!("node {} has more than one parent", node.index()),
                ));
            }
        }
        let own = node.transform().matrix().map(|column| column.map(f64::from));
        let matrix = product(&parent, &own);
        if let Some(mesh) = node.mesh() {
            if node.skin().is_some() {
                return Err(unsupported(file, "skins"));
            }
            for primitive in mesh.primitives() {
                add(&primitive, &matrix, buffers, file, raw)?;
            }
        }
        let first = open.len();
        open.extend(node.children().map(|child| (child, matrix)));
        open[first..].reverse();
    }
    Ok(())
}

/// Column-major product a b.
fn product(a: &Matrix, b: &Matrix) -> Matrix {
    b.map(|column| std::array::from_fn(|row| (0..4).map(|k| a[k][row] * column[k]).sum()))
}

fn add(
    primitive: &Primitive<'_>,
    matrix: &Matrix,
    buffers: &[Vec<u8>],
    file: &str,
    raw: &mut RawMesh,
) -> Result<(), MeshError> {
    match primitive.mode() {
        Mode::Triangles => {}
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => return Ok(()),
        Mode::TriangleStrip | Mode::TriangleFan => {
            return Err(unsupported(file, "triangle strips or fans"));
        }
    }
    if primitive.morph_targets().next().is_some() {
        return Err(unsupported(file, "morph targets"));
    }
    let accessor = primitive
        .get(&Semantic::Positions)
        .ok_or_else(|| MeshError::syntax(file, "has triangles without positions"))?;
    let first = raw.positions.len();
    let positions = items(&accessor, buffers, file, DataType::F32, Dimensions::Vec3, |b| {
        let float =
            |at: usize| f64::from(f32::from_le_bytes([b[at], b[at + 1], b[at + 2], b[at + 3]]));
        let p = [float(0), float(4), float(8), 1.0];
        let row = |r: usize| (0..4).map(|k| matrix[k][r] * p[k]).sum::<f64>();
        Vec3::new(row(0), row(1), row(2))
    })?;
    let count = positions.len();
    let indices: Vec<u32> = match primitive.indices() {
        None => (0..count as u32).collect(),
        Some(accessor) => {
            let scalar = Dimensions::Scalar;
            match accessor.data_type() {
                DataType::U8 => {
                    items(&accessor, buffers, file, DataType::U8, scalar, |b| u32::from(b[0]))
                }
                DataType::U16 => items(&accessor, buffers, file, DataType::U16, scalar, |b| {
                    u32::from(u16::from_le_bytes([b[0], b[1]]))
                }),
                kind => items(&accessor, buffers, file, kind, scalar, |b| {
                    u32::from_le_bytes([b[0], b[1], b[2], b[3]])
                }),
            }?
        }
    };
    // Many nodes may share one mesh: a small file can mean a thousand million triangles.
    too_many(raw.triangles.len() + indices.len() / 3, file)?;
    too_many((first + count) / 3, file)?;
    raw.positions.extend(positions);
    let [x, y, z] = [0, 1, 2].map(|k| Vec3::new(matrix[k][0], matrix[k][1], matrix[k][2]));
    // A mirroring transform turns the faces inside out: the format says to turn them back.
    let mirrored = x.cross(y).dot(z) < 0.0;
    for corners in indices.chunks_exact(3) {
        let face = raw.triangles.len() as u32;
        let shifted = |i: u32| {
            if (i as usize) < count { first as u32 + i } else { u32::MAX }
        };
        let [a, b, c] = [corners[0], corners[1], corners[2]].map(shifted);
        raw.push_polygon(&if mirrored { [a, c, b] } else { [a, b, c] }, face, None);
    }
    Ok(())
}

/// An accessor's items, each made from its bytes; refuses what does not lie within its buffer.
fn items<T>(
    accessor: &Accessor<'_>,
    buffers: &[Vec<u8>],
    file: &str,
    data_type: DataType,
    dimensions: Dimensions,
    item: impl Fn(&[u8]) -> T,
) -> Result<Vec<T>, MeshError> {
    let bad = |what: &str| MeshError::syntax(file, format!("accessor {} {what}", accessor.index()));
    if accessor.sparse().is_some() {
        return Err(unsupported(file, "sparse accessors"));
    }
    let supported =
        matches!(data_type, DataType::F32 | DataType::U8 | DataType::U16 | DataType::U32)
            && (data_type == DataType::F32) == (dimensions == Dimensions::Vec3);
    if accessor.data_type() != data_type || accessor.dimensions() != dimensions || !supported {
        return Err(bad("has a type that the format does not allow there"));
    }
    let view = accessor.view().ok_or_else(|| bad("has no data"))?;
    let size = accessor.size();
    let stride = view.stride().unwrap_or(size);
    if stride < size {
        return Err(bad("has items that overlap"));
    }
    let outside = || bad("reaches outside its buffer");
    let buffer = buffers.get(view.buffer().index()).ok_or_else(outside)?;
    let end = view.offset().checked_add(view.length()).ok_or_else(outside)?;
    let data = buffer
        .get(view.offset()..end)
        .and_then(|view| view.get(accessor.offset()..))
        .ok_or_else(outside)?;
    let count = accessor.count();
    let needed = match count.checked_sub(1) {
        None => 0,
        Some(steps) => {
            steps.checked_mul(stride).and_then(|n| n.checked_add(size)).ok_or_else(outside)?
        }
    };
    if needed > data.len() {
        return Err(outside());
    }
    Ok((0..count).map(|i| item(&data[i * stride..i * stride + size])).collect())
}
