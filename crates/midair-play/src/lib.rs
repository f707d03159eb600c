//! The window of the live show, on the light source's screen: keys, drawing, presenting. The show itself is `midair_live`'s.
//!
//! Threads: the window's (warps the newest frame by the newest map and presents it), the source's (frames at their times), the tracker's
//! (packets), and the solver's (a map for the newest viewpoint; older requests are dropped, so that the show never waits; and its gain, in
//! the time until the next). Frames are warped by a graphics device (`midair_gpu`) or by the processor, whose kernels
//! (`midair::picture::Warp`) take a few milliseconds for a full-HD frame, so that a machine without a graphics card can run the show; both
//! show the same codes.

mod draw;
mod keys;
mod letters;
mod options;
mod present;
mod show;

pub use options::{Options, PlayError, Renderer};
pub use show::{Outcome, run};
