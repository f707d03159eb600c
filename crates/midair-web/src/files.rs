//! The files that a scene names, and files that are taken away.

use midair::scene::InMemory;
use wasm_bindgen::prelude::*;

/// Files in memory, by name: meshes, pictures, tables, glasses.
#[wasm_bindgen]
#[derive(Clone, Default)]
pub struct Files(InMemory);

#[wasm_bindgen]
impl Files {
    /// None yet.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file, in the place of one of the same name.
    pub fn add(&mut self, name: String, bytes: Vec<u8>) {
        self.0 = std::mem::take(&mut self.0).with(name, bytes);
    }
}

impl Files {
    /// As the library asks for them.
    pub fn held(&self) -> &InMemory {
        &self.0
    }
}

/// A file to take away.
#[wasm_bindgen]
pub struct File {
    name: String,
    bytes: Vec<u8>,
}

#[wasm_bindgen]
impl File {
    /// What it is called.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.name.clone()
    }

    /// What it holds; once.
    pub fn take(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.bytes)
    }
}

impl File {
    pub(crate) fn new(name: &std::path::Path, bytes: &[u8]) -> Self {
        Self { name: name.display().to_string(), bytes: bytes.to_owned() }
    }
}
