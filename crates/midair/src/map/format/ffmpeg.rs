//! A pair of 16-bit PGM files for ffmpeg's remap filter.

use super::exr_channels::check_size;
use super::{FileError, LoadedMap, answer, pair, read_bytes};
use crate::files::write_bytes_atomically;
use crate::map::{Map, Status};
use std::path::{Path, PathBuf};

/// A value past any source: the filter shows its fill colour there.
const NONE: u16 = u16::MAX;

pub(super) fn write(map: &Map, source: [usize; 2], path: &Path) -> Result<Vec<PathBuf>, FileError> {
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
        write_bytes_atomically(file, &bytes)?;
    }
    Ok(files.to_vec())
}

/// The source pixel that holds the image point: column for axis 0, row from the top for axis 1.
fn nearest(uv: [f64; 2], axis: usize, size: usize) -> u16 {
    let place = if axis == 0 { uv[0] } else { 1.0 - uv[1] };
    // A point on the far edge belongs to the last pixel.
    (place * size as f64).floor().clamp(0.0, (size - 1) as f64) as u16
}

pub(super) fn read(path: &Path, source: [usize; 2]) -> Result<LoadedMap, FileError> {
    let files = pair::x_and_y(path);
    let (width, height, columns) = read_pgm(&files[0])?;
    let (other_width, other_height, rows) = read_pgm(&files[1])?;
    if (width, height) != (other_width, other_height) {
        let problem = format!(
            "{other_width} x {other_height} pixels, but {} has {width} x {height}",
            files[0].display()
        );
        return Err(FileError::malformed(&files[1], "header", problem, "write both from one map"));
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

fn read_pgm(path: &Path) -> Result<(usize, usize, Vec<u16>), FileError> {
    let bytes = read_bytes(path)?;
    let bad = |place: &str, problem: String| {
        Err(FileError::malformed(path, place, problem, "write it again as binary 16-bit PGM (P5)"))
    };
    if !bytes.starts_with(b"P5") {
        return bad("header", "it is not a binary PGM file".into());
    }
    let mut at = 2;
    let mut fields = [0u64; 3];
    for field in &mut fields {
        // White space and comments up to the next number.
        loop {
            match bytes.get(at) {
                Some(b'#') => {
                    at += bytes[at..].iter().take_while(|&&byte| byte != b'\n').count();
                }
                Some(byte) if byte.is_ascii_whitespace() => at += 1,
                _ => break,
            }
        }
        let digits = bytes[at..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let text = std::str::from_utf8(&bytes[at..at + digits]).unwrap_or_default();
        match text.parse() {
            Ok(number) => *field = number,
            Err(_) => return bad("header", "width, height or depth is missing".into()),
        }
        at += digits;
    }
    let [width, height, depth] = fields;
    check_size(path, width, height)?;
    if depth != 65535 {
        return bad("header", format!("its largest value is {depth}, not 65535"));
    }
    // One white space, then the samples.
    let data = bytes.get(at + 1..).unwrap_or_default();
    let needed = (width * height * 2) as usize;
    if data.len() < needed {
        return bad("data", format!("{} of {needed} bytes are there", data.len()));
    }
    let samples = data[..needed].as_chunks::<2>().0.iter().map(|&pair| u16::from_be_bytes(pair));
    Ok((width as usize, height as usize, samples.collect()))
}
