//! Making the maps, one or one for each colour, and their files.

use super::Method;
use crate::failure::Failure;
use crate::output::Output;
use crate::progress::Bar;
use crate::summary::Counts;
use midair::Monitor as _;
use midair::map::format::{Format, write_channels, write_map_and_gain};
use midair::map::{Accuracy, Gain, Map, Status, invert, splat};
use midair::transport::Setup;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// A map and what it took.
pub struct Solved {
    pub setup: Setup,
    pub map: Map,
    pub rays: u64,
    pub effort: Value,
    pub time: Duration,
}

/// The maps of all colours alike, or of red, green and blue.
pub struct Solutions(pub Vec<Solved>);

/// Names of the colours, as in files and in report.json.
pub const COLOURS: [&str; 3] = ["red", "green", "blue"];

impl Solutions {
    /// Makes a map for each set-up: one, or three for the display's colours.
    pub fn make(setups: Vec<Setup>, method: Method, spp: usize, bar: &Bar) -> Self {
        Self(setups.into_iter().map(|setup| solve(setup, method, spp, bar)).collect())
    }

    /// The one that speaks for all: green's.
    pub fn main(&self) -> &Solved {
        &self.0[self.0.len() / 2]
    }

    /// The one of a colour.
    pub fn of_colour(&self, c: usize) -> &Solved {
        &self.0[c.min(self.0.len() - 1)]
    }

    /// Whether each colour has a map of its own.
    pub fn by_colour(&self) -> bool {
        self.0.len() > 1
    }

    /// The time that all took.
    pub fn time(&self) -> Duration {
        self.0.iter().map(|solved| solved.time).sum()
    }

    /// Rays of all.
    pub fn rays(&self) -> u64 {
        self.0.iter().map(|solved| solved.rays).sum()
    }

    /// The largest error bound.
    pub fn error_bound(&self) -> f64 {
        self.0.iter().fold(0.0, |worst, solved| worst.max(solved.map.error_bound))
    }

    /// For report.json: each colour's counts; nothing if there is one map for all.
    pub fn colours_json(&self) -> Value {
        if !self.by_colour() {
            return Value::Null;
        }
        let entry = |(name, solved): (&&str, &Solved)| {
            let counts = Counts::of(&solved.map).json();
            ((*name).to_owned(), json!({ "status": counts, "rays": solved.rays }))
        };
        Value::Object(COLOURS.iter().zip(&self.0).map(entry).collect())
    }
}

/// Makes the map.
fn solve(setup: Setup, method: Method, spp: usize, bar: &Bar) -> Solved {
    let start = Instant::now();
    match method {
        Method::Inverse => {
            bar.stage("map", 1);
            let (map, effort) = invert(&setup, Accuracy::default());
            let time = start.elapsed();
            let told = json!({ "patches": effort.patches, "solved_pixels": effort.solved_pixels });
            Solved { setup, map, rays: effort.rays, effort: told, time }
        }
        Method::Splat => {
            bar.stage("samples of the view", setup.resolution[1]);
            let splat = splat(&setup, spp, &|rows| bar.advance(rows));
            let time = start.elapsed();
            Solved { setup, map: splat.map, rays: splat.rays, effort: Value::Null, time }
        }
    }
}

/// Writes the map in each format, under the format's file name with `name` in the place of "map", and its gain where there is a place
/// for it; returns what the user should know.
pub fn write_maps(
    output: &mut Output,
    map: &Map,
    gain: Option<&Gain>,
    name: &str,
    source: [usize; 2],
    formats: &[Format],
) -> Result<Vec<String>, Failure> {
    let mut notes = Vec::new();
    for &format in formats {
        let name = format.file_name().replacen("map", name, 1);
        let written =
            output.write(&name, |path| write_map_and_gain(map, gain, source, format, path))?;
        notes.extend(written.notes.into_iter().map(|note| format!("{name}: {note}")));
        if gain.is_some() && !matches!(format, Format::Exr | Format::ExrHalf) {
            notes.push(format!("{name}: this kind of map has no place for the gain; map.exr has"));
        }
    }
    Ok(notes)
}

/// Writes the maps of red, green and blue as one OpenEXR file of six channels and coverage.
pub fn write_six_channels(output: &mut Output, solutions: &Solutions) -> Result<(), Failure> {
    let mut channels = Vec::new();
    let maps: Vec<&Map> = solutions.0.iter().map(|solved| &solved.map).collect();
    for (map, names) in maps.iter().zip([["R.u", "R.v"], ["G.u", "G.v"], ["B.u", "B.v"]]) {
        for (axis, name) in names.into_iter().enumerate() {
            channels.push((name, map.uv.iter().map(|uv| uv[axis] as f32).collect()));
        }
    }
    let all_ok = |pixel: usize| maps.iter().all(|map| map.status[pixel] == Status::Ok);
    let [width, height] = [maps[0].width, maps[0].height];
    channels.push(("A", (0..width * height).map(|pixel| f32::from(all_ok(pixel))).collect()));
    output.write("map_rgb.exr", |path| write_channels(path, width, height, channels, false))
}
