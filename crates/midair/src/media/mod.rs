//! Pictures in linear light, and applying a map to stills and video.

mod brightness;
mod interpolate;
pub mod optimal;
mod picture;
mod resample;
pub mod srgb;
mod still;
mod warp;

pub use crate::map::format::FileError;
pub use brightness::{Evened, Overflow, even_out};
pub use picture::Picture;
pub use resample::display_image;
pub use still::{Depth, Still, decode_still, read_still, write_still};
pub use warp::{Filter, LinearScratch, Warp, WarpError};
