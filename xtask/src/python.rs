//! The Python package: put together for tests from what cargo has built, and built as a wheel for users.

use crate::book::{Profile, program_folder};
use crate::test::Tally;
use crate::{process, setup};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What is pinned for the package's tests.
const TEST_PACKAGES: &str = "xtask/peers/requirements-python.txt";
/// What is pinned for building wheels.
const WHEEL_PACKAGES: &str = "xtask/peers/requirements-wheel.txt";
const CRATE: &str = "crates/midair-python";

/// Everything of the package that is made lies here.
fn made() -> PathBuf {
    crate::root().join("target/python")
}

/// The environment that the package is tested in.
fn environment() -> PathBuf {
    made().join("environment")
}

/// The folder that holds the package for tests: Python finds it there by PYTHONPATH.
pub fn package_folder() -> PathBuf {
    folder_of(Profile::Dev)
}

fn folder_of(profile: Profile) -> PathBuf {
    made().join(match profile {
        Profile::Dev => "package",
        Profile::Release => "release",
    })
}

/// Installs what the package is tested with.
pub fn install() -> Result<()> {
    setup::packages_into(&environment(), TEST_PACKAGES)
}

/// Builds the workspace as its tests are built, and puts the package together: Python's files, and the module that cargo has built.
pub fn assemble() -> Result<()> {
    process::build_for_tests()?;
    put_together(Profile::Dev)
}

/// Puts Python's files and the module that cargo has built in this way into a folder of its own.
pub fn put_together(profile: Profile) -> Result<()> {
    let package = folder_of(profile).join("midair");
    if package.exists() {
        std::fs::remove_dir_all(&package)?;
    }
    std::fs::create_dir_all(&package)?;
    let source = crate::root().join(CRATE).join("python/midair");
    for entry in std::fs::read_dir(&source).with_context(|| format!("{}", source.display()))? {
        let entry = entry?;
        if entry.file_type()?.is_file() {
            std::fs::copy(entry.path(), package.join(entry.file_name()))?;
        }
    }
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let library = program_folder(profile).join(format!("{prefix}_core{suffix}"));
    let module = if cfg!(windows) { "_core.pyd" } else { "_core.abi3.so" };
    std::fs::copy(&library, package.join(module))
        .with_context(|| format!("{} is not there", library.display()))?;
    Ok(())
}

/// Tests the package: its types, what it computes, its notebooks.
pub fn test() -> Tally {
    let mut tally = Tally::default();
    if let Err(error) = install().and_then(|()| assemble()) {
        return Tally::of(Err(error));
    }
    let python = setup::python_in(&environment());
    let mut command = Command::new(&python);
    command.args(["-m", "pytest", "--quiet", "-p", "no:cacheprovider", "-rs"]).arg(CRATE);
    command.current_dir(crate::root()).env("PYTHONPATH", package_folder());
    command.env("MIDAIR_PROGRAM", program_folder(Profile::Dev).join("midair"));
    let mut counted = false;
    let status = process::run_watched(&mut command, |line| {
        if let Some(counts) = read_summary(line) {
            (tally, counted) = (counts, true);
        }
    });
    match status {
        Ok(status) if !counted || (!status.success() && tally.failed == 0) => {
            tally.add(Tally::of(Err(anyhow::anyhow!("pytest ended without a summary ({status})"))));
        }
        Ok(_) => {}
        Err(error) => tally.add(Tally::of(Err(error))),
    }
    tally
}

/// The counts in pytest's last line, such as `2 failed, 31 passed, 1 skipped, 3 warnings in 12.30s`.
fn read_summary(line: &str) -> Option<Tally> {
    let (counts, _) = line.trim().rsplit_once(" in ")?;
    let mut tally = Tally::default();
    for part in counts.trim_matches(|c| c == '=' || c == ' ').split(", ") {
        let (count, kind) = part.split_once(' ')?;
        let count: usize = count.parse().ok()?;
        match kind {
            "passed" => tally.passed += count,
            "failed" | "error" | "errors" => tally.failed += count,
            "skipped" => tally.skipped += count,
            _ => {}
        }
    }
    Some(tally)
}

/// Builds the wheel into target/wheels and tests it in an environment that holds nothing else.
pub fn wheel() -> Result<()> {
    let builder = made().join("builder");
    setup::packages_into(&builder, WHEEL_PACKAGES)?;
    let wheels = crate::root().join("target/wheels");
    if wheels.exists() {
        std::fs::remove_dir_all(&wheels)?;
    }
    let mut maturin = Command::new(setup::python_in(&builder));
    maturin.args(["-m", "maturin", "build", "--release", "--locked", "--manifest-path"]);
    maturin.arg(format!("{CRATE}/Cargo.toml")).arg("--out").arg(&wheels);
    process::run(maturin.current_dir(crate::root()))?;
    let wheel = only_wheel(&wheels)?;

    let fresh = tempfile::tempdir()?;
    setup::make_environment(fresh.path())?;
    let python = setup::python_in(fresh.path());
    process::run(setup::pip_install(&python).arg(&wheel))?;
    let mut tried = Command::new(&python);
    tried.arg(crate::root().join(CRATE).join("tests/fresh.py")).current_dir(fresh.path());
    process::run(tried.arg(crate::root().join("scenes"))).context("the wheel does not work")?;
    println!("{}", wheel.display());
    Ok(())
}

fn only_wheel(folder: &Path) -> Result<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(|| format!("{}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == "whl") {
            found.push(path);
        }
    }
    match &found[..] {
        [wheel] => Ok(wheel.clone()),
        _ => bail!("{} holds {} wheels", folder.display(), found.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pytest_s_summary_is_counted() {
        let tally = Tally { passed: 31, failed: 3, skipped: 1 };
        let line = "2 failed, 31 passed, 1 skipped, 4 warnings, 1 error in 12.30s\n";
        assert_eq!(read_summary(line), Some(tally));
        let tally = Tally { passed: 7, ..Tally::default() };
        assert_eq!(read_summary("===== 7 passed in 0.12s ====="), Some(tally));
        for other in ["....... [100%]", "collected 3 items", "nothing in particular", ""] {
            assert_eq!(read_summary(other), None, "{other}");
        }
    }
}
