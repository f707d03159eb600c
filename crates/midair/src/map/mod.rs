//! G: the inverse of the transport on the display's pixels; its status, colour and file formats.
//!
//! ```
//! use midair::Setup;
//! use midair::map::{Accuracy, invert};
//! use midair::transport::Path;
//!
//! # fn main() -> Result<(), midair::Error> {
//! let scene = midair::scene::load("../../scenes/ball.toml".as_ref())?;
//! let setup = Setup::new(&scene)?.with_resolution([64, 64]);
//! let (map, _) = invert(&setup, Accuracy::default());
//! // The pixel right of and below the middle shows this image point, whose light comes from that pixel's centre.
//! let uv = map.answer(32 * 64 + 32).expect("it is seen");
//! let st = setup.transport(uv, &mut Path::new()).formed().expect("its path ends on the display");
//! assert!((st[0] - 32.5 / 64.0).hypot(st[1] - 31.5 / 64.0) < 1e-4);
//! # Ok(())
//! # }
//! ```

mod bleed;
mod counts;
pub mod format;
mod formation;
mod forward;
mod image_gain;
mod invert;
mod model;
mod reverse;
mod splat;

pub use bleed::bleed;
pub(crate) use bleed::{REACH, continued, to_drawn_precision};
pub use counts::Counts;
pub(crate) use formation::reach;
pub use formation::{Formation, ImagePoint, formation};
pub use forward::forward;
pub use image_gain::ImageGain;
pub(crate) use image_gain::cell;
pub(crate) use invert::apply_inverse;
pub use invert::{Accuracy, Effort, Inverse, InverseRows, invert, invert_into};
pub use model::{Gain, Map, Status, pixel_at, pixel_centre};
pub use reverse::reversed;
pub use splat::{Splat, splat};
