//! Pictures with legends, axes and scales of colours.

pub mod chart_sheet;
mod colour_map;
pub mod lattice_picture;
mod lettering;
pub mod pattern;
pub mod set_up;
pub mod status_picture;
pub mod stray_picture;
pub mod test_picture;
pub mod tolerances;
mod vector;

pub use colour_map::{Chart, colour_map, point_spread_chart, shares_chart, viewpoints_chart};
pub use lettering::Lettering;
