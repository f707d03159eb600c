//! A plate's character at its place in a set-up: what becomes of light by direction, how bright the image is by viewpoint, how sharp a point of it is.

use crate::error::Error;
use crate::geometry::Vec3;
use crate::optics::plate::character::{
    Arrangement, Directions, PointSpread, PointSpreadSettings, Span, Viewpoints, VisibleRange,
    over_directions, over_viewpoints, point_spread,
};
use crate::optics::plate::{Shares, SlitMirror, SlitMirrorPlate, viewing_angles};
use crate::scene::Loaded;
use crate::transport::Setup;
use serde::{Serialize, Serializer};

/// Angles of incidence, degrees; light along the plate does not pass.
pub const INCIDENCE: [f64; 2] = [0.0, 90.0];
/// Azimuths from the plate's +x, degrees: the rest repeats these, for two crossed layers are the same after a quarter turn.
pub const AZIMUTH: [f64; 2] = [0.0, 90.0];
/// Viewers' azimuths and elevations, degrees.
pub const VIEWERS: [f64; 2] = [-60.0, 60.0];
/// Cells along each side of the point spread's histogram.
pub const CELLS: usize = 80;
/// Points of the image along each side whose mean luminance counts.
const POINTS: usize = 5;
/// Lines of sight of the point spread.
const RAYS: usize = 200_000;

/// All that characterises a slit-mirror plate; serialised, every number of plate.json.
#[derive(Clone, Debug)]
pub struct Character {
    /// The scene's name.
    pub scene: String,
    /// What the reader should know: what was assumed, what was left out.
    pub notes: Vec<String>,
    /// The plate's parameters.
    pub model: SlitMirror,
    /// Whether the luminance over the directions was measured.
    pub measured: bool,
    /// What becomes of light over [`INCIDENCE`] and [`AZIMUTH`], degree by degree.
    pub directions: Directions,
    /// The image's luminance over [`VIEWERS`], in steps of 2 degrees.
    pub viewpoints: Viewpoints,
    /// From where it is brighter than half of the most.
    pub range: Option<VisibleRange>,
    /// From the viewpoint to the image's centre, mm.
    pub distance: f64,
    /// Incidence (degrees) of the line of sight from the viewpoint to the image's centre.
    pub incidence: f64,
    /// What becomes of light along that line.
    pub shares: Shares,
    /// Who looks at the point.
    pub settings: PointSpreadSettings,
    /// How the image's centre spreads.
    pub spread: PointSpread,
    /// Side of the square about the point that holds nearly all of its light, mm.
    pub extent: f64,
    /// Spatial frequencies, cycles per mm, up to where a slit is two periods wide.
    pub frequencies: Vec<f64>,
    /// The modulation transfer at each of them, across x and across y.
    pub transfer: [Vec<f64>; 2],
}

