//! glTF 2.0, JSON or GLB: the triangles of the default scene, with its nodes' transforms.
//!
//! Read here on plain JSON, since the format's library panics on indices and lengths that do not fit.

use super::read::too_many;
use super::{MeshError, RawMesh, read_file};
use crate::geometry::Vec3;
use base64::Engine as _;
use serde_json::Value;
use std::path::{Component, Path};

pub(super) fn read(bytes: &[u8], file: &str, folder: Option<&Path>) -> Result<RawMesh, MeshError> {
    let (json, blob) = chunks(bytes, file)?;
    let root: Value = serde_json::from_slice(json)
        .map_err(|e| MeshError::syntax(file, format!("is not valid glTF: {e}")))?;
    let version = root["asset"]["version"].as_str().unwrap_or_default();
    if !version.starts_with("2.") {
        return Err(MeshError::new(
            file,
            "does not say that it is glTF of version 2",
            "export it as glTF 2.0",
        ));
    }
    if let Some(needed) = root["extensionsRequired"].as_array()
        && !needed.is_empty()
    {
        let names: Vec<&str> = needed.iter().filter_map(Value::as_str).take(5).collect();
        return Err(unsupported(file, &format!("the extensions {}", names.join(", "))));
    }
    let mut document = Document { root: &root, buffers: Vec::new(), file };
    for i in 0..root["buffers"].as_array().map_or(0, Vec::len) {
        document.buffers.push(match &root["buffers"][i]["uri"] {
            Value::Null => blob
                .map(<[u8]>::to_vec)
                .ok_or_else(|| MeshError::syntax(file, format!("buffer {i} has no data")))?,
            uri => fetch(uri.as_str().unwrap_or_default(), file, folder)?,
        });
    }
    document.triangles()
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
        Some(folder) if below && !uri.is_empty() && !uri.contains(':') => {
            read_file(&folder.join(path)).map_err(|e| {
                MeshError::new(
                    file,
                    format!("its buffer {shown} cannot be read: {e}"),
                    "put it beside the glTF file, or export as GLB",
                )
            })
        }
        _ => Err(MeshError::new(
            file,
            format!("has a buffer elsewhere: {shown}"),
            "put it beside the glTF file, or export as GLB",
        )),
    }
}

/// Column-major.
type Matrix = [[f64; 4]; 4];

const IDENTITY: Matrix = [[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.], [0., 0., 0., 1.]];

struct Document<'a> {
    root: &'a Value,
    buffers: Vec<Vec<u8>>,
    file: &'a str,
}

impl<'a> Document<'a> {
    fn bad(&self, message: impl Into<String>) -> MeshError {
        MeshError::syntax(self.file, message)
    }

    /// The object of a top-level list that `index` refers to, and its place.
    fn object(&self, list: &str, index: &Value) -> Result<(usize, &'a Value), MeshError> {
        let found = index.as_u64().and_then(|i| usize::try_from(i).ok()).and_then(|i| {
            self.root[list].as_array().and_then(|list| list.get(i)).map(|object| (i, object))
        });
        found.ok_or_else(|| self.bad(format!("refers to {list} {index}, which are not there")))
    }

    /// A number of bytes or items; `default` where it is left out.
    fn size(&self, value: &Value, default: usize) -> Result<usize, MeshError> {
        match value {
            Value::Null => Ok(default),
            other => other
                .as_u64()
                .and_then(|n| usize::try_from(n).ok())
                .ok_or_else(|| self.bad("has a size that is no whole number")),
        }
    }

    fn numbers<const N: usize>(
        &self,
        value: &Value,
        default: [f64; N],
    ) -> Result<[f64; N], MeshError> {
        if value.is_null() {
            return Ok(default);
        }
        let numbers: Option<Vec<f64>> =
            value.as_array().and_then(|list| list.iter().map(Value::as_f64).collect());
        numbers
            .and_then(|n| n.try_into().ok())
            .ok_or_else(|| self.bad(format!("has a transform that is not {N} numbers")))
    }

    /// The triangles of every node of the default scene; without one, of the first.
    fn triangles(&self) -> Result<RawMesh, MeshError> {
        let zero = Value::from(0);
        let scene = match &self.root["scene"] {
            Value::Null => &zero,
            scene => scene,
        };
        let (_, scene) = self.object("scenes", scene)?;
        let mut raw = RawMesh::default();
        let mut visited = std::collections::HashSet::new();
        // Nodes are visited in the file's order: faces are numbered along it.
        let mut open: Vec<(&Value, Matrix)> =
            list(&scene["nodes"]).map(|n| (n, IDENTITY)).collect();
        open.reverse();
        while let Some((index, parent)) = open.pop() {
            let (place, node) = self.object("nodes", index)?;
            // The format wants trees: a node met twice would be a cycle or a copy without end.
            if !visited.insert(place) {
                return Err(self.bad(format!("node {place} has more than one parent")));
            }
            let matrix = product(&parent, &self.transform(node)?);
            if !node["mesh"].is_null() {
                if !node["skin"].is_null() {
                    return Err(unsupported(self.file, "skins"));
                }
                let (_, mesh) = self.object("meshes", &node["mesh"])?;
                for primitive in list(&mesh["primitives"]) {
                    self.add(primitive, &matrix, &mut raw)?;
                }
            }
            let first = open.len();
            open.extend(list(&node["children"]).map(|child| (child, matrix)));
            open[first..].reverse();
        }
        Ok(raw)
    }

