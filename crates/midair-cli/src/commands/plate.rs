//! `midair plate`: a plate's character as pictures and numbers.

use crate::arguments::{length, open_scene};
use crate::failure::Failure;
use crate::summary::{Voice, number, paths, percent, wrote};
use midair::files::write_bytes_atomically;
use midair::geometry::Vec3;
use midair::optics::plate::character::{
    Arrangement, Directions, PointSpread, PointSpreadSettings, Span, Viewpoints, VisibleRange,
    over_directions, over_viewpoints, point_spread,
};
use midair::optics::plate::{
    Class, Shares, SlitMirror, SlitMirrorPlate, luminance, viewing_angles,
};
use midair::picture::{Depth, Picture, write_still};
use midair::scene::Loaded;
use midair::scene::model::PlateModel;
use midair::transport::Setup;
use midair_report::drawing::chart_sheet::{Axis, Curve, curves, map, row};
use midair_report::drawing::{point_spread_chart, shares_chart, viewpoints_chart};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Characterise a plate: efficiency by direction, luminance by viewpoint, sharpness
///
/// Writes shares.png (what becomes of light over incidence and azimuth: mid-air image, stray light, through), viewpoints.png (the
/// image's luminance over the viewer's azimuth and elevation), sharpness.png (how a point of the image spreads, and the modulation
/// transfer in the image's plane) and plate.json with all numbers. The scene's elements are left out.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  midair plate scene.toml --out plate
  midair plate scene.toml --out plate --aperture 25")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR", default_value = "out/plate")]
    out: PathBuf,
    /// Diameter in mm of the pupil that looks at the point: an eye's is 2 to 8
    #[arg(long, value_name = "MM", default_value = "4", allow_negative_numbers = true, value_parser = length)]
    aperture: f64,
}

/// Angles of incidence, degrees; light along the plate does not pass.
const INCIDENCE: [f64; 2] = [0.0, 90.0];
/// Azimuths from the plate's +x, degrees: the rest repeats these, for two crossed layers are the same after a
/// quarter turn.
const AZIMUTH: [f64; 2] = [0.0, 90.0];
/// Viewers' azimuths and elevations, degrees.
const VIEWERS: [f64; 2] = [-60.0, 60.0];
/// Points of the image along each side whose mean luminance counts.
const POINTS: usize = 5;
/// Lines of sight of the point spread.
const RAYS: usize = 200_000;
/// Cells along each side of the point spread's picture.
const CELLS: usize = 80;

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let loaded = open_scene(&arguments.scene, None)?;
    let mut notes = loaded.notes.clone();
    let character = Character::of(&loaded, arguments.aperture, &mut notes)?;
    let mut output = crate::output::into_folder(&arguments.out)?;
    for (name, picture) in [
        ("shares.png", character.shares()),
        ("viewpoints.png", character.viewpoints()),
        ("sharpness.png", character.sharpness()),
    ] {
        output.write(name, |path| write_still(path, &picture, Depth::Eight))?;
    }
    let mut told = character.json();
    told["notes"] = json!(notes);
    let text = format!("{told:#}\n");
    output.write("plate.json", |path| write_bytes_atomically(path, text.as_bytes()))?;
    let files = output.finish()?;
    voice.note(&notes);
    // The grids are in the file.
    let mut summary = json!({
        "scene": told["scene"],
        "plate": told["plate"],
        "from_viewpoint": told["from_viewpoint"],
        "visible_range": told["viewpoints"]["visible_range"],
        "deviation_mm": told["point_spread"]["deviation_mm"],
        "half_transfer_per_mm": told["modulation_transfer"]["half_per_mm"],
        "notes": told["notes"],
    });
    summary["files"] = paths(&files);
    voice.tell(&format!("{}{}", character.lines(), wrote(&files)), &summary)
}

/// All that is shown.
struct Character {
    scene: String,
    model: SlitMirror,
    measured: bool,
    directions: Directions,
    viewpoints: Viewpoints,
    range: Option<VisibleRange>,
    /// From the viewpoint to the image's centre, mm.
    distance: f64,
    /// Incidence (degrees) of the line of sight from the viewpoint to the image's centre, and what becomes of
    /// light along it.
    incidence: f64,
    shares: Shares,
    settings: PointSpreadSettings,
    spread: PointSpread,
    /// Side of the square that the point spread is shown in, mm.
    extent: f64,
    frequencies: Vec<f64>,
    transfer: [Vec<f64>; 2],
}

