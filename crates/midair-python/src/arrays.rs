//! Arrays from and to Python: numpy's, or bytes where there is no numpy.

use crate::error::refused;
use crate::setting::shown;
use numpy::{Element, PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Points of two numbers: an array whose last axis has two entries (or what numpy makes one of), or bytes of 64-bit floats.
pub enum Points<'py> {
    Array(PyReadonlyArrayDyn<'py, f64>),
    Bytes(Vec<[f64; 2]>),
}

impl<'py> Points<'py> {
    pub fn new(value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let py = value.py();
        if let Some(bytes) = bytes(value)? {
            let pairs = bytes.as_bytes().as_chunks::<16>();
            if !pairs.1.is_empty() {
                let message =
                    format!("{} bytes are no pairs of 64-bit floats", bytes.as_bytes().len());
                return Err(refused(py, message, "give 16 bytes for each point"));
            }
            let number = |pair: &[u8; 16], k: usize| {
                f64::from_ne_bytes(std::array::from_fn(|byte| pair[8 * k + byte]))
            };
            let points = pairs.0.iter().map(|pair| [number(pair, 0), number(pair, 1)]).collect();
            return Ok(Self::Bytes(points));
        }
        let array = contiguous::<f64>(value, "float64")?;
        if array.shape().last() != Some(&2) {
            let message = format!("points of shape {:?} are not pairs", array.shape());
            return Err(refused(
                py,
                message,
                "give an array whose last axis has two entries, u and v",
            ));
        }
        Ok(Self::Array(array))
    }

    pub fn all(&self) -> &[[f64; 2]] {
        match self {
            // Contiguous, as it was made.
            Self::Array(array) => array.as_slice().unwrap_or_default().as_chunks().0,
            Self::Bytes(points) => points,
        }
    }

    /// What was found for each point, in the form that the points came in: so many numbers each, their axes after the points' own.
    pub fn answer<const N: usize>(
        &self,
        py: Python<'py>,
        found: Vec<[f64; N]>,
        axes: &[usize],
    ) -> PyResult<Bound<'py, PyAny>> {
        match self {
            Self::Bytes(_) => Ok(to_bytes(py, found.as_flattened())?.into_any()),
            Self::Array(array) => {
                let shape = array.shape();
                let shape = [&shape[..shape.len() - 1], axes].concat();
                shaped(py, found.into_flattened(), &shape)
            }
        }
    }
}

use numpy::PyUntypedArrayMethods as _;

/// The bytes of an object that holds nothing else; without a copy where they are bytes.
pub fn bytes<'py>(value: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyBytes>>> {
    if let Ok(bytes) = value.cast::<PyBytes>() {
        return Ok(Some(bytes.clone()));
    }
    let class = value.get_type().name()?;
    if class == "bytearray" || class == "memoryview" {
        let bytes = value.py().get_type::<PyBytes>().call1((value,))?;
        return Ok(Some(bytes.cast_into::<PyBytes>()?));
    }
    Ok(None)
}

/// numpy itself; without it a message that says what to do.
pub fn numpy(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    py.import("numpy").map_err(|_| {
        let message = "arrays need numpy, which is not installed";
        refused(py, message, "pip install numpy, or give and take bytes")
    })
}

/// An array of a kind of number, row by row in memory; a copy only where it is of another kind or order.
pub fn contiguous<'py, T: Element>(
    value: &Bound<'py, PyAny>,
    kind: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let py = value.py();
    let array = numpy(py)?.call_method1("ascontiguousarray", (value, kind)).map_err(|_| {
        let message = format!("{} is no array of numbers", shown(value));
        refused(py, message, "give a numpy array, or nested lists of numbers")
    })?;
    Ok(array.cast_into::<PyArrayDyn<T>>()?.try_readonly()?)
}

/// Numbers as a new array of this shape, which holds them without a copy.
pub fn shaped<'py, T: Element>(
    py: Python<'py>,
    numbers: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    numpy(py)?;
    Ok(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any())
}

/// Numbers as bytes of 64-bit floats.
pub fn to_bytes<'py>(py: Python<'py>, numbers: &[f64]) -> PyResult<Bound<'py, PyBytes>> {
    PyBytes::new_with(py, 8 * numbers.len(), |bytes| {
        for (eight, number) in bytes.as_chunks_mut::<8>().0.iter_mut().zip(numbers) {
            *eight = number.to_ne_bytes();
        }
        Ok(())
    })
}
