//! G: the inverse of the transport on the display's pixels; its status, colour and file formats.

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
pub use formation::{Formation, ImagePoint, formation};
pub use forward::forward;
pub use image_gain::ImageGain;
pub(crate) use image_gain::cell;
pub use invert::{Accuracy, Effort, Inverse, InverseRows, invert, invert_into};
pub use model::{Gain, Map, Status, pixel_at, pixel_centre};
pub use reverse::reversed;
pub use splat::{Splat, splat};
