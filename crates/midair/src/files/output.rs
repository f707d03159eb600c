//! Files that appear together, at the end, or not at all.

use super::staging::Staging;
use super::{FileError, Inputs, place};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Files being made for a folder. Those that are not published when it is dropped are gone.
#[derive(Debug)]
pub struct Output {
    folder: PathBuf,
    staging: Staging,
    inputs: Inputs,
    /// The folders that had to be made, innermost first.
    made: Vec<PathBuf>,
    files: Vec<PathBuf>,
}

impl Output {
    /// Files for a folder, which is made if need be; none of them will replace one of the inputs.
    ///
    /// # Errors
    /// [`FileError::Io`] where nothing can be written there.
    pub fn into_folder(folder: &Path, inputs: &Inputs) -> Result<Self, FileError> {
        let made: Vec<PathBuf> = folder
            .ancestors()
            .take_while(|part| !part.as_os_str().is_empty() && !part.exists())
            .map(Path::to_path_buf)
            .collect();
        let create = |error| FileError::io(folder, "create", error);
        std::fs::create_dir_all(folder).map_err(create)?;
        let place = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let staging = Staging::inside(place).map_err(|error| {
            made.iter().for_each(|part| drop(std::fs::remove_dir(part)));
            create(error)
        })?;
        let (folder, inputs) = (folder.to_owned(), inputs.clone());
        Ok(Self { folder, staging, inputs, made, files: Vec::new() })
    }

    /// One file: as [`Output::into_folder`] with its folder, which must exist. Returns the file's name as well.
    ///
    /// # Errors
    /// [`FileError`] where `path` is no place for a file, or is one of the inputs.
    pub fn of_file(path: &Path, inputs: &Inputs) -> Result<(Self, OsString), FileError> {
        check_place(path)?;
        let Some(name) = path.file_name() else {
            let problem = "this is not the name of a file";
            return Err(FileError::unsupported(path, problem, "name a file, not a folder"));
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        if !folder.as_os_str().is_empty() && !folder.is_dir() {
            let problem = "its folder does not exist";
            return Err(FileError::unsupported(
                path,
                problem,
                "make the folder, or choose another",
            ));
        }
        inputs.spare(path)?;
        Ok((Self::into_folder(folder, inputs)?, name.to_owned()))
    }

    /// Says that a file of this name will be made: for work that takes long, so that what cannot be is refused before it.
    ///
    /// # Errors
    /// [`FileError::Unsupported`] where the name is taken by an input, a folder or a device.
    pub fn claim(&self, name: impl AsRef<Path>) -> Result<(), FileError> {
        let target = self.folder.join(name);
        check_place(&target)?;
        self.inputs.spare(&target)
    }

    /// Makes a file: `write` gets the path to write to. Further files that it writes beside it come along.
    ///
    /// # Errors
    /// Those of [`Output::claim`] and of `write`, with the file's final name.
    pub fn write<T>(
        &mut self,
        name: impl AsRef<Path>,
        write: impl FnOnce(&Path) -> Result<T, FileError>,
    ) -> Result<T, FileError> {
        self.claim(&name)?;
        let made = write(&self.path(&name)).map_err(|error| self.renamed(error))?;
        let target = self.folder.join(name);
        if !self.files.contains(&target) {
            self.files.push(target);
        }
        Ok(made)
    }

    /// Where a file of this name is to be written by someone else; it comes along with the others.
    pub fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.staging.path().join(name)
    }

    /// An error with the file's final name, not the one it has meanwhile.
    fn renamed(&self, error: FileError) -> FileError {
        match error.path().strip_prefix(self.staging.path()).map(|name| self.folder.join(name)) {
            Ok(name) => error.of(&name),
            Err(_) => error,
        }
    }

    /// Puts all files in their place and names them, those asked for first.
    ///
    /// # Errors
    /// As [`Output::publish`].
    pub fn finish(mut self) -> Result<Vec<PathBuf>, FileError> {
        self.publish()?;
        self.made.clear();
        // A name that stands for a pair of files is none itself.
        self.files.retain(|file| file.exists());
        Ok(std::mem::take(&mut self.files))
    }

    /// Puts the files that are made so far in their place; made again, they replace these. A symbolic link that is in the place stays one, and a
    /// file that is replaced hands its permissions on.
    ///
    /// # Errors
    /// [`FileError`] where a file's place is taken by an input, a folder or a device, or cannot be written.
    pub fn publish(&mut self) -> Result<(), FileError> {
        let read = |error| FileError::io(&self.folder, "write", error);
        let names = self.staging.names().map_err(read)?;
        // All or none.
        names.iter().try_for_each(|name| self.claim(name))?;
        for name in names {
            let target = self.folder.join(&name);
            place::put(&self.path(&name), &target)
                .map_err(|error| FileError::io(&target, "write", error))?;
            if !self.files.contains(&target) {
                self.files.push(target);
            }
        }
        Ok(())
    }
}

/// Refuses folders and devices as places for a file.
pub(super) fn check_place(path: &Path) -> Result<(), FileError> {
    if path.is_dir() {
        let problem = "this is not the name of a file";
        return Err(FileError::unsupported(path, problem, "name a file, not a folder"));
    }
    if path.exists() && !path.is_file() {
        let problem = "this is not an ordinary file";
        return Err(FileError::unsupported(path, problem, "name a file that may be replaced"));
    }
    Ok(())
}

impl Drop for Output {
    fn drop(&mut self) {
        self.staging.clear();
        // Only while they are empty.
        self.made.iter().for_each(|folder| drop(std::fs::remove_dir(folder)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::write_bytes_atomically;

    #[test]
    fn files_appear_at_the_end_together() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("a/b");
        let mut output = Output::into_folder(&folder, &Inputs::default()).unwrap();
        output.write("one", |path| write_bytes_atomically(path, b"1")).unwrap();
        assert!(!folder.join("one").exists());
        let files = output.finish().unwrap();
        assert_eq!(files, [folder.join("one")]);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    }

    #[test]
    fn what_is_published_is_there_and_can_be_made_again() {
        let place = tempfile::tempdir().unwrap();
        let (mut output, name) =
            Output::of_file(&place.path().join("one"), &Inputs::default()).unwrap();
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
        let mut output = Output::into_folder(&folder, &Inputs::default()).unwrap();
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
        assert!(Output::of_file(place.path(), &Inputs::default()).is_err());
        assert!(Output::of_file(&place.path().join("none/x.png"), &Inputs::default()).is_err());
        #[cfg(unix)]
        assert!(Output::of_file(Path::new("/dev/null"), &Inputs::default()).is_err());
    }
}
