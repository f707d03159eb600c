//! What pictures say: lattices found in views and photographs, likeness by SSIM, PSNR and LPIPS.
//!
//! Pictures are measured as a person would measure photographs: on sRGB-encoded values
//! ([`Plane`]), with [`ssim`], its blurred form and [`psnr`] for likeness and
//! [`lattice::detect`] for geometry. Nothing here knows a scene.
//!
//! ```
//! use midair::measure::lattice::{LatticeStyle, detect, displacement, draw_lattice};
//! use midair::measure::{Plane, ssim};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let style = LatticeStyle::default();
//! let view = Plane::luminance(&draw_lattice(256, 256, &style)?);
//! assert_eq!(ssim(&view, &view)?.mean, 1.0);
//! // The lattice is found where it was drawn.
//! let found = detect(&view, style.lines)?;
//! let drawn: Vec<_> =
//!     style.intersections_uv().iter().map(|[u, v]| Some([256.0 * u, 256.0 * (1.0 - v)])).collect();
//! assert!(displacement(&found.points(), &drawn)?.max < 0.05);
//! # Ok(())
//! # }
//! ```

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
