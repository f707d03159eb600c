//! The library's errors as Python's exceptions.

use midair::{Error, Kind};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};

/// The exceptions: one for all, and one for each kind of error, which is Python's own as well.
struct Exceptions {
    all: Py<PyAny>,
    scene: Py<PyAny>,
    file: Py<PyAny>,
    content: Py<PyAny>,
    request: Py<PyAny>,
}

static EXCEPTIONS: PyOnceLock<Exceptions> = PyOnceLock::new();

fn exceptions(py: Python<'_>) -> PyResult<&Exceptions> {
    EXCEPTIONS.get_or_try_init(py, || {
        let builtin = |name: &str| py.import("builtins")?.getattr(name);
        let class =
            |name: &str, about: &str, bases: Vec<Bound<'_, PyAny>>| -> PyResult<Py<PyAny>> {
                let members = PyDict::new(py);
                members.set_item("__module__", "midair")?;
                members.set_item("__doc__", about)?;
                members.set_item("message", "")?;
                for member in ["file", "line", "remedy"] {
                    members.set_item(member, py.None())?;
                }
                let bases = PyTuple::new(py, bases)?;
                Ok(py.get_type::<PyType>().call1((name, bases, members))?.unbind())
            };
        let all = class(
            "Error",
            "What is wrong, with its place and what helps.",
            vec![builtin("Exception")?],
        )?;
        let kind = |name: &str, about: &str, base: &str| -> PyResult<Py<PyAny>> {
            class(name, about, vec![all.bind(py).clone(), builtin(base)?])
        };
        Ok(Exceptions {
            scene: kind("SceneError", "The description of a set-up is wrong.", "ValueError")?,
            file: kind("FileError", "A file cannot be read or written.", "OSError")?,
            content: kind(
                "ContentError",
                "A file is damaged, or of a kind that is not read.",
                "ValueError",
            )?,
            request: kind("RequestError", "What was asked for cannot be done.", "ValueError")?,
            all: all.clone_ref(py),
        })
    })
}

/// Puts the exceptions into the module.
pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let found = exceptions(module.py())?;
    for (name, exception) in [
        ("Error", &found.all),
        ("SceneError", &found.scene),
        ("FileError", &found.file),
        ("ContentError", &found.content),
        ("RequestError", &found.request),
    ] {
        module.add(name, exception)?;
    }
    Ok(())
}

/// An error of the library as an exception.
pub fn raised(py: Python<'_>, error: impl Into<Error>) -> PyErr {
    let error = error.into();
    exception(py, &error).unwrap_or_else(|failure| failure)
}

/// Something that cannot be done, and what helps.
pub fn refused(py: Python<'_>, message: impl Into<String>, remedy: impl Into<String>) -> PyErr {
    raised(py, Error::request(message, remedy))
}

/// What scenes are called in messages that come from no file.
pub const NO_FILE: &str = "scene";

fn exception(py: Python<'_>, error: &Error) -> PyResult<PyErr> {
    let kinds = exceptions(py)?;
    let class = match error.kind() {
        Kind::Scene => &kinds.scene,
        Kind::File => &kinds.file,
        Kind::Content => &kinds.content,
        Kind::Request => &kinds.request,
        _ => &kinds.all,
    };
    let told = |what: String, remedy: Option<&str>| match remedy {
        Some(remedy) => format!("{what}\n  help: {remedy}"),
        None => what,
    };
    let mut text = told(error.to_string(), error.remedy());
    for other in error.scene().iter().flat_map(|scene| scene.others.iter()) {
        text += &format!("\n{}", told(other.to_string(), Some(&other.help)));
    }
    let value = class.bind(py).call1((text,))?;
    let place = error.place();
    value.setattr("message", error.message())?;
    value.setattr("file", place.map(|place| &place.file).filter(|file| *file != NO_FILE))?;
    value.setattr("line", place.and_then(|place| place.line))?;
    value.setattr("remedy", error.remedy())?;
    Ok(PyErr::from_value(value))
}
