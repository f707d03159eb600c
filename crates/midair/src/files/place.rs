//! Moving a finished file to its place.

use std::io;
use std::path::{Path, PathBuf};

/// Moves a file over `target`, which is then there whole. A symbolic link stays one and leads to the new file; a file that is replaced hands its
/// permissions on.
pub(super) fn put(made: &Path, target: &Path) -> io::Result<()> {
    let real = end_of_links(target)?;
    if let Ok(old) = std::fs::metadata(&real) {
        std::fs::set_permissions(made, old.permissions())?;
    }
    match std::fs::rename(made, &real) {
        // A link may lead to another disk, where the file has to be made anew beside its place.
        Err(error) if error.kind() == io::ErrorKind::CrossesDevices => {
            let folder = real.parent().unwrap_or(Path::new("."));
            let near = tempfile::Builder::new().prefix(".midair-").tempfile_in(folder)?;
            std::fs::copy(made, near.path())?;
            near.persist(&real).map_err(|error| error.error)?;
            std::fs::remove_file(made)
        }
        done => done,
    }
}

/// Where symbolic links lead; the last one's target need not exist.
fn end_of_links(path: &Path) -> io::Result<PathBuf> {
    // As many as Linux follows.
    const MOST: usize = 40;
    let mut at = path.to_owned();
    for _ in 0..MOST {
        match std::fs::symlink_metadata(&at) {
            Ok(metadata) if metadata.is_symlink() => {
                let to = std::fs::read_link(&at)?;
                at = at.parent().unwrap_or(Path::new("")).join(to);
            }
            _ => return Ok(at),
        }
    }
    Err(io::Error::other("its symbolic links lead in a circle"))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::{PermissionsExt as _, symlink};

    #[test]
    fn links_stay_links_and_modes_stay() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        std::fs::create_dir(at("other")).unwrap();
        std::fs::write(at("other/old"), "old").unwrap();
        std::fs::set_permissions(at("other/old"), std::fs::Permissions::from_mode(0o640)).unwrap();
        symlink("other/old", at("link")).unwrap();
        symlink("link", at("second")).unwrap();
        symlink("other/none yet", at("dangling")).unwrap();
        for (target, real) in
            [("second", "other/old"), ("dangling", "other/none yet"), ("plain", "plain")]
        {
            std::fs::write(at("made"), "new").unwrap();
            put(&at("made"), &at(target)).unwrap();
            assert_eq!(std::fs::read_to_string(at(real)).unwrap(), "new");
            assert!(!at("made").exists());
        }
        assert_eq!(std::fs::metadata(at("other/old")).unwrap().permissions().mode() & 0o777, 0o640);
        for link in ["link", "second", "dangling"] {
            assert!(std::fs::symlink_metadata(at(link)).unwrap().is_symlink());
        }
        symlink("b", at("a")).unwrap();
        symlink("a", at("b")).unwrap();
        std::fs::write(at("made"), "new").unwrap();
        assert!(put(&at("made"), &at("a")).is_err());
    }
}
