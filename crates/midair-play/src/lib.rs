//! The live show: a window on the light source's screen that shows the compensated source and follows the viewer.
//!
//! Threads: the window's (warps the newest frame by the newest map and presents it), the source's (frames at their times), the tracker's
//! (packets), and the solver's (a map for the newest viewpoint; older requests are dropped, so that the show never waits; and its gain, in
//! the time until the next). Frames are warped by a graphics device or by the processor, whose kernels (`midair::picture::Warp`) take a few
//! milliseconds for a full-HD frame, so that a machine without a graphics card can run the show; both show the same codes.

mod brightness;
mod draw;
mod keys;
mod letters;
mod lit;
mod nudge;
mod options;
mod present;
mod show;
mod solver;
mod source;
mod steady;
mod tracker;
mod trial;

pub use nudge::{Nudge, Target};
pub use options::{Options, PlayError, Renderer};
pub use show::{Outcome, run};
pub use source::SourceKind;
pub use steady::{OneEuro, Steady};
pub use tracker::{Calibration, Protocol, Reading, parse_opentrack, parse_osc};
pub use trial::{Latency, Stages, Trial};
