//! NumPy arrays: midair's own `npy` format, and the arrays of others.

use super::exr_channels::check_size;
use super::{FileError, LoadedMap, answer, pair, read_bytes};
use crate::files::write_atomically;
use crate::map::{Map, Status};
use npyz::WriterBuilder;
use std::io;
use std::path::{Path, PathBuf};

pub(super) fn write(map: &Map, path: &Path) -> Result<Vec<PathBuf>, FileError> {
    let (height, width) = (map.height as u64, map.width as u64);
    let uv = map.uv.iter().flat_map(|&uv| answer(uv).unwrap_or([f64::NAN; 2]));
    write_array(path, &[height, width, 2], uv)?;
    let status = pair::status(path);
    write_array(&status, &[height, width], map.status.iter().map(|&status| status as u8))?;
    Ok(vec![path.to_owned(), status])
}

/// Writes an array in C order.
pub(super) fn write_array<T: npyz::AutoSerialize>(
    path: &Path,
    shape: &[u64],
    values: impl Iterator<Item = T>,
) -> Result<(), FileError> {
    write_atomically(path, |file| {
        let write = || -> io::Result<()> {
            let options = npyz::WriteOptions::new().default_dtype().shape(shape);
            let mut writer = options.writer(file).begin_nd()?;
            writer.extend(values)?;
            writer.finish()
        };
        write().map_err(|error| FileError::io(path, "write", error))
    })
}

/// An array's shape and its numbers, whatever their type; `dimensions` is how many axes it should have.
pub(super) fn read_array(
    path: &Path,
    dimensions: usize,
) -> Result<(Vec<usize>, Vec<f64>), FileError> {
    let bytes = read_bytes(path)?;
    decode_array(path, &bytes, dimensions)
}

fn decode_array(
    path: &Path,
    bytes: &[u8],
    dimensions: usize,
) -> Result<(Vec<usize>, Vec<f64>), FileError> {
    let bad = |place: &str, problem: String, remedy: &str| {
        Err(FileError::malformed(path, place, problem, remedy))
    };
    // The header's parser and the arithmetic on its shape meet damaged files here.
    let header = std::panic::catch_unwind(|| npyz::NpyHeader::from_reader(bytes));
    let header = match header {
        Ok(Ok(header)) => header,
        Ok(Err(error)) => return bad("header", error.to_string(), "save it again with numpy.save"),
        Err(_) => {
            return bad("header", "it makes no sense".into(), "save it again with numpy.save");
        }
    };
    let shape: Vec<u64> = header.shape().to_vec();
    if shape.len() != dimensions {
        let problem = format!("an array of shape {shape:?}, not of {dimensions} axes");
        return bad("header", problem, "save the map as midair's book describes");
    }
    check_size(path, shape[1], shape[0])?;
    if header.order() != npyz::Order::C {
        let remedy = "save numpy.ascontiguousarray of it";
        return bad("header", "the array is in Fortran order".into(), remedy);
    }
    let npyz::DType::Plain(kind) = header.dtype() else {
        return bad("header", "an array of records".into(), "save plain numbers");
    };
    let count = shape.iter().product::<u64>();
    let size = kind.num_bytes().unwrap_or(0) as u64;
    if count.checked_mul(size).is_none_or(|needed| needed > bytes.len() as u64) {
        let problem = format!("{count} numbers of {size} bytes cannot be in {} bytes", bytes.len());
        return bad("header", problem, "it seems cut short: save it again");
    }
    let file = || npyz::NpyFile::new(bytes);
    let numbers: Option<io::Result<Vec<f64>>> =
        match kind.to_string().trim_start_matches(['<', '>', '|', '=']) {
            "f8" => Some(file().and_then(|file| file.into_vec::<f64>())),
            "f4" => Some(
                file()
                    .and_then(|file| file.into_vec::<f32>())
                    .map(|values| values.into_iter().map(f64::from).collect()),
            ),
            "u1" => Some(
                file()
                    .and_then(|file| file.into_vec::<u8>())
                    .map(|values| values.into_iter().map(f64::from).collect()),
            ),
            _ => None,
        };
    match numbers {
        Some(Ok(numbers)) => Ok((shape.iter().map(|&n| n as usize).collect(), numbers)),
        Some(Err(error)) => bad("data", error.to_string(), "save it again with numpy.save"),
        None => bad("header", format!("numbers of type {kind}"), "save float64, float32 or uint8"),
    }
}

pub(super) fn read(path: &Path) -> Result<LoadedMap, FileError> {
    let (shape, numbers) = read_array(path, 3)?;
    if shape[2] != 2 {
        let problem = format!("{} numbers a pixel", shape[2]);
        return Err(FileError::malformed(path, "header", problem, "save u and v of each pixel"));
    }
    let (height, width) = (shape[0], shape[1]);
    let uv: Vec<[f64; 2]> =
        numbers.as_chunks::<2>().0.iter().map(|&uv| answer(uv).unwrap_or([f64::NAN; 2])).collect();
    let finite = |uv: &[f64; 2]| if uv[0].is_nan() { Status::Outside } else { Status::Ok };
    let mut loaded = LoadedMap::new(Map {
        width,
        height,
        status: uv.iter().map(finite).collect(),
        uv,
        error_bound: f64::INFINITY,
    });
    let beside = pair::status(path);
    if !beside.exists() {
        loaded.notes.push(format!(
            "{}: without {} each pixel with u and v is taken as ok",
            path.display(),
            beside.display()
        ));
        return Ok(loaded);
    }
    let (shape, codes) = read_array(&beside, 2)?;
    if shape != [height, width] {
        let problem = format!("{shape:?} pixels, but the map has [{height}, {width}]");
        return Err(FileError::malformed(&beside, "header", problem, "save both from one map"));
    }
    for (i, code) in codes.iter().enumerate() {
        let status = Status::from_code(*code as f32);
        let place = || format!("column {}, row {}", i % width, i / width);
        let Some(status) = status else {
            let problem = format!("{code} is none of 0, 1, 2, 3");
            return Err(FileError::malformed(&beside, place(), problem, "save it again"));
        };
        if status.is_answered() && loaded.map.uv[i][0].is_nan() {
            let problem = "its status is ok but it has no u and v";
            return Err(FileError::malformed(path, place(), problem, "save both from one map"));
        }
        loaded.map.status[i] = status;
    }
    Ok(loaded)
}
