//! What a scene is made of: a file, a text, or data.

use super::files::Files;
use crate::error::{NO_FILE, raised, refused};
use crate::setting::{plain, shown};
use midair::scene::{Format, scene_file_text};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::path::{Path, PathBuf};

/// A scene's text, what it is called in messages, and its files.
pub struct Source {
    pub text: String,
    pub name: String,
    pub format: Format,
    pub files: Files,
    /// Whether the text was made of data.
    pub is_data: bool,
}

impl Source {
    pub fn of(source: &Bound<'_, PyAny>, files: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let py = source.py();
        if let Ok(data) = source.cast::<PyDict>() {
            let text = format!("{:#}", plain(data.as_any())?);
            return Self::in_memory(text, Format::Json, files, true);
        }
        if let Ok(text) = source.cast::<PyString>() {
            let text = text.to_string();
            if text.trim_start().starts_with('{') {
                return Self::in_memory(text, Format::Json, files, true);
            }
            if text.contains('\n') {
                return Self::in_memory(text, Format::Toml, files, false);
            }
        }
        let path: PathBuf = source.extract().map_err(|_| {
            let message = format!("{} is no scene", shown(source));
            refused(py, message, "give the path of a scene file, its text, or a dict")
        })?;
        let text = scene_file_text(&path).map_err(|error| raised(py, error))?;
        let name = path.display().to_string();
        let format = Format::of_name(&name);
        let files = match files {
            Some(files) => given(files)?,
            None => Files::of_folder(path.parent().map(Path::to_path_buf).unwrap_or_default()),
        };
        Ok(Self { text, name, format, files, is_data: false })
    }

    fn in_memory(
        text: String,
        format: Format,
        files: Option<&Bound<'_, PyAny>>,
        is_data: bool,
    ) -> PyResult<Self> {
        let files = files.map(given).transpose()?.unwrap_or_default();
        Ok(Self { text, name: NO_FILE.to_owned(), format, files, is_data })
    }
}

fn given(files: &Bound<'_, PyAny>) -> PyResult<Files> {
    match files.cast::<PyDict>() {
        Ok(files) => Files::of_bytes(files),
        Err(_) => Ok(Files::of_folder(files.extract()?)),
    }
}
