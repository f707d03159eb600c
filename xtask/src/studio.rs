//! `cargo xtask studio`: the studio's page, built into target/studio; and its tests, in a browser.

use crate::book::{self, Profile};
use crate::test::Tally;
use crate::{process, setup, wasm};
use anyhow::{Context, Result};
use clap::Args;
use std::path::{Path, PathBuf};
use std::process::Command;

#[derive(Args)]
pub struct Options {
    /// Run the tests in a browser on what was built.
    #[arg(long)]
    test: bool,
    /// Remake the pictures of the book's page, by the tests.
    #[arg(long)]
    pictures: bool,
}

/// The crate that is the page's core, and the tool that writes what is around it.
const CORE: &str = "midair-web";
const BINDGEN: &str = "midair-bindgen";

fn folder() -> PathBuf {
    crate::root().join("studio")
}

/// Brings node, npm's packages as they are pinned, and the target of the core.
pub fn install() -> Result<()> {
    wasm::install()?;
    if !process::succeeds(Command::new("npm").arg("--version")) {
        setup::apt_install(&["npm"])?;
    }
    if is_installed()? {
        return Ok(());
    }
    println!("installing studio/package-lock.json into studio/node_modules");
    let mut npm = Command::new("npm");
    npm.args(["ci", "--no-audit", "--no-fund", "--loglevel=error"]).current_dir(folder());
    process::run(&mut npm).context("the studio's packages cannot be had")
}

/// Brings the browser that the tests drive.
pub fn install_browser() -> Result<()> {
    install()?;
    if Path::new(CHROMIUM).exists() { Ok(()) } else { setup::apt_install(&["chromium"]) }
}

/// Debian's.
const CHROMIUM: &str = "/usr/bin/chromium";

/// Whether the packages are those of the lock file: npm keeps a copy of what it installed.
fn is_installed() -> Result<bool> {
    let read = |name: &str| -> Result<serde_json::Value> {
        let path = folder().join(name);
        let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        Ok(serde_json::from_str(&text)?)
    };
    let wanted = read("package-lock.json")?;
    let Ok(there) = read("node_modules/.package-lock.json") else { return Ok(false) };
    let all = wanted["packages"].as_object().context("package-lock.json has no packages")?;
    // Packages for other systems are not installed.
    let same = |(name, package): (&String, &serde_json::Value)| {
        let found = &there["packages"][name];
        found["version"] == package["version"] || (found.is_null() && package["optional"] == true)
    };
    Ok(all.iter().filter(|(name, _)| !name.is_empty()).all(same))
}

/// Builds the page and says where it is and what it weighs; an error where it weighs too much.
pub fn run(options: &Options) -> Result<bool> {
    install()?;
    build()?;
    println!("{}", crate::root().join("target/studio").display());
    if !options.test && !options.pictures {
        return Ok(true);
    }
    install_browser()?;
    process::run(&mut process::cargo(&["build", "--quiet", "--package", "midair-cli"]))?;
    let pictures = options.pictures.then(|| crate::root().join("docs/pictures"));
    let tally = run_tests(pictures.as_deref());
    println!("{tally}");
    Ok(tally.failed == 0)
}

/// Builds the page and runs its tests.
pub fn test() -> Tally {
    if let Err(error) = build() {
        return Tally::of(Err(error));
    }
    let built = process::build_for_tests();
    if built.is_err() {
        return Tally::of(built);
    }
    run_tests(None)
}

fn build() -> Result<()> {
    let module = wasm::build(CORE)?;
    process::run(&mut process::cargo(&["build", "--quiet", "--package", BINDGEN]))?;
    let mut bindgen = Command::new(book::program_folder(Profile::Dev).join(BINDGEN));
    process::run(bindgen.arg(module).arg(folder().join("core")))?;
    for script in ["check", "build", "budget"] {
        process::run(Command::new("npm").args(["run", "--silent", script]).current_dir(folder()))
            .with_context(|| format!("the studio's page: npm run {script}"))?;
    }
    Ok(())
}

/// Runs the tests in the browser. `pictures`: where pictures for the book go.
fn run_tests(pictures: Option<&Path>) -> Tally {
    let mut playwright = Command::new("npx");
    playwright.args(["playwright", "test"]).current_dir(folder());
    playwright.env("MIDAIR", book::program_folder(Profile::Dev).join("midair"));
    playwright.env("CHROMIUM", CHROMIUM);
    if let Some(folder) = pictures {
        playwright.env("PICTURES", folder);
    }
    Tally::watched(&mut playwright, |tally, line| {
        let line = line.trim_start();
        tally.passed += usize::from(line.starts_with("ok "));
        tally.failed += usize::from(line.starts_with("not ok "));
    })
}
