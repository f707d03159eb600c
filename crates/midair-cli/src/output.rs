//! Files that appear together, at the end, or not at all.

use crate::failure::Failure;
use midair::map::format::FileError;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use tempfile::TempDir;

/// Folders to remove if the program is interrupted.
static STAGING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Whether work is under way that keeps what it has when it is interrupted.
static STOPPABLE: AtomicBool = AtomicBool::new(false);
/// Whether it was.
static STOP: AtomicBool = AtomicBool::new(false);

/// What a shell reports for a program ended by an interrupt.
pub const INTERRUPTED: u8 = 130;

/// The flag that an interrupt sets from now on, for work that watches it and keeps what it has. A second interrupt
/// ends the program.
pub fn stop_on_interrupt() -> &'static AtomicBool {
    STOPPABLE.store(true, Ordering::SeqCst);
    &STOP
}

/// Whether the work is to stop.
pub fn is_stopped() -> bool {
    STOP.load(Ordering::SeqCst)
}

/// What is said if the program is interrupted.
static FAREWELL: Mutex<Option<&'static str>> = Mutex::new(None);

/// Has an interrupt say something.
pub fn on_interrupt_say(farewell: &'static str) {
    if let Ok(mut text) = FAREWELL.lock() {
        *text = Some(farewell);
    }
}

/// On Ctrl-C (and on a request to end) unfinished files are removed before the program ends.
pub fn clean_up_on_interrupt() {
    // If no handler can be set an interrupt leaves a hidden folder behind, which harms nobody.
    let _ = ctrlc::set_handler(|| {
        if STOPPABLE.load(Ordering::SeqCst) && !STOP.swap(true, Ordering::SeqCst) {
            return;
        }
        let staging = STAGING.lock().map(|mut folders| std::mem::take(&mut *folders));
        for folder in staging.unwrap_or_default() {
            let _ = std::fs::remove_dir_all(&folder);
            // Removes the output folder only while it is empty: made by us, for nothing.
            let _ = folder.parent().map(std::fs::remove_dir);
        }
        if let Ok(Some(farewell)) = FAREWELL.lock().map(|text| *text) {
            // A closed standard error is no reason to stay.
            let _ = writeln!(std::io::stderr(), "\n{farewell}");
        }
        std::process::exit(INTERRUPTED.into());
    });
}

/// Files being made for a folder.
#[derive(Debug)]
pub struct Output {
    folder: PathBuf,
    /// A hidden folder inside, so that moving a file out of it cannot fail half-way.
    staging: TempDir,
    /// The folders that had to be made, innermost first.
    made: Vec<PathBuf>,
    files: Vec<PathBuf>,
}

impl Output {
    /// Files for a folder, which is made if need be.
    pub fn into_folder(folder: &Path) -> Result<Self, Failure> {
        let made: Vec<PathBuf> = folder
            .ancestors()
            .take_while(|part| !part.as_os_str().is_empty() && !part.exists())
            .map(Path::to_path_buf)
            .collect();
        let create = |error| Failure::from(FileError::io(folder, "create", error));
        std::fs::create_dir_all(folder).map_err(create)?;
        let place = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let staging =
            tempfile::Builder::new().prefix(".midair-").tempdir_in(place).map_err(|error| {
                made.iter().for_each(|part| drop(std::fs::remove_dir(part)));
                create(error)
            })?;
        if let Ok(mut folders) = STAGING.lock() {
            folders.push(staging.path().to_owned());
        }
        Ok(Self { folder: folder.to_owned(), staging, made, files: Vec::new() })
    }

