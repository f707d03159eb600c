//! Names of formats that come in two files.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// `NAME_x.EXT` and `NAME_y.EXT` for `NAME.EXT`, or for either of the two themselves.
pub(super) fn x_and_y(path: &Path) -> [PathBuf; 2] {
    let name = name(path);
    ["_x", "_y"].map(|suffix| with_stem(path, &format!("{name}{suffix}")))
}

/// `NAME_coverage.png` for any of them.
pub(super) fn coverage(path: &Path) -> PathBuf {
    path.with_file_name(format!("{}_coverage.png", name(path)))
}

fn name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    stem.strip_suffix("_x").or(stem.strip_suffix("_y")).unwrap_or(&stem).to_owned()
}

/// `status.npy` for `map.npy`: "status" in the place of the name's last "map", or appended.
pub(super) fn status(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let name = match stem.rfind("map") {
        Some(at) => format!("{}status{}", &stem[..at], &stem[at + 3..]),
        None => format!("{stem}-status"),
    };
    with_stem(path, &name)
}

fn with_stem(path: &Path, stem: &str) -> PathBuf {
    let mut name = OsString::from(stem);
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_derived_and_found_again() {
        let expected = [PathBuf::from("a/m_x.pgm"), PathBuf::from("a/m_y.pgm")];
        for name in ["a/m.pgm", "a/m_x.pgm", "a/m_y.pgm"] {
            assert_eq!(x_and_y(Path::new(name)), expected);
            assert_eq!(coverage(Path::new(name)), Path::new("a/m_coverage.png"));
        }
        assert_eq!(status(Path::new("a/map.npy")), Path::new("a/status.npy"));
        assert_eq!(status(Path::new("g.npy")), Path::new("g-status.npy"));
        assert_eq!(status(Path::new("map-left.npy")), Path::new("status-left.npy"));
    }
}
