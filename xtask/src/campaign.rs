//! `cargo xtask campaign`: random set-ups by the hundred, their maps judged by brute force; or random benches, fitted to what their cameras see.

use crate::process;
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;
use std::process::Command;

#[derive(Args)]
pub struct Options {
    /// How many set-ups; 300 if left out, or 50 benches of each kind.
    #[arg(long)]
    count: Option<u64>,
    /// The number of the first one: the same number is the same set-up.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Write the set-ups whose maps are wrong into this folder, as scene files.
    #[arg(long, value_name = "FOLDER")]
    keep: Option<PathBuf>,
    /// Calibrate benches instead: how near the fit comes, and whether its deviations mean something.
    #[arg(long, conflicts_with_all = ["keep", "scenes"])]
    calibrate: bool,
    /// Judge these scene files instead.
    #[arg(value_name = "SCENE")]
    scenes: Vec<PathBuf>,
}

/// Judges them; whether all maps, or all benches together, are right.
pub fn run(options: &Options) -> Result<bool> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut test = Command::new(cargo);
    let (package, file, which, count) = match options.calibrate {
        true => ("midair-calibrate", "benches", "the_scene_is_found", 50),
        false => ("midair", "completeness", "", 300),
    };
    test.args(["test", "--quiet", "--release", "--package", package, "--test", file])
        .args(["--", "--nocapture", which])
        .current_dir(crate::root())
        .env(midair_peers::campaign::COUNT, options.count.unwrap_or(count).to_string())
        .env(midair_peers::campaign::FIRST, options.first.to_string());
    if let Some(folder) = &options.keep {
        std::fs::create_dir_all(folder)?;
        test.env("MIDAIR_CAMPAIGN_KEEP", std::path::absolute(folder)?);
    }
    if !options.scenes.is_empty() {
        let whole = options.scenes.iter().map(std::path::absolute);
        let whole = whole.collect::<std::io::Result<Vec<_>>>()?;
        test.env("MIDAIR_CAMPAIGN_SCENES", std::env::join_paths(whole)?);
    }
    Ok(process::run_watched(&mut test, |_| {})?.success())
}
