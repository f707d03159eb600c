//! Pictures from and to Python: 8- or 16-bit sRGB codes or linear light, by the array's kind of number.

use crate::arrays::{contiguous, shaped};
use crate::error::refused;
use crate::threads::work;
use midair::picture::{Picture, Samples};
use pyo3::prelude::*;

/// What an array's numbers stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Eight,
    Sixteen,
    Light,
}

/// A picture of an array: height x width, or height x width x 1, 3 or 4; uint8 and uint16 are sRGB codes, floats linear light.
pub fn read(value: &Bound<'_, PyAny>) -> PyResult<(Picture, Kind)> {
    let py = value.py();
    let array = crate::arrays::numpy(py)?.call_method1("asarray", (value,))?;
    let dtype = array.getattr("dtype")?;
    let (letter, size): (String, usize) =
        (dtype.getattr("kind")?.extract()?, dtype.getattr("itemsize")?.extract()?);
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    let (height, width, channels) = match shape[..] {
        [height, width] => (height, width, 1),
        [height, width, channels] => (height, width, channels),
        _ => (0, 0, 0),
    };
    let wrong = || {
        let message = format!("an array of shape {shape:?} is no picture");
        refused(
            py,
            message,
            "give height x width x 3 (R, G, B), or 4 with alpha, or height x width",
        )
    };
    if width == 0 || height == 0 {
        return Err(wrong());
    }
    let made =
        |samples: Samples| work(py, || Picture::of_samples([width, height], channels, samples));
    let (picture, kind) = match (&letter[..], size) {
        ("u", 1) => {
            let codes = contiguous::<u8>(&array, "uint8")?;
            (made(Samples::Eight(codes.as_slice()?))?, Kind::Eight)
        }
        ("u", 2) => {
            let codes = contiguous::<u16>(&array, "uint16")?;
            (made(Samples::Sixteen(codes.as_slice()?))?, Kind::Sixteen)
        }
        ("f", _) => {
            let light = contiguous::<f32>(&array, "float32")?;
            (made(Samples::Light(light.as_slice()?))?, Kind::Light)
        }
        _ => {
            let message = format!("a picture of {} is not known", dtype.str()?);
            let remedy = "give uint8 or uint16 (sRGB codes), or float32 (linear light)";
            return Err(refused(py, message, remedy));
        }
    };
    Ok((picture.ok_or_else(wrong)?, kind))
}

/// A picture as an array of a kind: height x width x 3.
pub fn write<'py>(py: Python<'py>, picture: &Picture, kind: Kind) -> PyResult<Bound<'py, PyAny>> {
    let shape = [picture.height, picture.width, 3];
    match kind {
        Kind::Eight => shaped(py, work(py, || picture.codes_8())?, &shape),
        Kind::Sixteen => shaped(py, work(py, || picture.codes_16())?, &shape),
        Kind::Light => shaped(py, work(py, || picture.light())?, &shape),
    }
}
