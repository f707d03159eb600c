//! NumPy arrays: midair's own `npy` format, and the arrays of others.

use super::exr_channels::check_size;
use super::{Fetch, FileError, LoadedMap, Put, answer, fetched, pair};
use crate::map::{Map, Status};
use npyz::WriterBuilder;
use std::io;
use std::path::{Path, PathBuf};

pub(super) fn write(map: &Map, path: &Path, put: &mut Put<'_>) -> Result<Vec<PathBuf>, FileError> {
    let (height, width) = (map.height as u64, map.width as u64);
    let uv = map.uv.iter().flat_map(|&uv| answer(uv).unwrap_or([f64::NAN; 2]));
    put(path, &encode_array(path, &[height, width, 2], uv)?)?;
    let status = pair::status(path);
    let codes = map.status.iter().map(|&status| status as u8);
    put(&status, &encode_array(&status, &[height, width], codes)?)?;
    Ok(vec![path.to_owned(), status])
}

/// An array in C order as a file; `path` is named in errors.
pub(super) fn encode_array<T: npyz::AutoSerialize>(
    path: &Path,
    shape: &[u64],
    values: impl Iterator<Item = T>,
) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    let write = || -> io::Result<()> {
        let options = npyz::WriteOptions::new().default_dtype().shape(shape);
        let mut writer = options.writer(&mut bytes).begin_nd()?;
        writer.extend(values)?;
        writer.finish()
    };
    write().map_err(|error| FileError::io(path, "write", error))?;
    Ok(bytes)
}

/// An array in C order, its numbers as they are whatever their type.
pub(super) struct Array {
    pub shape: Vec<usize>,
    pub numbers: Vec<f64>,
    /// What NumPy calls their type, without the byte order: `f8`, `i2`.
    kind: String,
}

impl Array {
    /// Whether they are 16-bit integers with a sign, as cv2.convertMaps makes them.
    pub fn is_fixed(&self) -> bool {
        self.kind == "i2"
    }
}

fn header(path: &Path, bytes: &[u8]) -> Result<npyz::NpyHeader, FileError> {
    // The header's parser and the arithmetic on its shape meet damaged files here.
    let problem = match std::panic::catch_unwind(|| npyz::NpyHeader::from_reader(bytes)) {
        Ok(Ok(header)) => return Ok(header),
        Ok(Err(error)) => error.to_string(),
        Err(_) => "it makes no sense".to_owned(),
    };
    Err(FileError::malformed(path, "header", problem, "save it again with numpy.save"))
}

/// How many axes an array has.
pub(super) fn axes(path: &Path, bytes: &[u8]) -> Result<usize, FileError> {
    Ok(header(path, bytes)?.shape().len())
}

/// An array of so many axes.
pub(super) fn decode_array(
    path: &Path,
    bytes: &[u8],
    dimensions: usize,
) -> Result<Array, FileError> {
    let bad = |place: &str, problem: String, remedy: &str| {
        Err(FileError::malformed(path, place, problem, remedy))
    };
    let header = header(path, bytes)?;
    let shape: Vec<u64> = header.shape().to_vec();
    if shape.len() != dimensions {
        let problem = format!("an array of shape {shape:?}, not of {dimensions} axes");
        return bad("header", problem, "save the map as midair's book describes");
    }
    check_size(path, shape[1], shape[0])?;
    let npyz::DType::Plain(kind) = header.dtype() else {
        return bad("header", "an array of records".into(), "save plain numbers");
    };
    let count = shape.iter().try_fold(1u64, |n, &length| n.checked_mul(length));
    let size = kind.num_bytes().unwrap_or(0) as u64;
    let needed = count.and_then(|count| count.checked_mul(size));
    if needed.is_none_or(|needed| needed > bytes.len() as u64) {
        let problem = format!("an array of shape {shape:?} cannot be in {} bytes", bytes.len());
        return bad("header", problem, "it seems cut short: save it again");
    }
    fn all<T: npyz::Deserialize>(bytes: &[u8], wide: fn(T) -> f64) -> io::Result<Vec<f64>> {
        Ok(npyz::NpyFile::new(bytes)?.into_vec::<T>()?.into_iter().map(wide).collect())
    }
    let name = kind.to_string().trim_start_matches(['<', '>', '|', '=']).to_owned();
    let numbers = match &*name {
        "f8" => all(bytes, |x: f64| x),
        "f4" => all(bytes, |x: f32| x.into()),
        "f2" => all(bytes, |x: half::f16| x.to_f64()),
        "u1" => all(bytes, |x: u8| x.into()),
        "i2" => all(bytes, |x: i16| x.into()),
        "u2" => all(bytes, |x: u16| x.into()),
        "i4" => all(bytes, |x: i32| x.into()),
        "u4" => all(bytes, |x: u32| x.into()),
        _ => {
            let remedy = "save floats of 64, 32 or 16 bits, or whole numbers of 8 to 32 bits";
            return bad("header", format!("numbers of type {kind}"), remedy);
        }
    };
    let shape: Vec<usize> = shape.iter().map(|&n| n as usize).collect();
    match numbers {
        Ok(numbers) => {
            let fortran = header.order() == npyz::Order::Fortran;
            let numbers = if fortran { in_c_order(&numbers, &shape) } else { numbers };
            Ok(Array { shape, numbers, kind: name })
        }
        Err(error) => bad("data", error.to_string(), "save it again with numpy.save"),
    }
}

/// Numbers whose first index runs fastest, so that the last does.
fn in_c_order(numbers: &[f64], shape: &[usize]) -> Vec<f64> {
    let place = |mut at: usize| {
        let mut index = vec![0; shape.len()];
        for (axis, &length) in shape.iter().enumerate().rev() {
            index[axis] = at % length;
            at /= length;
        }
        index.iter().zip(shape).rev().fold(0, |place, (&i, &length)| place * length + i)
    };
    (0..numbers.len()).map(|at| numbers[place(at)]).collect()
}

pub(super) fn read(path: &Path, fetch: &Fetch<'_>) -> Result<LoadedMap, FileError> {
    let Array { shape, numbers, .. } = decode_array(path, &fetched(path, fetch)?, 3)?;
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
    let Ok(bytes) = fetch(&beside) else {
        loaded.notes.push(format!(
            "{}: without {} each pixel with u and v is taken as ok",
            path.display(),
            beside.display()
        ));
        return Ok(loaded);
    };
    let Array { shape, numbers: codes, .. } = decode_array(&beside, &bytes, 2)?;
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
