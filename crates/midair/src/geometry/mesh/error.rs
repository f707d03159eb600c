//! What is wrong with a mesh file: where, and what to do.

use thiserror::Error;

/// A mesh that cannot be used: the file, the place in it, what is wrong, the remedy.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{file}: {message}")]
pub struct MeshError {
    /// The file's name as it was given.
    pub file: String,
    /// What is wrong, with the face or line.
    pub message: String,
    /// What to do about it.
    pub help: String,
}

impl MeshError {
    pub(super) fn new(file: &str, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { file: file.to_owned(), message: message.into(), help: help.into() }
    }

    pub(super) fn format(file: &str) -> Self {
        Self::new(
            file,
            "the name does not end in a mesh format's extension",
            "use .obj, .stl, .ply, .off, .gltf or .glb",
        )
    }

    /// A file that does not follow its format.
    pub(super) fn syntax(file: &str, message: impl Into<String>) -> Self {
        Self::new(file, message, "the file is damaged or truncated: export it again")
    }

    /// A file that announces more than it holds.
    pub(super) fn claim(file: &str, claimed: u64, what: &str, bytes: usize) -> Self {
        Self::syntax(
            file,
            format!("announces {claimed} {what}, more than its {bytes} bytes can hold"),
        )
    }
}
