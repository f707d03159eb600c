//! `cargo xtask test`: everything that must hold before a change is merged.

use crate::{book, process, setup, wasm};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use std::time::Instant;

#[derive(Args)]
pub struct Options {
    /// Run only this step; may be given several times.
    #[arg(long, value_name = "STEP")]
    only: Vec<Step>,
}

/// The steps, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Step {
    /// Install what tests need.
    Setup,
    /// The code is formatted.
    Fmt,
    /// Clippy has nothing to say.
    Clippy,
    /// Unit, integration and documentation tests.
    Tests,
    /// The API's documentation builds without a warning.
    Docs,
    /// The library packages, and the package builds.
    Package,
    /// The commands of the README and the book do what they say.
    Book,
    /// The library does the same in WebAssembly as here.
    Wasm,
}

/// How many checks went which way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    pub passed: usize,
    pub failed: usize,
}

impl Tally {
    /// One check.
    pub fn of(outcome: Result<()>) -> Self {
        match outcome {
            Ok(()) => Self { passed: 1, failed: 0 },
            Err(error) => {
                println!("FAILED: {error:#}");
                Self { passed: 0, failed: 1 }
            }
        }
    }

    pub fn add(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
    }
}

/// Runs the steps, all of them even if one fails; whether all passed.
pub fn run(options: &Options) -> Result<bool> {
    let mut total = Tally::default();
    let mut failed = Vec::new();
    for step in Step::value_variants() {
        if !options.only.is_empty() && !options.only.contains(step) {
            continue;
        }
        let name = format!("{step:?}").to_lowercase();
        println!("\n== {name}");
        let start = Instant::now();
        let tally = step.run();
        println!("-- {name}: {:.0} s", start.elapsed().as_secs_f64());
        if tally.failed > 0 {
            failed.push(name);
        }
        total.add(tally);
    }
    println!();
    if !failed.is_empty() {
        println!("failed steps: {}", failed.join(", "));
    }
    println!("{} passed, {} failed", total.passed, total.failed);
    Ok(total.failed == 0)
}

impl Step {
    fn run(self) -> Tally {
        match self {
            Self::Setup => Tally::of(setup::install()),
            Self::Fmt => Tally::of(cargo(&["fmt", "--all", "--check"])),
            Self::Clippy => Tally::of(cargo(&[
                "clippy",
                "--quiet",
                "--workspace",
                "--all-targets",
                "--",
                "-Dwarnings",
            ])),
            Self::Tests => tests(),
            Self::Docs => Tally::of(process::run(
                process::cargo(&["doc", "--quiet", "--workspace", "--no-deps"])
                    .env("RUSTDOCFLAGS", "-Dwarnings"),
            )),
            Self::Package => {
                Tally::of(cargo(&["package", "--quiet", "--package", "midair", "--allow-dirty"]))
            }
            Self::Book => {
                let built = cargo(&["build", "--quiet", "--release", "--package", "midair-cli"]);
                if built.is_err() {
                    return Tally::of(built);
                }
                book::run()
            }
            Self::Wasm => wasm::run(),
        }
    }
}

fn cargo(arguments: &[&str]) -> Result<()> {
    process::run(&mut process::cargo(arguments))
}

/// All tests of the workspace, documentation tests among them.
fn tests() -> Tally {
    let mut tally = Tally::default();
    let mut command = process::cargo(&["test", "--quiet", "--workspace", "--no-fail-fast"]);
    let status = process::run_watched(&mut command, |line| {
        if let Some(counts) = read_result(line) {
            tally.add(counts);
        }
    });
    let outcome = match status {
        Ok(status) if status.success() && tally.passed == 0 => no_tests(),
        Ok(status) if !status.success() && tally.failed == 0 => {
            Err(anyhow::anyhow!("`{}` failed ({status})", process::shown(&command)))
        }
        Ok(_) => return tally,
        Err(error) => Err(error),
    };
    tally.add(Tally::of(outcome));
    tally
}

fn no_tests() -> Result<()> {
    bail!("no test ran: has the test runner's summary line changed?")
}

/// The counts in a test runner's line `test result: ok. 3 passed; 0 failed; ...`.
fn read_result(line: &str) -> Option<Tally> {
    let counts = line.trim().strip_prefix("test result: ")?;
    let count = |word: &str| {
        let before = counts.split(word).next()?;
        before.split_whitespace().next_back()?.parse().ok()
    };
    Some(Tally { passed: count(" passed;")?, failed: count(" failed;")? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_runner_s_summary_is_counted() {
        let line = "test result: FAILED. 12 passed; 3 failed; 1 ignored; 0 measured; 7 filtered \
                    out; finished in 0.10s\n";
        assert_eq!(read_result(line), Some(Tally { passed: 12, failed: 3 }));
        assert_eq!(read_result("running 15 tests"), None);
        assert_eq!(read_result("test result: nonsense"), None);
    }
}
