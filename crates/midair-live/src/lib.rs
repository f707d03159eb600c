//! The live show without a window: what is shown ([`Player`]), to whom ([`listen`], [`Steady`]), through which map ([`start`]) and how bright.
//!
//! Threads hand one another the newest of everything ([`Newest`]): a show never waits, it leaves out what was overtaken.
#![deny(missing_docs)]

mod brightness;
mod lit;
mod newest;
mod nudge;
mod solver;
mod source;
mod spent;
mod steady;
mod tracker;
mod trial;

pub use lit::Lit;
pub use newest::{Late, Newest};
pub use nudge::{Nudge, Target};
pub use solver::{COLOURS, Job, Request, Settled, Solved, start};
pub use source::{Frame, Player, SourceError, SourceKind};
pub use spent::Spent;
pub use steady::{OneEuro, Steady};
pub use tracker::{Calibration, Protocol, Reading, listen, parse_opentrack, parse_osc};
pub use trial::{Departures, Latency, Stages, Trial, latency, send};
