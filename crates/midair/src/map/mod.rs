//! G: the inverse of the transport on the display's pixels; its status, colour and file formats.

pub mod format;
mod invert;
mod model;

pub use invert::{Accuracy, Effort, invert, invert_into};
pub use model::{Map, Status, pixel_centre};
