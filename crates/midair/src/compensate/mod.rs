//! What the display must show.
//!
//! A [`Compensation`] is the answer for one viewpoint: a map for all colours or one for each, the gain along its paths, and from them
//! the display image of any picture. [`Report`] says in figures what it is.

mod best;
mod maps;
mod report;
mod shown;
#[cfg(test)]
mod tests;
mod uncompensated;

pub use maps::{Method, Solved};
pub use report::{Brightness, ByColour, ColourReport, GainReport, ImageReport, Report};
pub use shown::Shown;
pub(crate) use uncompensated::AsIs;
pub use uncompensated::uncompensated_map;

use crate::Monitor;
use crate::map::{Gain, Map};
use crate::picture::{Overflow, Picture, display_image, display_image_by_colour};
use crate::simulate::gain;
use crate::transport::Setup;

/// What is compensated for, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// How maps are made.
    pub method: Method,
    /// A map for each of the display's colours, at the wavelength that stands for it.
    pub by_colour: bool,
    /// Whether the gain is divided out of what is shown, and what is done where the display is not bright enough for that.
    pub gain: Option<Overflow>,
}

impl Options {
    /// One map by inversion, for all colours; the gain is left as it is.
    pub fn new() -> Self {
        Self::default()
    }

    /// With maps made in this way.
    pub fn method(self, method: Method) -> Self {
        Self { method, ..self }
    }

    /// With a map for each colour, or with one for all.
    pub fn by_colour(self, by_colour: bool) -> Self {
        Self { by_colour, ..self }
    }

    /// With the gain divided out in this way, or not.
    pub fn gain(self, gain: Option<Overflow>) -> Self {
        Self { gain, ..self }
    }
}

/// What a display must show so that its image looks undistorted from the set-up's viewpoint.
#[derive(Clone, Debug)]
pub struct Compensation {
    /// One for all colours, or red's, green's and blue's.
    solved: Vec<Solved>,
    /// The gain of each map.
    gains: Option<(Vec<Gain>, Overflow)>,
    method: Method,
}

impl Compensation {
    /// Works the maps out, and their gains where they are asked for.
    pub fn of(setup: &Setup, options: &Options, monitor: &dyn Monitor) -> Self {
        let setups = match options.by_colour {
            true => setup.by_colour().into(),
            false => vec![setup.clone()],
        };
        let solved: Vec<Solved> =
            setups.into_iter().map(|setup| Solved::make(setup, options.method, monitor)).collect();
        let plain = Self { solved, gains: None, method: options.method };
        match options.gain {
            Some(overflow) => plain.with_gain(overflow, monitor),
            None => plain,
        }
    }

    /// The same maps with their gains, which are divided out of what is shown.
    pub fn with_gain(self, overflow: Overflow, monitor: &dyn Monitor) -> Self {
        monitor.stage("gain", 1);
        let gains = self.solved.iter().map(|solved| gain(&solved.setup, &solved.map)).collect();
        Self { gains: Some((gains, overflow)), ..self }
    }

    /// The map that speaks for all: the one that there is, or green's.
    pub fn map(&self) -> &Map {
        &self.main().map
    }

    /// The set-up of [`map`](Self::map).
    pub fn setup(&self) -> &Setup {
        &self.main().setup
    }

    /// The solution that speaks for all.
    pub fn main(&self) -> &Solved {
        &self.solved[self.solved.len() / 2]
    }

    /// All solutions: one for all colours, or red's, green's and blue's.
    pub fn solved(&self) -> &[Solved] {
        &self.solved
    }

    /// Whether each colour has a map of its own.
    pub fn is_by_colour(&self) -> bool {
        self.solved.len() > 1
    }

    /// The gain of each solution's map, if it was asked for.
    pub fn gains(&self) -> Option<&[Gain]> {
        self.gains.as_ref().map(|(gains, _)| gains.as_slice())
    }

    /// The light that the display must emit to show a picture, before its gain is divided out: linear, premultiplied.
    pub fn light(&self, picture: &Picture) -> Picture {
        match self.solved.as_slice() {
            [r, g, b] => display_image_by_colour(picture, [&r.map, &g.map, &b.map]),
            _ => display_image(picture, self.map()),
        }
    }

    /// What the display must show of a picture: drawn through the maps, its gain divided out where that was asked for, encoded for the
    /// set-up's screen.
    pub fn display(&self, picture: &Picture) -> Shown {
        self.shown(self.light(picture))
    }
}
