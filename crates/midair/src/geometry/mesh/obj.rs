//! Wavefront OBJ: its vertices and faces. Materials, normals and texture coordinates are left.
//!
//! Read here because messages have to name the line and the file's own face, which the reading
//! libraries do not keep; a library is the tests' peer.

use super::{MeshError, RawMesh};
use crate::geometry::Vec3;

pub(super) fn read(bytes: &[u8], file: &str) -> Result<RawMesh, MeshError> {
    let mut raw = RawMesh::default();
    let mut face = 0u32;
    let mut corners = Vec::new();
    for (number, line) in (1u32..).zip(bytes.split(|&b| b == b'\n')) {
        // Names of objects and materials may be in any encoding: only v and f lines are text
        // that matters.
        let line = match line.iter().position(|&b| b == b'#') {
            Some(comment) => &line[..comment],
            None => line,
        };
        let mut words = line.split(|b| b.is_ascii_whitespace()).filter(|w| !w.is_empty()).map(word);
        let place = |what: &str| MeshError::syntax(file, format!("line {number}: {what}"));
        match words.next() {
            Some("v") => {
                let mut coordinate = || words.next()?.parse::<f64>().ok();
                match (coordinate(), coordinate(), coordinate()) {
                    (Some(x), Some(y), Some(z)) => raw.positions.push(Vec3::new(x, y, z)),
                    _ => return Err(place("a vertex needs three numbers")),
                }
            }
            Some("f") => {
                face += 1;
                corners.clear();
                for corner in words {
                    let index = corner.split('/').next().and_then(|i| i.parse::<i64>().ok());
                    corners.push(match index {
                        Some(i) if i > 0 => u32::try_from(i - 1).unwrap_or(u32::MAX),
                        // Negative ones count back from the latest vertex.
                        Some(i) if i < 0 => {
                            u32::try_from(raw.positions.len() as i64 + i).map_err(|_| {
                                place(&format!(
                                    "face {face} refers to vertex {i}, before the first"
                                ))
                            })?
                        }
                        _ => {
                            return Err(place(&format!(
                                "a corner of face {face} is not a vertex number"
                            )));
                        }
                    });
                }
                if corners.len() < 3 {
                    return Err(place(&format!("face {face} has fewer than three corners")));
                }
                raw.push_polygon(&corners, face, Some(number));
            }
            _ => {}
        }
    }
    Ok(raw)
}

/// A word as text; one that is none is like a keyword that is not known.
fn word(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap_or("\u{fffd}")
}
