//! The `midair` program: compensate, view and prove mid-air displays.
//!
//! Each command is a file in [`commands`]; this one reads the command line and tells what went wrong. Everything
//! else is the library's.

mod arguments;
mod commands;
mod failure;
mod output;
mod progress;
mod summary;

use clap::Parser;
use std::io::Write as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    output::clean_up_on_interrupt();
    let program = commands::Program::parse();
    match commands::run(program) {
        Ok(code) => code,
        Err(failure) => {
            // There is nobody to tell if even this cannot be written.
            let _ = writeln!(anstream::stderr(), "{}", failure.shown());
            ExitCode::from(2)
        }
    }
}
