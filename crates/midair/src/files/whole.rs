//! Files that are there whole or not at all.

use super::{FileError, place};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes a file by way of a temporary one beside it, which is renamed over `path` only after
/// everything was written and flushed: a reader never sees half a file, and a failure leaves
/// what was there before. Where `path` is a symbolic link it stays one, and a file that is replaced hands its permissions on.
///
/// # Errors
/// Whatever `fill` returns, or [`FileError::Io`] where the folder is missing, not writable or full.
pub fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> Result<(), FileError>,
) -> Result<(), FileError> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if path.is_dir() {
        let error = std::io::Error::from(std::io::ErrorKind::IsADirectory);
        return Err(FileError::io(path, "write", error));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".midair-").suffix(".tmp");
    // A temporary file is private by default; the result should have an ordinary file's mode.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let temporary =
        builder.tempfile_in(folder).map_err(|error| FileError::io(path, "create", error))?;
    // Removed when it goes out of sight, unless it has been moved to its place.
    let (file, temporary) = temporary.into_parts();
    let mut writer = BufWriter::with_capacity(1 << 16, file);
    fill(&mut writer)?;
    writer.flush().map_err(|error| FileError::io(path, "write", error))?;
    drop(writer);
    place::put(&temporary, path).map_err(|error| FileError::io(path, "write", error))
}

/// Writes `bytes` as [`write_atomically`] does.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_bytes_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_atomically(path, |writer| {
        writer.write_all(bytes).map_err(|error| FileError::io(path, "write", error))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        write_bytes_atomically(&path, b"old").unwrap();
        let result = write_atomically(&path, |writer| {
            writer.write_all(b"half").unwrap();
            Err(FileError::unsupported(&path, "stop", "go on"))
        });
        assert!(result.is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_and_a_folder_in_the_way_are_errors_that_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("none/a.bin");
        let message = write_bytes_atomically(&missing, b"x").unwrap_err().to_string();
        assert!(message.contains("none/a.bin") && message.contains("folder must exist"));
        let message = write_bytes_atomically(folder.path(), b"x").unwrap_err().to_string();
        assert!(message.contains("name a file"), "{message}");
    }

    #[cfg(unix)]
    #[test]
    fn a_written_file_has_an_ordinary_mode() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (ours, ordinary) = (folder.path().join("a"), folder.path().join("b"));
        write_bytes_atomically(&ours, b"x").unwrap();
        std::fs::write(&ordinary, b"x").unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&ordinary));
    }
}
