//! OFF: a header, vertices and polygons as text.

use super::{MeshError, RawMesh};
use crate::geometry::Vec3;

pub(super) fn read(bytes: &[u8], file: &str) -> Result<RawMesh, MeshError> {
    let text = std::str::from_utf8(bytes)
        .map_err(|_| MeshError::syntax(file, "is not text: only the text form of OFF is read"))?;
    let mut lines = (1u32..)
        .zip(text.lines())
        .map(|(number, line)| (number, line.split('#').next().unwrap_or("").trim()))
        .filter(|(_, line)| !line.is_empty());

    let end = || MeshError::syntax(file, "ends too early");
    let (number, mut header) = lines.next().ok_or_else(end)?;
    header = header
        .strip_prefix("OFF")
        .ok_or_else(|| MeshError::syntax(file, format!("line {number}: does not start with OFF")))?
        .trim();
    // The counts may stand on the header's own line.
    let (number, counts) =
        if header.is_empty() { lines.next().ok_or_else(end)? } else { (number, header) };
    let mut counts = counts.split_ascii_whitespace().map(str::parse::<u64>);
    let (Some(Ok(vertices)), Some(Ok(faces))) = (counts.next(), counts.next()) else {
        return Err(MeshError::syntax(
            file,
            format!("line {number}: needs the numbers of vertices, faces and edges"),
        ));
    };
    // A vertex or a face takes at least six bytes: three digits and what parts them.
    for (claimed, what) in [(vertices, "vertices"), (faces, "faces")] {
        if claimed > bytes.len() as u64 / 6 {
            return Err(MeshError::claim(file, claimed, what, bytes.len()));
        }
    }

    let mut raw = RawMesh::default();
    for v in 0..vertices {
        let (number, line) = lines.next().ok_or_else(|| {
            MeshError::syntax(file, format!("ends after {v} of {vertices} vertices"))
        })?;
        let mut words = line.split_ascii_whitespace().map(|w| w.parse::<f64>().ok());
        let mut coordinate = || words.next().flatten();
        match (coordinate(), coordinate(), coordinate()) {
            (Some(x), Some(y), Some(z)) => raw.positions.push(Vec3::new(x, y, z)),
            _ => {
                return Err(MeshError::syntax(
                    file,
                    format!("line {number}: vertex {v} needs three numbers"),
                ));
            }
        }
    }
    let mut corners = Vec::new();
    for face in 0..faces {
        let (number, line) = lines.next().ok_or_else(|| {
            MeshError::syntax(file, format!("ends after {face} of {faces} faces"))
        })?;
        let mut words = line.split_ascii_whitespace().map(|w| w.parse::<u32>().ok());
        let count = words.next().flatten().unwrap_or(0) as usize;
        corners.clear();
        // What follows the corners is a colour.
        corners.extend(words.take(count).map_while(|w| w));
        if count < 3 || corners.len() != count {
            return Err(MeshError::syntax(
                file,
                format!(
                    "line {number}: face {face} needs a count of at least 3 and as many corners"
                ),
            ));
        }
        raw.push_polygon(&corners, face as u32, Some(number));
    }
    Ok(raw)
}
