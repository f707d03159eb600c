//! Lattice displacement, SSIM, LPIPS, the tables of an evaluation.
//!
//! Pictures are measured as a person would measure photographs: on sRGB-encoded values
//! ([`Plane`]), with [`ssim`], its blurred form and [`psnr`] for likeness and
//! [`lattice::detect`] for geometry. [`report`] sets what was found into one page that stands
//! on its own.

pub mod colour;
pub mod eyebox;
mod filter;
pub mod lattice;
pub mod lpips;
pub mod orbit;
pub mod paper;
mod plane;
pub mod proof;
pub mod report;
mod similarity;

pub use filter::{box_blur5, gaussian_blur};
pub use plane::Plane;
pub use similarity::{Similarity, SimilarityError, blurred_ssim, psnr, ssim, ssim_over_channels};
