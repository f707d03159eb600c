//! In the place of MPCDI files where the library was built without them.

use super::{FileError, LoadedMap, Put};
use crate::map::Map;
use std::path::Path;

pub(super) fn write(_: &Map, _: [usize; 2], path: &Path, _: &mut Put<'_>) -> Result<(), FileError> {
    Err(absent(path))
}

pub(super) fn read(path: &Path, _: &[u8], _: Option<&str>) -> Result<LoadedMap, FileError> {
    Err(absent(path))
}

fn absent(path: &Path) -> FileError {
    let problem = "this build knows no MPCDI files";
    FileError::unsupported(
        path,
        problem,
        "build midair with its feature `mpcdi`, or take another format",
    )
}
