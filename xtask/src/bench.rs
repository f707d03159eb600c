//! `cargo xtask bench`: builds the program and the benchmark table in release mode and runs the latter.

use crate::book::Profile;
use crate::{process, python, setup};
use anyhow::Result;
use clap::Args;
use std::process::Command;

#[derive(Args)]
pub struct Options {
    /// Fewer rounds, and fewer samples for the scattering peers, extrapolated (the table says so).
    #[arg(long)]
    quick: bool,
    /// Install Mitsuba 3 into .venv and run its kernel in the same rounds.
    #[arg(long)]
    with_mitsuba: bool,
    /// Measure the map through this mesh of a bunny as well.
    #[arg(long, value_name = "FILE")]
    bunny: Option<std::path::PathBuf>,
    /// Only rows whose name contains this.
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
}

/// Prints the table.
pub fn run(options: &Options) -> Result<()> {
    if options.with_mitsuba {
        setup::python_packages(setup::BENCH_PACKAGES)?;
    }
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut build = Command::new(&cargo);
    build.args(["build", "--quiet", "--release", "--package", "midair-cli"]);
    build.args(["--package", "midair-python"]);
    process::run(build.current_dir(crate::root()))?;
    python::install()?;
    python::put_together(Profile::Release)?;
    let mut bench = Command::new(&cargo);
    bench.args(["bench", "--quiet", "--package", "xtask", "--bench", "table", "--"]);
    if options.quick {
        bench.arg("--quick");
    }
    if options.with_mitsuba {
        bench.arg("--with-mitsuba");
    }
    if let Some(file) = &options.bunny {
        bench.arg("--bunny").arg(std::path::absolute(file)?);
    }
    if let Some(only) = &options.only {
        bench.args(["--only", only]);
    }
    process::run(bench.current_dir(crate::root()))
}
