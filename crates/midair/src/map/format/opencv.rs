//! Maps for cv2.remap: a pair of arrays, or a FileStorage.

use super::png::{coverage, uncover};
use super::storage::Matrix;
use super::{Fetch, FileError, LoadedMap, Put, answer, npy, pair, storage};
use crate::map::{Map, Status};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// cv2.remap's coordinates along an axis: 0 at the centre of the first pixel, rows from the top.
fn coordinate(uv: [f64; 2], axis: usize, size: usize) -> f32 {
    let place = if axis == 0 { uv[0] } else { 1.0 - uv[1] };
    (place * size as f64 - 0.5) as f32
}

pub(super) fn coordinates(map: &Map, axis: usize, size: usize) -> impl Iterator<Item = f32> {
    map.uv.iter().map(move |&uv| answer(uv).map_or(f32::NAN, |uv| coordinate(uv, axis, size)))
}

pub(super) fn write_npy(
    map: &Map,
    source: [usize; 2],
    path: &Path,
    put: &mut Put<'_>,
) -> Result<Vec<PathBuf>, FileError> {
    let files = pair::x_and_y(path);
    for (axis, file) in files.iter().enumerate() {
        let shape = [map.height as u64, map.width as u64];
        put(file, &npy::encode_array(file, &shape, coordinates(map, axis, source[axis]))?)?;
    }
    Ok(files.to_vec())
}

pub(super) fn write_yaml(
    map: &Map,
    source: [usize; 2],
    path: &Path,
    put: &mut Put<'_>,
) -> Result<(), FileError> {
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
    put(path, text.as_bytes())
}

/// What stands before a matrix's number, of so many in a line.
fn gap(index: usize, in_line: usize) -> &'static str {
    match index {
        0 => " ",
        _ if index.is_multiple_of(in_line) => ",\n       ",
        _ => ", ",
    }
}

/// cv2.convertMaps keeps the fractions of fixed coordinates in 32 steps each.
const STEPS: i64 = 32;

pub(super) fn read_npy(
    path: &Path,
    fetch: &Fetch<'_>,
    source: [usize; 2],
) -> Result<LoadedMap, FileError> {
    let arrays = match fetch(path) {
        // One array of pairs, as numpy.dstack or cv2.convertMaps makes it.
        Ok(bytes) if npy::axes(path, &bytes)? == 3 => {
            let pairs = npy::decode_array(path, &bytes, 3)?;
            // The fractions are in an array beside it.
            let beside = pairs.is_fixed().then(|| pair::find(path, fetch).ok()).flatten();
            let fractions = match beside {
                Some([_, (second, bytes)]) if second != path => {
                    Some(npy::decode_array(&second, &bytes, 2)?)
                }
                _ => None,
            };
            vec![Some(pairs), fractions]
        }
        _ => {
            let found = pair::find(path, fetch)?;
            let mut arrays = Vec::new();
            for (k, (file, bytes)) in found.iter().enumerate() {
                // The first may hold whole numbers for both.
                let axes = if k == 0 { npy::axes(file, bytes)?.clamp(2, 3) } else { 2 };
                arrays.push(Some(npy::decode_array(file, bytes, axes)?));
            }
            arrays
        }
    };
    let matrices: Vec<Matrix> = arrays
        .into_iter()
        .flatten()
        .zip(["map1", "map2"])
        .map(|(array, name)| Matrix {
            name: name.to_owned(),
            width: array.shape[1],
            height: array.shape[0],
            channels: array.shape.get(2).copied().unwrap_or(1),
            kind: if array.is_fixed() { 's' } else { 'f' },
            numbers: array.numbers,
        })
        .collect();
    from_matrices(path, &matrices, source)
}

pub(super) fn read_storage(
    path: &Path,
    bytes: &[u8],
    source: Option<[usize; 2]>,
) -> Result<LoadedMap, FileError> {
    let storage = storage::parse(path, bytes)?;
    let own = || Some([storage.number("source_width")?, storage.number("source_height")?]);
    let Some(source) = own().or(source).filter(|source| !source.contains(&0)) else {
        return Err(FileError::SourceUnknown { path: path.to_owned() });
    };
    // Files of others have none.
    let is_coverage = |m: &Matrix| m.name == "coverage" && m.channels == 1;
    let (cover, matrices): (Vec<Matrix>, _) = storage.matrices.into_iter().partition(is_coverage);
    let mut loaded = from_matrices(path, &chosen(path, matrices)?, source)?;
    if let Some(cover) = cover.first() {
        let [width, height] = [loaded.map.width, loaded.map.height];
        if (cover.width, cover.height) != (width, height) {
            let problem =
                format!("{} x {}, but the map is {width} x {height}", cover.width, cover.height);
            let remedy = "write all from one map, or leave the coverage out";
            return Err(FileError::malformed(path, "coverage", problem, remedy));
        }
        uncover(&mut loaded.map, cover.numbers.iter().map(|&cover| cover > 0.0));
    }
    Ok(loaded)
}