impl Character {
    fn of(loaded: &Loaded, aperture: f64, notes: &mut Vec<String>) -> Result<Self, Failure> {
        let parameters = match loaded.scene.plate.model {
            PlateModel::SlitMirror(parameters) => parameters,
            PlateModel::Ideal => {
                notes.push(
                    "the scene's plate is ideal: what is shown is the usual slit-mirror plate \
                     (write model = \"slit-mirror\" with its values in the scene's [plate])"
                        .to_owned(),
                );
                SlitMirror::default()
            }
        };
        if !loaded.scene.elements.is_empty() {
            notes.push("the scene's elements are left out".to_owned());
        }
        let model = SlitMirrorPlate::new(parameters)
            .map_err(|error| Failure::new(error.to_string(), format!("give {}", error.allowed)))?;
        let mut setup = Setup::new(loaded)?.with_plate(model.clone().into()).unobstructed();
        if let Some(table) = &loaded.luminance {
            setup.plate = setup.plate.with_luminance(table.clone(), &setup.image.frame);
        }
        let plate = &setup.plate;
        let centre = setup.image.frame.origin;
        let distance = (setup.viewpoint - centre).length();
        let sight = (centre - setup.viewpoint).normalized();
        let local = setup.plate.rectangle.frame.to_local_direction(sight);
        let in_image = setup.image.frame.to_local_direction(sight);
        let arrangement =
            Arrangement { plate: plate.rectangle, image: setup.image, display: setup.display };
        let angles = steps(VIEWERS, 2.0);
        let efficiency = |d: Vec3| plate.model().efficiency(d);
        let viewpoints =
            over_viewpoints(&arrangement, distance, &angles, &angles, POINTS, efficiency);
        let settings = PointSpreadSettings {
            eye: setup.viewpoint,
            pupil: aperture,
            rays: RAYS,
            lattice_averaged: true,
        };
        let spread = point_spread(&model, &plate.rectangle, &setup.image, centre, &settings);
        // Up to where a slit is two periods wide.
        let highest = 2.0 / parameters.pitch;
        let frequencies: Vec<f64> = (0..=80).map(|i| highest * f64::from(i) / 80.0).collect();
        let transfer = spread.modulation_transfer(&frequencies);
        Ok(Self {
            scene: loaded.scene.name.clone(),
            model: parameters,
            measured: loaded.luminance.is_some(),
            directions: over_directions(&model, &steps(INCIDENCE, 1.0), &steps(AZIMUTH, 1.0)),
            range: viewpoints.visible_range_from(viewing_angles(-in_image)),
            viewpoints,
            distance,
            incidence: local.z.abs().min(1.0).acos().to_degrees(),
            shares: model.shares(local),
            settings,
            extent: extent(&spread, parameters.pitch),
            spread,
            frequencies,
            transfer,
        })
    }

    fn shares(&self) -> Picture {
        let x = Axis { label: "incidence, degrees", range: INCIDENCE, intervals: 3 };
        let y =
            Axis { label: "azimuth from the plate's +x, degrees", range: AZIMUTH, intervals: 3 };
        row(&[
            (Class::Real, "Mid-air image"),
            (Class::Stray, "Stray light"),
            (Class::Through, "Through, as by a window"),
        ]
        .map(|(class, title)| map(&shares_chart(&self.directions, class, 4), title, &x, &y)))
    }

    fn viewpoints(&self) -> Picture {
        let x = Axis { label: "viewer's azimuth, degrees", range: VIEWERS, intervals: 4 };
        let y = Axis { label: "viewer's elevation, degrees", range: VIEWERS, intervals: 4 };
        let title = match self.measured {
            true => "Luminance of the image over the display's, measured",
            false => "Luminance of the image over the display's",
        };
        map(&viewpoints_chart(&self.viewpoints, 7), title, &x, &y)
    }

    fn sharpness(&self) -> Picture {
        let half = 0.5 * self.extent;
        let x = Axis { label: "x in the image, mm", range: [-half, half], intervals: 4 };
        let y = Axis { label: "y in the image, mm", range: [-half, half], intervals: 4 };
        let spread = point_spread_chart(&self.spread, self.extent, CELLS, 5);
        let highest = self.frequencies.last().copied().unwrap_or(1.0);
        let frequency = Axis { label: "cycles per mm", range: [0.0, highest], intervals: 4 };
        let contrast = Axis { label: "contrast", range: [0.0, 1.0], intervals: 4 };
        let points = |axis: usize| {
            let pairs = self.frequencies.iter().zip(&self.transfer[axis]);
            pairs.map(|(&f, &m)| [f, m]).collect::<Vec<_>>()
        };
        let lines = [
            Curve { name: "across x", colour: [0, 114, 178], points: points(0) },
            Curve { name: "across y", colour: [213, 94, 0], points: points(1) },
        ];
        row(&[
            map(&spread, "A point of the image", &x, &y),
            curves(&lines, [400, 400], "Modulation transfer", &frequency, &contrast),
        ])
    }

    /// The lowest frequency at which a transfer has fallen to a half, between the frequencies that it is known at.
    fn half(&self, axis: usize) -> Option<f64> {
        let m = &self.transfer[axis];
        let first = m.iter().position(|&m| m < 0.5).filter(|&i| i > 0)?;
        let (a, b) = (m[first - 1], m[first]);
        let share = (a - 0.5) / (a - b);
        Some(
            self.frequencies[first - 1]
                + share * (self.frequencies[first] - self.frequencies[first - 1]),
        )
    }

