//! Hidden folders in which files are made, and what becomes of those that a killed program left.

use std::ffi::OsStr;
use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::TempDir;

/// How the hidden folders' names begin.
const PREFIX: &str = ".midair-";
/// A file inside that is locked for as long as the program that made the folder lives.
const LOCK: &str = ".lock";

/// The hidden folders of this program.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes all files that this program has begun and not finished: for a program about to end by a signal, whose destructors do not run.
/// Folders that were made for them go as well, if nothing else is in them.
pub fn remove_unfinished() {
    let folders = std::mem::take(&mut *UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner));
    for folder in folders {
        // What cannot be removed now the next run removes.
        let _ = std::fs::remove_dir_all(&folder);
        let _ = folder.parent().map(std::fs::remove_dir);
    }
}

/// A hidden folder, removed with all that is in it when it is dropped.
#[derive(Debug)]
pub(super) struct Staging {
    folder: TempDir,
    lock: Option<File>,
}

impl Staging {
    /// Makes a hidden folder inside `folder`, so that moving a file out of it cannot fail half-way. What killed programs left there is removed.
    pub(super) fn inside(folder: &Path) -> io::Result<Self> {
        sweep(folder);
        let made = tempfile::Builder::new().prefix(PREFIX).tempdir_in(folder)?;
        // The lock gets its name only once it is held: an unlocked one tells of a killed program.
        let new = made.path().join(".unlocked");
        let lock = File::create(&new)?;
        // Some network file systems cannot lock. Then nothing is swept away there, and nothing else is lost.
        let held = lock.try_lock().is_ok();
        if held {
            std::fs::rename(&new, made.path().join(LOCK))?;
        } else {
            std::fs::remove_file(&new)?;
        }
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).push(made.path().to_owned());
        Ok(Self { folder: made, lock: held.then_some(lock) })
    }

    pub(super) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The names of the files made so far, in order.
    pub(super) fn names(&self) -> io::Result<Vec<std::ffi::OsString>> {
        let entries = std::fs::read_dir(self.path())?;
        let names = entries.map(|entry| Ok(entry?.file_name())).collect::<io::Result<Vec<_>>>()?;
        let mut names: Vec<_> = names.into_iter().filter(|name| name != OsStr::new(LOCK)).collect();
        names.sort();
        Ok(names)
    }
}

impl Staging {
    /// Removes the folder and all that is in it.
    pub(super) fn clear(&mut self) {
        // Systems that keep open files from being removed want it closed.
        self.lock = None;
        let _ = std::fs::remove_dir_all(self.folder.path());
        let own = self.folder.path();
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).retain(|folder| folder != own);
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        self.clear();
    }
}

/// Removes the hidden folders of programs that live no more.
fn sweep(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let ours = entry.file_name().to_str().is_some_and(|name| name.starts_with(PREFIX));
        if !ours || !entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            continue;
        }
        let Ok(lock) = File::options().write(true).open(entry.path().join(LOCK)) else { continue };
        match lock.try_lock() {
            // Held until they are gone, so that two programs do not remove them at once.
            Ok(()) => drop(std::fs::remove_dir_all(entry.path())),
            Err(TryLockError::WouldBlock | TryLockError::Error(_)) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_program_left_is_removed_and_what_a_living_one_makes_is_not() {
        let place = tempfile::tempdir().unwrap();
        let living = Staging::inside(place.path()).unwrap();
        std::fs::write(living.path().join("a"), "half").unwrap();
        // A killed program's locks are gone with it.
        let left = place.path().join(".midair-killed");
        std::fs::create_dir(&left).unwrap();
        for name in [LOCK, "b"] {
            std::fs::write(left.join(name), "half").unwrap();
        }
        // A folder that is being made, and one that only looks like ours.
        let (young, other) = (place.path().join(".midair-young"), place.path().join("midair"));
        for folder in [&young, &other] {
            std::fs::create_dir(folder).unwrap();
        }
        std::fs::write(other.join(LOCK), "").unwrap();
        let next = Staging::inside(place.path()).unwrap();
        assert!(!left.exists() && young.exists() && other.exists());
        assert_eq!(living.names().unwrap(), ["a"]);
        drop((living, next));
        let mut names: Vec<_> = std::fs::read_dir(place.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        names.sort();
        assert_eq!(names, [".midair-young", "midair"]);
    }
}