    /// One file: as [`Output::into_folder`] with its folder, which must exist. Returns the file's name as well.
    pub fn of_file(path: &Path) -> Result<(Self, String), Failure> {
        let name = path.file_name().and_then(|name| name.to_str()).filter(|_| !path.is_dir());
        let Some(name) = name else {
            let message = format!("{}: this is not the name of a file", path.display());
            return Err(Failure::new(message, "name a file, not a folder"));
        };
        if path.exists() && !path.is_file() {
            let message = format!("{}: this is not an ordinary file", path.display());
            return Err(Failure::new(message, "name a file that may be replaced"));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        if !folder.as_os_str().is_empty() && !folder.is_dir() {
            let message = format!("{}: its folder does not exist", path.display());
            return Err(Failure::new(message, "make the folder, or choose another"));
        }
        Ok((Self::into_folder(folder)?, name.to_owned()))
    }

    /// Makes a file: `write` gets the path to write to. Further files that it writes beside it come along.
    pub fn write<T>(
        &mut self,
        name: &str,
        write: impl FnOnce(&Path) -> Result<T, FileError>,
    ) -> Result<T, Failure> {
        let made = write(&self.staging.path().join(name)).map_err(|error| self.renamed(error))?;
        let target = self.folder.join(name);
        if !self.files.contains(&target) {
            self.files.push(target);
        }
        Ok(made)
    }

    /// Where a file of this name is to be written by someone else; it comes along with the others.
    pub fn path(&self, name: &str) -> PathBuf {
        self.staging.path().join(name)
    }

    /// An error with the file's final name, not the one it has meanwhile.
    fn renamed(&self, error: FileError) -> FileError {
        let real = |path: PathBuf| match path.strip_prefix(self.staging.path()) {
            Ok(name) => self.folder.join(name),
            Err(_) => path,
        };
        match error {
            FileError::Io { path, doing, source } => {
                FileError::Io { path: real(path), doing, source }
            }
            FileError::Malformed { path, place, problem, remedy } => {
                FileError::Malformed { path: real(path), place, problem, remedy }
            }
            FileError::SourceUnknown { path } => FileError::SourceUnknown { path: real(path) },
            FileError::Unsupported { path, problem, remedy } => {
                FileError::Unsupported { path: real(path), problem, remedy }
            }
        }
    }

    /// Puts all files in their place and names them, those asked for first.
    pub fn finish(mut self) -> Result<Vec<PathBuf>, Failure> {
        self.publish()?;
        self.made.clear();
        // A name that stands for a pair of files is none itself.
        self.files.retain(|file| file.exists());
        Ok(std::mem::take(&mut self.files))
    }

    /// Puts the files that are made so far in their place; made again, they replace these.
    pub fn publish(&mut self) -> Result<(), Failure> {
        let read = |error| FileError::io(&self.folder, "write", error);
        let entries = std::fs::read_dir(self.staging.path()).map_err(read)?;
        let names = entries.map(|entry| Ok(entry.map_err(read)?.file_name()));
        let mut names = names.collect::<Result<Vec<_>, Failure>>()?;
        names.sort();
        for name in names {
            let target = self.folder.join(&name);
            std::fs::rename(self.staging.path().join(&name), &target)
                .map_err(|error| FileError::io(&target, "write", error))?;
            if !self.files.contains(&target) {
                self.files.push(target);
            }
        }
        Ok(())
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        let staging = self.staging.path();
        let _ = std::fs::remove_dir_all(staging);
        if let Ok(mut folders) = STAGING.lock() {
            folders.retain(|folder| folder != staging);
        }
        // Only while they are empty.
        self.made.iter().for_each(|folder| drop(std::fs::remove_dir(folder)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use midair::map::format::write_bytes_atomically;

    #[test]
    fn files_appear_at_the_end_together() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("a/b");
        let mut output = Output::into_folder(&folder).unwrap();
        output.write("one", |path| write_bytes_atomically(path, b"1")).unwrap();
        assert!(!folder.join("one").exists());
        let files = output.finish().unwrap();
        assert_eq!(files, [folder.join("one")]);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    }

    #[test]
    fn what_is_published_is_there_and_can_be_made_again() {
        let place = tempfile::tempdir().unwrap();
        let (mut output, name) = Output::of_file(&place.path().join("one")).unwrap();
        let read = || std::fs::read(place.path().join("one")).unwrap();
        output.write(&name, |path| write_bytes_atomically(path, b"1")).unwrap();
        output.publish().unwrap();
        assert_eq!(read(), b"1");
        output.write(&name, |path| write_bytes_atomically(path, b"2")).unwrap();
        assert_eq!(read(), b"1");
        assert_eq!(output.finish().unwrap(), [place.path().join("one")]);
        assert_eq!(read(), b"2");
        assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failure_leaves_nothing_and_names_the_file() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("a/b");
        let mut output = Output::into_folder(&folder).unwrap();
        output.write("one", |path| write_bytes_atomically(path, b"1")).unwrap();
        let failed = output.write("two", |path| -> Result<(), _> {
            Err(FileError::unsupported(path, "stop", "go on"))
        });
        let message = failed.unwrap_err().to_string();
        assert!(message.contains("a/b/two") && !message.contains(".midair"), "{message}");
        drop(output);
        assert!(!place.path().join("a").exists());
    }

    #[test]
    fn folders_and_devices_are_not_files() {
        let place = tempfile::tempdir().unwrap();
        assert!(Output::of_file(place.path()).is_err());
        assert!(Output::of_file(&place.path().join("none/x.png")).is_err());
        #[cfg(unix)]
        assert!(Output::of_file(Path::new("/dev/null")).is_err());
    }
}
