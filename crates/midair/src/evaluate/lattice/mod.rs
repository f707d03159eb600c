//! The lattice of the paper's shape evaluation: drawing it, and finding its intersections again
//! in rendered views and in photographs.
//!
//! Places in a picture are in pixels from its top left corner, x right and y down: the first
//! pixel's centre is (0.5, 0.5).

mod drawing;

pub use drawing::{LatticeStyle, LatticeStyleError, draw_lattice};
