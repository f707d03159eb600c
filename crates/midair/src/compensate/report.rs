//! What a compensation is, in figures.

use super::{Compensation, Method};
use crate::map::{Counts, Effort, ImagePoint, formation};
use crate::picture::Overflow;
use serde::{Serialize, Serializer};
use std::time::Duration;

/// What a compensation is, in figures: the data of `report.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// How the maps were made.
    #[serde(flatten)]
    pub method: Method,
    /// Display pixels: width, height.
    pub size: [usize; 2],
    /// The map's pixels by status.
    pub status: Counts,
    /// What becomes of the image.
    pub image: ImageReport,
    /// Largest |uv - exact| over the ok pixels of all maps; `None` where none is proved.
    pub error_bound: Option<f64>,
    /// Rays traced for all maps.
    pub rays: u64,
    /// What the inversion did.
    pub effort: Option<Effort>,
    /// Each colour's own map; `None` where one map serves all.
    pub colours: Option<ByColour>,
    /// The time that the maps took.
    #[serde(skip)]
    pub time: Duration,
}

/// What becomes of the image, over 64 x 64 of its points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ImageReport {
    /// The share that is formed.
    pub formed: f64,
    /// The share whose display pixels are seen at other image points as well.
    pub folded: f64,
}

/// Image points along a side that an [`ImageReport`] looks at.
const POINTS: usize = 64;
/// An image of which less is formed will not be recognised.
const LITTLE: f64 = 0.5;

impl ImageReport {
    /// Whether too little of the image is formed for a viewer to recognise it.
    pub fn is_little(&self) -> bool {
        self.formed < LITTLE
    }
}

/// Red's, green's and blue's.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ByColour {
    /// Of the display's red.
    pub red: ColourReport,
    /// Of its green.
    pub green: ColourReport,
    /// Of its blue.
    pub blue: ColourReport,
}

/// One colour's map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ColourReport {
    /// Its pixels by status.
    pub status: Counts,
    /// Rays traced.
    pub rays: u64,
}

/// What became of a display image's brightness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Brightness {
    /// The gain that was divided out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<GainReport>,
    /// Fraction of the samples that are darker than the display's black, so that the image stays too bright there; `None` for a display that
    /// is sent sRGB codes as they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub darker_than_black: Option<f64>,
}

/// The gain that was divided out of a display image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct GainReport {
    /// What was done where the display is not bright enough.
    #[serde(serialize_with = "overflow_name")]
    pub mode: Overflow,
    /// How bright white is in the mid-air image, over the display's white.
    pub level: f64,
    /// Fraction of the samples that the display's white was not bright enough for.
    pub clipped: f64,
    /// Least gain; `None` where the map has no answer.
    pub least: Option<f32>,
    /// Largest gain.
    pub most: Option<f32>,
}

fn overflow_name<S: Serializer>(overflow: &Overflow, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(overflow.name())
}

impl Compensation {
    fn image(&self) -> ImageReport {
        let shares = formation(self.setup(), self.map(), [POINTS; 2]).shares();
        let share = |point| shares.get(&point).copied().unwrap_or(0.0);
        ImageReport { formed: share(ImagePoint::Formed), folded: share(ImagePoint::Folded) }
    }

    /// What it is, in figures.
    pub fn report(&self) -> Report {
        let bound = self.solved().iter().fold(0.0, |worst: f64, s| worst.max(s.map.error_bound));
        let colour = |c: usize| {
            let solved = &self.solved()[c];
            ColourReport { status: solved.map.counts(), rays: solved.rays }
        };
        Report {
            method: self.method,
            size: self.setup().resolution,
            status: self.map().counts(),
            image: self.image(),
            error_bound: bound.is_finite().then_some(bound),
            rays: self.solved().iter().map(|solved| solved.rays).sum(),
            effort: self.main().effort,
            colours: self.is_by_colour().then(|| ByColour {
                red: colour(0),
                green: colour(1),
                blue: colour(2),
            }),
            time: self.solved().iter().map(|solved| solved.time).sum(),
        }
    }
}
