//! From the bench to the scene: what a mid-air display's parts really are, measured by photographs of what the display shows.
//!
//! With the plate alone, a pattern on the display floats as a flat picture of known pitch: the mid-air image is its own calibration target. A
//! photograph without the object (*empty*) tells the camera; one from the same place with it (*object*) tells for each camera pixel which display
//! point it sees. [`fit()`] looks for the scene that says the same.
//!
//! - [`mod@bench`]: the file that says what was photographed, and what was assumed
//! - [`correspondences`]: camera pixels and the display points that they see
//! - [`camera`]: the lens by OpenCV's model, its place; [`storage`]: the same as OpenCV's programs write it
//! - [`fit()`]: cameras and elements at once, and what is determined ([`Finding`])
//! - [`page`], [`scene_file`]: the finding as a page and as a scene file

mod advice;
pub mod bench;
pub mod camera;
mod cameras;
pub mod correspondences;
pub mod decode;
mod decoded;
mod equations;
mod finding;
mod fit;
mod freedom;
pub mod model_free;
mod moved;
mod number;
pub mod order;
pub mod page;
mod parameters;
pub mod patterns;
pub mod photographs;
mod plane;
pub mod rehearsal;
pub mod scene_file;
mod solve;
mod state;
pub mod storage;
pub mod stray;
pub mod survey;

pub use advice::Advice;
pub use bench::{Bench, Uncertainty};
pub use camera::Lens;
pub use cameras::ViewPoints;
pub use correspondences::Correspondence;
pub use decoded::{Decoded, Seen, SeenCounts};
pub use equations::without_elements;
pub use finding::{Finding, Residual, Starts, Used, View};
pub use fit::{Options, fit, standing_still};
pub use parameters::{Parameter, upright};
pub use patterns::Patterns;
pub use survey::{SightedView, Sighting, Survey, survey};
