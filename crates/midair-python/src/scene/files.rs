//! The files that a scene names: held in memory once they were read, so that a scene goes to other machines whole.

use crate::arrays::bytes;
use crate::error::refused;
use midair::scene::{Assets, Folder};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Files by name: given, or read from a folder and kept.
#[derive(Default)]
pub struct Files {
    folder: Option<Folder>,
    held: Mutex<BTreeMap<PathBuf, Vec<u8>>>,
}

impl Files {
    pub fn of_folder(folder: PathBuf) -> Self {
        Self { folder: Some(Folder(folder)), held: Mutex::default() }
    }

    /// Of a dict of bytes by name.
    pub fn of_bytes(files: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut held = BTreeMap::new();
        for (name, content) in files {
            let Some(content) = bytes(&content)? else {
                let message = format!("the file {name} is not given as bytes");
                return Err(refused(files.py(), message, "give a dict of bytes by name"));
            };
            held.insert(name.extract()?, content.as_bytes().to_vec());
        }
        Ok(Self { folder: None, held: Mutex::new(held) })
    }

    /// The files that were read so far.
    pub fn held<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, content) in self.lock().iter() {
            dict.set_item(name.to_string_lossy(), PyBytes::new(py, content))?;
        }
        Ok(dict)
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<PathBuf, Vec<u8>>> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Assets for Files {
    fn read(&self, name: &Path) -> io::Result<Vec<u8>> {
        if let Some(content) = self.lock().get(name) {
            return Ok(content.clone());
        }
        let Some(folder) = &self.folder else {
            let message = "no file of that name was given; files= takes a folder, or bytes by name";
            return Err(io::Error::new(io::ErrorKind::NotFound, message));
        };
        let content = folder.read(name)?;
        self.lock().insert(name.to_owned(), content.clone());
        Ok(content)
    }

    fn place(&self, name: &Path) -> PathBuf {
        self.folder.as_ref().map_or_else(|| name.to_owned(), |folder| folder.place(name))
    }
}
