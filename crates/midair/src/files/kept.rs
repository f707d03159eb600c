//! The pieces of long work, kept beside what they will become, so that it can be gone on with.

use super::output::check_place;
use super::{FileError, Inputs, place, write_bytes_atomically};
use std::ffi::OsString;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// A hidden folder of pieces, `.NAME.midair-pieces` beside the file NAME that they will become. It outlives an interruption. It belongs to one
/// program at a time: a second one is refused while the first lives.
#[derive(Debug)]
pub struct Kept {
    target: PathBuf,
    folder: PathBuf,
    inputs: Inputs,
    /// Whether an interrupted run of the same work is gone on with.
    pub resumed: bool,
    /// Held until the end.
    lock: Option<File>,
}

/// What says which work the pieces are of.
const RECORD: &str = "work.json";
const LOCK: &str = ".lock";

impl Kept {
    /// Begins work on `target`, or goes on with it where `resume` says so. `work` says all that makes two runs the same work. Pieces of other or
    /// earlier work are removed, unless they are to be gone on with.
    ///
    /// # Errors
    /// [`FileError`] where the folder cannot be written, another program is making the same file, or there is nothing to resume.
    pub fn begin(
        target: &Path,
        work: &str,
        resume: bool,
        inputs: &Inputs,
    ) -> Result<Self, FileError> {
        let mut hidden = OsString::from(".");
        hidden.push(target.file_name().unwrap_or_default());
        hidden.push(".midair-pieces");
        let folder = target.with_file_name(hidden);
        let known = || std::fs::read_to_string(folder.join(RECORD)).ok();
        let refused =
            |message: &str, remedy: &str| Err(FileError::unsupported(target, message, remedy));
        if resume && known().is_none() {
            return refused("there is nothing to go on with", "leave --resume out to begin");
        }
        let Some(lock) = Self::lock(&folder)? else {
            return refused(
                "another run is making it just now",
                "wait until it is done, or give this one another name",
            );
        };
        let resumed = resume && known().as_deref() == Some(work);
        if resume && !resumed {
            return refused(
                "what was interrupted was other work: the map, the input or an option has changed",
                "give the same command again, or leave --resume out to begin anew",
            );
        }
        let (target, inputs) = (target.to_owned(), inputs.clone());
        let kept = Self { target, folder, inputs, resumed, lock: Some(lock) };
        if !resumed {
            kept.clear()?;
            write_bytes_atomically(&kept.path(RECORD), work.as_bytes())?;
        }
        Ok(kept)
    }

    /// The folder made, and its lock if nobody holds it.
    fn lock(folder: &Path) -> Result<Option<File>, FileError> {
        let create = |error| FileError::io(folder, "create", error);
        // Another program may remove the folder, its work being done, between one step and the next.
        const TRIES: usize = 10;
        for _ in 0..TRIES {
            match std::fs::create_dir(folder) {
                Err(error) if error.kind() != std::io::ErrorKind::AlreadyExists => {
                    return Err(create(error));
                }
                _ => {}
            }
            let Ok(lock) = File::options().create(true).append(true).open(folder.join(LOCK)) else {
                continue;
            };
            match lock.try_lock() {
                Err(TryLockError::WouldBlock) => return Ok(None),
                // A file system without locks: as if alone.
                Err(TryLockError::Error(_)) => return Ok(Some(lock)),
                Ok(()) if folder.join(LOCK).exists() => return Ok(Some(lock)),
                Ok(()) => {}
            }
        }
        Err(create(std::io::ErrorKind::NotFound.into()))
    }

    /// Removes all pieces.
    fn clear(&self) -> Result<(), FileError> {
        let failed = |error| FileError::io(&self.folder, "remove", error);
        for entry in std::fs::read_dir(&self.folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            match path.is_dir() {
                _ if path.ends_with(LOCK) => Ok(()),
                true => std::fs::remove_dir_all(&path),
                false => std::fs::remove_file(&path),
            }
            .map_err(failed)?;
        }
        Ok(())
    }

    /// A file among the pieces.
    pub fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.folder.join(name)
    }

    /// Refuses a place that is no file's, or an input's.
    ///
    /// # Errors
    /// [`FileError::Unsupported`] that names `target`.
    pub fn claim(&self, target: &Path) -> Result<(), FileError> {
        check_place(target)?;
        self.inputs.spare(target)
    }

    /// Moves a complete piece to its place, as [`Output::publish`](super::Output::publish) does.
    ///
    /// # Errors
    /// [`FileError`] as [`Kept::claim`], or where the place cannot be written.
    pub fn publish(&self, name: impl AsRef<Path>, target: &Path) -> Result<(), FileError> {
        self.claim(target)?;
        place::put(&self.path(name), target).map_err(|error| FileError::io(target, "write", error))
    }

    /// Makes a file that is complete by itself and puts it in its place: `write` gets the path to write to.
    ///
    /// # Errors
    /// [`FileError`] as [`Kept::claim`], and those of `write`, with the file's final name.
    pub fn write(
        &self,
        target: &Path,
        write: impl FnOnce(&Path) -> Result<(), FileError>,
    ) -> Result<(), FileError> {
        let name = target.file_name().unwrap_or_default();
        write(&self.path(name)).map_err(|error| error.of(target))?;
        self.publish(name, target)
    }

    /// The work is done: the pieces go.
    ///
    /// # Errors
    /// [`FileError::Io`] where they cannot be removed.
    pub fn finish(mut self) -> Result<(), FileError> {
        // The lock goes last, and with it the folder: who waits for neither finds either.
        self.clear()?;
        let removed = std::fs::remove_dir_all(&self.folder);
        self.lock = None;
        removed.map_err(|error| FileError::io(&self.target, "remove the pieces of", error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_gone_on_with_if_it_is_the_same_and_nobody_is_at_it() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("film.mp4");
        let inputs = Inputs::default();
        let begin = |work: &str, resume: bool| Kept::begin(&target, work, resume, &inputs);
        let message = |result: Result<Kept, FileError>| result.unwrap_err().to_string();
        assert!(message(begin("a", true)).contains("nothing to go on with"));
        let first = begin("a", false).unwrap();
        std::fs::write(first.path("piece"), "1").unwrap();
        // Another program opens the lock anew, as this does.
        assert!(message(begin("a", false)).contains("another run"));
        assert!(message(begin("a", true)).contains("another run"));
        assert!(first.path("piece").exists());
        // Interrupted: the lock is given up, the pieces stay.
        drop(first);
        assert!(message(begin("b", true)).contains("other work"));
        let second = begin("a", true).unwrap();
        assert!(second.resumed && second.path("piece").exists());
        drop(second);
        let anew = begin("b", false).unwrap();
        assert!(!anew.resumed && !anew.path("piece").exists());
        std::fs::write(anew.path("done"), "film").unwrap();
        anew.publish("done", &target).unwrap();
        anew.finish().unwrap();
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "film");
        assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 1);
    }

    #[test]
    fn an_input_is_not_replaced_by_a_piece() {
        let place = tempfile::tempdir().unwrap();
        let (target, read) = (place.path().join("o.mp4"), place.path().join("i.mp4"));
        std::fs::write(&read, "in").unwrap();
        let inputs = Inputs::default();
        inputs.add(&read);
        let kept = Kept::begin(&target, "w", false, &inputs).unwrap();
        std::fs::write(kept.path("a"), "out").unwrap();
        assert!(kept.publish("a", &read).unwrap_err().to_string().contains("another name"));
        assert_eq!(std::fs::read_to_string(&read).unwrap(), "in");
    }
}
