//! What a check says of the plate's stray light.

use crate::failure::Failure;
use crate::summary::percent;
use midair::map::Map;
use midair::optics::plate::SlitMirrorPlate;
use midair::picture::{Picture, srgb};
use midair::scene::model::{PlateModel, SlitMirror};
use midair::simulate::{BestPose, PoseLimits, Sights, StrayView, best_pose};
use midair::transport::Setup;
use midair_report::drawing::stray_picture;
use serde_json::{Value, json};

/// Views of stray light show this much more than the image, along each side.
const WINDOW: f64 = 4.0;
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

/// The kinds of stray light, in words.
const KINDS: [&str; 3] = [
    "stray image turned by the first layer",
    "stray image turned by the second layer",
    "the display seen through the plate",
];

/// What they are drawn in, linear light.
const COLOURS: [[f32; 3]; 3] = [[1.0, 0.45, 0.1], [0.15, 0.4, 1.0], [0.2, 0.8, 0.3]];

/// Where stray light falls.
pub struct Stray {
    near: StrayView,
    wide: StrayView,
    azimuth: f64,
    best: BestPose,
    limits: PoseLimits,
    /// Where the display stands in the best pose, mm.
    display: [f64; 3],
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
        match model {
            PlateModel::Ideal if !asked => Ok(None),
            _ => Self::at_least_usual(model, setup, map).map(Some),
        }
    }

    /// The same with the usual slit-mirror plate wherever the scene's is ideal.
    pub fn at_least_usual(model: &PlateModel, setup: &Setup, map: &Map) -> Result<Self, Failure> {
        let (parameters, assumed) = match model {
            PlateModel::SlitMirror(parameters) => (*parameters, false),
            PlateModel::Ideal => (SlitMirror::default(), true),
        };
        let plate = SlitMirrorPlate::new(parameters)
            .map_err(|error| Failure::new(error.to_string(), "change the scene's [plate]"))?;
        let sights = Sights::new(setup, GRID, 1.0);
        let near = sights.through(&plate, setup, map);
        let wide = Sights::new(setup, [PIXELS; 2], WINDOW).through(&plate, setup, map);
        let limits = limits(setup);
        let best = best_pose(setup, &plate, map, &sights, &limits);
        let frame = &setup.display.frame;
        let display = (frame.origin + frame.normal() * best.shift).to_array();
        let azimuth = parameters.azimuth;
        Ok(Self { near, wide, azimuth, best, limits, display, assumed })
    }

    /// How much there is, in one line: for summaries of other things.
    pub fn line(&self) -> String {
        let plate = if self.assumed { "with the usual slit-mirror plate, " } else { "" };
        let better = self.best.view.burden() < self.near.burden();
        format!(
            "{plate}{} of the image's light is stray light over it{}\n",
            percent(self.near.burden()),
            if better { "; report.html says which pose has less" } else { "" }
        )
    }

    /// What there is, where, and what would be better.
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
        } else if self.best.azimuth == self.azimuth && self.best.shift == 0.0 {
            lines += &format!(
                "no turn of the plate in its plane, and no shift of the display along its normal by up to {:.0} mm, leaves less of it over the image\n",
                self.limits.shift[1]
            );
        } else {
            let mut pose = Vec::new();
            if self.best.azimuth != self.azimuth {
                pose.push(format!(
                    "the plate turned in its plane to azimuth = {}",
                    self.best.azimuth
                ));
            }
            if self.best.shift != 0.0 {
                let way =
                    if self.best.shift > 0.0 { "towards the plate" } else { "away from the plate" };
                let position = self.display.map(|c| (c * 100.0).round() / 100.0 + 0.0);
                pose.push(format!(
                    "the display moved {:.0} mm {way} to position = {position:?}",
                    self.best.shift.abs()
                ));
            }
            lines += &format!(
                "{} would leave {} of the image's light over it instead of {}\n",
                pose.join(" and "),
                percent(self.best.view.burden()),
                percent(self.near.burden())
            );
        }
        lines
    }

    /// For the summary in JSON.
    pub fn json(&self) -> Value {
        let limits = &self.limits;
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
            "best_azimuth": self.best.azimuth,
            "best_shift": self.best.shift,
            "best_display_position": self.display,
            "over_image_at_best": self.best.view.burden(),
            "azimuths_tried": {
                "from": limits.azimuth[0], "to": limits.azimuth[1], "step": limits.azimuth_step
            },
            "shifts_tried": { "from": limits.shift[0], "to": limits.shift[1], "step": limits.shift_step },
        })
    }

    /// [`Self::picture`] with what its colours mean.
    pub fn sheet(&self) -> Picture {
        let colours = [[255, 255, 255]].into_iter().chain(COLOURS.map(|c| c.map(srgb::encode_8)));
        let names = std::iter::once("the image").chain(KINDS).enumerate();
        let told = |(i, name): (usize, &str)| match i {
            0 => "the image, in the middle".to_owned(),
            _ if self.wide.brightness(i - 1) > 0.0 => {
                format!("{name}: up to {} as bright", percent(self.wide.brightness(i - 1)))
            }
            _ => format!("{name}: none"),
        };
        let legend: Vec<_> = colours.zip(names.map(told)).collect();
        let plate = if self.assumed { " of the usual slit-mirror plate" } else { "" };
        let title = format!("Stray light{plate}, four times as wide as the image");
        stray_picture::draw(&title, &self.picture(), &legend)
    }

    /// The image (white) with the two stray images (orange and blue) and what is seen through the plate (green), four times
    /// as wide as the image: luminances over the image's brightest.
    pub fn picture(&self) -> Picture {
        drawn(&self.wide)
    }

    /// The same, as wide as the image.
    pub fn close_up(&self) -> Picture {
        drawn(&self.near)
    }
}

fn drawn(view: &StrayView) -> Picture {
    let most = view.image.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let pixels = (0..view.image.len()).map(|pixel| {
        let mut rgb = [view.image[pixel] / most; 3];
        for (kind, colour) in view.stray.iter().zip(COLOURS) {
            (0..3).for_each(|c| rgb[c] += f64::from(colour[c]) * kind[pixel] / most);
        }
        let [r, g, b] = rgb.map(|value| value.min(1.0) as f32);
        [r, g, b, 1.0]
    });
    let [width, height] = view.size;
    Picture { width, height, pixels: pixels.collect() }
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
