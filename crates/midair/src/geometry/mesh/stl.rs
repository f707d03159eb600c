//! STL, text and binary.
//!
//! Read here, since the format's libraries stop at the first of several solids, at normals that are no numbers, and at binary files whose header
//! begins like text. Normals are left: they are each face's own, and many programs write zeros.

use super::text::{lines, number, plain, words};
use super::{MeshError, RawMesh};
use crate::geometry::Vec3;

const HEADER: usize = 84;
const PER_TRIANGLE: usize = 50;

pub(super) fn read(bytes: &[u8], file: &str) -> Result<RawMesh, MeshError> {
    if is_text(bytes) { read_text(&plain(bytes), file) } else { read_binary(bytes, file) }
}

/// The number of triangles that a binary file announces.
fn claimed(bytes: &[u8]) -> Option<u32> {
    bytes.get(HEADER - 4..)?.first_chunk().map(|&b| u32::from_le_bytes(b))
}

/// By the content: many programs begin the header of binary files with "solid", and some texts begin with a comment or a mark.
fn is_text(bytes: &[u8]) -> bool {
    let fits =
        |n: u32| (n as usize).checked_mul(PER_TRIANGLE).is_some_and(|n| bytes.len() == HEADER + n);
    if claimed(bytes).is_some_and(fits) {
        return false;
    }
    let text = plain(bytes);
    // Zeros may fill a text's last block.
    let end = text.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    let start = &text[..end.min(4096)];
    // No text has zero bytes; a binary file has them in its padding and its attributes.
    let mut found = lines(start).flat_map(|(_, line)| words(line)).map(str::to_ascii_lowercase);
    !start.contains(&0) && found.any(|word| matches!(&*word, "solid" | "facet" | "endsolid"))
}

fn read_binary(bytes: &[u8], file: &str) -> Result<RawMesh, MeshError> {
    let Some(claimed) = claimed(bytes) else {
        return Err(MeshError::syntax(file, "is too short for an STL file"));
    };
    let there = (bytes.len() - HEADER) / PER_TRIANGLE;
    // Programs that write as they go may never come back to fill in the number.
    let unsaid = matches!(claimed, 0 | u32::MAX) && bytes.len() == HEADER + there * PER_TRIANGLE;
    if claimed as usize > there && !unsaid {
        return Err(MeshError::claim(file, claimed.into(), "triangles", bytes.len()));
    }
    let count = if unsaid { there } else { claimed as usize };
    let mut raw = RawMesh::default();
    let records = bytes[HEADER..].as_chunks::<PER_TRIANGLE>().0;
    for (face, record) in (1u32..).zip(&records[..count]) {
        let first = raw.positions.len() as u32;
        let floats = record[12..48].as_chunks::<4>().0;
        raw.positions.extend(
            floats
                .as_chunks::<3>()
                .0
                .iter()
                .map(|p| Vec3::from_array(p.map(|b| f64::from(f32::from_le_bytes(b))))),
        );
        raw.push_polygon(&[first, first + 1, first + 2], face, None);
    }
    Ok(raw)
}

/// Words, wherever the lines end: only names, comments and colours take the rest of theirs.
fn read_text(bytes: &[u8], file: &str) -> Result<RawMesh, MeshError> {
    let mut raw = RawMesh::default();
    let mut face = 0u32;
    let mut solid = false;
    let mut within = false;
    let mut begun = 0;
    let mut corners: Vec<u32> = Vec::new();
    for (line_number, line) in lines(bytes) {
        let bad = |face: u32, what: &str| {
            MeshError::syntax(
                file,
                format!("line {line_number}: face {face} (counted from 1) {what}"),
            )
        };
        let mut words = words(line).collect::<Vec<_>>().into_iter();
        let is = |word: &&str, wanted: &[&str]| wanted.iter().any(|w| word.eq_ignore_ascii_case(w));
        while let Some(word) = words.next() {
            match &*word.to_ascii_lowercase() {
                name @ ("solid" | "endsolid") => {
                    if within {
                        return Err(bad(face, "does not end"));
                    }
                    solid = name == "solid";
                    // A name takes the rest of the line, unless the whole file is one.
                    if !words.as_slice().iter().any(|word| is(word, &["outer"])) {
                        break;
                    }
                    let name = words.as_slice().iter();
                    let length = name.take_while(|word| !is(word, &["facet", "solid"])).count();
                    words.by_ref().take(length).for_each(drop);
                }
                "end" if !within && words.as_slice().first().is_some_and(|w| is(w, &["solid"])) => {
                    solid = false;
                    break;
                }
                "facet" if within => return Err(bad(face, "does not end")),
                "facet" => {
                    (face, begun) = (face + 1, line_number);
                    within = true;
                }
                "vertex" if within => {
                    let mut coordinate = || words.next().and_then(number);
                    let (Some(x), Some(y), Some(z)) = (coordinate(), coordinate(), coordinate())
                    else {
                        return Err(bad(face, "has a vertex without three numbers"));
                    };
                    corners.push(raw.positions.len() as u32);
                    raw.positions.push(Vec3::new(x, y, z));
                }
                "endfacet" if within => {
                    if corners.len() < 3 {
                        return Err(bad(face, "has fewer than three vertices"));
                    }
                    raw.push_polygon(&corners, face, Some(begun));
                    corners.clear();
                    within = false;
                }
                "normal" | "outer" | "loop" | "endloop" if within => {}
                // What follows "normal".
                word if within && corners.is_empty() && number(word).is_some() => {}
                // Comments and colours, as some programs write them.
                word if !within && (word.starts_with(['#', ';', '/']) || word == "color") => break,
                word => {
                    let what: String = word.chars().take(20).collect();
                    return Err(bad(
                        face.max(1),
                        &format!("or what is about it has `{what}`, which is no word of STL"),
                    ));
                }
            }
        }
    }
    if solid || within {
        return Err(MeshError::syntax(
            file,
            format!("ends after face {face} (counted from 1), before its solid does"),
        ));
    }
    Ok(raw)
}
