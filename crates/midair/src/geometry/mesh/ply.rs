//! PLY, text and binary.

use super::{MeshError, RawMesh};
use crate::geometry::Vec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};
use std::io::Cursor;

/// A vertex's coordinates.
#[derive(Default)]
struct Vertex([Option<f64>; 3]);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        self.0[axis] = match value {
            Property::Char(v) => Some(v.into()),
            Property::UChar(v) => Some(v.into()),
            Property::Short(v) => Some(v.into()),
            Property::UShort(v) => Some(v.into()),
            Property::Int(v) => Some(v.into()),
            Property::UInt(v) => Some(v.into()),
            Property::Float(v) => Some(v.into()),
            Property::Double(v) => Some(v),
            _ => None,
        };
        PropertyAccessResult::Set
    }
}

/// A face's corners.
#[derive(Default)]
struct Face(Option<Vec<Option<u32>>>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        self.0 = corners(value);
        PropertyAccessResult::Set
    }
}

/// An element that is read past, without taking memory.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

/// A list's items as indices; `None` within for negative ones, `None` for what is no list of
/// whole numbers.
fn corners(value: Property) -> Option<Vec<Option<u32>>> {
    fn indices<T>(list: Vec<T>) -> Option<Vec<Option<u32>>>
    where
        u32: TryFrom<T>,
    {
        Some(list.into_iter().map(|i| u32::try_from(i).ok()).collect())
    }
    match value {
        Property::ListChar(list) => indices(list),
        Property::ListUChar(list) => indices(list),
        Property::ListShort(list) => indices(list),
        Property::ListUShort(list) => indices(list),
        Property::ListInt(list) => indices(list),
        Property::ListUInt(list) => indices(list),
        _ => None,
    }
}

pub(super) fn read(bytes: &[u8], file: &str) -> Result<RawMesh, MeshError> {
    let damaged = |e: ParseError| damaged(&e, file);
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(damaged)?;
    for (name, element) in &header.elements {
        // Every property takes at least a byte; an element without any is no reason to count
        // to a thousand million.
        if element.count as u64 > bytes.len() as u64 {
            return Err(MeshError::claim(file, element.count as u64, name, bytes.len()));
        }
    }
    let mut raw = RawMesh::default();
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => {
                let vertices = Parser::<Vertex>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(damaged)?;
                for (v, vertex) in vertices.iter().enumerate() {
                    let [Some(x), Some(y), Some(z)] = vertex.0 else {
                        return Err(MeshError::syntax(
                            file,
                            format!("vertex {v} lacks one of x, y and z"),
                        ));
                    };
                    raw.positions.push(Vec3::new(x, y, z));
                }
            }
            "face" => {
                let faces = Parser::<Face>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(damaged)?;
                for (face, item) in (0u32..).zip(faces) {
                    let corners: Option<Vec<u32>> =
                        item.0.and_then(|list| list.into_iter().collect());
                    match corners {
                        Some(corners) if corners.len() >= 3 => {
                            raw.push_polygon(&corners, face, None);
                        }
                        _ => {
                            return Err(MeshError::syntax(
                                file,
                                format!("face {face} is not a list of three or more vertices"),
                            ));
                        }
                    }
                }
            }
            _ => {
                Parser::<Skipped>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(damaged)?;
            }
        }
    }
    Ok(raw)
}

/// The library's message in one line: it quotes the file's line between what and why.
fn damaged(error: &ParseError, file: &str) -> MeshError {
    let text = error.to_string();
    let mut lines = text.lines().map(str::trim);
    let what = lines.next().unwrap_or_default();
    let why = lines.find_map(|l| l.strip_prefix("Error: ")).unwrap_or_default();
    let message: String = format!("{what} {why}").trim().chars().take(200).collect();
    MeshError::syntax(file, message)
}
