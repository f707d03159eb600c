//! STL, text and binary.

use super::{MeshError, RawMesh};
use crate::geometry::Vec3;
use std::io::Cursor;

const HEADER: usize = 80;
const PER_TRIANGLE: u64 = 50;

pub(super) fn read(bytes: &[u8], file: &str) -> Result<RawMesh, MeshError> {
    let claimed = bytes
        .get(HEADER..HEADER + 4)
        .and_then(|b| <[u8; 4]>::try_from(b).ok())
        .map(|b| u64::from(u32::from_le_bytes(b)));
    let needed = claimed.map(|n| HEADER as u64 + 4 + n * PER_TRIANGLE);
    // Many programs write "solid" into binary headers: the length is the better witness.
    let text = bytes.starts_with(b"solid") && needed != Some(bytes.len() as u64);
    let mut binary;
    let source = if text {
        bytes
    } else {
        match (claimed, needed) {
            (Some(claimed), Some(needed)) if needed > bytes.len() as u64 => {
                return Err(MeshError::claim(file, claimed, "triangles", bytes.len()));
            }
            (Some(_), Some(_)) => {}
            _ => return Err(MeshError::syntax(file, "is too short for an STL file")),
        }
        // The library takes any header that starts with "solid" for text.
        binary = bytes.to_vec();
        binary[..HEADER].fill(0);
        &binary
    };
    let bad = |e: std::io::Error, face: u32| {
        MeshError::syntax(file, format!("face {face} (counted from 1): {e}"))
    };
    let mut cursor = Cursor::new(source);
    let triangles = stl_io::create_stl_reader(&mut cursor).map_err(|e| bad(e, 1))?;
    let mut raw = RawMesh::default();
    for (face, triangle) in (1u32..).zip(triangles) {
        let triangle = triangle.map_err(|e| bad(e, face))?;
        let first = raw.positions.len() as u32;
        raw.positions
            .extend(triangle.vertices.iter().map(|v| Vec3::from_array(v.0.map(f64::from))));
        raw.push_polygon(&[first, first + 1, first + 2], face, None);
    }
    Ok(raw)
}
