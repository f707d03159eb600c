//! The plate's stray light over the image, and the pose of plate and display that leaves less of it.

use crate::map::Map;
use crate::optics::plate::{PlateError, SlitMirrorPlate};
use crate::scene::model::PlateModel;
use crate::simulate::{BestPose, PoseLimits, Sights, StrayView, best_pose};
use crate::transport::Setup;
use serde::{Serialize, Serializer};

/// Views of stray light show this much more than the image, along each side.
pub const WINDOW: f64 = 4.0;
/// Their width and height in pixels.
const PIXELS: usize = 384;
/// Places of the image that are looked at.
const GRID: [usize; 2] = [64; 2];
/// Azimuths of the plate that are tried, degrees: a quarter turn is all that there is.
const AZIMUTHS: [f64; 2] = [0.0, 90.0];
const AZIMUTH_STEP: f64 = 2.5;
/// How far the display is moved towards the plate and away from it, as a share of its distance from the plate; in so many steps either way.
const SHIFT: f64 = 0.2;
const SHIFTS: f64 = 2.0;

/// The kinds of stray light, in the order of [`STRAY`](crate::simulate::STRAY), in words.
pub const KINDS: [&str; 3] = [
    "stray image turned by the first layer",
    "stray image turned by the second layer",
    "the display seen through the plate",
];

/// Where stray light falls; serialised, in figures.
#[derive(Clone, Debug)]
pub struct Stray {
    /// Over the image.
    pub near: StrayView,
    /// Over four times the image's width and height.
    pub wide: StrayView,
    /// The azimuth of the plate's mirrors, degrees.
    pub azimuth: f64,
    /// The pose that leaves the least of it over the image.
    pub best: BestPose,
    /// Which poses were tried.
    pub limits: PoseLimits,
    /// Where the display's centre stands in the best pose, mm.
    pub display: [f64; 3],
    /// Whether the scene's plate is ideal: then the usual slit-mirror plate was looked at.
    pub assumed: bool,
}

/// Looks at the plate that the scene has, at the usual slit-mirror plate where that is ideal. `map` is the set-up's.
///
/// # Errors
/// [`PlateError`] where the plate cannot be.
pub fn stray(model: &PlateModel, setup: &Setup, map: &Map) -> Result<Stray, PlateError> {
    let (parameters, assumed) = model.slit_mirror_or_usual();
    let plate = SlitMirrorPlate::new(parameters)?;
    let sights = Sights::new(setup, GRID, 1.0);
    let near = sights.through(&plate, setup, map);
    let wide = Sights::new(setup, [PIXELS; 2], WINDOW).through(&plate, setup, map);
    let limits = limits(setup);
    let best = best_pose(setup, &plate, map, &sights, &limits);
    let frame = &setup.display.frame;
    let display = (frame.origin + frame.normal() * best.shift).to_array();
    Ok(Stray { near, wide, azimuth: parameters.azimuth, best, limits, display, assumed })
}

/// A quarter turn of the plate, and the display up to a fifth of its distance nearer to the plate or further off.
fn limits(setup: &Setup) -> PoseLimits {
    let frame = &setup.plate.rectangle.frame;
    let distance = (setup.display.frame.origin - frame.origin).dot(frame.normal()).abs();
    // Whole millimetres where there are any.
    let most = if distance * SHIFT >= SHIFTS {
        (distance * SHIFT / SHIFTS).round() * SHIFTS
    } else {
        distance * SHIFT
    };
    PoseLimits {
        azimuth: AZIMUTHS,
        azimuth_step: AZIMUTH_STEP,
        shift: [-most, most],
        shift_step: most / SHIFTS,
    }
}

/// Without the views.
impl Serialize for Stray {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Kind {
            kind: &'static str,
            covered: f64,
            brightness: f64,
        }
        #[derive(Serialize)]
        struct Tried {
            from: f64,
            to: f64,
            step: f64,
        }
        #[derive(Serialize)]
        struct Told {
            assumed_plate: bool,
            kinds: [Kind; 3],
            over_image: f64,
            azimuth: f64,
            best_azimuth: f64,
            best_shift: f64,
            best_display_position: [f64; 3],
            over_image_at_best: f64,
            azimuths_tried: Tried,
            shifts_tried: Tried,
        }
        let tried = |[from, to]: [f64; 2], step: f64| Tried { from, to, step };
        let told = Told {
            assumed_plate: self.assumed,
            kinds: [0, 1, 2].map(|kind| Kind {
                kind: KINDS[kind],
                covered: self.near.covered(kind),
                brightness: self.near.brightness(kind),
            }),
            over_image: self.near.burden(),
            azimuth: self.azimuth,
            best_azimuth: self.best.azimuth,
            best_shift: self.best.shift,
            best_display_position: self.display,
            over_image_at_best: self.best.view.burden(),
            azimuths_tried: tried(self.limits.azimuth, self.limits.azimuth_step),
            shifts_tried: tried(self.limits.shift, self.limits.shift_step),
        };
        told.serialize(serializer)
    }
}
