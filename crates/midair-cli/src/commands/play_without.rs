//! `midair play` of a program that was built without the live show: it says how to have it.

use crate::failure::Failure;
use crate::summary::Voice;

/// Show the compensated source live, following the viewer (this program was built without it)
///
/// The live show needs a window and a graphics device, which take as long to build as all the rest; they are built where they are asked for:
/// cargo install --path crates/midair-cli --features show
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  cargo install --path crates/midair-cli --features show")]
pub struct Arguments {
    /// What the show is asked for
    #[arg(allow_hyphen_values = true, hide = true)]
    _all: Vec<String>,
}

pub fn run(_: &Arguments, _: Voice) -> Result<(), Failure> {
    Err(Failure::new(
        "this midair was built without the live show",
        "build it with the show: cargo install --path crates/midair-cli --features show",
    ))
}