impl Character {
    /// Of a scene's plate, looked at by a pupil of `aperture` mm; of the usual slit-mirror plate where the scene's is ideal. Elements are left out.
    ///
    /// # Errors
    /// Where the scene cannot be traced, or the plate not be.
    pub fn of(loaded: &Loaded, aperture: f64) -> Result<Self, Error> {
        let mut notes = Vec::new();
        let (parameters, assumed) = loaded.scene.plate.model.slit_mirror_or_usual();
        if assumed {
            notes.push(
                "the scene's plate is ideal: what is shown is the usual slit-mirror plate \
                 (write model = \"slit-mirror\" with its values in the scene's [plate])"
                    .to_owned(),
            );
        }
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
        let local = plate.rectangle.frame.to_local_direction(sight);
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
        let highest = 2.0 / parameters.pitch;
        let frequencies: Vec<f64> = (0..=80).map(|i| highest * f64::from(i) / 80.0).collect();
        let transfer = spread.modulation_transfer(&frequencies);
        Ok(Self {
            scene: loaded.scene.name.clone(),
            notes,
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

    /// The lowest frequency at which the transfer across x (0) or y (1) has fallen to a half, between the frequencies that it is known at.
    pub fn half(&self, axis: usize) -> Option<f64> {
        let m = &self.transfer[axis];
        let first = m.iter().position(|&m| m < 0.5).filter(|&i| i > 0)?;
        let (a, b) = (m[first - 1], m[first]);
        let share = (a - 0.5) / (a - b);
        let [below, above] = [first - 1, first].map(|i| self.frequencies[i]);
        Some(below + share * (above - below))
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

/// Values over two angles, a row for each value of the second.
type Grid<T> = Vec<Vec<T>>;

#[derive(Serialize)]
struct Told<'a> {
    scene: &'a str,
    notes: &'a [String],
    plate: ToldPlate,
    from_viewpoint: ToldSight,
    directions: ToldDirections<'a>,
    viewpoints: ToldViewpoints<'a>,
    point_spread: ToldSpread,
    modulation_transfer: ToldTransfer<'a>,
}

#[derive(Serialize)]
struct ToldPlate {
    model: &'static str,
    pitch: f64,
    layer_depth: f64,
    azimuth: f64,
    reflectance: [f64; 3],
    ior: f64,
    glass_absorption: [f64; 3],
    cover_glass: f64,
    mirror_thickness: f64,
    measured_luminance: bool,
}

#[derive(Serialize)]
struct ToldSight {
    incidence_degrees: f64,
    real: [f64; 3],
    stray: [f64; 3],
    through: [f64; 3],
    lost: [f64; 3],
}

#[derive(Serialize)]
struct ToldDirections<'a> {
    incidence_degrees: &'a [f64],
    azimuth_degrees: &'a [f64],
    real: Grid<[f64; 3]>,
    stray: Grid<[f64; 3]>,
    through: Grid<[f64; 3]>,
    lost: Grid<[f64; 3]>,
}

#[derive(Serialize)]
struct ToldViewpoints<'a> {
    distance_mm: f64,
    azimuth_degrees: &'a [f64],
    elevation_degrees: &'a [f64],
    luminance: Grid<f64>,
    visible_range: Option<ToldRange>,
}

#[derive(Serialize)]
struct ToldRange {
    brightest_degrees: [f64; 2],
    luminance: f64,
    azimuth_degrees: ToldSpan,
    elevation_degrees: ToldSpan,
}

#[derive(Serialize)]
struct ToldSpan {
    from: f64,
    to: f64,
    cut: [bool; 2],
}

#[derive(Serialize)]
struct ToldSpread {
    eye: [f64; 3],
    pupil_mm: f64,
    efficiency: f64,
    centroid_mm: [f64; 2],
    deviation_mm: [f64; 2],
    extent_mm: f64,
    cells: Grid<f64>,
}

#[derive(Serialize)]
struct ToldTransfer<'a> {
    frequency_per_mm: &'a [f64],
    x: &'a [f64],
    y: &'a [f64],
    half_per_mm: [Option<f64>; 2],
}

impl Serialize for Character {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let p = &self.model;
        let grid = |of: fn(&Shares) -> [f64; 3]| -> Grid<[f64; 3]> {
            let rows = self.directions.shares.chunks(self.directions.incidence.len());
            rows.map(|row| row.iter().map(of).collect()).collect()
        };
        let span = |span: &Span| ToldSpan { from: span.from, to: span.to, cut: span.cut };
        let luminance = self.viewpoints.luminance.chunks(self.viewpoints.azimuth.len());
        let told = Told {
            scene: &self.scene,
            notes: &self.notes,
            plate: ToldPlate {
                model: "slit-mirror",
                pitch: p.pitch,
                layer_depth: p.layer_depth,
                azimuth: p.azimuth,
                reflectance: p.reflectance,
                ior: p.ior,
                glass_absorption: p.absorption,
                cover_glass: p.cover_glass,
                mirror_thickness: p.mirror_thickness,
                measured_luminance: self.measured,
            },
            from_viewpoint: ToldSight {
                incidence_degrees: self.incidence,
                real: self.shares.real,
                stray: self.shares.stray,
                through: self.shares.through,
                lost: self.shares.absorbed,
            },
            directions: ToldDirections {
                incidence_degrees: &self.directions.incidence,
                azimuth_degrees: &self.directions.azimuth,
                real: grid(|s| s.real),
                stray: grid(|s| s.stray),
                through: grid(|s| s.through),
                lost: grid(|s| s.absorbed),
            },
            viewpoints: ToldViewpoints {
                distance_mm: self.distance,
                azimuth_degrees: &self.viewpoints.azimuth,
                elevation_degrees: &self.viewpoints.elevation,
                luminance: luminance.map(<[f64]>::to_vec).collect(),
                visible_range: self.range.as_ref().map(|range| ToldRange {
                    brightest_degrees: range.brightest,
                    luminance: range.luminance,
                    azimuth_degrees: span(&range.azimuth),
                    elevation_degrees: span(&range.elevation),
                }),
            },
            point_spread: ToldSpread {
                eye: self.settings.eye.to_array(),
                pupil_mm: self.settings.pupil,
                efficiency: self.spread.efficiency,
                centroid_mm: self.spread.centroid(),
                deviation_mm: self.spread.deviation(),
                extent_mm: self.extent,
                cells: self
                    .spread
                    .histogram(self.extent, CELLS)
                    .chunks(CELLS)
                    .map(<[f64]>::to_vec)
                    .collect(),
            },
            modulation_transfer: ToldTransfer {
                frequency_per_mm: &self.frequencies,
                x: &self.transfer[0],
                y: &self.transfer[1],
                half_per_mm: [self.half(0), self.half(1)],
            },
        };
        told.serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Format, InMemory, load_text};
    use serde_json::Value;

    /// What the data say of the viewpoint is what the plate's own closed form says, and the figures of one kind add up.
    #[test]
    fn the_data_agree_with_the_plate_itself() {
        let text = "[viewpoint]\nposition = [0.0, 0.0, 800.0]\n[image]\nsize = [20.0, 20.0]\n\
             [plate]\nposition = [0.0, 0.0, -150.0]\nrotation = [-45.0, 0.0, 0.0]\nsize = [400.0, 400.0]\n[display]\n";
        let loaded = load_text(text, "a", Format::Toml, &InMemory::new()).unwrap();
        let character = Character::of(&loaded, 4.0).unwrap();
        assert!(character.notes[0].contains("ideal"));
        // The plate leans by 45 degrees, and the eye looks along z.
        assert!((character.incidence - 45.0).abs() < 1e-9);
        let data = serde_json::to_value(&character).unwrap();
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
