//! Values of scene files from and to Python.

use crate::error::refused;
use midair::scene::Setting;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use serde_json::{Map, Value};

/// A value for a key: a number, a text, true or false, a list of numbers, rows of numbers; numpy's kinds as well.
pub fn from_python(value: &Bound<'_, PyAny>) -> PyResult<Setting> {
    let py = value.py();
    let wrong = || {
        refused(
            py,
            format!("{} is no value of a scene", shown(value)),
            "give a number, a text, true or false, or a list of numbers",
        )
    };
    Ok(match plain(value)? {
        Value::Bool(flag) => Setting::Flag(flag),
        Value::String(text) => Setting::Text(text),
        Value::Number(number) => match number.as_i64() {
            Some(whole) => Setting::Integer(whole),
            None => Setting::Number(number.as_f64().ok_or_else(wrong)?),
        },
        Value::Array(items) => list(&items).ok_or_else(wrong)?,
        Value::Null | Value::Object(_) => return Err(wrong()),
    })
}

fn list(items: &[Value]) -> Option<Setting> {
    let numbers = |items: &[Value]| items.iter().map(Value::as_f64).collect::<Option<Vec<_>>>();
    if let Some(whole) = items.iter().map(Value::as_i64).collect() {
        return Some(Setting::Integers(whole));
    }
    match numbers(items) {
        Some(numbers) => Some(Setting::Numbers(numbers)),
        None => items
            .iter()
            .map(|row| numbers(row.as_array()?))
            .collect::<Option<_>>()
            .map(Setting::Rows),
    }
}

/// A value as Python has it.
pub fn to_python(py: Python<'_>, value: &Setting) -> PyResult<Py<PyAny>> {
    Ok(match value {
        Setting::Flag(flag) => flag.into_pyobject(py)?.to_owned().into_any(),
        Setting::Integer(number) => number.into_pyobject(py)?.into_any(),
        Setting::Number(number) => number.into_pyobject(py)?.into_any(),
        Setting::Integers(numbers) => numbers.into_pyobject(py)?,
        Setting::Numbers(numbers) => numbers.into_pyobject(py)?,
        Setting::Rows(rows) => rows.into_pyobject(py)?,
        Setting::Text(text) => text.into_pyobject(py)?.into_any(),
    }
    .unbind())
}

/// A value of Python's as JSON has it: what a scene in a dict is read from.
pub fn plain(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    let py = value.py();
    if value.is_none() {
        return Ok(Value::Null);
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_string()));
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        let entries = dict.iter().map(|(key, value)| {
            let key = key.cast::<PyString>().map_err(|_| {
                let message = format!("{} is no key of a scene", shown(&key));
                refused(py, message, "keys are texts")
            })?;
            Ok((key.to_string(), plain(&value)?))
        });
        return Ok(Value::Object(entries.collect::<PyResult<Map<_, _>>>()?));
    }
    if value.hasattr("__fspath__")? {
        return plain(&value.call_method0("__fspath__")?);
    }
    if let Ok(flag) = value.extract::<bool>() {
        return Ok(Value::Bool(flag));
    }
    // An array with one number in it is an array.
    if let Ok(items) = value.try_iter() {
        return items.map(|item| plain(&item?)).collect::<PyResult<_>>().map(Value::Array);
    }
    if let Ok(whole) = value.extract::<i64>() {
        return Ok(whole.into());
    }
    let number = value.extract::<f64>().ok().and_then(serde_json::Number::from_f64);
    number.map(Value::Number).ok_or_else(|| {
        refused(
            py,
            format!("{} is no value of a scene", shown(value)),
            "give a number, a text, true or false, or a list of numbers",
        )
    })
}

/// Data as Python has it: dicts, lists, numbers.
pub fn data(py: Python<'_>, value: &Value) -> PyResult<Py<PyAny>> {
    Ok(py.import("json")?.call_method1("loads", (value.to_string(),))?.unbind())
}

/// What was given, cut short, for messages.
pub fn shown(value: &Bound<'_, PyAny>) -> String {
    const MOST: usize = 60;
    let text = value.repr().map_or_else(|_| "this".to_owned(), |repr| repr.to_string());
    match text.char_indices().nth(MOST) {
        Some((at, _)) => format!("{}...", &text[..at]),
        None => text,
    }
}
