//! `cargo xtask <task>`: what developers run.
//!
//! ```text
//! cargo xtask test [--only STEP]     install what tests need, then run them all
//! cargo xtask bench [--quick]        the table of times and memory, as Markdown
//! cargo xtask campaign [--count N]   the maps of random set-ups, judged by brute force
//! cargo xtask fuzz [--seconds N]     what reads files, under a fuzzer that follows coverage
//! cargo xtask blender                Blender's extension as a .zip, with midair's wheel in it
//! cargo xtask pictures               remake the pictures of the README and the book
//! cargo xtask reference              bring the book's tables of keys and commands up to date
//! cargo xtask studio [--test]       the studio's page, and its tests in a browser
//! cargo xtask wheel                  the Python package's wheel
//! ```

mod bench;
mod blender;
mod book;
mod campaign;
#[cfg(test)]
mod citations;
mod fuzz;
mod pictures;
mod process;
mod python;
mod reference;
mod setup;
mod studio;
mod test;
mod wasm;

use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What midair's developers run.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Install what tests need, then run them all.
    Test(test::Options),
    /// Print the table of times and memory, as Markdown.
    Bench(bench::Options),
    /// Judge the maps of random set-ups by brute force, or the calibration of random benches.
    Campaign(campaign::Options),
    /// Run what reads people's files under a fuzzer that follows coverage.
    Fuzz(fuzz::Options),
    /// Build Blender's extension: an installable .zip with midair's wheel in it.
    Blender(blender::Options),
    /// Remake the pictures of the README and the book.
    Pictures,
    /// Bring the book's tables of keys and commands up to date.
    Reference,
    /// Build the studio's page into target/studio, and say what it weighs.
    Studio(studio::Options),
    /// Build the Python package's wheel into target/wheels, and try it in a fresh environment.
    Wheel,
}

/// The workspace's root: where this package's folder lies.
fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().task {
        Task::Test(options) => test::run(&options),
        Task::Bench(options) => bench::run(&options).map(|()| true),
        Task::Campaign(options) => campaign::run(&options),
        Task::Fuzz(options) => fuzz::run(&options),
        Task::Blender(options) => blender::run(&options),
        Task::Pictures => pictures::run().map(|()| true),
        Task::Reference => reference::write().map(|()| true),
        Task::Studio(options) => studio::run(&options),
        Task::Wheel => python::wheel().map(|()| true),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
