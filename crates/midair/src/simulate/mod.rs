//! The forward simulator: what the viewpoint sees.
//!
//! Two ways: [`Camera::rays`] with [`view_through`](crate::picture::optimal::view_through) trace one path for each
//! ray, through an ideal plate and clear elements; [`render`] is a Monte Carlo path tracer
//! with reflections, losses, a pupil of any size and a plate of any kind.

mod bundle;
mod camera;
mod film;
mod gain;
mod lens;
mod light;
mod reference;
mod render;
mod sequence;
mod stray;
#[cfg(test)]
mod tests;
pub mod tone;

pub use camera::{Camera, Sight};
pub use film::{ErrorEstimate, Layers, Light, Render};
pub use gain::{ImageGainWork, faded_view, gain, image_gain};
pub use lens::Viewer;
pub use reference::Reference;
pub use render::{Pass, Progress, Settings, SimulateError, render, render_all, render_by_colour};
pub use stray::{BestPose, PoseLimits, STRAY, Sights, StrayView, best_pose};