    fn lines(&self) -> String {
        let share = |light: [f64; 3]| percent(luminance(light));
        let mut lines = format!(
            "{}: the slit-mirror plate; the viewpoint looks at it at {:.1} degrees of incidence\n\
             there {} of the display's light forms the image, {} is stray, {} goes through, {} is lost\n",
            self.scene,
            self.incidence,
            share(self.shares.real),
            share(self.shares.stray),
            share(self.shares.through),
            share(self.shares.absorbed),
        );
        match &self.range {
            Some(range) => {
                let span = |span: &Span| {
                    let end = |value: f64, cut: bool| match cut {
                        true => format!("{value:.0} or further"),
                        false => format!("{value:.0}"),
                    };
                    format!("{} to {}", end(span.from, span.cut[0]), end(span.to, span.cut[1]))
                };
                lines += &format!(
                    "brightest from azimuth {:.0}, elevation {:.0} degrees; above half of that over azimuths {}, elevations {}\n",
                    range.brightest[0],
                    range.brightest[1],
                    span(&range.azimuth),
                    span(&range.elevation),
                );
            }
            None => lines += "the image is dark from everywhere\n",
        }
        let [x, y] = self.spread.deviation();
        let half = |axis| self.half(axis).map_or("-".to_owned(), |f| format!("{f:.2}"));
        lines
            + &format!(
                "through a pupil of {} mm a point spreads by {x:.3} x {y:.3} mm (standard deviations); contrast is a half at {} and {} cycles per mm\n",
                self.settings.pupil,
                half(0),
                half(1),
            )
    }

    fn json(&self) -> Value {
        let p = &self.model;
        let grid = |of: fn(&Shares) -> [f64; 3]| -> Value {
            let rows = self.directions.shares.chunks(self.directions.incidence.len());
            rows.map(|row| row.iter().map(|s| of(s).map(number)).collect::<Vec<_>>()).collect()
        };
        let span = |span: &Span| json!({ "from": span.from, "to": span.to, "cut": span.cut });
        let rows = self.viewpoints.luminance.chunks(self.viewpoints.azimuth.len());
        let eye = self.settings.eye;
        let [x, y] = &self.transfer;
        let numbers = |values: &[f64]| values.iter().map(|&v| number(v)).collect::<Vec<_>>();
        json!({
            "scene": self.scene,
            "plate": {
                "model": "slit-mirror",
                "pitch": p.pitch,
                "layer_depth": p.layer_depth,
                "azimuth": p.azimuth,
                "reflectance": p.reflectance,
                "ior": p.ior,
                "glass_absorption": p.absorption,
                "cover_glass": p.cover_glass,
                "mirror_thickness": p.mirror_thickness,
                "measured_luminance": self.measured,
            },
            "from_viewpoint": {
                "incidence_degrees": self.incidence,
                "real": self.shares.real,
                "stray": self.shares.stray,
                "through": self.shares.through,
                "lost": self.shares.absorbed,
            },
            "directions": {
                "incidence_degrees": self.directions.incidence,
                "azimuth_degrees": self.directions.azimuth,
                "real": grid(|s| s.real),
                "stray": grid(|s| s.stray),
                "through": grid(|s| s.through),
                "lost": grid(|s| s.absorbed),
            },
            "viewpoints": {
                "distance_mm": self.distance,
                "azimuth_degrees": self.viewpoints.azimuth,
                "elevation_degrees": self.viewpoints.elevation,
                "luminance": rows.map(numbers).collect::<Vec<_>>(),
                "visible_range": self.range.as_ref().map(|range| json!({
                    "brightest_degrees": range.brightest,
                    "luminance": range.luminance,
                    "azimuth_degrees": span(&range.azimuth),
                    "elevation_degrees": span(&range.elevation),
                })),
            },
            "point_spread": {
                "eye": [eye.x, eye.y, eye.z],
                "pupil_mm": self.settings.pupil,
                "efficiency": self.spread.efficiency,
                "centroid_mm": numbers(&self.spread.centroid()),
                "deviation_mm": numbers(&self.spread.deviation()),
                "extent_mm": self.extent,
                "cells": self.spread.histogram(self.extent, CELLS).chunks(CELLS).map(numbers).collect::<Vec<_>>(),
            },
            "modulation_transfer": {
                "frequency_per_mm": self.frequencies,
                "x": numbers(x),
                "y": numbers(y),
                "half_per_mm": [self.half(0), self.half(1)],
            },
        })
    }
}

/// The side of a square about the point that holds nearly all of its light, in whole pitches times four, mm.
fn extent(spread: &PointSpread, pitch: f64) -> f64 {
    let mut reach: Vec<f64> = spread.light.iter().map(|l| l[0].abs().max(l[1].abs())).collect();
    reach.sort_by(f64::total_cmp);
    let most = reach.get(reach.len().saturating_sub(1) * 999 / 1000).copied().unwrap_or(0.0);
    4.0 * pitch * (2.2 * most / (4.0 * pitch)).ceil().clamp(1.0, 1e6)
}

/// Numbers from one to another.
fn steps([from, to]: [f64; 2], step: f64) -> Vec<f64> {
    let count = ((to - from) / step).round() as usize;
    (0..=count).map(|i| from + i as f64 * step).collect()
}
