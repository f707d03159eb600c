//! A pair of 16-bit PGM files for ffmpeg's remap filter.

use super::exr_channels::check_size;
use super::{Fetch, FileError, LoadedMap, Put, answer, pair};
use crate::map::{Map, Status};
use std::path::{Path, PathBuf};

/// A value past any source: the filter shows its fill colour there.
const NONE: u16 = u16::MAX;

pub(super) fn write(
    map: &Map,
    source: [usize; 2],
    path: &Path,
    put: &mut Put<'_>,
) -> Result<Vec<PathBuf>, FileError> {
    if source.iter().any(|&size| size >= usize::from(NONE)) {
        let problem = format!("{} x {} source pixels do not fit 16 bits", source[0], source[1]);
        return Err(FileError::unsupported(path, problem, "write exr or opencv instead"));
    }
    let files = pair::x_and_y(path);
    for (axis, file) in files.iter().enumerate() {
        let mut bytes = format!("P5\n{} {}\n65535\n", map.width, map.height).into_bytes();
        for &uv in &map.uv {
            let value = answer(uv).map_or(NONE, |uv| nearest(uv, axis, source[axis]));
            bytes.extend(value.to_be_bytes());
        }
        put(file, &bytes)?;
    }
    Ok(files.to_vec())
}

/// The source pixel that holds the image point: column for axis 0, row from the top for axis 1.
fn nearest(uv: [f64; 2], axis: usize, size: usize) -> u16 {
    let place = if axis == 0 { uv[0] } else { 1.0 - uv[1] };
    // A point on the far edge belongs to the last pixel.
    (place * size as f64).floor().clamp(0.0, (size - 1) as f64) as u16
}

pub(super) fn read(
    path: &Path,
    fetch: &Fetch<'_>,
    source: [usize; 2],
) -> Result<LoadedMap, FileError> {
    let files = pair::find(path, fetch)?;
    let [(x, x_bytes), (y, y_bytes)] = &files;
    let (width, height, columns) = decode_pgm(x, x_bytes)?;
    let (other_width, other_height, rows) = decode_pgm(y, y_bytes)?;
    if (width, height) != (other_width, other_height) {
        let problem = format!(
            "{other_width} x {other_height} pixels, but {} has {width} x {height}",
            x.display()
        );
        return Err(FileError::malformed(y, "header", problem, "write both from one map"));
    }
    let (uv, status) = columns
        .iter()
        .zip(&rows)
        .map(|(&x, &y)| {
            let (x, y) = (usize::from(x), usize::from(y));
            if x >= source[0] || y >= source[1] {
                ([f64::NAN; 2], Status::Outside)
            } else {
                (crate::map::pixel_centre(x, y, source[0], source[1]), Status::Ok)
            }
        })
        .unzip();
    Ok(LoadedMap::new(Map { width, height, uv, status, error_bound: f64::INFINITY }))
}

/// A PGM file, as text (P2) or binary (P5).
fn decode_pgm(path: &Path, bytes: &[u8]) -> Result<(usize, usize, Vec<u16>), FileError> {
    let bad = |place: &str, problem: String| {
        Err(FileError::malformed(path, place, problem, "write it again as 16-bit PGM (P5 or P2)"))
    };
    let text = match bytes.get(..2) {
        Some(b"P5") => false,
        Some(b"P2") => true,
        _ => return bad("header", "it is not a PGM file (P5 or P2)".into()),
    };
    let mut at = 2;
    let mut fields = [0u64; 3];
    for field in &mut fields {
        match next_number(bytes, &mut at) {
            Some(number) => *field = number,
            None => return bad("header", "width, height or depth is missing".into()),
        }
    }
    let [width, height, depth] = fields;
    check_size(path, width, height)?;
    if depth != 65535 {
        return bad("header", format!("its largest value is {depth}, not 65535"));
    }
    let (count, size) = ((width * height) as usize, (width as usize, height as usize));
    if text {
        let mut samples = Vec::new();
        while samples.len() < count {
            match next_number(bytes, &mut at).and_then(|number| u16::try_from(number).ok()) {
                Some(sample) => samples.push(sample),
                None => {
                    let there = samples.len();
                    let problem = format!("{there} of {count} numbers from 0 to 65535 are there");
                    return bad("data", problem);
                }
            }
        }
        return Ok((size.0, size.1, samples));
    }
    // One white space, then the samples.
    let data = bytes.get(at + 1..).unwrap_or_default();
    if data.len() < 2 * count {
        return bad("data", format!("{} of {} bytes are there", data.len(), 2 * count));
    }
    let samples = data[..2 * count].as_chunks::<2>().0.iter().map(|&pair| u16::from_be_bytes(pair));
    Ok((size.0, size.1, samples.collect()))
}

/// The next number of a header, or of text samples, past white space and comments.
fn next_number(bytes: &[u8], at: &mut usize) -> Option<u64> {
    loop {
        match bytes.get(*at) {
            Some(b'#') => *at += bytes[*at..].iter().take_while(|&&byte| byte != b'\n').count(),
            Some(byte) if byte.is_ascii_whitespace() => *at += 1,
            _ => break,
        }
    }
    let rest = bytes.get(*at..)?;
    let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
    *at += digits;
    std::str::from_utf8(&rest[..digits]).ok()?.parse().ok()
}
