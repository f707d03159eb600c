//! G: the inverse of the transport on the display's pixels; its status, colour and file formats.

pub mod format;
mod model;

pub use model::{Map, Status, pixel_centre};
