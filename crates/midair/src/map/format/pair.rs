//! Formats that come in two files: their names, and finding one by the other.

use super::{Fetch, FileError, fetched};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// A file with its bytes.
pub(super) type Found = (PathBuf, Vec<u8>);

/// What tells the two files of a pair apart, the likelier first.
const TWINS: [&[[char; 2]]; 3] =
    [&[['x', 'y'], ['X', 'Y']], &[['u', 'v'], ['U', 'V']], &[['1', '2'], ['0', '1']]];

/// The files of x and of y, by the name that they share, by one of them, or by both with a comma between.
///
/// Other tools call theirs `xmap` and `ymap`, `map_x` and `map_y`, `map1` and `map2`: of a file that is there, the twin is the one whose name differs
/// in such a letter only.
pub(super) fn find(path: &Path, fetch: &Fetch<'_>) -> Result<[Found; 2], FileError> {
    let own = x_and_y(path);
    let both = |[x, y]: [PathBuf; 2]| -> Result<[Found; 2], FileError> {
        let (a, b) = (fetched(&x, fetch)?, fetched(&y, fetch)?);
        Ok([(x, a), (y, b)])
    };
    let there = fetch(path);
    if there.is_err()
        && let Some((x, y)) = path.to_str().and_then(|text| text.split_once(','))
    {
        return both([x, y].map(|name| PathBuf::from(name.trim())));
    }
    let named = both(own);
    let Ok(bytes) = there else { return named };
    if let Ok(pair) = named {
        return Ok(pair);
    }
    for letters in TWINS {
        let mut twins = twins(path, letters);
        twins.retain(|(twin, _)| fetch(twin).is_ok());
        match &twins[..] {
            [] => {}
            [(twin, second)] => {
                let other = (twin.clone(), fetched(twin, fetch)?);
                let this = (path.to_owned(), bytes);
                return Ok(if *second { [this, other] } else { [other, this] });
            }
            [(a, _), (b, _), ..] => {
                let problem =
                    format!("it has more than one twin: {} and {}", a.display(), b.display());
                return Err(FileError::unsupported(path, problem, BOTH));
            }
        }
    }
    let [x, y] = x_and_y(path);
    let problem = format!(
        "one file holds x, another y, and there is none that differs from it in an x or y only, nor {} with {}",
        x.display(),
        y.display()
    );
    Err(FileError::unsupported(path, problem, BOTH))
}

const BOTH: &str = "name both with a comma between, that of x first: x.pgm,y.pgm";

/// Names that differ from a file's in one of these letters, and whether they are the second of the two.
fn twins(path: &Path, letters: &[[char; 2]]) -> Vec<(PathBuf, bool)> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut found = Vec::new();
    for (at, letter) in stem.char_indices() {
        for [first, second] in letters {
            let twin = match letter {
                c if c == *first => (*second, true),
                c if c == *second => (*first, false),
                _ => continue,
            };
            let after = &stem[at + letter.len_utf8()..];
            found.push((with_stem(path, &format!("{}{}{after}", &stem[..at], twin.0)), twin.1));
        }
    }
    found
}

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

    /// The pair found for a name among files that are there; each file's content is its name.
    fn found(path: &str, files: &[&str]) -> Result<[String; 2], String> {
        let fetch = |path: &Path| {
            let name = path.to_str().unwrap_or_default();
            let there = files.contains(&name);
            there.then(|| name.into()).ok_or_else(|| std::io::ErrorKind::NotFound.into())
        };
        let pair = find(Path::new(path), &fetch).map_err(|error| error.to_string())?;
        Ok(pair.map(|(path, bytes)| {
            assert_eq!(path.to_str().unwrap().as_bytes(), bytes);
            path.to_str().unwrap().to_owned()
        }))
    }

    #[test]
    fn twins_of_other_names_are_found() {
        for [x, y] in [
            ["m_x.pgm", "m_y.pgm"],
            ["xmap.pgm", "ymap.pgm"],
            ["a/mapX.npy", "a/mapY.npy"],
            ["map1.npy", "map2.npy"],
            ["matrix_x.pgm", "matrix_y.pgm"],
            ["map1_x.npy", "map1_y.npy"],
        ] {
            let files = [x, y, "map2_x.npy", "other.pgm"];
            let expected = Ok([x.to_owned(), y.to_owned()]);
            for path in [x, y, &format!("{x},{y}")] {
                assert_eq!(found(path, &files), expected, "{path}");
            }
        }
        assert_eq!(
            found("columns.pgm,rows.pgm", &["columns.pgm", "rows.pgm"]),
            Ok(["columns.pgm", "rows.pgm"].map(str::to_owned))
        );
        assert!(found("xx.pgm", &["xx.pgm", "xy.pgm", "yx.pgm"]).unwrap_err().contains("twin"));
        assert!(found("a.pgm", &["a.pgm", "b.pgm"]).unwrap_err().contains("comma"));
        assert!(found("m.pgm", &["a.pgm"]).unwrap_err().contains("m_x.pgm"));
    }

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
