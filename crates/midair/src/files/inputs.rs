//! The files that work reads, which none of its outputs may replace.

use super::FileError;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The files that some work reads. Copies are the same list, so that all who read for one piece of work can add to it.
#[derive(Clone, Debug, Default)]
pub struct Inputs(Arc<Mutex<Vec<Identity>>>);

/// What a file is, whatever it is called.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Identity {
    /// Its place, with all links followed.
    real: PathBuf,
    /// Device and number of the file, which its hard links share.
    #[cfg(unix)]
    node: [u64; 2],
}

impl Identity {
    /// `None` where there is no such file.
    fn of(path: &Path) -> Option<Self> {
        let real = std::fs::canonicalize(path).ok()?;
        #[cfg(unix)]
        let node = {
            use std::os::unix::fs::MetadataExt as _;
            let metadata = std::fs::metadata(&real).ok()?;
            [metadata.dev(), metadata.ino()]
        };
        Some(Self {
            real,
            #[cfg(unix)]
            node,
        })
    }

    fn is(&self, other: &Self) -> bool {
        #[cfg(unix)]
        if self.node == other.node {
            return true;
        }
        self.real == other.real
    }
}

impl Inputs {
    /// Adds a file that is read. One that does not exist is nothing to lose.
    pub fn add(&self, path: &Path) {
        let Some(identity) = Identity::of(path) else { return };
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !known.contains(&identity) {
            known.push(identity);
        }
    }

    /// Refuses to write over a file that is read, under whichever name: symbolic and hard links are seen through.
    ///
    /// # Errors
    /// [`FileError::Unsupported`] that names `target`.
    pub fn spare(&self, target: &Path) -> Result<(), FileError> {
        let Some(identity) = Identity::of(target) else { return Ok(()) };
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if known.iter().any(|input| input.is(&identity)) {
            let problem = "this is an input as well, and would be overwritten";
            return Err(FileError::unsupported(target, problem, "give the output another name"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_is_known_under_all_its_names_and_others_are_not() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        std::fs::create_dir(at("folder")).unwrap();
        for name in ["read", "same bytes"] {
            std::fs::write(at(name), "x").unwrap();
        }
        let inputs = Inputs::default();
        inputs.add(&at("read"));
        inputs.add(&at("not there"));
        let mut names = vec!["read", "folder/../read"];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../read", at("folder/link")).unwrap();
            std::fs::hard_link(at("read"), at("hard")).unwrap();
            names.extend(["folder/link", "hard"]);
        }
        for name in names {
            let message = inputs.clone().spare(&at(name)).unwrap_err().to_string();
            assert!(message.contains(name) && message.contains("another name"), "{message}");
        }
        for name in ["same bytes", "not there", "folder/new"] {
            assert!(inputs.spare(&at(name)).is_ok(), "{name}");
        }
    }
}
