//! A plate's character as `midair plate` tells it: efficiency by direction, luminance by viewpoint, sharpness.

use crate::Error;
use crate::geometry::Vec3;
use crate::optics::plate::character::{
    Arrangement, Directions, PointSpread, PointSpreadSettings, Span, Viewpoints, VisibleRange,
    over_directions, over_viewpoints, point_spread,
};
use crate::optics::plate::{Shares, SlitMirror, SlitMirrorPlate, viewing_angles};
use crate::scene::Loaded;
use crate::scene::model::PlateModel;
use crate::transport::Setup;
use serde_json::{Value, json};

/// Angles of incidence, degrees; light along the plate does not pass.
pub const INCIDENCE: [f64; 2] = [0.0, 90.0];
/// Azimuths from the plate's +x, degrees: the rest repeats these, for two crossed layers are the same after a
/// quarter turn.
pub const AZIMUTH: [f64; 2] = [0.0, 90.0];
/// Viewers' azimuths and elevations, degrees.
pub const VIEWERS: [f64; 2] = [-60.0, 60.0];
/// Points of the image along each side whose mean luminance counts.
const POINTS: usize = 5;
/// Lines of sight of the point spread.
const RAYS: usize = 200_000;
/// Cells along each side of the point spread's picture.
pub const CELLS: usize = 80;

/// All that is told of a plate.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Character {
    /// The scene's name.
    pub scene: String,
    /// The plate.
    pub model: SlitMirror,
    /// Whether its image's luminance was measured.
    pub measured: bool,
    /// What becomes of light over all directions.
    pub directions: Directions,
    /// How bright the image is from all around.
    pub viewpoints: Viewpoints,
    /// From where it is seen well; `None` where it is dark from everywhere.
    pub range: Option<VisibleRange>,
    /// From the viewpoint to the image's centre, mm.
    pub distance: f64,
    /// Incidence (degrees) of the line of sight from the viewpoint to the image's centre, and what becomes of
    /// light along it.
    pub incidence: f64,
    /// See `incidence`.
    pub shares: Shares,
    /// How a point of the image is looked at.
    pub settings: PointSpreadSettings,
    /// How it spreads.
    pub spread: PointSpread,
    /// Side of the square that the point spread is shown in, mm.
    pub extent: f64,
    /// Cycles per mm in the image's plane.
    pub frequencies: Vec<f64>,
    /// Modulation transfer at them, across x and across y.
    pub transfer: [Vec<f64>; 2],
}

impl Character {
    /// The character of a scene's plate, of the usual slit-mirror plate where the scene's is ideal; `aperture` is the diameter of the pupil that
    /// looks at it, mm. `notes` are given what the user should know.
    ///
    /// # Errors
    /// Where the scene cannot be traced, or no plate has such dimensions.
    pub fn of(loaded: &Loaded, aperture: f64, notes: &mut Vec<String>) -> Result<Self, Error> {
        let own = loaded.scene.plate.model;
        if own == PlateModel::Ideal {
            notes.push(
                "the scene's plate is ideal: what is shown is the usual slit-mirror plate \
                 (write model = \"slit-mirror\" with its values in the scene's [plate])"
                    .to_owned(),
            );
        }
        let parameters = own.or_slit_mirror();
        if !loaded.scene.elements.is_empty() {
            notes.push("the scene's elements are left out".to_owned());
        }
        let model = SlitMirrorPlate::new(parameters)?;
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

    /// The lowest frequency at which a transfer has fallen to a half, between the frequencies that it is known at.
    pub fn half(&self, axis: usize) -> Option<f64> {
        let m = &self.transfer[axis];
        let first = m.iter().position(|&m| m < 0.5).filter(|&i| i > 0)?;
        let (a, b) = (m[first - 1], m[first]);
        let share = (a - 0.5) / (a - b);
        Some(
            self.frequencies[first - 1]
                + share * (self.frequencies[first] - self.frequencies[first - 1]),
        )
    }

    /// All of it as data.
    pub fn to_json(&self) -> Value {
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

/// A number for JSON, which has no infinities: `null` for those.
fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Format, InMemory, load_text};

    /// What the data say of the viewpoint is what the plate's own closed form says, and the figures of one kind add up.
    #[test]
    fn the_data_agree_with_the_plate_itself() {
        let text = "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n\
             [plate]\nposition = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [400.0, 400.0]\n[display]\n";
        let loaded = load_text(text, "a", Format::Toml, &InMemory::new()).unwrap();
        let mut notes = Vec::new();
        let character = Character::of(&loaded, 4.0, &mut notes).unwrap();
        assert!(notes[0].contains("ideal"));
        // The plate leans by 45 degrees, and the eye looks along z.
        assert!((character.incidence - 45.0).abs() < 1e-9);
        let data = character.to_json();
        let directions = &data["directions"];
        let shares = |kind: &str| directions[kind][45][45][1].as_f64().unwrap();
        let sum: f64 = ["real", "stray", "through", "lost"].into_iter().map(shares).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        let transfer = data["modulation_transfer"]["x"].as_array().unwrap();
        assert_eq!((transfer.len(), transfer[0].as_f64()), (81, Some(1.0)));
        let cells = data["point_spread"]["cells"].as_array().unwrap();
        assert_eq!(cells.len(), CELLS);
        let light: f64 =
            cells.iter().flat_map(|row| row.as_array().unwrap()).filter_map(Value::as_f64).sum();
        assert!(light > 0.0);
    }
}
