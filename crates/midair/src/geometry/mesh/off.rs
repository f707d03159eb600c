//! OFF and its relatives: a header, vertices (with normals, colours, texture coordinates) and polygons as text.
//!
//! The header's letters are geomview's: `ST` texture coordinates, `C` colours, `N` normals, `4` a fourth, homogeneous coordinate, `n` any number of
//! coordinates.

use super::text::{lines, number, plain, words};
use super::{MeshError, RawMesh};
use crate::geometry::Vec3;

/// What each vertex has beyond three coordinates, as far as it counts.
#[derive(Clone, Copy, Default)]
struct Kind {
    normals: bool,
    homogeneous: bool,
}

impl Kind {
    /// How many numbers of a vertex count.
    fn numbers(self) -> usize {
        let coordinates = if self.homogeneous { 4 } else { 3 };
        coordinates + if self.normals { 3 } else { 0 }
    }
}

/// The kind that a header's word names; `Err` for one that is not read here.
fn kind(word: &str) -> Option<Result<Kind, &'static str>> {
    // Geomview tells n from N; where all is small there is nothing to tell.
    let word = if word.eq_ignore_ascii_case("off") { "OFF" } else { word };
    let mut letters = word.strip_suffix("OFF")?;
    let mut kind = Kind::default();
    while !letters.is_empty() {
        let rest = ["ST", "C", "N", "4", "n"]
            .into_iter()
            .find_map(|l| letters.strip_prefix(l).map(|r| (l, r)));
        let (letter, rest) = rest?;
        match letter {
            "N" => kind.normals = true,
            "4" => kind.homogeneous = true,
            "n" => return Some(Err("vertices of any number of coordinates (nOFF)")),
            _ => {}
        }
        letters = rest;
    }
    Some(Ok(kind))
}

/// A line's words, without its comment, and its number.
type Line<'a> = (u32, Vec<&'a str>);

/// The lines that have words.
fn written(bytes: &[u8]) -> impl Iterator<Item = Line<'_>> {
    lines(bytes)
        .map(|(number, line)| (number, line.split(|&b| b == b'#').next().unwrap_or_default()))
        .map(|(number, line)| (number, words(line).collect()))
        .filter(|(_, words): &Line| !words.is_empty())
}

/// A text that is laid out freely as lines of one vertex or face each; `None` for one that is not.
///
/// Colours end where their line does, so lines count. A text with fewer of them than it has vertices and faces has no colours: then its numbers are
/// those of vertices and faces, and no more.
fn laid_out(bytes: &[u8]) -> Option<Vec<Line<'_>>> {
    let all = || written(bytes).flat_map(|(line, words)| words.into_iter().map(move |w| (line, w)));
    let header = all().next().filter(|(_, word)| kind(word).is_some());
    let kind = match header.and_then(|(_, word)| kind(word)) {
        Some(found) => found.ok()?,
        None => Kind::default(),
    };
    let mut rest = all().skip(usize::from(header.is_some()));
    let counts: Vec<(u32, &str)> = rest.by_ref().take(3).collect();
    let [vertices, faces] = [0, 1].map(|k| counts.get(k).and_then(|c| c.1.parse::<usize>().ok()));
    let (vertices, faces) = (vertices?, faces?);
    let fewest = vertices.checked_add(faces)?;
    if written(bytes).take(fewest).count() == fewest {
        return None;
    }
    let mut laid: Vec<Line> = header.iter().map(|&(line, word)| (line, vec![word])).collect();
    laid.push((counts[0].0, counts.iter().map(|&(_, word)| word).collect()));
    for _ in 0..vertices {
        let (line, first) = rest.next()?;
        let more = rest.by_ref().take(kind.numbers() - 1).map(|(_, word)| word);
        laid.push((line, std::iter::once(first).chain(more).collect()));
    }
    for _ in 0..faces {
        let (line, count) = rest.next()?;
        let corners = rest.by_ref().take(count.parse().ok()?).map(|(_, word)| word);
        laid.push((line, std::iter::once(count).chain(corners).collect()));
    }
    rest.next().is_none().then_some(laid)
}

