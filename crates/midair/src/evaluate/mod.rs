//! Proofs, walks around the set-up, viewing regions, and the paper's evaluation: what a set-up does, in figures and pictures.

pub mod colour;
pub mod eyebox;
pub mod layout;
pub mod orbit;
#[cfg(feature = "lpips")]
pub mod paper;
pub mod preflight;
pub mod proof;
pub mod tolerance;
mod words;

pub use words::percent;
