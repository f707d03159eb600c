//! `cargo xtask pictures`: remakes the pictures that the README and the book show.

use anyhow::Result;

/// Runs the program and puts its pictures where the pages look for them.
pub fn run() -> Result<()> {
    anyhow::bail!("not yet")
}
