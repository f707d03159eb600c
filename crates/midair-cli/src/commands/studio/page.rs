//! The page's files, read once: what is served later is looked up by name in memory, so that no request reaches the disk.

use crate::failure::Failure;
use std::collections::BTreeMap;
use std::path::Path;

/// A file as it is served.
pub struct Served {
    pub kind: &'static str,
    pub bytes: Vec<u8>,
}

/// All files of the page, by their path in an address, such as `/assets/index.js`.
pub struct Page(BTreeMap<String, Served>);

/// A page of this size is none of ours.
const MOST_BYTES: u64 = 1 << 27;

impl Page {
    /// Reads a folder and those in it. Links are left out.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let mut files = BTreeMap::new();
        let mut left = MOST_BYTES;
        gather(folder, "", &mut files, &mut left).map_err(|error| {
            let message = format!("{}: cannot be read: {error}", folder.display());
            Failure::new(message, "name the folder of the page that `cargo xtask studio` builds")
        })?;
        let page = Self(files);
        if page.find("/").is_none() {
            return Err(Failure::new(
                format!("{}: there is no index.html in it", folder.display()),
                "name the folder of the page that `cargo xtask studio` builds",
            ));
        }
        Ok(page)
    }

    /// The file of an address' path; `/` is the page itself.
    pub fn find(&self, path: &str) -> Option<&Served> {
        self.0.get(if path == "/" { "/index.html" } else { path })
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }
}

fn gather(
    folder: &Path,
    above: &str,
    files: &mut BTreeMap<String, Served>,
    left: &mut u64,
) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let (kind, name) = (entry.file_type()?, entry.file_name());
        let Some(name) = name.to_str() else { continue };
        let path = format!("{above}/{name}");
        if kind.is_dir() {
            gather(&entry.path(), &path, files, left)?;
        } else if kind.is_file() {
            let size = entry.metadata()?.len();
            *left = left
                .checked_sub(size)
                .ok_or_else(|| std::io::Error::other("it holds more than 128 MiB"))?;
            let served = Served { kind: media_type(name), bytes: std::fs::read(entry.path())? };
            files.insert(path, served);
        }
    }
    Ok(())
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit('.').next().unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "svg" => "image/svg+xml",
        "json" => "application/json",
        "wasm" => "application/wasm",
        _ => "application/octet-stream",
    }
}
