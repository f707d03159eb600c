//! What tests read, kept as the beginning of the fuzzer's corpus.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::PathBuf;

/// The environment variable that names the folder for it, with a folder in it for each of the fuzzer's targets; unset, nothing is kept.
pub const CORPUS: &str = "MIDAIR_CORPUS";

/// Keeps an input of the fuzzer's target `target`, made of `parts`: its first byte says there how the rest is read.
///
/// # Panics
/// Where the folder cannot be written.
pub fn keep(target: &str, parts: &[&[u8]]) {
    let Some(folder) = std::env::var_os(CORPUS) else { return };
    let input = parts.concat();
    let mut hasher = DefaultHasher::new();
    input.hash(&mut hasher);
    let folder = PathBuf::from(folder).join(target);
    let file = folder.join(format!("{:016x}", hasher.finish()));
    let written = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&file, input));
    written.unwrap_or_else(|error| panic!("{}: {error}", file.display()));
}

/// Keeps a map of one file or two: the number of its format, and between the two how long the first is.
///
/// # Panics
/// As [`keep`].
pub fn keep_map(format: u8, file: &[u8], twin: Option<&[u8]>) {
    let length = (file.len() as u32).to_le_bytes();
    match twin {
        Some(twin) => keep("maps", &[&[format], &length[..3], file, twin]),
        None => keep("maps", &[&[format], file]),
    }
}
