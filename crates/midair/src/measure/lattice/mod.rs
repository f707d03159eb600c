//! The lattice of the paper's shape evaluation: drawing it, and finding its intersections again
//! in rendered views and in photographs.
//!
//! Places in a picture are in pixels from its top left corner, x right and y down: the first
//! pixel's centre is (0.5, 0.5).

mod curve;
mod detection;
mod displacement;
mod drawing;
mod graph;
mod measurement;
mod ordering;
mod refinement;
mod ridge;
mod stretch;
#[cfg(test)]
mod tests;

pub use detection::{Count, Lattice, LatticeError, Missing, detect, detect_at, detect_part};
pub use displacement::{Alignment, Displacement, DisplacementError, aligned, displacement};
pub use drawing::{LatticeStyle, LatticeStyleError, draw_lattice};
