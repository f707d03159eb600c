//! The live show's warp on a graphics device: a shader in WGSL does the processor's integer arithmetic, so that both show the same codes.
//!
//! Nothing here knows a window or a show. A [`Surface`] is made of whatever wgpu can draw to, an [`OffScreen`] picture is read back into
//! memory. [`Device`]s are opened by futures, as a browser needs it; where one may wait, `pollster::block_on` does.
#![deny(missing_docs)]

mod device;
mod off_screen;
mod surface;
mod warper;

pub use device::{Device, GraphicsError};
pub use off_screen::OffScreen;
pub use surface::{Drawn, Picture, Surface};
pub use warper::{Letters, Warper};
