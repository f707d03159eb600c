//! PLY, text and binary: vertices with normals, polygons and triangle strips.

use super::read::NO_NORMAL;
use super::text::{number, plain, words};
use super::{MeshError, RawMesh};
use crate::geometry::Vec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
};
use std::io::Cursor;

/// What a file holds, before it is put together: faces may stand before their vertices.
#[derive(Default)]
struct Content {
    vertices: Vec<Vertex>,
    faces: Vec<Corners>,
    strips: Vec<Corners>,
}

/// A vertex's coordinates and its normal's.
#[derive(Default)]
struct Vertex([Option<f64>; 6]);

/// The properties of a vertex that count.
const COORDINATES: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let Some(axis) = COORDINATES.iter().position(|known| *known == name) else {
            return PropertyAccessResult::Ignored;
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

/// The corners of a face or of strips; `None` for what is no list of whole numbers.
#[derive(Default)]
struct Corners(Option<Vec<i64>>);

/// Whether a property lists corners.
fn lists_corners(name: &str) -> bool {
    matches!(name, "vertex_indices" | "vertex_index")
}

impl PropertyAccess for Corners {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !lists_corners(name) {
            return PropertyAccessResult::Ignored;
        }
        fn wide<T: Into<i64>>(list: Vec<T>) -> Option<Vec<i64>> {
            Some(list.into_iter().map(Into::into).collect())
        }
        self.0 = match value {
            Property::ListChar(list) => wide(list),
            Property::ListUChar(list) => wide(list),
            Property::ListShort(list) => wide(list),
            Property::ListUShort(list) => wide(list),
            Property::ListInt(list) => wide(list),
            Property::ListUInt(list) => wide(list),
            _ => None,
        };
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

pub(super) fn read(bytes: &[u8], file: &str) -> Result<RawMesh, MeshError> {
    let bytes = &*plain(bytes);
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
    let payload = &bytes[reader.get_ref().position() as usize..];
    let content = match elements(&mut reader, &header) {
        // The library wants an element on each line; the format only wants the words in their order.
        Err(error) if header.encoding == Encoding::Ascii => {
            free_text(payload, &header).ok_or(error)
        }
        other => other,
    };
    assemble(content.map_err(damaged)?, file)
}

fn elements(reader: &mut Reader<Cursor<&[u8]>>, header: &Header) -> Result<Content, ParseError> {
    let mut content = Content::default();
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => {
                content.vertices =
                    Parser::new().read_payload_for_element(reader, element, header)?;
            }
            "face" => {
                content.faces = Parser::new().read_payload_for_element(reader, element, header)?;
            }
            "tristrips" => {
                content.strips = Parser::new().read_payload_for_element(reader, element, header)?;
            }
            _ => {
                Parser::<Skipped>::new().read_payload_for_element(reader, element, header)?;
            }
        }
    }
    Ok(content)
}

/// The elements of a text whose words are not laid out by lines; `None` where they are not just as many as the header says, or make no faces of its
/// vertices: a word that is missing would make others of all that follow.
fn free_text(payload: &[u8], header: &Header) -> Option<Content> {
    let mut words = words(payload);
    let mut content = Content::default();
    for (name, element) in &header.elements {
        for _ in 0..element.count {
            match name.as_str() {
                "vertex" => content.vertices.push(free_element(&mut words, element)?.0),
                "face" => content.faces.push(free_element(&mut words, element)?.1),
                "tristrips" => content.strips.push(free_element(&mut words, element)?.1),
                _ => {
                    free_element(&mut words, element)?;
                }
            }
        }
    }
    let count = content.vertices.len() as i64;
    let fits = |Corners(corners): &Corners| {
        let known = |corners: &Vec<i64>| corners.iter().all(|i| (0..count).contains(i));
        corners.as_ref().is_some_and(|corners| corners.len() >= 3 && known(corners))
    };
    (words.next().is_none() && content.faces.iter().all(fits)).then_some(content)
}

/// An element's words, as what a vertex and as what a face has of them.
fn free_element<'a>(
    words: &mut impl Iterator<Item = &'a str>,
    element: &ElementDef,
) -> Option<(Vertex, Corners)> {
    let (mut vertex, mut corners) = (Vertex::default(), Corners::default());
    for (name, property) in &element.properties {
        match property.data_type {
            PropertyType::Scalar(_) => {
                let value = words.next().and_then(number)?;
                if let Some(axis) = COORDINATES.iter().position(|known| known == name) {
                    vertex.0[axis] = Some(value);
                }
            }
            PropertyType::List(..) => {
                let count: usize = words.next()?.parse().ok()?;
                let items: Vec<f64> =
                    (0..count).map_while(|_| words.next().and_then(number)).collect();
                if items.len() < count {
                    return None;
                }
                if lists_corners(name) {
                    let whole = |x: f64| (x.fract() == 0.0).then_some(x as i64);
                    corners.0 = items.into_iter().map(whole).collect();
                }
            }
        }
    }
    Some((vertex, corners))
}

fn assemble(content: Content, file: &str) -> Result<RawMesh, MeshError> {
    let mut raw = RawMesh::default();
    let mut normals = Vec::new();
    for (v, Vertex(numbers)) in content.vertices.iter().enumerate() {
        let [Some(x), Some(y), Some(z), normal @ ..] = numbers else {
            return Err(MeshError::syntax(file, format!("vertex {v} lacks one of x, y and z")));
        };
        raw.positions.push(Vec3::new(*x, *y, *z));
        if let [Some(x), Some(y), Some(z)] = *normal {
            normals.resize(v, NO_NORMAL);
            normals.push(Vec3::new(x, y, z));
        }
    }
    let mut push = |corners: &[u32], face: u32| {
        let of = |&v: &u32| normals.get(v as usize).copied().unwrap_or(NO_NORMAL);
        let own: Vec<Vec3> =
            if normals.is_empty() { Vec::new() } else { corners.iter().map(of).collect() };
        raw.push_polygon_with_normals(corners, &own, face, None);
    };
    // An index that is no vertex's is refused with the rest.
    let vertex = |i: &i64| u32::try_from(*i).unwrap_or(u32::MAX);
    for (face, Corners(corners)) in (0u32..).zip(content.faces) {
        match corners {
            Some(corners) if corners.len() >= 3 => {
                push(&corners.iter().map(vertex).collect::<Vec<_>>(), face);
            }
            _ => {
                return Err(MeshError::syntax(
                    file,
                    format!("face {face} is not a list of three or more vertices"),
                ));
            }
        }
    }
    let mut face = 0;
    for (strips, Corners(corners)) in content.strips.into_iter().enumerate() {
        let Some(corners) = corners else {
            return Err(MeshError::syntax(
                file,
                format!("tristrips {strips} is not a list of vertices"),
            ));
        };
        // -1 ends a strip.
        for strip in corners.split(|&i| i == -1) {
            let strip: Vec<u32> = strip.iter().map(vertex).collect();
            for triangle in strip_triangles(&strip) {
                push(&triangle, face);
                face += 1;
            }
        }
    }
    Ok(raw)
}

/// A strip's triangles: each corner with the two before it, every other one turned. Those with a corner twice only lead on to the next.
pub(super) fn strip_triangles(strip: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    strip
        .windows(3)
        .enumerate()
        .map(|(k, t)| if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] })
        .filter(|[a, b, c]| a != b && b != c && c != a)
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
