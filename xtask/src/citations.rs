//! What the sources say of the repository: documents that they cite are in it.

use crate::root;
use std::path::{Path, PathBuf};

/// Folders that people write in.
const FOLDERS: [&str; 6] = [".ci", "crates", "docs", "scenes", "xtask", "blender"];

/// Kinds of text files.
const KINDS: [&str; 7] = ["rs", "md", "toml", "py", "wgsl", "txt", "sh"];

/// All text files, relative to the root.
fn sources() -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(root()).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_file() {
            files.push(path);
        }
    }
    for folder in FOLDERS {
        walk(&root().join(folder), &mut files);
    }
    files.retain(|path| {
        path.extension().and_then(|e| e.to_str()).is_some_and(|e| KINDS.contains(&e))
    });
    files.sort();
    files
}

fn walk(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        if path.is_dir() {
            if !["target", "node_modules", "__pycache__"].iter().any(|other| name == *other) {
                walk(&path, files);
            }
        } else {
            files.push(path);
        }
    }
}

/// Words of letters, digits and what paths are written with.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let part_of_path = |c: char| c.is_ascii_alphanumeric() || "._-/".contains(c);
    line.split(move |c| !part_of_path(c)).filter(|word| !word.is_empty())
}

/// A document that is cited by its bare name, without the ending, would be a word in capitals.
const NAMES_OF_OTHERS: [&str; 5] = ["DESIGN", "SCENE", "STYLE", "FIELD", "REFERENCES"];

/// What a line of a file cites that is not in the repository.
fn missing<'a>(file: &Path, line: &'a str) -> Vec<&'a str> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let there = |word: &str| {
        let word = word.trim_start_matches('/');
        root().join(word).exists() || folder.join(word).exists()
    };
    let cited = |word: &&str| {
        let word = word.trim_end_matches('.');
        let document = word.ends_with(".md") && !there(word) && !there(&format!("docs/{word}"));
        let outside = word.contains("../shared") || word.starts_with("/work/");
        let by_name = NAMES_OF_OTHERS.contains(&word) && line.trim_start().starts_with("//");
        document || outside || by_name
    };
    if line.contains("://") {
        return Vec::new();
    }
    words(line).filter(cited).collect()
}

#[test]
fn documents_that_are_cited_are_in_the_repository() {
    let own = Path::new(file!()).file_name().unwrap();
    let files = sources();
    let mut cited = 0;
    for file in files.iter().filter(|file| file.file_name() != Some(own)) {
        let text = std::fs::read_to_string(file).unwrap();
        for (number, line) in text.lines().enumerate() {
            let gone = missing(file, line);
            assert!(gone.is_empty(), "{}:{}: {gone:?}", file.display(), number + 1);
            cited += words(line).filter(|word| word.ends_with(".md")).count();
        }
    }
    // The README alone cites a score of pages.
    assert!(files.len() > 200 && cited > 40, "{} files, {cited} citations", files.len());
}

#[test]
fn a_citation_of_what_is_not_there_is_found() {
    let file = root().join("crates/midair/src/lib.rs");
    for line in ["// DESIGN 3.4 says so.", "/// See NOTES.md.", "let a = \"../../../shared/data\";"]
    {
        assert_eq!(missing(&file, line).len(), 1, "{line}");
    }
    for line in ["// See ARCHITECTURE.md.", "DESIGN_WAVELENGTH", "docs/introduction.md"] {
        assert!(missing(&file, line).is_empty(), "{line}");
    }
}

/// A test that skips itself by printing so is counted as passed by everybody.
#[test]
fn no_test_skips_itself_past_the_peers() {
    let own = Path::new(file!()).file_name().unwrap();
    let mut looked_at = 0;
    for file in sources() {
        let peers = file.starts_with(root().join("crates/midair-peers"));
        let rust = file.extension().is_some_and(|e| e == "rs");
        if !rust || peers || file.file_name() == Some(own) {
            continue;
        }
        looked_at += 1;
        let text = std::fs::read_to_string(&file).unwrap();
        for (number, line) in text.lines().enumerate() {
            let skips = line.contains("println!(\"skipped") || line.contains("not tested\")");
            assert!(
                !skips || line.contains("{line}"),
                "{}:{}: ask midair-peers instead",
                file.display(),
                number + 1
            );
        }
    }
    assert!(looked_at > 100, "{looked_at}");
}
