//! The window of the live show, on the light source's screen: keys, drawing, presenting. The show itself is `midair_live`'s; this crate
//! alone knows winit.
//!
//! Threads: the window's (tells the show what happens, warps the newest frame by the newest map and presents it), the source's (frames at
//! their times), the tracker's (packets), and the solver's (a map for the newest viewpoint; older requests are dropped, so that the show
//! never waits; and its gain, in the time until the next). Frames are warped by a graphics device (`midair_gpu`) or by the processor,
//! whose kernels (`midair::picture::Warp`) take a few milliseconds for a full-HD frame, so that a machine without a graphics card can run
//! the show; both show the same codes.
#![deny(missing_docs)]

mod draw;
mod keys;
mod letters;
mod options;
mod present;
mod quiet;
mod screens;
mod slides;
mod window;

pub use options::{Options, Outcome, PlayError, Renderer};
pub use screens::{ScreenInfo, screens};
pub use slides::{Pictures, show_pictures};
pub use window::run;
