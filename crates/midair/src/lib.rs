//! `midair` computes what a display must show so that its mid-air image, formed by a
//! micro-mirror array plate and seen through or on a distortive element, looks undistorted.
//!
//! The floors of the house, each knowing only those above it:
//! [`geometry`], [`optics`], [`scene`], [`transport`], [`map`], [`picture`], [`simulate`],
//! [`measure`], [`evaluate`].
//!
//! Units are millimetres and degrees; frames are right-handed with +y up.
#![deny(missing_docs)]

pub mod compensate;
mod error;
pub mod evaluate;
pub mod geometry;
pub mod map;
pub mod measure;
mod monitor;
pub mod optics;
pub mod picture;
pub mod scene;
pub mod simulate;
pub mod transport;

pub use error::{Error, Kind, Place};
pub use monitor::Monitor;

/// The README's example is compiled as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
