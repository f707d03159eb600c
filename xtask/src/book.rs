//! The commands of the README and the book, run as they stand.
//!
//! A page's code blocks marked `sh` and `python` are run in their order, in a folder of the page's own with a copy
//! of `scenes/`, `midair` on the PATH and the Python of `.venv`, which finds the package `midair`. Blocks marked `sh,ignore`
//! (or in any other way) are not. A local link must lead to a file.

use crate::test::Tally;
use crate::{process, python, reference, setup};
use anyhow::{Context, Result, anyhow, bail};
use pulldown_cmark::{CodeBlockKind, Event, Parser, Tag, TagEnd};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Pages beside those of `docs/`.
const PAGES: [&str; 4] = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"];

/// No command that the book shows takes this long.
const LIMIT: Duration = Duration::from_secs(300);

/// A code block that is run.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Block {
    language: Language,
    /// The page's line (from 1) that the block's first line of code is on.
    line: usize,
    code: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Language {
    Shell,
    Python,
}

/// Runs all pages: each one is a check of its commands and one of its links; the table of contents, what the program
/// itself tells and the table of dependencies are one each.
pub fn run() -> Tally {
    let mut tally = Tally::default();
    let pages = match pages() {
        Ok(pages) => pages,
        Err(error) => return Tally::of(Err(error)),
    };
    tally.add(Tally::of(contents(&pages)));
    tally.add(Tally::of(reference::check()));
    tally.add(Tally::of(dependencies()));
    for page in pages {
        let checked = std::fs::read_to_string(crate::root().join(&page))
            .with_context(|| format!("{} cannot be read", page.display()));
        match checked {
            Ok(text) => {
                tally.add(Tally::of(links(&page, &text)));
                let blocks = blocks(&text);
                if !blocks.is_empty() {
                    println!("{}: {} blocks", page.display(), blocks.len());
                    tally.add(Tally::of(run_page(&page, &blocks)));
                }
            }
            Err(error) => tally.add(Tally::of(Err(error))),
        }
    }
    tally
}

/// All Markdown pages, relative to the workspace's root.
fn pages() -> Result<Vec<PathBuf>> {
    let mut pages: Vec<PathBuf> = PAGES.iter().map(PathBuf::from).collect();
    let mut folders = vec![PathBuf::from("docs")];
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(crate::root().join(&folder))
            .with_context(|| format!("{} cannot be read", folder.display()))?;
        for entry in entries {
            let entry = entry?;
            let path = folder.join(entry.file_name());
            if entry.file_type()?.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "md") {
                pages.push(path);
            }
        }
    }
    pages.sort();
    Ok(pages)
}

/// Every page of the book is in its table of contents.
fn contents(pages: &[PathBuf]) -> Result<()> {
    let summary = std::fs::read_to_string(crate::root().join("docs/SUMMARY.md"))
        .context("docs/SUMMARY.md cannot be read")?;
    for page in pages {
        if let Ok(inside) = page.strip_prefix("docs")
            && inside != Path::new("SUMMARY.md")
            && !summary.contains(&format!("({})", inside.display()))
        {
            bail!("docs/SUMMARY.md lacks {}", inside.display());
        }
    }
    Ok(())
}

/// Every dependency is in ARCHITECTURE.md with its reason.
fn dependencies() -> Result<()> {
    let page = std::fs::read_to_string(crate::root().join("ARCHITECTURE.md"))
        .context("ARCHITECTURE.md cannot be read")?;
    let (_, told) =
        page.split_once("## Dependencies").context("ARCHITECTURE.md: no `## Dependencies`")?;
    let mut cargo = Command::new(std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned()));
    cargo.args(["metadata", "--no-deps", "--format-version", "1"]).current_dir(crate::root());
    let output =
        cargo.output().with_context(|| format!("cannot run `{}`", process::shown(&cargo)))?;
    let workspace: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let packages = workspace["packages"].as_array().into_iter().flatten();
    let all = packages.flat_map(|p| p["dependencies"].as_array().into_iter().flatten());
    let word = |c: char| !(c.is_alphanumeric() || c == '-' || c == '_');
    // Those of the workspace itself have a path.
    let foreign = all.filter(|d| d["path"].is_null());
    for name in foreign.filter_map(|d| d["name"].as_str()) {
        if !told.split(word).any(|w| w == name) {
            bail!("ARCHITECTURE.md does not say what the dependency `{name}` is for");
        }
    }
    Ok(())
}

/// Every local link leads to a file.
fn links(page: &Path, text: &str) -> Result<()> {
    let folder = page.parent().unwrap_or(Path::new(""));
    for (event, range) in Parser::new(text).into_offset_iter() {
        let (Event::Start(Tag::Link { dest_url, .. }) | Event::Start(Tag::Image { dest_url, .. })) =
            event
        else {
            continue;
        };
        let file = dest_url.split('#').next().unwrap_or_default();
        if file.is_empty() || file.contains("://") || file.starts_with("mailto:") {
            continue;
        }
        if !crate::root().join(folder).join(file).exists() {
            let line = line_of(text, range.start);
            bail!("{}:{line}: the link to {file} leads nowhere", page.display());
        }
    }
    Ok(())
}

