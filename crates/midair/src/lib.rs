//! `midair` computes what a display must show so that its mid-air image, formed by a
//! micro-mirror array plate and seen through or on a distortive element, looks undistorted.
//!
//! ```
//! use midair::{Compensation, Setup, compensate::Options, picture::Picture};
//!
//! # fn main() -> Result<(), midair::Error> {
//! # let photo = Picture::filled(64, 64, [0.5, 0.25, 0.125, 1.0]);
//! let scene = midair::scene::load("../../scenes/ball.toml".as_ref())?;
//! let setup = Setup::new(&scene)?.with_resolution([256, 256]);
//! let compensation = Compensation::of(&setup, &Options::new(), &());
//! let display = compensation.display(&photo).display;
//! # assert_eq!(display.width, 256);
//! # assert!(compensation.report().error_bound.is_some_and(|bound| bound <= 1e-6));
//! # Ok(())
//! # }
//! ```
//!
//! The floors of the house, each knowing only those above it:
//! [`geometry`], [`optics`], [`scene`], [`transport`], [`map`], [`picture`], [`simulate`],
//! [`compensate`], [`measure`], [`evaluate`], [`files`].
//!
//! Every error becomes an [`Error`]: what is wrong, where, and what helps. Long work is watched by a [`Monitor`].
//!
//! Units are millimetres and degrees; frames are right-handed with +y up.
#![deny(missing_docs)]

pub mod clock;
pub mod compensate;
mod error;
pub mod evaluate;
pub mod files;
pub mod geometry;
pub mod map;
pub mod measure;
mod monitor;
pub mod optics;
pub mod picture;
pub mod scene;
pub mod simulate;
pub mod transport;

pub use compensate::Compensation;
pub use error::{Error, Kind, Place};
pub use monitor::Monitor;
pub use transport::Setup;

/// The README's example is compiled as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
