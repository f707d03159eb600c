//! How much of the display's light arrives at the viewpoint.

use super::finding::{Finding, Kind, Severity, millimetres};
use crate::evaluate::percent;
use crate::geometry::Vec3;
use crate::optics::plate::{Model, SlitMirror, SlitMirrorPlate, luminance};
use crate::transport::{End, Path, Setup};
use serde::Serialize;

/// How much of the display's light arrives, where the image is formed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Light {
    /// Whether the usual slit-mirror plate stands in for the scene's ideal one.
    pub assumed_plate: bool,
    /// The image's luminance over the display's, mean over the image: after plate, surfaces, glass and mirrors.
    pub mean: f64,
    /// Where it is least.
    pub least: f64,
    /// Where it is most.
    pub most: f64,
    /// What the plate alone sends on, mean over the image.
    pub plate: f64,
    /// What the plate alone sends on in the one direction that suits it best.
    pub best: f64,
    /// Angle between the light and the plate's normal at the image's brightest, degrees.
    pub incidence: f64,
    /// A viewpoint at the same distance, above or below, from which the plate sends on much more; `None` where none is needed.
    pub better_viewpoint: Option<[f64; 3]>,
}

/// Image points along each side.
const GRID: usize = 17;
/// Less of the plate's best than this is a warning, and than that a fault: a quarter of the light is a room made four times as dark for the
/// same contrast, a twentieth is no image in any room.
const LITTLE: f64 = 0.25;
const NONE: f64 = 0.05;

impl Light {
    /// `None` where nothing gets through the plate.
    pub(super) fn of(setup: &Setup) -> Option<Self> {
        let (model, assumed_plate) = match setup.plate.model() {
            Model::Ideal => {
                (SlitMirrorPlate::new(SlitMirror::default()).ok().map(Model::from)?, true)
            }
            model => (model.clone(), false),
        };
        let seen = seen(setup, &model, GRID);
        let count = seen.len() as f64;
        let brightest = seen.iter().max_by(|a, b| a.all.total_cmp(&b.all))?;
        let (incidence, most) = (brightest.incidence, brightest.all);
        let plate = seen.iter().map(|s| s.plate).sum::<f64>() / count;
        let best = best(&model);
        let better_viewpoint =
            if plate < LITTLE * best { better_viewpoint(setup, &model, plate) } else { None };
        Some(Self {
            assumed_plate,
            mean: seen.iter().map(|s| s.all).sum::<f64>() / count,
            least: seen.iter().map(|s| s.all).fold(f64::INFINITY, f64::min),
            most,
            plate,
            best,
            incidence,
            better_viewpoint: better_viewpoint.map(|eye| millimetres(eye.to_array())),
        })
    }

    pub(super) fn finding(&self) -> Finding {
        let plate = if self.assumed_plate { "through the usual slit-mirror plate " } else { "" };
        let sentence = format!(
            "{plate}{} of the display's light arrives ({} to {}); the plate sends on {} here, and {} in the direction that suits it best",
            percent(self.mean),
            percent(self.least),
            percent(self.most),
            percent(self.plate),
            percent(self.best)
        );
        let severity = match self.plate / self.best {
            share if share < NONE => Severity::Fault,
            share if share < LITTLE => Severity::Warning,
            _ => Severity::Note,
        };
        let finding = Finding::new(Kind::Light, severity, sentence);
        if severity == Severity::Note {
            return finding;
        }
        let met = format!(
            "light meets the plate at {:.0} degrees from its normal; a plate sends on most at 40 to 55 degrees, half-way between its two mirror directions",
            self.incidence
        );
        match self.better_viewpoint {
            Some(eye) => finding
                .remedy(format!(
                    "{met}: turn the plate with the display about the image, or look from here"
                ))
                .line("viewpoint.position", eye),
            None => {
                finding.remedy(format!("{met}: turn the plate, with the display, about the image"))
            }
        }
    }
}

struct Seen {
    plate: f64,
    all: f64,
    incidence: f64,
}

/// What arrives through a grid of the image's points, of those whose light goes through the plate.
fn seen(setup: &Setup, model: &Model, grid: usize) -> Vec<Seen> {
    let mut path = Path::new();
    let frame = &setup.plate.rectangle.frame;
    let mut seen = Vec::new();
    for index in 0..grid * grid {
        let uv = [index % grid, index / grid].map(|k| (k as f64 + 0.5) / grid as f64);
        let ray = setup.ray(uv);
        let End::Display { through_plate: true, .. } = setup.trace(ray, &mut path) else {
            continue;
        };
        let Some(left) = setup.remainder(ray, &path) else { continue };
        // Light goes the other way than the path.
        let out = frame.to_local_direction(-left.at_plate.direction);
        let share = model.real_share(out);
        let emitted = setup.emitted_against(left.at_display);
        seen.push(Seen {
            plate: luminance(share),
            all: luminance([0, 1, 2].map(|c| share[c] * left.share[c] * emitted[c])),
            incidence: out.z.abs().min(1.0).acos().to_degrees(),
        });
    }
    seen
}

/// What a plate sends on in the direction that suits it best.
fn best(model: &Model) -> f64 {
    let mut best = 0.0f64;
    for incidence in 0..180 {
        for azimuth in 0..72 {
            let [(si, ci), (sa, ca)] = [0.5 * f64::from(incidence), 5.0 * f64::from(azimuth)]
                .map(|angle| angle.to_radians().sin_cos());
            best = best.max(luminance(model.real_share(Vec3::new(si * ca, si * sa, ci))));
        }
    }
    best
}

/// The viewpoint nearest to the present one, at the same distance above or below, from which the plate sends on nearly as much as from any of
/// these; `None` where that is not at least twice as much as `now`.
fn better_viewpoint(setup: &Setup, model: &Model, now: f64) -> Option<Vec3> {
    let centre = setup.image.frame.origin;
    let sight = setup.viewpoint - centre;
    let across = Vec3::new(0.0, 1.0, 0.0).cross(sight);
    if across.length() < 1e-6 * sight.length() {
        return None;
    }
    let across = across.normalized();
    let mut tried = Vec::new();
    for degrees in -60..=60 {
        let (s, c) = f64::from(degrees).to_radians().sin_cos();
        let eye = centre + sight * c + across.cross(sight) * s;
        let there = setup.with_viewpoint(eye);
        let facing = setup.image.frame.normal().dot(eye - centre) / sight.length();
        let through = seen(&there, model, 3);
        // Seen from its front at less than 60 degrees, and all of it.
        if facing > 0.5 && through.len() == 9 && setup.elements.iter().all(|e| !e.holds(eye)) {
            let plate = through.iter().map(|s| s.plate).sum::<f64>() / 9.0;
            tried.push((degrees, eye, plate));
        }
    }
    let most = tried.iter().map(|t| t.2).fold(0.0, f64::max);
    if most < 2.0 * now {
        return None;
    }
    let good = tried.into_iter().filter(|t| t.2 >= 0.8 * most);
    good.min_by_key(|t: &(i32, Vec3, f64)| t.0.abs()).map(|t| t.1)
}
