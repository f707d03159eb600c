//! F: viewpoint, elements, plate, display; and its derivatives.

#[cfg(test)]
pub(crate) mod bench_setup;
mod build;
mod losses;
mod path;
mod setup;
#[cfg(test)]
pub(crate) mod tests;
mod walk;

pub use crate::optics::glass::DESIGN_WAVELENGTH;
pub use build::SetupError;
pub use losses::Remainder;
pub use path::{Action, End, Path, Step, on_display};
pub use setup::{Element, MAX_SOLIDS, Matter, Setup};
pub use walk::Walk;
