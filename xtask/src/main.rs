//! `cargo xtask <task>`: what developers run.
fn main() {}
