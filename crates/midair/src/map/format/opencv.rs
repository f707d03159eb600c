//! Maps for cv2.remap: a pair of arrays, or a FileStorage in YAML.

use super::exr_channels::check_size;
use super::png::{coverage, uncover};
use super::{FileError, LoadedMap, answer, npy, pair};
use crate::files::write_bytes_atomically;
use crate::map::{Map, Status};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// cv2.remap's coordinates along an axis: 0 at the centre of the first pixel, rows from the top.
fn coordinate(uv: [f64; 2], axis: usize, size: usize) -> f32 {
    let place = if axis == 0 { uv[0] } else { 1.0 - uv[1] };
    (place * size as f64 - 0.5) as f32
}

fn coordinates(map: &Map, axis: usize, size: usize) -> impl Iterator<Item = f32> {
    map.uv.iter().map(move |&uv| answer(uv).map_or(f32::NAN, |uv| coordinate(uv, axis, size)))
}

pub(super) fn write_npy(
    map: &Map,
    source: [usize; 2],
    path: &Path,
) -> Result<Vec<PathBuf>, FileError> {
    let files = pair::x_and_y(path);
    for (axis, file) in files.iter().enumerate() {
        let shape = [map.height as u64, map.width as u64];
        npy::write_array(file, &shape, coordinates(map, axis, source[axis]))?;
    }
    Ok(files.to_vec())
}

pub(super) fn write_yaml(map: &Map, source: [usize; 2], path: &Path) -> Result<(), FileError> {
    let mut text = String::from("%YAML:1.0\n---\n");
    // Writing to a string cannot fail.
    let _ = writeln!(text, "source_width: {}\nsource_height: {}", source[0], source[1]);
    for (axis, name) in ["map1", "map2"].into_iter().enumerate() {
        let (rows, columns) = (map.height, map.width);
        let _ = write!(
            text,
            "{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: f\n   data: ["
        );
        for (i, value) in coordinates(map, axis, source[axis]).enumerate() {
            let gap = gap(i, 8);
            // `{:?}` gives the shortest text that reads back to the same float.
            let _ = match value.is_nan() {
                true => write!(text, "{gap}.Nan"),
                false => write!(text, "{gap}{value:?}"),
            };
        }
        text.push_str(" ]\n");
    }
    let _ = write!(
        text,
        "coverage: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: u\n   data: [",
        map.height, map.width
    );
    for (i, cover) in coverage(map).into_iter().enumerate() {
        let gap = gap(i, 16);
        let _ = write!(text, "{gap}{cover}");
    }
    text.push_str(" ]\n");
    write_bytes_atomically(path, text.as_bytes())
}

/// What stands before a matrix's number, of so many in a line.
fn gap(index: usize, in_line: usize) -> &'static str {
    match index {
        0 => " ",
        _ if index.is_multiple_of(in_line) => ",\n       ",
        _ => ", ",
    }
}

pub(super) fn read_npy(path: &Path, source: [usize; 2]) -> Result<LoadedMap, FileError> {
    let files = pair::x_and_y(path);
    let (shape, x) = npy::read_array(&files[0], 2)?;
    let (other, y) = npy::read_array(&files[1], 2)?;
    if shape != other {
        let problem = format!("{other:?} pixels, but {} has {shape:?}", files[0].display());
        return Err(FileError::malformed(&files[1], "header", problem, "save both from one map"));
    }
    Ok(from_coordinates(shape[1], shape[0], &x, &y, source))
}

fn from_coordinates(
    width: usize,
    height: usize,
    x: &[f64],
    y: &[f64],
    source: [usize; 2],
) -> LoadedMap {
    let (uv, status) = x
        .iter()
        .zip(y)
        .map(|(x, y)| {
            let uv = [(x + 0.5) / source[0] as f64, 1.0 - (y + 0.5) / source[1] as f64];
            // What lies off the source is the border's, whatever the number.
            let margin = [0.5 / source[0] as f64, 0.5 / source[1] as f64];
            let on = (0..2).all(|axis| (-margin[axis]..=1.0 + margin[axis]).contains(&uv[axis]));
            if on { (uv, Status::Ok) } else { ([f64::NAN; 2], Status::Outside) }
        })
        .unzip();
    LoadedMap::new(Map { width, height, uv, status, error_bound: f64::INFINITY })
}

pub(super) fn read_yaml(
    path: &Path,
    bytes: &[u8],
    source: Option<[usize; 2]>,
) -> Result<LoadedMap, FileError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        FileError::malformed(path, "text", error, "write it again with cv2.FileStorage")
    })?;
    let own = || Some([number(text, "source_width")?, number(text, "source_height")?]);
    let Some(source) = own().or(source).filter(|source| !source.contains(&0)) else {
        return Err(FileError::SourceUnknown { path: path.to_owned() });
    };
    let (width, height, x) = matrix(path, text, "map1")?;
    let (other_width, other_height, y) = matrix(path, text, "map2")?;
    if (width, height) != (other_width, other_height) {
        let problem = format!("{other_width} x {other_height}, but map1 is {width} x {height}");
        return Err(FileError::malformed(path, "map2", problem, "write both from one map"));
    }
    let mut loaded = from_coordinates(width, height, &x, &y, source);
    // Files of others have none.
    if text.contains("\ncoverage:") {
        let (columns, rows, cover) = matrix(path, text, "coverage")?;
        if (columns, rows) != (width, height) {
            let problem = format!("{columns} x {rows}, but map1 is {width} x {height}");
            let remedy = "write all from one map, or leave the coverage out";
            return Err(FileError::malformed(path, "coverage", problem, remedy));
        }
        uncover(&mut loaded.map, cover.iter().map(|&cover| cover > 0.0));
    }
    Ok(loaded)
}

/// The integer after `key:`.
fn number(text: &str, key: &str) -> Option<usize> {
    let after = text.split_once(&format!("{key}:"))?.1.trim_start();
    after.split_whitespace().next()?.parse().ok()
}

/// The matrix of floats called `name`: columns, rows, numbers.
fn matrix(path: &Path, text: &str, name: &str) -> Result<(usize, usize, Vec<f64>), FileError> {
    let bad = |problem: String| {
        let remedy = "write map1 and map2 as float32 matrices with cv2.FileStorage";
        FileError::malformed(path, name, problem, remedy)
    };
    let missing = |what: &str| bad(format!("{what} is missing"));
    let body = text.split_once(&format!("{name}:")).ok_or_else(|| missing("the matrix"))?.1;
    let rows = number(body, "rows").ok_or_else(|| missing("rows"))?;
    let columns = number(body, "cols").ok_or_else(|| missing("cols"))?;
    check_size(path, columns as u64, rows as u64)?;
    let data = body.split_once("data:").ok_or_else(|| missing("data"))?.1;
    let data = data.split_once('[').and_then(|(_, rest)| rest.split_once(']'));
    let data = data.ok_or_else(|| bad("its data do not end".into()))?.0;
    let mut numbers = Vec::new();
    for item in data.split(',').map(str::trim) {
        let value = match item {
            ".Nan" | ".NaN" | ".nan" => f64::NAN,
            ".Inf" | ".inf" => f64::INFINITY,
            "-.Inf" | "-.inf" => f64::NEG_INFINITY,
            _ => item.parse().map_err(|_| {
                bad(format!("`{}` is no number", item.chars().take(20).collect::<String>()))
            })?,
        };
        numbers.push(value);
    }
    if numbers.len() != rows * columns {
        let found = numbers.len();
        return Err(bad(format!("{rows} x {columns} numbers are announced, {found} are there")));
    }
    Ok((columns, rows, numbers))
}