    /// A node's own transform: its matrix, or translation times rotation times scale.
    fn transform(&self, node: &Value) -> Result<Matrix, MeshError> {
        if !node["matrix"].is_null() {
            let m: [f64; 16] = self.numbers(&node["matrix"], [0.0; 16])?;
            return Ok(std::array::from_fn(|column| {
                std::array::from_fn(|row| m[4 * column + row])
            }));
        }
        let [x, y, z, w] = self.numbers(&node["rotation"], [0.0, 0.0, 0.0, 1.0])?;
        let scale: [f64; 3] = self.numbers(&node["scale"], [1.0; 3])?;
        let t: [f64; 3] = self.numbers(&node["translation"], [0.0; 3])?;
        let rotation = [
            [1. - 2. * (y * y + z * z), 2. * (x * y + w * z), 2. * (x * z - w * y)],
            [2. * (x * y - w * z), 1. - 2. * (x * x + z * z), 2. * (y * z + w * x)],
            [2. * (x * z + w * y), 2. * (y * z - w * x), 1. - 2. * (x * x + y * y)],
        ];
        let column = |k: usize| {
            let [a, b, c] = rotation[k].map(|e| e * scale[k]);
            [a, b, c, 0.0]
        };
        Ok([column(0), column(1), column(2), [t[0], t[1], t[2], 1.0]])
    }

    fn add(&self, primitive: &Value, matrix: &Matrix, raw: &mut RawMesh) -> Result<(), MeshError> {
        match self.size(&primitive["mode"], 4)? {
            4 => {}
            // Points and lines have no faces.
            0..=3 => return Ok(()),
            _ => return Err(unsupported(self.file, "triangle strips or fans")),
        }
        if list(&primitive["targets"]).next().is_some() {
            return Err(unsupported(self.file, "morph targets"));
        }
        let first = raw.positions.len();
        let positions =
            self.items(&primitive["attributes"]["POSITION"], &[(5126, "VEC3", 12)], |_, b| {
                let float = |at: usize| {
                    f64::from(f32::from_le_bytes([b[at], b[at + 1], b[at + 2], b[at + 3]]))
                };
                let p = [float(0), float(4), float(8), 1.0];
                let row = |r: usize| (0..4).map(|k| matrix[k][r] * p[k]).sum::<f64>();
                Vec3::new(row(0), row(1), row(2))
            })?;
        let count = positions.len();
        let indices: Vec<u32> = match &primitive["indices"] {
            Value::Null => (0..count as u32).collect(),
            accessor => self.items(
                accessor,
                &[(5121, "SCALAR", 1), (5123, "SCALAR", 2), (5125, "SCALAR", 4)],
                |size, b| match size {
                    1 => u32::from(b[0]),
                    2 => u32::from(u16::from_le_bytes([b[0], b[1]])),
                    _ => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
                },
            )?,
        };
        // Many nodes may share one mesh: a small file can mean a thousand million triangles.
        too_many(raw.triangles.len() + indices.len() / 3, self.file)?;
        too_many((first + count) / 3, self.file)?;
        raw.positions.extend(positions);
        let [x, y, z] = [0, 1, 2].map(|k| Vec3::new(matrix[k][0], matrix[k][1], matrix[k][2]));
        // A mirroring transform turns the faces inside out: the format says to turn them back.
        let mirrored = x.cross(y).dot(z) < 0.0;
        for corners in indices.chunks_exact(3) {
            let face = raw.triangles.len() as u32;
            // Out of range in its own list is out of range in the whole one.
            let shifted = |i: u32| if (i as usize) < count { first as u32 + i } else { u32::MAX };
            let [a, b, c] = [corners[0], corners[1], corners[2]].map(shifted);
            raw.push_polygon(&if mirrored { [a, c, b] } else { [a, b, c] }, face, None);
        }
        Ok(())
    }

    /// An accessor's items, each made from its size and bytes; refuses what does not lie within its
    /// buffer. `allowed` are the component types, item types, and sizes in bytes that may stand here.
    fn items<T>(
        &self,
        accessor: &Value,
        allowed: &[(u64, &str, usize)],
        item: impl Fn(usize, &[u8]) -> T,
    ) -> Result<Vec<T>, MeshError> {
        let (place, accessor) = self.object("accessors", accessor)?;
        if !accessor["sparse"].is_null() {
            return Err(unsupported(self.file, "sparse accessors"));
        }
        let size = allowed
            .iter()
            .find(|(component, kind, _)| {
                accessor["componentType"].as_u64() == Some(*component)
                    && accessor["type"].as_str() == Some(kind)
            })
            .map(|&(_, _, size)| size)
            .ok_or_else(|| {
                self.bad(format!(
                    "accessor {place} has a type that the format does not allow there"
                ))
            })?;
        let (_, view) = self.object("bufferViews", &accessor["bufferView"])?;
        let (buffer, _) = self.object("buffers", &view["buffer"])?;
        let stride = self.size(&view["byteStride"], size)?;
        let outside = || self.bad(format!("accessor {place} reaches outside its buffer"));
        let start = self.size(&view["byteOffset"], 0)?;
        let end = start.checked_add(self.size(&view["byteLength"], 0)?).ok_or_else(outside)?;
        let data = self
            .buffers
            .get(buffer)
            .and_then(|bytes| bytes.get(start..end))
            .and_then(|view| view.get(self.size(&accessor["byteOffset"], 0).ok()?..))
            .ok_or_else(outside)?;
        let count = self.size(&accessor["count"], 0)?;
        let needed = match count.checked_sub(1) {
            None => Some(0),
            Some(steps) => steps.checked_mul(stride).and_then(|n| n.checked_add(size)),
        };
        if stride < size || needed.is_none_or(|n| n > data.len()) {
            return Err(outside());
        }
        Ok((0..count).map(|i| item(size, &data[i * stride..i * stride + size])).collect())
    }
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    b.map(|column| std::array::from_fn(|row| (0..4).map(|k| a[k][row] * column[k]).sum()))
}