/// Which of a file's matrices are the map: the only one of two channels (and what fractions belong to it), or two of one channel.
fn chosen(path: &Path, matrices: Vec<Matrix>) -> Result<Vec<Matrix>, FileError> {
    // `map_x`, `mapX`, `xmap` and the like; OpenCV's documents have `map1` and `map2`.
    const NAMES: [[&str; 2]; 6] = [
        ["map1", "map2"],
        ["mapx", "mapy"],
        ["xmap", "ymap"],
        ["x", "y"],
        ["mapu", "mapv"],
        ["map0", "map1"],
    ];
    let plain = |name: &str| name.to_lowercase().replace(['_', '-', '.'], "");
    let named = |name: &str| matrices.iter().find(|matrix| plain(&matrix.name) == name);
    let pairs: Vec<&Matrix> = matrices.iter().filter(|matrix| matrix.channels == 2).collect();
    let by_name = NAMES.iter().find_map(|[x, y]| Some(vec![named(x)?, named(y)?]));
    let picked = match (&pairs[..], by_name) {
        (_, Some(both)) => both,
        ([only], None) if matrices.len() == 1 || only.kind != 's' => vec![*only],
        // Fixed coordinates have their fractions in the other matrix.
        ([only], None) => {
            let fits =
                |m: &&Matrix| m.channels == 1 && (m.width, m.height) == (only.width, only.height);
            [*only].into_iter().chain(matrices.iter().find(fits)).collect()
        }
        _ => {
            let found: Vec<String> = matrices
                .iter()
                .map(|m| {
                    format!("{} ({} x {}, {} channels)", m.name, m.width, m.height, m.channels)
                })
                .collect();
            let found = if found.is_empty() { "none".to_owned() } else { found.join(", ") };
            return Err(FileError::malformed(
                path,
                "matrices",
                format!("which of them are the map is not clear: {found}"),
                "write map1 and map2, or mapx and mapy, as float32 matrices with cv2.FileStorage, or one of two channels",
            ));
        }
    };
    Ok(picked.into_iter().cloned().collect())
}

/// A map of one or two matrices, as cv2.remap takes them.
fn from_matrices(
    path: &Path,
    matrices: &[Matrix],
    source: [usize; 2],
) -> Result<LoadedMap, FileError> {
    let fits = |a: &Matrix, b: &Matrix| {
        if (a.width, a.height) == (b.width, b.height) {
            return Ok(());
        }
        let problem =
            format!("{} x {}, but {} is {} x {}", b.width, b.height, a.name, a.width, a.height);
        Err(FileError::malformed(path, b.name.clone(), problem, "write both from one map"))
    };
    let wrong = |m: &Matrix| {
        let problem = format!("it has {} channels of type `{}`", m.channels, m.kind);
        let remedy = "write x and y as float32 (CV_32FC1 or CV_32FC2), or as cv2.convertMaps makes them (CV_16SC2 and CV_16UC1)";
        FileError::malformed(path, m.name.clone(), problem, remedy)
    };
    let pixels: Vec<[f64; 2]> = match matrices {
        [both] if both.channels == 2 => both.numbers.as_chunks::<2>().0.to_vec(),
        [whole, rest] if whole.channels == 2 && rest.channels == 1 => {
            fits(whole, rest)?;
            let parts = rest.numbers.iter().map(|&code| code as i64);
            let parts = parts.map(|code| [code % STEPS, code / STEPS % STEPS]);
            let whole = whole.numbers.as_chunks::<2>().0.iter();
            let sum = |whole: f64, part: i64| whole + part as f64 / STEPS as f64;
            whole.zip(parts).map(|(w, p)| [sum(w[0], p[0]), sum(w[1], p[1])]).collect()
        }
        [x, y] if x.channels == 1 && y.channels == 1 => {
            fits(x, y)?;
            x.numbers.iter().zip(&y.numbers).map(|(&x, &y)| [x, y]).collect()
        }
        [first, ..] => return Err(wrong(first)),
        [] => {
            return Err(FileError::unsupported(path, "it holds no matrix", "write map1 and map2"));
        }
    };
    let uv: Vec<[f64; 2]> = pixels
        .into_iter()
        .map(|[x, y]| [(x + 0.5) / source[0] as f64, 1.0 - (y + 0.5) / source[1] as f64])
        .map(|uv| answer(uv).unwrap_or([f64::NAN; 2]))
        .collect();
    let known = |uv: &[f64; 2]| if uv[0].is_nan() { Status::Outside } else { Status::Ok };
    let (width, height) = (matrices[0].width, matrices[0].height);
    let status = uv.iter().map(known).collect();
    let mut loaded = LoadedMap::new(Map { width, height, status, uv, error_bound: f64::INFINITY });
    if let [Matrix { kind: 's', name, .. }] = matrices {
        loaded.notes.push(format!(
            "{}: {name} has whole pixels only: their fractions, the second matrix of cv2.convertMaps, are not there",
            path.display()
        ));
    }
    Ok(loaded)
}
