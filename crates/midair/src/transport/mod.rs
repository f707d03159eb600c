//! F: viewpoint, elements, plate, display; and its derivatives.

mod path;
mod setup;

pub use path::{Action, End, Path, Step, on_display};
pub use setup::{Element, MAX_SOLIDS, Matter, Setup};
