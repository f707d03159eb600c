//! What can go wrong with a file, said so that it can be mended.

use std::io;
use std::path::{Path, PathBuf};

/// A file that could not be read or written: which, where in it, why, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The operating system refused.
    #[error("{}: cannot {doing}: {source}; {}", path.display(), io_remedy(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// What was being done, as an infinitive: `read`, `write`, `create`.
        doing: &'static str,
        /// The operating system's word.
        source: io::Error,
    },
    /// The file's content is not what it should be.
    #[error("{}: {place}: {problem}; {remedy}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Where in it: `header`, `channel R`, `line 3`.
        place: String,
        /// What is wrong there.
        problem: String,
        /// What the reader can do about it.
        remedy: String,
    },
    /// A map that holds pixels of its source, whose size nobody told.
    #[error("{}: this kind of map holds pixels of the picture, whose size is not known; give the picture's width and height in pixels", path.display())]
    SourceUnknown {
        /// The file.
        path: PathBuf,
    },
    /// What was asked for cannot be put in (or found in) a file of this kind.
    #[error("{}: {problem}; {remedy}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        problem: String,
        /// What the reader can do about it.
        remedy: String,
    },
}

impl FileError {
    /// An error of the operating system on `path`.
    pub fn io(path: &Path, doing: &'static str, source: io::Error) -> Self {
        Self::Io { path: path.to_owned(), doing, source }
    }

    /// The same error, of the file `path`: for one that had another name while it was made.
    pub(crate) fn of(mut self, name: &Path) -> Self {
        let (Self::Io { path, .. }
        | Self::Malformed { path, .. }
        | Self::SourceUnknown { path }
        | Self::Unsupported { path, .. }) = &mut self;
        *path = name.to_owned();
        self
    }

    /// The file.
    pub fn path(&self) -> &Path {
        let (Self::Io { path, .. }
        | Self::Malformed { path, .. }
        | Self::SourceUnknown { path }
        | Self::Unsupported { path, .. }) = self;
        path
    }

    /// Wrong content at `place` of `path`.
    pub fn malformed(
        path: &Path,
        place: impl Into<String>,
        problem: impl ToString,
        remedy: impl Into<String>,
    ) -> Self {
        Self::Malformed {
            path: path.to_owned(),
            place: place.into(),
            problem: problem.to_string(),
            remedy: remedy.into(),
        }
    }

    /// Something that a file like `path` cannot hold.
    pub fn unsupported(path: &Path, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Unsupported { path: path.to_owned(), problem: problem.into(), remedy: remedy.into() }
    }
}

/// What helps where the system refuses.
pub(crate) fn io_remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::NotFound => "check the path; its folder must exist",
        io::ErrorKind::PermissionDenied => "give yourself the permission or choose another folder",
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "free some disk space",
        io::ErrorKind::IsADirectory => "name a file, not a folder",
        io::ErrorKind::UnexpectedEof => "the file is cut short: copy or export it again",
        _ => "check the file, its folder and the disk",
    }
}
