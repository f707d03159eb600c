//! The live show without a window: what happens goes into a [`Show`], what is to be seen comes out of it.
//!
//! A show is told of frames, packets of a tracker, maps and [`Command`]s, each with a reading of the clock, and asks for maps
//! ([`Show::take_job`]); a [`Solver`] makes them. It has neither threads nor a clock of its own, so that a test drives a whole show, and a
//! browser can. For programs there are threads that feed it: a [`Player`] of frames at their times, [`listen`] for a tracker, [`start`] for
//! the solver. They hand one another the newest of everything ([`Newest`]): a show never waits, it leaves out what was overtaken.
//!
//! [`Slides`] are pictures in the display's own pixels that follow one another, for a camera: by key, by time, or each when a command ([`release`]) has
//! photographed the last.
#![deny(missing_docs)]

mod arrangement;
mod attendance;
mod brightness;
mod clock;
mod command;
mod figures;
mod lit;
mod newest;
mod show;
mod shutter;
mod slides;
mod solver;
mod source;
mod spent;
mod steady;
mod tracker;
mod trial;
mod viewer;

pub use arrangement::{Nudge, Target};
pub use attendance::Hours;
pub use clock::{Clock, Pace};
pub use command::{Command, KEYS, Wish};
pub use newest::{Late, Newest};
pub use show::{Picture, Settings, Show};
pub use shutter::release;
pub use slides::{Act, GRACE, Slides, Turn};
pub use solver::{Found, Job, Request, Settled, Solved, Solver, start};
pub use source::{Frame, Player, SourceError, SourceKind};
pub use spent::Spent;
pub use steady::OneEuro;
pub use tracker::{Calibration, Heard, Protocol, Reading, listen, parse_opentrack, parse_osc};
pub use trial::{Departures, Latency, Stages, Trial, latency, send};
