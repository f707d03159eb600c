//! The view with light followed by chance: a pupil, the plate's micro-structure, all reflections.

use super::Shot;
use crate::arguments::length;
use crate::failure::Failure;
use crate::output::{INTERRUPTED, stop_on_interrupt};
use crate::progress::Bar;
use crate::summary::{Voice, milliseconds, number, paths, wrote};
use clap::ValueEnum;
use midair::Monitor as _;
use midair::files::Output;
use midair::picture::Depth;
use midair::scene::Loaded;
use midair::scene::model::PlateModel;
use midair::simulate::tone::{Exposure, write_layers, write_png};
use midair::simulate::{Light, Progress, Render, Settings, Viewer, render};
use serde_json::{Value, json};
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// A pixel of the render takes as much memory as this many rays along each side.
pub const MEMORY_AS_RAYS: usize = 2;

/// A picture under way is written again when the last one is older than this.
const REFRESH: Duration = Duration::from_secs(10);

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Monte Carlo path tracing")]
pub struct Options {
    /// Paths per pixel; rounded up to a multiple of 8, best a power of two [default: 256]
    #[arg(long, value_name = "N", conflicts_with = "supersampling", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    spp: Option<u32>,
    /// Model of the plate [default: the scene's]
    #[arg(long, value_name = "MODEL")]
    plate: Option<Model>,
    /// Diameter of the pupil in mm: an eye's is 2 to 8, a camera's its focal length over its f-number [default: 0]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = length)]
    aperture: Option<f64>,
    /// Focus distance from the eye in mm [default: the image's plane]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = length)]
    focus: Option<f64>,
    /// Which light is shown [default: all]
    #[arg(long, value_name = "LIGHT")]
    light: Option<Which>,
    /// Exposure of a PNG: a factor, or auto, which maps the 99th percentile to white [default: auto]
    #[arg(long, value_name = "auto|FACTOR", allow_negative_numbers = true)]
    exposure: Option<Brightness>,
    /// Seed of the random numbers [default: 0]
    #[arg(long, value_name = "N")]
    seed: Option<u32>,
}

impl Options {
    /// Whether any of them is given.
    pub fn any(&self) -> bool {
        self.spp.is_some()
            || self.plate.is_some()
            || self.aperture.is_some()
            || self.focus.is_some()
            || self.light.is_some()
            || self.exposure.is_some()
            || self.seed.is_some()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Model {
    /// Plane symmetry, without loss
    Ideal,
    /// Two crossed layers of slit mirrors, with the scene's dimensions or typical ones
    SlitMirror,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Which {
    /// The mid-air image alone
    Real,
    /// Stray images and what is seen through the plate
    Stray,
    /// All light
    All,
}

/// `auto` or a factor.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Brightness(Exposure);

impl FromStr for Brightness {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self(Exposure::Auto));
        }
        match text.parse::<f64>() {
            Ok(factor) if factor > 0.0 && factor <= 1e6 => Ok(Self(Exposure::Fixed(factor))),
            _ => Err("give auto, or a number above 0, at most 1000000".to_owned()),
        }
    }
}

pub fn run(options: &Options, shot: Shot, voice: Voice) -> Result<ExitCode, Failure> {
    let Shot { loaded, setup, still, camera, mut outputs, notes } = shot;
    let own = loaded.scene.plate.model;
    let model = match options.plate {
        None => own,
        Some(Model::Ideal) => PlateModel::Ideal,
        Some(Model::SlitMirror) => PlateModel::SlitMirror(own.or_slit_mirror()),
    };
    let setup = setup
        .with_plate_model(&own, &model)
        .map_err(|error| Failure::new(error.to_string(), "ask for --plate ideal"))?;
    let viewer = Viewer { camera, aperture: options.aperture.unwrap_or(0.0), focus: options.focus };
    let default = Settings::default();
    let settings = Settings {
        samples_per_pixel: options.spp.unwrap_or(default.samples_per_pixel),
        seed: options.seed.unwrap_or(default.seed),
    };
    let light = match options.light.unwrap_or(Which::All) {
        Which::Real => Light::Real,
        Which::Stray => Light::Stray,
        Which::All => Light::All,
    };
    let exposure = options.exposure.map_or(Exposure::Auto, |Brightness(exposure)| exposure);
    let depth = if still.depth == Depth::Eight { Depth::Eight } else { Depth::Sixteen };

    let picture = Picture { light, exposure, depth };

    let start = Instant::now();
    let bar = Bar::new();
    let mut written: Option<Instant> = None;
    let mut shown = 0;
    let mut trouble = None;
    let cancel = stop_on_interrupt();
    let mut pass = |progress: &Progress| {
        if shown == 0 {
            bar.stage("paths of light", progress.total as usize);
        }
        bar.advance((progress.samples_per_pixel - shown) as usize);
        shown = progress.samples_per_pixel;
        let due = written.is_none_or(|when: Instant| when.elapsed() >= REFRESH);
        // The whole one is written below.
        if due && shown < progress.total {
            if let Err(failure) = picture.write(&progress.preview(), &mut outputs) {
                trouble = Some(failure);
                cancel.store(true, Ordering::SeqCst);
            }
            written = Some(Instant::now());
        }
    };
    let rendered = render(&setup, &still.picture, &viewer, &settings, &bar, &mut pass);
    let view = rendered.map_err(|error| Failure::new(error.to_string(), "change that option"))?;
    bar.finish();
    if let Some(failure) = trouble {
        return Err(failure);
    }
    let time = start.elapsed();
    if view.paths == 0 {
        return Err(Failure::new(
            "interrupted before the first paths were followed",
            "let it run a little longer, or ask for fewer pixels by --size",
        ));
    }
    let factor = picture.write(&view, &mut outputs)?;
    let mut files = Vec::new();
    for (output, _) in outputs {
        files.extend(output.finish()?);
    }

    voice.note(&notes);
    let told = Told { loaded: &loaded, viewer: &viewer, model: &model, settings, light };
    let dispersion = setup.disperses();
    let mut value = told.json(&view, dispersion);
    value["exposure"] = json!(factor);
    value["timings_ms"] = json!({ "view": milliseconds(time) });
    value["files"] = paths(&files);
    value["notes"] = json!(notes);
    let bright = match factor {
        Some(factor) => format!("PNG: light times {factor:.4}"),
        None => "linear light".to_owned(),
    };
    let speed = view.paths as f64 / time.as_secs_f64() * 1e-6;
    let lines = format!(
        "{}{bright}\n{:.1} s, {speed:.1} million paths a second\n{}",
        told.lines(&view),
        time.as_secs_f64(),
        wrote(&files)
    );
    voice.tell(&lines, &value)?;
    Ok(if view.complete { ExitCode::SUCCESS } else { ExitCode::from(INTERRUPTED) })
}

