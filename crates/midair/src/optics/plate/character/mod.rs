//! A plate's character as plain arrays, for pictures and JSON: what it does to light over all
//! directions, how bright its image is from all viewpoints, and how sharp.

mod directions;
mod point_spread;
mod viewpoints;

pub use directions::{Directions, over_directions};
pub use point_spread::{PointSpread, PointSpreadSettings, point_spread};
pub use viewpoints::{Arrangement, Span, Viewpoints, VisibleRange, over_viewpoints};
