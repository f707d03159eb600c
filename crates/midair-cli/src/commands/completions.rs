//! `midair completions`: what a shell needs to complete the command line.

use super::Program;
use crate::failure::Failure;
use crate::summary::print;
use clap::CommandFactory as _;
use clap_complete::Shell;

/// Print completions for a shell
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  midair completions bash > ~/.local/share/bash-completion/completions/midair"
)]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Program::command(), "midair", &mut script);
    print(&String::from_utf8_lossy(&script))
}