/// How a render becomes files.
#[derive(Clone, Copy)]
struct Picture {
    light: Light,
    exposure: Exposure,
    depth: Depth,
}

impl Picture {
    /// Puts the files in their place, whole; returns the factor on a PNG's light, if there is one.
    fn write(
        self,
        view: &Render,
        outputs: &mut [(Output, OsString)],
    ) -> Result<Option<f64>, Failure> {
        let mut factor = None;
        for (output, name) in outputs {
            if Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
                output.write(&name, |path| write_layers(path, view, self.light))?;
            } else {
                let shown = view.view(self.light);
                let write = |path: &Path| write_png(path, &shown, self.exposure, self.depth);
                factor = Some(output.write(&name, write)?);
            }
            output.publish()?;
        }
        Ok(factor)
    }
}

/// What is said of a render.
struct Told<'a> {
    loaded: &'a Loaded,
    viewer: &'a Viewer,
    model: &'a PlateModel,
    settings: Settings,
    light: Light,
}

impl Told<'_> {
    fn model(&self) -> &'static str {
        match self.model {
            PlateModel::Ideal => "ideal",
            PlateModel::SlitMirror(_) => "slit-mirror",
        }
    }

    fn lines(&self, view: &Render) -> String {
        let [width, height] = self.viewer.camera.size;
        let light = match self.light {
            Light::Real => "the mid-air image alone",
            Light::Stray => "stray light alone",
            Light::All => "all light",
        };
        let [least, most] = view.samples_per_pixel;
        let held = if least == most { format!("{least}") } else { format!("{least} to {most}") };
        let asked = self.settings.samples_per_pixel;
        let stopped = match view.complete {
            true => String::new(),
            false => format!(" of {asked}: interrupted"),
        };
        format!(
            "{}: a view of {width} x {height} pixels through the {} plate, {light}; {held} paths a pixel{stopped}\n\
             luminance {:.4} +- {:.4} in the mean, each pixel +- {:.4} (standard errors, white = 1)\n",
            self.loaded.scene.name,
            self.model(),
            view.mean_luminance,
            view.error.of_mean,
            view.error.noise,
        )
    }

    fn json(&self, view: &Render, dispersion: bool) -> Value {
        let eye = self.viewer.camera.eye;
        json!({
            "scene": self.loaded.scene.name,
            "size": self.viewer.camera.size,
            "from": [eye.x, eye.y, eye.z],
            "window": self.viewer.camera.window,
            "plate": self.model(),
            "aperture": self.viewer.aperture,
            "focus": self.viewer.focus,
            "light": match self.light {
                Light::Real => "real",
                Light::Stray => "stray",
                Light::All => "all",
            },
            "dispersion": dispersion,
            "seed": self.settings.seed,
            "samples_per_pixel": view.samples_per_pixel,
            "complete": view.complete,
            "paths": view.paths,
            "luminance": number(view.mean_luminance),
            "error": { "mean": number(view.error.of_mean), "pixel": number(view.error.noise) },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposures_are_read_and_typos_refused() {
        assert_eq!("auto".parse(), Ok(Brightness(Exposure::Auto)));
        assert_eq!("2.5".parse(), Ok(Brightness(Exposure::Fixed(2.5))));
        for wrong in ["", "Auto", "0", "-1", "nan", "inf", "1e9"] {
            assert!(wrong.parse::<Brightness>().is_err(), "{wrong}");
        }
    }
}
