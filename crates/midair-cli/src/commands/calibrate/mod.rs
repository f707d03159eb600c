//! `midair calibrate`: from photographs of what the display shows to the scene as it really is.

mod decode;
mod demo;
mod fit;
mod map;
mod open;
mod patterns;

use crate::failure::Failure;
use crate::summary::Voice;
use clap::Subcommand;

/// Measure a set-up by photographs of what its display shows
///
/// The display shows patterns; they are photographed without the object and, from the same place, with it. A bench file (TOML) names the scene as it
/// was assumed and each view's photographs. From them come the scene as it really is (fit), or the map for a camera's place without any model (map).
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  midair calibrate demo --out rehearsal\n  midair calibrate fit bench.toml --out fitted"
)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Demo(demo::Arguments),
    Patterns(patterns::Arguments),
    Decode(decode::Arguments),
    Fit(fit::Arguments),
    Map(map::Arguments),
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    match &arguments.command {
        Command::Demo(arguments) => demo::run(arguments, voice),
        Command::Patterns(arguments) => patterns::run(arguments, voice),
        Command::Decode(arguments) => decode::run(arguments, voice),
        Command::Fit(arguments) => fit::run(arguments, voice),
        Command::Map(arguments) => map::run(arguments, voice),
    }
}
