//! F: viewpoint, elements, plate, display; and its derivatives.
//!
//! ```
//! use midair::Setup;
//! use midair::transport::Path;
//!
//! # fn main() -> Result<(), midair::Error> {
//! let scene = midair::scene::load("../../scenes/ball.toml".as_ref())?;
//! let setup = Setup::new(&scene)?;
//! // Which display point is seen at this image point, and through what?
//! let mut path = Path::new();
//! let end = setup.transport([0.5, 0.5], &mut path);
//! assert!(end.formed().is_some());
//! // Into the ball, out of it, and by the plate.
//! assert_eq!(path.len(), 3);
//! // Along the known path, the derivatives as well: rows d(s)/d(u, v) and d(t)/d(u, v).
//! let (st, jacobian) = setup.follow_with_jacobian([0.5, 0.5], &mut path);
//! assert_eq!(Some(st), end.st());
//! assert!(jacobian[0][0] != 0.0);
//! # Ok(())
//! # }
//! ```

#[cfg(test)]
pub(crate) mod bench_setup;
mod build;
mod course;
mod losses;
mod many;
mod moved;
pub(crate) mod packet;
mod path;
mod setup;
#[cfg(test)]
pub(crate) mod tests;
mod walk;

pub use crate::optics::glass::DESIGN_WAVELENGTH;
pub use build::SetupError;
pub use course::Course;
pub use losses::Remainder;
pub use moved::{Moved, MovedElement, Placing};
pub use packet::Packets;
pub use path::{Action, End, Path, Step, on_display};
pub use setup::{Element, MAX_SOLIDS, Matter, Setup};
pub use walk::Walk;
