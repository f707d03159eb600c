//! What pictures say: lattices found in views and photographs, likeness by SSIM, PSNR and LPIPS.
//!
//! Pictures are measured as a person would measure photographs: on sRGB-encoded values
//! ([`Plane`]), with [`ssim`], its blurred form and [`psnr`] for likeness and
//! [`lattice::detect`] for geometry. Nothing here knows a scene.

mod filter;
pub mod lattice;
#[cfg(feature = "lpips")]
pub mod lpips;
mod plane;
mod similarity;

pub use filter::{box_blur5, gaussian_blur};
pub use plane::Plane;
pub(crate) use similarity::Standard;
pub use similarity::{Similarity, SimilarityError, blurred_ssim, psnr, ssim, ssim_over_channels};
