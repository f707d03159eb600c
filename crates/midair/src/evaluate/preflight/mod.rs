//! The preflight: what is wrong with a set-up before it is built, each finding with its remedy and, where there is one, the lines to paste.

mod bodies;
mod check;
mod coverage;
mod finding;
mod lengths;
mod light;
mod object;
mod pixels;
mod place;
#[cfg(test)]
mod tests;

pub use check::{Check, Part};
pub use coverage::DisplayAdvice;
pub use finding::{Finding, Kind, Line, Severity};
pub use light::Light;
pub use pixels::Pixels;
pub use place::Floating;

use super::percent;
use crate::map::{Formation, ImagePoint, Map};
use crate::scene::model::Scene;
use crate::transport::Setup;
use serde::Serialize;

/// What is to be known of a set-up before it is built.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Preflight {
    /// What is wrong, and what is worth knowing; the gravest first.
    pub findings: Vec<Finding>,
    /// Where the display's image floats, as the plate (and flat mirrors) form it, against where it should.
    pub floating: Floating,
    /// How much of the display's light arrives.
    pub light: Option<Light>,
    /// Which of the display's pixels the image gets.
    pub pixels: Pixels,
    /// A display that would show the whole image, where the present one does not or floats elsewhere.
    pub display: Option<DisplayAdvice>,
}

/// What a scene's set-up is found to be. `map` and `formation` are the set-up's.
pub fn preflight(setup: &Setup, scene: &Scene, map: &Map, formation: &Formation) -> Preflight {
    let floating = Floating::of(setup);
    let pixels = Pixels::of(setup, map);
    let display = DisplayAdvice::of(setup, &floating);
    let light = Light::of(setup);
    let mut findings = Vec::new();
    findings.extend(bodies::findings(setup, scene));
    findings.extend(floating.finding(setup, display.as_ref()));
    findings.extend(not_formed(setup, scene, formation, display.as_ref()));
    findings.extend(object::findings(setup));
    findings.extend(light.as_ref().map(Light::finding));
    findings.extend(pixels.findings(setup, scene));
    findings.extend(lengths::findings(setup, scene));
    findings.sort_by_key(|finding| finding.severity);
    Preflight { findings, floating, light, pixels, display }
}

impl Preflight {
    /// How many findings there are of a severity.
    pub fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|finding| finding.severity == severity).count()
    }
}

/// Image points along each side that are followed, edges included.
const GRID: usize = 65;

/// The image points that are followed, row by row.
fn places() -> impl Iterator<Item = [f64; 2]> {
    (0..GRID * GRID).map(|index| [index % GRID, index / GRID].map(|k| k as f64 / (GRID - 1) as f64))
}

/// What becomes of an image point, in words.
pub fn reason(setup: &Setup, point: ImagePoint) -> String {
    match point {
        ImagePoint::Formed => "formed".to_owned(),
        ImagePoint::Folded => "folded: its display pixel is seen elsewhere too".to_owned(),
        ImagePoint::TotalReflection(element) => {
            let name = setup.elements.get(usize::from(element)).map_or("?", |e| &e.name);
            format!("total internal reflection in \"{name}\"")
        }
        ImagePoint::MissedPlate => "its light goes past the plate".to_owned(),
        ImagePoint::PlateBehind => "its light meets the plate from behind".to_owned(),
        ImagePoint::MissedDisplay => "its light goes past the display".to_owned(),
        ImagePoint::TooManyInteractions => {
            format!("more than {} interactions (max_interactions)", setup.max_interactions)
        }
    }
}

/// What is not formed, and what would form it.
fn not_formed(
    setup: &Setup,
    scene: &Scene,
    formation: &Formation,
    display: Option<&DisplayAdvice>,
) -> Vec<Finding> {
    let mut shares: Vec<_> = formation.shares().into_iter().collect();
    shares.sort_by(|a, b| b.1.total_cmp(&a.1).then(reason(setup, a.0).cmp(&reason(setup, b.0))));
    let mut findings = Vec::new();
    for (point, share) in shares {
        let part = percent(share);
        let sentence = format!("{part} of the image is not formed: {}", reason(setup, point));
        let lost = Finding::new(Kind::NotFormed, Severity::of_lost(share), sentence);
        findings.push(match point {
            ImagePoint::Formed => continue,
            ImagePoint::Folded => Finding::new(
                Kind::Folded,
                Severity::Note,
                format!("{part} of the image is folded: its display pixels are seen at several places of the image"),
            )
            .remedy("a smaller image, or one that stands elsewhere in its object, has no caustic"),
            ImagePoint::MissedDisplay => coverage::display_remedy(lost, setup, scene, display),
            ImagePoint::MissedPlate => coverage::plate_remedy(lost, setup),
            ImagePoint::TotalReflection(_) => lost.remedy(
                "turn the object or move the eye until the light meets its faces less obliquely, or make the image smaller; \
                 follow_total_reflection = true follows the light further",
            ),
            ImagePoint::PlateBehind => {
                lost.remedy("the plate's front is its local +z: turn it, or move the object that sends the light round")
            }
            ImagePoint::TooManyInteractions => lost
                .remedy("allow more, if the paths are wanted")
                .line("max_interactions", 4 * setup.max_interactions as i64),
        });
    }
    findings
}