pub(super) fn read(bytes: &[u8], file: &str) -> Result<RawMesh, MeshError> {
    let bytes = &*plain(bytes);
    let mut lines: Box<dyn Iterator<Item = Line>> = match laid_out(bytes) {
        Some(laid) => Box::new(laid.into_iter()),
        None => Box::new(written(bytes)),
    };
    let at = |line: u32, what: String| MeshError::syntax(file, format!("line {line}: {what}"));

    let end = || MeshError::syntax(file, "ends too early");
    let (mut line_number, mut header) = lines.next().ok_or_else(end)?;
    let kind = match kind(header[0]) {
        Some(found) => {
            header.remove(0);
            let binary = header.first().is_some_and(|word| word.eq_ignore_ascii_case("binary"));
            let other = if binary { Err("the binary form of OFF") } else { found };
            other.map_err(|what| {
                MeshError::new(
                    file,
                    format!("has {what}, which is not read here"),
                    "export it as OFF text, or as PLY",
                )
            })?
        }
        // The word may be left out.
        None if header[0].parse::<u64>().is_ok() => Kind::default(),
        None => {
            return Err(at(
                line_number,
                "does not start with OFF, or COFF, NOFF, STOFF and the like".to_owned(),
            ));
        }
    };
    // The counts may stand on the header's own line.
    if header.is_empty() {
        (line_number, header) = lines.next().ok_or_else(end)?;
    }
    let count = |k: usize| header.get(k).and_then(|word| word.parse::<u64>().ok());
    let (Some(vertices), Some(faces)) = (count(0), count(1)) else {
        return Err(at(line_number, "needs the numbers of vertices, faces and edges".to_owned()));
    };
    // A vertex or a face takes at least six bytes: three digits and what parts them.
    for (claimed, what) in [(vertices, "vertices"), (faces, "faces")] {
        if claimed > bytes.len() as u64 / 6 {
            return Err(MeshError::claim(file, claimed, what, bytes.len()));
        }
    }

    let mut raw = RawMesh::default();
    let mut normals = Vec::new();
    let coordinates = if kind.homogeneous { 4 } else { 3 };
    let needed = kind.numbers();
    for v in 0..vertices {
        let mut numbers: Vec<f64> = Vec::with_capacity(needed);
        // What is more on the last line is a colour or a texture's.
        while numbers.len() < needed {
            let (number_of_line, line) = lines.next().ok_or_else(|| {
                MeshError::syntax(file, format!("ends after {v} of {vertices} vertices"))
            })?;
            let missing = needed - numbers.len();
            for word in line.iter().take(missing) {
                numbers.push(number(word).ok_or_else(|| {
                    at(number_of_line, format!("vertex {v} needs {needed} numbers"))
                })?);
            }
        }
        let point = Vec3::new(numbers[0], numbers[1], numbers[2]);
        raw.positions.push(if kind.homogeneous { point * (1.0 / numbers[3]) } else { point });
        if kind.normals {
            let n = &numbers[coordinates..];
            normals.push(Vec3::new(n[0], n[1], n[2]));
        }
    }
    let mut corners: Vec<u32> = Vec::new();
    for face in 0..faces {
        let ends = || MeshError::syntax(file, format!("ends after {face} of {faces} faces"));
        let (number_of_line, line) = lines.next().ok_or_else(ends)?;
        let mut found = line.iter();
        let count = found.next().and_then(|word| word.parse::<usize>().ok()).unwrap_or(0);
        corners.clear();
        // What follows the corners is a colour.
        corners.extend(found.take(count).map_while(|word| word.parse::<u32>().ok()));
        if count < 3 || corners.len() != count {
            return Err(at(
                number_of_line,
                format!("face {face} needs a count of at least 3 and as many corners"),
            ));
        }
        let of_corners: Option<Vec<Vec3>> =
            corners.iter().map(|&v| normals.get(v as usize).copied()).collect();
        raw.push_polygon_with_normals(
            &corners,
            &of_corners.filter(|_| kind.normals).unwrap_or_default(),
            face as u32,
            Some(number_of_line),
        );
    }
    Ok(raw)
}
