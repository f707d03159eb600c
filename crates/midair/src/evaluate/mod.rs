//! Proofs, walks around the set-up, viewing regions, and the paper's evaluation: what a set-up does, in figures and pictures.
//!
//! ```
//! use midair::Setup;
//! use midair::evaluate::proof::{Settings, prove};
//! use midair::picture::Picture;
//!
//! # fn main() -> Result<(), midair::Error> {
//! let scene = midair::scene::load("../../scenes/ball.toml".as_ref())?;
//! let setup = Setup::new(&scene)?.with_resolution([96, 96]);
//! let picture = Picture::filled(96, 96, [0.5, 0.25, 0.125, 1.0]);
//! let proof = prove(&setup, &picture, &Settings { splat_spp: 0, ..Settings::for_setup(&setup) }, &())?;
//! // By calculation: how far the lattice is from where it belongs, view pixels.
//! let lattice = &proof.lattice;
//! assert!(lattice.compensated.exact.mean < 0.1 && lattice.uncompensated.exact.mean > 1.0);
//! # Ok(())
//! # }
//! ```

pub mod character;
pub mod colour;
mod csv;
pub mod explore;
pub mod eyebox;
pub mod layout;
pub mod orbit;
#[cfg(feature = "lpips")]
pub mod paper;
pub mod preflight;
pub mod proof;
pub mod stray;
pub mod tolerance;
mod words;

pub use words::percent;
