//! What a check says of the plate's stray light.

use crate::failure::Failure;
use crate::summary::percent;
use midair::map::Map;
use midair::media::Picture;
use midair::optics::plate::SlitMirrorPlate;
use midair::scene::model::{PlateModel, SlitMirror};
use midair::simulate::{StrayView, best_azimuth, stray_view};
use midair::transport::Setup;
use serde_json::{Value, json};

/// Views of stray light show this much more than the image, along each side.
const WINDOW: f64 = 4.0;
/// Their width and height in pixels.
const PIXELS: usize = 384;
/// Places of the image that are looked at.
const GRID: [usize; 2] = [64; 2];
/// Azimuths of the plate that are tried, degrees: a quarter turn is all that there is.
const LIMITS: [f64; 2] = [0.0, 90.0];
const STEP: f64 = 2.5;

/// The kinds of stray light, in words.
const KINDS: [&str; 3] = [
    "stray image turned by the first layer",
    "stray image turned by the second layer",
    "the display seen through the plate",
];

/// Where stray light falls.
pub struct Stray {
    near: StrayView,
    wide: StrayView,
    azimuth: f64,
    best: (f64, StrayView),
    assumed: bool,
}

impl Stray {
    /// Looks at the plate that the scene has; at the usual slit-mirror plate if the scene's is ideal and `asked` for.
    pub fn of(
        model: &PlateModel,
        setup: &Setup,
        map: &Map,
        asked: bool,
    ) -> Result<Option<Self>, Failure> {
        let (parameters, assumed) = match model {
            PlateModel::SlitMirror(parameters) => (*parameters, false),
            PlateModel::Ideal if asked => (SlitMirror::default(), true),
            PlateModel::Ideal => return Ok(None),
        };
        let plate = SlitMirrorPlate::new(parameters)
            .map_err(|error| Failure::new(error.to_string(), "change the scene's [plate]"))?;
        let near = stray_view(setup, &plate, map, GRID, 1.0);
        let wide = stray_view(setup, &plate, map, [PIXELS; 2], WINDOW);
        let best = best_azimuth(setup, &plate, map, &near, LIMITS, STEP);
        Ok(Some(Self { near, wide, azimuth: parameters.azimuth, best, assumed }))
    }

    /// For people.
    pub fn lines(&self) -> String {
        let mut lines = String::new();
        if self.assumed {
            lines += "the scene's plate is ideal; with the usual slit-mirror plate:\n";
        }
        for (kind, name) in KINDS.iter().enumerate() {
            let covered = self.near.covered(kind);
            if covered > 0.0 {
                lines += &format!(
                    "{name}: over {} of the image, up to {} as bright\n",
                    percent(covered),
                    percent(self.near.brightness(kind))
                );
            } else if self.wide.brightness(kind) > 0.0 {
                lines += &format!("{name}: beside the image\n");
            }
        }
        if self.near.burden() == 0.0 {
            lines += "no stray light lies over the image\n";
        } else if self.best.0 == self.azimuth {
            lines += "no turn of the plate in its plane leaves less of it over the image\n";
        } else {
            lines += &format!(
                "the plate turned in its plane to azimuth = {} would leave {} of the image's light instead of {}\n",
                self.best.0,
                percent(self.best.1.burden()),
                percent(self.near.burden())
            );
        }
        lines
    }

    /// For the summary in JSON.
    pub fn json(&self) -> Value {
        let kind = |kind: usize| {
            json!({
                "kind": KINDS[kind],
                "covered": self.near.covered(kind),
                "brightness": self.near.brightness(kind),
            })
        };
        json!({
            "assumed_plate": self.assumed,
            "kinds": [kind(0), kind(1), kind(2)],
            "over_image": self.near.burden(),
            "azimuth": self.azimuth,
            "best_azimuth": self.best.0,
            "over_image_at_best": self.best.1.burden(),
            "azimuths_tried": { "from": LIMITS[0], "to": LIMITS[1], "step": STEP },
        })
    }

    /// The image (white) with the two stray images (orange and blue) and what is seen through the plate (green), four times
    /// as wide as the image: luminances over the image's brightest.
    pub fn picture(&self) -> Picture {
        let most = self.wide.image.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let colours = [[1.0, 0.45, 0.1], [0.15, 0.4, 1.0], [0.2, 0.8, 0.3]];
        let pixels = (0..self.wide.image.len()).map(|pixel| {
            let mut rgb = [self.wide.image[pixel] / most; 3];
            for (kind, colour) in self.wide.stray.iter().zip(colours) {
                (0..3).for_each(|c| rgb[c] += colour[c] * kind[pixel] / most);
            }
            let [r, g, b] = rgb.map(|value| value.min(1.0) as f32);
            [r, g, b, 1.0]
        });
        let [width, height] = self.wide.size;
        Picture { width, height, pixels: pixels.collect() }
    }
}
