//! `midair schema`: the scene file's JSON Schema.

use crate::failure::Failure;
use crate::summary::print;

/// Print the scene file's JSON Schema
///
/// Editors that know the schema complete keys and mark mistakes while a scene is written.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair schema > scene.schema.json")]
pub struct Arguments {}

pub fn run(_: &Arguments) -> Result<(), Failure> {
    print(&format!("{:#}\n", midair::scene::schema()))
}
