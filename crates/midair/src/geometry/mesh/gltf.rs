//! glTF 2.0, JSON or GLB: the triangles of the default scene, with its nodes' transforms.
//!
//! Read here on plain JSON, since the format's library panics on indices and lengths that do not fit.

mod container;

use super::ply::strip_triangles;
use super::read::{Beside, NO_NORMAL, too_many};
use super::{MeshError, RawMesh};
use crate::geometry::Vec3;
use container::{chunks, fetch};
use serde_json::Value;
use std::cell::OnceCell;

pub(super) fn read(
    bytes: &[u8],
    file: &str,
    beside: Option<&Beside<'_>>,
) -> Result<RawMesh, MeshError> {
    let (json, blob) = chunks(bytes, file)?;
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
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
    let needed = list(&root["extensionsRequired"]).filter_map(Value::as_str);
    let needed: Vec<&str> = needed.filter(|name| !leaves_geometry(name)).take(5).collect();
    if !needed.is_empty() {
        return Err(unsupported(file, &format!("the extensions {}", needed.join(", "))));
    }
    let buffers = list(&root["buffers"]).map(|_| OnceCell::new()).collect();
    Document { root: &root, buffers, blob, file, beside }.triangles()
}

/// Whether an extension has nothing to do with where surfaces are, or is read here.
fn leaves_geometry(name: &str) -> bool {
    const KINDS: [&str; 8] =
        ["materials", "texture", "lights", "xmp", "animation", "audio", "image", "techniques"];
    let kind = name.split_once('_').map_or("", |(_, kind)| kind);
    name == "KHR_mesh_quantization" || KINDS.iter().any(|known| kind.starts_with(known))
}

fn unsupported(file: &str, what: &str) -> MeshError {
    MeshError::new(
        file,
        format!("needs {what}, which are not read here"),
        "export plain triangles: uncompressed, with skins, morphs and instances applied",
    )
}

/// Column-major.
type Matrix = [[f64; 4]; 4];

const IDENTITY: Matrix = [[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.], [0., 0., 0., 1.]];

