//! The forward simulator: what the viewpoint sees.
//!
//! Two ways: [`Camera::rays`] with [`view_through`](crate::picture::optimal::view_through) trace one path for each
//! ray, through an ideal plate and clear elements; [`render`] is a Monte Carlo path tracer
//! with reflections, losses, a pupil of any size and a plate of any kind.
//!
//! ```
//! use midair::Setup;
//! use midair::picture::Picture;
//! use midair::simulate::{Camera, Light, Settings, Viewer, render};
//!
//! # fn main() -> Result<(), midair::Error> {
//! let scene = midair::scene::load("../../scenes/ball.toml".as_ref())?;
//! let setup = Setup::new(&scene)?.with_resolution([16, 16]);
//! let white = Picture::filled(16, 16, [1.0; 4]);
//! let camera = Camera::at_viewpoint(&setup, [16, 16]);
//! let viewer = Viewer { camera, aperture: 4.0, focus: None };
//! let settings = Settings { samples_per_pixel: 4, seed: 1 };
//! let render = render(&setup, &white, &viewer, &settings, &(), &mut |_| ())?;
//! // Surfaces reflect some of the light, and none is added.
//! let [red, ..] = render.view(Light::All).pixels[8 * 16 + 8];
//! assert!(0.5 < red && red < 1.0);
//! # Ok(())
//! # }
//! ```

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

pub use camera::{Camera, Sight, check_view};
pub use film::{ErrorEstimate, Layers, Light, Render};
pub(crate) use gain::share_along;
pub use gain::{ImageGainWork, faded_view, gain, image_gain};
pub use lens::Viewer;
pub use reference::Reference;
pub use render::{Pass, Progress, Settings, SimulateError, render, render_all, render_by_colour};
pub use stray::{BestPose, PoseLimits, STRAY, Sights, StrayView, best_pose};