/// The blocks of a page that are run.
fn blocks(text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut language = None;
    for (event, range) in Parser::new(text).into_offset_iter() {
        match event {
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(info))) => {
                language = match &*info {
                    "sh" => Some(Language::Shell),
                    "python" => Some(Language::Python),
                    _ => None,
                };
            }
            Event::Text(code) => {
                if let Some(language) = language.take() {
                    let line = line_of(text, range.start);
                    blocks.push(Block { language, line, code: code.into_string() });
                }
            }
            Event::End(TagEnd::CodeBlock) => language = None,
            _ => {}
        }
    }
    blocks
}

fn line_of(text: &str, offset: usize) -> usize {
    text[..offset].matches('\n').count() + 1
}

fn run_page(page: &Path, blocks: &[Block]) -> Result<()> {
    let folder = tempfile::tempdir()?;
    copy_folder(&crate::root().join("scenes"), &folder.path().join("scenes"))?;
    for block in blocks {
        run_block(page, block, folder.path())?;
    }
    Ok(())
}

fn run_block(page: &Path, block: &Block, folder: &Path) -> Result<()> {
    let (program, file, text) = match block.language {
        // The trap tells where in the block it failed; the prelude is one line.
        Language::Shell => {
            let prelude = "set -Eeuo pipefail; trap 'echo \"failed in line $LINENO\" >&2' ERR";
            (PathBuf::from("bash"), "block.sh", format!("{prelude}\n{}", block.code))
        }
        Language::Python => (setup::python(), "block.py", format!("\n{}", block.code)),
    };
    let scripts = tempfile::tempdir()?;
    let script = scripts.path().join(file);
    std::fs::write(&script, text)?;
    let mut command = Command::new(program);
    command.arg(&script).current_dir(folder).env("PATH", path_with_midair()?);
    command.env("PYTHONPATH", python::package_folder());
    let (status, output) = process::run_within(&mut command, LIMIT)?;
    match status {
        Some(status) if status.success() => Ok(()),
        Some(status) => {
            let inside = failing_line(&output).unwrap_or(2);
            let line = block.line + inside.saturating_sub(2);
            bail!("{}:{line}: {status}\n{}", page.display(), indented(&output))
        }
        None => {
            let (page, line, limit) = (page.display(), block.line, LIMIT.as_secs());
            bail!("{page}:{line}: still running after {limit} s\n{}", indented(&output))
        }
    }
}

/// The script's line (from 1) at which bash or Python says it failed.
fn failing_line(output: &str) -> Option<usize> {
    let after = |line: &str, word: &str| {
        let digits = line.split(word).nth(1)?;
        digits.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
    };
    output.lines().rev().find_map(|line| {
        after(line, "failed in line ").or_else(|| after(line, "block.py\", line "))
    })
}

fn indented(output: &str) -> String {
    output.lines().map(|line| format!("    {line}\n")).collect()
}

/// The PATH with the folder of the built program in front.
fn path_with_midair() -> Result<std::ffi::OsString> {
    let built = program_folder(Profile::Dev);
    if !built.join(format!("midair{}", std::env::consts::EXE_SUFFIX)).exists() {
        return Err(anyhow!("{} holds no midair: build it first", built.display()));
    }
    let old = std::env::var_os("PATH").unwrap_or_default();
    let places = std::iter::once(built).chain(std::env::split_paths(&old));
    Ok(std::env::join_paths(places)?)
}

/// How programs are built.
#[derive(Clone, Copy)]
pub enum Profile {
    /// As the tests are, so that what they have built serves.
    Dev,
    /// As users build them.
    Release,
}

/// Where cargo puts programs.
pub fn program_folder(profile: Profile) -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    let folder = match profile {
        Profile::Dev => "debug",
        Profile::Release => "release",
    };
    crate::root().join(target.unwrap_or_else(|| PathBuf::from("target"))).join(folder)
}

fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &target)?;
        } else {
            std::fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# Page\n\n```sh\ntrue\nfalse\n```\n\n```sh,ignore\nexit 9\n```\n\nIn a list:\n\n\
                        1. so\n   ```python\n   print(1)\n   ```\n\n```toml\na = 1\n```\n";

    #[test]
    fn blocks_are_found_with_their_lines() {
        assert_eq!(
            blocks(TEXT),
            [
                Block { language: Language::Shell, line: 4, code: "true\nfalse\n".to_owned() },
                Block { language: Language::Python, line: 16, code: "print(1)\n".to_owned() },
            ]
        );
    }

    #[test]
    fn a_dead_link_is_told_with_its_line() {
        let page = Path::new("docs/here");
        let error = links(page, "a\n\n[b](../Cargo.toml) [c](nowhere.txt#part)\n").unwrap_err();
        assert!(
            error.to_string().contains("docs/here:3") && error.to_string().contains("nowhere.txt")
        );
        links(page, "[a](https://example.org/) [b](../Cargo.toml#x) [c](#here)").unwrap();
    }

    #[test]
    fn the_failing_line_is_read_from_bash_and_python() {
        assert_eq!(failing_line("x\nfailed in line 3\n"), Some(3));
        assert_eq!(
            failing_line("  File \"/a/block.py\", line 12, in <module>\nKeyError"),
            Some(12)
        );
        assert_eq!(failing_line("nothing"), None);
    }
}
