//! The files that maps are kept in.

mod atomic;
mod error;
mod exr_channels;
mod png;

pub use atomic::{write_atomically, write_bytes_atomically};
pub use error::FileError;
pub(crate) use exr_channels::check_size;
pub use exr_channels::{Channels, MAX_PIXELS, SampleKind, decode_channels, write_channels};
pub(crate) use png::write_png;
