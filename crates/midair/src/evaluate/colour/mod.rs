//! Brightness and colour of the mid-air image in figures: how even a white field is, how wide colour fringes are, with and without
//! what `midair compensate --gain` and `--per-channel` do.
//!
//! Both look at displays of few pixels, so that they cost little beside a map in full. Places whose display pixels straddle a jump of the
//! map, where no compensation can be right, are left out.

mod evenness;
mod fringes;
#[cfg(test)]
mod tests;

pub use evenness::{Evenness, evenness};
pub use fringes::{FringeWidth, Fringes, fringes};

use super::proof::displacement::interpolated;
use super::proof::{ProofError, Settings};
use super::stray::{Stray, stray};
use crate::clock::Laps;
use crate::error::Error;
use crate::map::Map;
use crate::scene::Loaded;
use crate::transport::Setup;
use serde::ser::SerializeMap as _;
use serde::{Serialize, Serializer};
use std::time::Duration;

/// Brightness, fringes where a material disperses, and stray light; serialised, their figures.
#[derive(Clone, Debug, Serialize)]
pub struct Colour {
    /// How even a white field is.
    #[serde(rename = "brightness")]
    pub evenness: Evenness,
    /// How wide colour fringes are; nothing if no material disperses.
    pub fringes: Option<Fringes>,
    /// Where stray light falls.
    pub stray: Stray,
    /// How long each took.
    #[serde(skip)]
    pub timings: Vec<(&'static str, Duration)>,
}

/// Width of the white field's views in pixels.
const FIELD: usize = 256;

/// Looks at a set-up as `midair compensate --gain` and `--per-channel` and `midair check --stray` do. `map` is the set-up's, for all colours.
///
/// # Errors
/// Where the scene cannot be traced, or its plate not be.
pub fn colour(
    loaded: &Loaded,
    setup: &Setup,
    settings: &Settings,
    map: &Map,
) -> Result<Colour, Error> {
    let mut laps = Laps::start();
    let evenness = evenness(setup, setup.view_size(FIELD));
    laps.lap("brightness");
    let of = |setup| -> Result<Fringes, ProofError> {
        fringes(setup, map, &settings.lattice, settings.view[0])
    };
    let fringes = setup.disperses().then(|| of(setup)).transpose()?;
    laps.lap("fringes");
    let stray = stray(&loaded.scene.plate.model, setup, map)?;
    laps.lap("stray");
    Ok(Colour { evenness, fringes, stray, timings: laps.into_all() })
}

/// Without the pictures.
impl Serialize for Evenness {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Range {
            least: Option<f32>,
            most: Option<f32>,
            size: [usize; 2],
        }
        #[derive(Serialize)]
        struct Field {
            uncompensated: f64,
            compensated: f64,
        }
        #[derive(Serialize)]
        struct Level {
            level: f64,
            clipped: f64,
        }
        let range = self.gain.range();
        let gain = Range {
            least: range.map(|[least, _]| least),
            most: range.map(|[_, most]| most),
            size: [self.gain.width, self.gain.height],
        };
        let mut map = serializer.serialize_map(Some(4))?;
        map.serialize_entry("gain", &gain)?;
        map.serialize_entry(
            "white_field",
            &Field { uncompensated: self.plain, compensated: self.even },
        )?;
        map.serialize_entry("fit", &Level { level: self.fit_level, clipped: 0.0 })?;
        map.serialize_entry("clip", &Level { level: self.clip_level, clipped: self.clipped })?;
        map.end()
    }
}

/// Without the pictures.
impl Serialize for Fringes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(4))?;
        map.serialize_entry("one_map", &self.one_map)?;
        map.serialize_entry("per_channel", &self.by_colour)?;
        map.serialize_entry("places", &self.places)?;
        map.serialize_entry("resolution_per_channel", &self.resolution)?;
        map.end()
    }
}

/// The set-up with its display no finer than `most` pixels along a side, in the same proportions.
fn coarse(mut setup: Setup, most: usize) -> Setup {
    let longer = setup.resolution[0].max(setup.resolution[1]);
    if longer > most {
        setup.resolution =
            setup.resolution.map(|side| ((side * most + longer / 2) / longer).max(1));
    }
    setup
}

/// Whether the map shows at the display's place st what belongs at uv, to within `slack` of the image: no jump is straddled.
fn shows(map: &Map, st: [f64; 2], uv: [f64; 2], slack: f64) -> bool {
    interpolated(map, st).is_some_and(|shown| (0..2).all(|c| (shown[c] - uv[c]).abs() <= slack))
}