struct Document<'a> {
    root: &'a Value,
    /// Fetched when they are needed: those of textures and animations never are.
    buffers: Vec<OnceCell<Vec<u8>>>,
    blob: Option<&'a [u8]>,
    file: &'a str,
    beside: Option<&'a Beside<'a>>,
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

    /// The triangles of every node of the default scene; without one, of the first; without any, of all nodes, or meshes.
    fn triangles(&self) -> Result<RawMesh, MeshError> {
        let zero = Value::from(0);
        let scene = match &self.root["scene"] {
            Value::Null => &zero,
            scene => scene,
        };
        let mut raw = RawMesh::default();
        let roots: Vec<Value> = if list(&self.root["scenes"]).next().is_some() {
            list(&self.object("scenes", scene)?.1["nodes"]).cloned().collect()
        } else {
            let nodes = || list(&self.root["nodes"]);
            let child = |i: usize| {
                nodes().flat_map(|n| list(&n["children"])).any(|c| c.as_u64() == Some(i as u64))
            };
            (0..nodes().count()).filter(|&i| !child(i)).map(Value::from).collect()
        };
        if roots.is_empty() && list(&self.root["nodes"]).next().is_none() {
            for mesh in list(&self.root["meshes"]) {
                self.add_mesh(mesh, &Value::Null, &IDENTITY, &mut raw)?;
            }
        }
        let mut visited = std::collections::HashSet::new();
        // Nodes are visited in the file's order: faces are numbered along it.
        let mut open: Vec<(&Value, Matrix)> = roots.iter().map(|n| (n, IDENTITY)).collect();
        open.reverse();
        while let Some((index, parent)) = open.pop() {
            let (place, node) = self.object("nodes", index)?;
            // The format wants trees: a node met twice would be a cycle or a copy without end.
            if !visited.insert(place) {
                return Err(self.bad(format!("node {place} has more than one parent")));
            }
            let extensions = &node["extensions"];
            if extensions["KHR_node_visibility"]["visible"] == Value::Bool(false) {
                continue;
            }
            let matrix = product(&parent, &self.transform(node)?);
            if !node["mesh"].is_null() {
                if !node["skin"].is_null() {
                    return Err(unsupported(self.file, "skins"));
                }
                if !extensions["EXT_mesh_gpu_instancing"].is_null() {
                    return Err(unsupported(self.file, "instances (EXT_mesh_gpu_instancing)"));
                }
                let (_, mesh) = self.object("meshes", &node["mesh"])?;
                self.add_mesh(mesh, &node["weights"], &matrix, &mut raw)?;
            }
            let first = open.len();
            open.extend(list(&node["children"]).map(|child| (child, matrix)));
            open[first..].reverse();
        }
        Ok(raw)
    }

    /// `weights` are the node's, of morph targets; the mesh's own stand for them where it has none.
    fn add_mesh(
        &self,
        mesh: &Value,
        weights: &Value,
        matrix: &Matrix,
        raw: &mut RawMesh,
    ) -> Result<(), MeshError> {
        let weights = if weights.is_null() { &mesh["weights"] } else { weights };
        let morphed = list(weights).any(|weight| weight.as_f64() != Some(0.0));
        for primitive in list(&mesh["primitives"]) {
            if morphed && list(&primitive["targets"]).next().is_some() {
                return Err(unsupported(self.file, "morph targets"));
            }
            self.add(primitive, matrix, raw)?;
        }
        Ok(())
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
        let mode = self.size(&primitive["mode"], 4)?;
        // Points and lines have no faces.
        if mode < 4 {
            return Ok(());
        }
        let first = raw.positions.len();
        let columns = [0, 1, 2, 3].map(|k| Vec3::new(matrix[k][0], matrix[k][1], matrix[k][2]));
        let [x, y, z, shift] = columns;
        let attributes = &primitive["attributes"];
        // Integers are what KHR_mesh_quantization allows.
        let positions = self.vectors(&attributes["POSITION"], &[5120, 5121, 5122, 5123, 5126])?;
        let count = positions.len();
        let determinant = x.cross(y).dot(z);
        let normals: Vec<Vec3> = match &attributes["NORMAL"] {
            Value::Null => Vec::new(),
            accessor => {
                // The matrix of cofactors is the inverse's transpose, but for the determinant.
                let cofactors =
                    [y.cross(z), z.cross(x), x.cross(y)].map(|c| c * determinant.signum());
                let normals = self.vectors(accessor, &[5120, 5122, 5126])?;
                let turned = normals
                    .into_iter()
                    .map(|n| cofactors[0] * n.x + cofactors[1] * n.y + cofactors[2] * n.z);
                turned.collect()
            }
        };
        let indices: Vec<u32> = match &primitive["indices"] {
            Value::Null => (0..count as u32).collect(),
            accessor => {
                let indices = self.components(accessor, "SCALAR", 1, &[5121, 5123, 5125])?;
                indices.into_iter().map(|i| i as u32).collect()
            }
        };
        // Many nodes may share one mesh: a small file can mean a thousand million triangles.
        too_many(raw.triangles.len() + indices.len() / 3, self.file)?;
        too_many((first + count) / 3, self.file)?;
        raw.positions.extend(positions.iter().map(|p| x * p.x + y * p.y + z * p.z + shift));
        let triangles: Vec<[u32; 3]> = match mode {
            4 => indices.as_chunks::<3>().0.to_vec(),
            5 => strip_triangles(&indices).collect(),
            6 => match &indices[..] {
                [centre, rim @ ..] => rim.windows(2).map(|w| [w[0], w[1], *centre]).collect(),
                [] => Vec::new(),
            },
            _ => return Err(self.bad(format!("has a primitive of mode {mode}, which is none"))),
        };
        for [a, b, c] in triangles {
            let face = raw.triangles.len() as u32;
            // A mirroring transform turns the faces inside out: the format says to turn them back.
            let corners = if determinant < 0.0 { [a, c, b] } else { [a, b, c] };
            // Out of range in its own list is out of range in the whole one.
            let shifted = |i: u32| if (i as usize) < count { first as u32 + i } else { u32::MAX };
            let own = |i: u32| normals.get(i as usize).copied().unwrap_or(NO_NORMAL);
            let own = if normals.is_empty() { Vec::new() } else { corners.map(own).to_vec() };
            raw.push_polygon_with_normals(&corners.map(shifted), &own, face, None);
        }
        Ok(())
    }

    /// The vectors of an accessor whose components are of an allowed type.
    fn vectors(&self, accessor: &Value, allowed: &[u64]) -> Result<Vec<Vec3>, MeshError> {
        let numbers = self.components(accessor, "VEC3", 3, allowed)?;
        Ok(numbers.as_chunks::<3>().0.iter().map(|&v| Vec3::from_array(v)).collect())
    }

    /// An accessor's numbers: `width` of them to an item of this `kind`, of an allowed component type.
    fn components(
        &self,
        accessor: &Value,
        kind: &str,
        width: usize,
        allowed: &[u64],
    ) -> Result<Vec<f64>, MeshError> {
        let (place, accessor) = self.object("accessors", accessor)?;
        let component = accessor["componentType"].as_u64().unwrap_or_default();
        if !allowed.contains(&component) || accessor["type"].as_str() != Some(kind) {
            return Err(self
                .bad(format!("accessor {place} has a type that the format does not allow there")));
        }
        let normalized = accessor["normalized"] == Value::Bool(true);
        let count = self.size(&accessor["count"], 0)?;
        let name = format!("accessor {place}");
        let mut numbers = if accessor["bufferView"].is_null() {
            // All zeros, but for what `sparse` says.
            too_many(count / 3, self.file)?;
            vec![0.0; count * width]
        } else {
            self.numbers_at(accessor, &name, component, width, count, normalized)?
        };
        let sparse = &accessor["sparse"];
        if !sparse.is_null() {
            let name = format!("the sparse part of accessor {place}");
            let count = self.size(&sparse["count"], 0)?;
            let (at, with) = (&sparse["indices"], &sparse["values"]);
            let of = at["componentType"].as_u64().filter(|c| [5121, 5123, 5125].contains(c));
            let of = of.ok_or_else(|| self.bad(format!("{name} has indices of no type")))?;
            let places = self.numbers_at(at, &name, of, 1, count, false)?;
            let values = self.numbers_at(with, &name, component, width, count, normalized)?;
            for (at, value) in places.iter().zip(values.chunks_exact(width)) {
                let at = *at as usize * width;
                let old = numbers.get_mut(at..at + width);
                old.ok_or_else(|| self.bad(format!("{name} reaches outside of it")))?
                    .copy_from_slice(value);
            }
        }
        Ok(numbers)
    }

    /// Numbers in a buffer where `part` says; refuses what does not lie within it.
    fn numbers_at(
        &self,
        part: &Value,
        name: &str,
        component: u64,
        width: usize,
        count: usize,
        normalized: bool,
    ) -> Result<Vec<f64>, MeshError> {
        let size = match component {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            _ => 4,
        };
        let item = size * width;
        let (_, view) = self.object("bufferViews", &part["bufferView"])?;
        let stride = self.size(&view["byteStride"], item)?;
        let outside = || self.bad(format!("{name} reaches outside its buffer"));
        let start = self.size(&view["byteOffset"], 0)?;
        let end = start.checked_add(self.size(&view["byteLength"], 0)?).ok_or_else(outside)?;
        let offset = self.size(&part["byteOffset"], 0)?;
        let data = self
            .buffer(&view["buffer"])?
            .get(start..end)
            .and_then(|view| view.get(offset..))
            .ok_or_else(outside)?;
        let needed = match count.checked_sub(1) {
            None => Some(0),
            Some(steps) => steps.checked_mul(stride).and_then(|n| n.checked_add(item)),
        };
        if stride < item || needed.is_none_or(|n| n > data.len()) {
            return Err(outside());
        }
        // A normalised integer's largest value is 1; the two lowest signed ones both are -1 (glTF 2.0, 3.6.2.2).
        let share =
            |value: f64, most: f64| if normalized { (value / most).max(-1.0) } else { value };
        let number = |b: &[u8]| match (component, b) {
            (5120, &[a]) => share(f64::from(a as i8), 127.0),
            (5121, &[a]) => share(f64::from(a), 255.0),
            (5122, &[a, b]) => share(f64::from(i16::from_le_bytes([a, b])), 32767.0),
            (5123, &[a, b]) => share(f64::from(u16::from_le_bytes([a, b])), 65535.0),
            (5125, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
            (_, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            // No other size is cut off.
            _ => f64::NAN,
        };
        let items = (0..count).map(|i| &data[i * stride..i * stride + item]);
        Ok(items.flat_map(|item| item.chunks_exact(size).map(number)).collect())
    }

    fn buffer(&self, index: &Value) -> Result<&[u8], MeshError> {
        let (place, buffer) = self.object("buffers", index)?;
        let bytes = match &buffer["uri"] {
            Value::Null => self
                .blob
                .filter(|_| place == 0)
                .ok_or_else(|| self.bad(format!("buffer {place} has no data")))?,
            uri => {
                let slot = &self.buffers[place];
                if slot.get().is_none() {
                    let fetched = fetch(uri.as_str().unwrap_or_default(), self.file, self.beside)?;
                    // It was empty.
                    let _ = slot.set(fetched);
                }
                slot.get().map_or(&[][..], Vec::as_slice)
            }
        };
        Ok(bytes)
    }
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    b.map(|column| std::array::from_fn(|row| (0..4).map(|k| a[k][row] * column[k]).sum()))
}
