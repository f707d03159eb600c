//! Wavefront OBJ: its vertices, normals and faces. Materials and texture coordinates are left.
//!
//! Read here because messages have to name the line and the file's own face, which the reading
//! libraries do not keep; a library is the tests' peer.

use super::read::NO_NORMAL;
use super::text::{lines, number, plain, words};
use super::{MeshError, RawMesh};
use crate::geometry::Vec3;

/// A face as it stands in the file; vertices may come after it.
struct Face {
    line: u32,
    /// Where its corners begin in the list of all.
    first: usize,
}

pub(super) fn read(bytes: &[u8], file: &str) -> Result<RawMesh, MeshError> {
    let bytes = plain(bytes);
    let mut raw = RawMesh::default();
    let mut normals: Vec<Vec3> = Vec::new();
    let mut faces: Vec<Face> = Vec::new();
    // Vertex and normal of each corner; a normal that is not there is out of range.
    let mut corners: Vec<[u32; 2]> = Vec::new();
    let mut rest = lines(&bytes);
    let mut statement = String::new();
    while let Some((line_number, mut line)) = rest.next() {
        // Names of objects and materials may be in any encoding: only lines of numbers are text that matters.
        let Some(keyword @ ("v" | "vn" | "f" | "fo")) = words(line).next() else { continue };
        statement.clear();
        // A backslash at a line's end: the statement goes on. In names and comments it is only a backslash.
        loop {
            let text = line.split(|&b| b == b'#').next().unwrap_or_default();
            let (text, goes_on) = match text.trim_ascii_end().strip_suffix(b"\\") {
                Some(text) => (text, true),
                None => (text, false),
            };
            for word in words(text) {
                statement.push_str(word);
                statement.push(' ');
            }
            match goes_on.then(|| rest.next()).flatten() {
                Some((_, next)) => line = next,
                None => break,
            }
        }
        let bad = |what: &str| MeshError::syntax(file, format!("line {line_number}: {what}"));
        let mut found = statement.split_ascii_whitespace().skip(1);
        match keyword {
            "v" | "vn" => {
                let mut coordinate = || found.next().and_then(number);
                let point = match (coordinate(), coordinate(), coordinate()) {
                    (Some(x), Some(y), Some(z)) => Vec3::new(x, y, z),
                    // A face without its normal is still a face.
                    _ if keyword == "vn" => NO_NORMAL,
                    _ => return Err(bad("a vertex needs three numbers")),
                };
                if keyword == "v" { raw.positions.push(point) } else { normals.push(point) }
            }
            _ => {
                let face = faces.len() + 1;
                let first = corners.len();
                faces.push(Face { line: line_number, first });
                for corner in found {
                    let mut indices = corner.split('/').map(str::parse::<i64>);
                    let vertex = match indices.next() {
                        Some(Ok(i)) if i != 0 => {
                            place(i, raw.positions.len()).ok_or_else(|| {
                                bad(&format!("face {face} refers to vertex {i}, before the first"))
                            })?
                        }
                        _ => {
                            return Err(bad(&format!(
                                "a corner of face {face} is not a vertex number"
                            )));
                        }
                    };
                    let normal = match indices.nth(1) {
                        Some(Ok(i)) => place(i, normals.len()).unwrap_or(u32::MAX),
                        _ => u32::MAX,
                    };
                    corners.push([vertex, normal]);
                }
                if corners.len() < first + 3 {
                    return Err(bad(&format!("face {face} has fewer than three corners")));
                }
            }
        }
    }
    let ends = faces.iter().skip(1).map(|face| face.first).chain([corners.len()]);
    for ((number, face), end) in (1u32..).zip(&faces).zip(ends) {
        let corners = &corners[face.first..end];
        let vertices: Vec<u32> = corners.iter().map(|corner| corner[0]).collect();
        let of = |&[_, n]: &[u32; 2]| normals.get(n as usize).copied().unwrap_or(NO_NORMAL);
        let normals: Vec<Vec3> =
            if normals.is_empty() { Vec::new() } else { corners.iter().map(of).collect() };
        raw.push_polygon_with_normals(&vertices, &normals, number, Some(face.line));
    }
    Ok(raw)
}

/// The place in a list of an index that counts from 1, or back from the latest one; `None` before the first.
fn place(index: i64, latest: usize) -> Option<u32> {
    match index {
        1.. => Some(u32::try_from(index - 1).unwrap_or(u32::MAX)),
        _ => u32::try_from(latest as i64 + index).ok().filter(|_| index < 0),
    }
}
