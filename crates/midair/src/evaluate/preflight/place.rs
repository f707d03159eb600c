//! Where the display's image floats, as plate and flat mirrors form it.

use super::coverage::DisplayAdvice;
use super::finding::{Finding, Kind, Severity};
use crate::geometry::Frame;
use crate::optics::plate::floating_place;
use crate::transport::Setup;
use serde::Serialize;

/// How the plane that the plate forms of the display lies to the image's: with solids absent and mirrors taken as flat.
///
/// From the set-up's viewpoint the image is compensated wherever the display stands; but light comes from where it floats, which is what two
/// eyes and a camera's focus see.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Floating {
    /// From the image's centre along its normal to that plane, mm: positive on the viewer's side. `None` where they are so tilted that there
    /// is no such place.
    pub offset: Option<f64>,
    /// Angle between the two planes, degrees, 0 to 90.
    pub tilt: f64,
}

/// What is no finding: a millimetre is what people place things to, half a degree is a millimetre over 100 mm.
const OFFSET: f64 = 1.0;
const TILT: f64 = 0.5;
/// Beyond this angle the planes are taken to have nothing to do with each other.
const STEEP: f64 = 80.0;

impl Floating {
    pub(super) fn of(setup: &Setup) -> Self {
        let mirrors: Vec<Frame> = setup.mirrors().map(|mirror| mirror.frame).collect();
        let plate = &setup.plate.rectangle.frame;
        let there = floating_place(setup.display.frame, &mirrors, plate, setup.viewpoint);
        let (point, normal) = (there.origin, there.normal());
        let image = setup.image.frame;
        let cosine = image.normal().dot(normal);
        let tilt = cosine.abs().min(1.0).acos().to_degrees();
        let offset = (tilt < STEEP).then(|| (point - image.origin).dot(normal) / cosine);
        Self { offset, tilt }
    }

    /// Whether it floats where it should.
    pub fn is_in_place(&self) -> bool {
        self.offset.is_some_and(|offset| offset.abs() <= OFFSET) && self.tilt <= TILT
    }

    pub(super) fn finding(&self, setup: &Setup, advice: Option<&DisplayAdvice>) -> Option<Finding> {
        if self.is_in_place() {
            return None;
        }
        let offset = self.offset.filter(|offset| offset.abs() > OFFSET).map(|offset| {
            let side = if offset > 0.0 { "before" } else { "behind" };
            format!("{:.1} mm {side} the image's place", offset.abs())
        });
        let tilt = (self.tilt > TILT).then(|| format!("tilted by {:.1} degrees", self.tilt));
        let how: Vec<String> = offset.into_iter().chain(tilt).collect();
        let bent = setup.mirrors().any(|m| m.shape.bounds().map(|b| b.z) != [0.0; 2]);
        // A bent mirror shifts the image by itself: flat ones are a guide there, not a law.
        let severity = if bent { Severity::Note } else { Severity::Warning };
        let sentence = format!(
            "light of the display comes together {}: one eye at the viewpoint sees no difference, two eyes and a camera's focus do",
            how.join(" and ")
        );
        let finding = Finding::new(Kind::OffPlace, severity, sentence);
        Some(match advice {
            Some(advice) => advice.lines(finding.remedy(
                "move the display to where the image, mirrored in the plate, lies (or turn the plate back, or move the image)",
            )),
            None => finding.remedy(
                "leave the display's position and rotation out: it then stands where the image, mirrored in the plate, lies",
            ),
        })
    }
}
