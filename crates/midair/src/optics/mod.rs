//! Media, interfaces and plates: what light does at each thing it meets.
//!
//! Every formula here is a pure function over [`Real`](crate::geometry::Real), so the transport,
//! its derivatives and the forward simulator share one copy of it.
//!
//! ```
//! use midair::geometry::Vec3;
//! use midair::optics::glass;
//! use midair::optics::interface::refract;
//!
//! // The sodium line in N-BK7: 1.5168 in every table.
//! let index = glass::lookup("N-BK7").expect("it is in the catalogue").index(0.58756);
//! assert!((index - 1.5168).abs() < 5e-5);
//! // From air into the glass at 30 degrees: sin r = sin 30 / n.
//! let direction = Vec3::new(0.5, 0.0, -f64::sqrt(0.75));
//! let inside = refract(direction, Vec3::new(0.0, 0.0, 1.0), 1.0 / index);
//! assert!((inside.x - 0.5 / index).abs() < 1e-12);
//! ```

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
