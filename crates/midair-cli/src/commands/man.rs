//! `midair man`: manual pages.

use super::Program;
use crate::failure::Failure;
use crate::summary::{Voice, paths, wrote};
use clap::CommandFactory as _;
use midair::map::format::FileError;
use serde_json::json;
use std::path::PathBuf;

/// Write manual pages: midair.1 and one for each command
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair man --out man1 && man ./man1/midair.1")]
pub struct Arguments {
    /// Folder for the pages
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let mut output = crate::output::into_folder(&arguments.out)?;
    output.write("midair.1", |path| {
        let folder = path.parent().unwrap_or(path);
        clap_mangen::generate_to(Program::command(), folder)
            .map_err(|error| FileError::io(path, "write", error))
    })?;
    let files = output.finish()?;
    voice.tell(&wrote(&files), &json!({ "files": paths(&files) }))
}
