//! Media, interfaces and plates: what light does at each thing it meets.
//!
//! Every formula here is a pure function over [`Real`](crate::geometry::Real), so the transport,
//! its derivatives and the forward simulator share one copy of it.

pub mod emission;
pub mod glass;
pub mod glass_file;
mod index;
pub mod interface;
pub mod plate;
pub mod polarisation;
pub mod screen;
pub mod srgb;
mod table;

pub use index::Index;
pub use table::TableError;
