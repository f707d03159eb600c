//! Displays and plates that would cover the whole image.

use super::finding::{Finding, degrees, millimetres};
use super::place::Floating;
use super::places;
use crate::geometry::{Frame, Rectangle};
use crate::map::reach;
use crate::scene::model::Scene;
use crate::transport::{End, Path, Setup};
use serde::{Serialize, Serializer};

/// A display that would show the whole image, in the proportions of the present one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct DisplayAdvice {
    /// Its centre, mm.
    pub position: [f64; 3],
    /// Its turn, Rx*Ry*Rz in degrees.
    pub rotation: [f64; 3],
    /// Width and height, mm.
    pub size: [f64; 2],
    /// The image's width and height for which that display is large enough, where the whole image would ask for one that nobody has, mm;
    /// `None`: the image stays as it is.
    pub image: Option<[f64; 2]>,
    /// The part of the present display's plane that the whole image asks for: lower left and upper right in st; beyond \[0, 1\] it is not
    /// covered.
    #[serde(serialize_with = "corners")]
    pub asked_for: [[f64; 2]; 2],
}

fn corners<S: Serializer>(corners: &[[f64; 2]; 2], serializer: S) -> Result<S::Ok, S::Error> {
    corners.map(|corner| corner.map(|c| (c * 1e6).round() / 1e6)).serialize(serializer)
}

/// Room around what the followed points ask for, as a share of it: between two of them an edge bends by less.
const ROOM: f64 = 0.005;
/// A display is not advised beyond this many times the present one.
const MOST_TIMES: f64 = 2.5;
/// An image is not advised below this share of the present one.
const LEAST_IMAGE: f64 = 0.25;

impl DisplayAdvice {
    /// `None` where the present display covers the whole image and floats where it should, or where no display would.
    pub(super) fn of(setup: &Setup, floating: &Floating) -> Option<Self> {
        let asked_for = wanted(setup, 1.0)?;
        let [low, high] = asked_for;
        // As much as a map's samples leave open at an edge.
        let covered = (0..2).all(|axis| low[axis] >= -1e-9 && high[axis] <= 1.0 + 1e-9);
        let in_place = floating.is_in_place();
        if covered && in_place {
            return None;
        }
        let mut there = setup.clone();
        if !in_place {
            there.display = Rectangle { size: setup.display.size, ..setup.display_place() };
        }
        let scale = largest_image(&there)?;
        let image = (scale < 1.0).then(|| {
            // Rounded down, so that the display is large enough.
            setup.image.size.map(|side| (side * scale * 10.0).floor() / 10.0)
        });
        let scale = image.map_or(1.0, |size| size[0] / setup.image.size[0]);
        let display = grown(&there, wanted(&there, scale)?);
        Some(Self {
            position: millimetres(display.frame.origin.to_array()),
            rotation: degrees(display.frame.rotation()),
            size: display.size,
            image,
            asked_for,
        })
    }

    /// With this display's lines.
    pub(super) fn lines(&self, finding: Finding) -> Finding {
        let finding = match self.image {
            Some(size) => finding.line("image.size", size),
            None => finding,
        };
        finding
            .line("display.position", self.position)
            .line("display.rotation", self.rotation)
            .line("display.size", self.size)
    }
}

/// The part of the display's plane that the image, `scale` times as large about its centre, asks for. `None` where nothing gets through the plate.
fn wanted(setup: &Setup, scale: f64) -> Option<[[f64; 2]; 2]> {
    let mut path = Path::new();
    reach(places().filter_map(|uv| {
        let uv = uv.map(|c| (c - 0.5) * scale + 0.5);
        match setup.transport(uv, &mut path) {
            End::Display { st, through_plate: true } => Some(st),
            _ => None,
        }
    }))
}

/// The largest share of the image, about its centre, that no unreasonable display is needed for; `None` where not even a small one is.
fn largest_image(setup: &Setup) -> Option<f64> {
    let reasonable = |scale: f64| {
        wanted(setup, scale)
            .is_some_and(|[low, high]| (0..2).all(|axis| high[axis] - low[axis] <= MOST_TIMES))
    };
    if reasonable(1.0) {
        return Some(1.0);
    }
    let (mut small, mut large) = (LEAST_IMAGE, 1.0);
    if !reasonable(small) {
        return None;
    }
    // To a thousandth of the image.
    for _ in 0..10 {
        let middle = 0.5 * (small + large);
        *if reasonable(middle) { &mut small } else { &mut large } = middle;
    }
    Some(small)
}

/// The display, moved in its plane and, if it is too small, enlarged in its proportions, so that it covers a part of its plane.
fn grown(setup: &Setup, [low, high]: [[f64; 2]; 2]) -> Rectangle {
    let display = setup.display;
    let times =
        (0..2).map(|axis| (high[axis] - low[axis]) * (1.0 + 2.0 * ROOM)).fold(1.0, f64::max);
    let size = if times > 1.0 {
        // Rounded up to a tenth of a millimetre.
        display.size.map(|side| (side * times * 10.0).ceil() / 10.0)
    } else {
        display.size
    };
    let centre = [0, 1].map(|axis| {
        let middle = 0.5 * (low[axis] + high[axis]);
        // As far from where it is as it must: half of what is to spare on either side.
        let spare = 0.5 * (size[axis] / display.size[axis] - (high[axis] - low[axis]));
        if times > 1.0 { middle } else { 0.5f64.clamp(middle - spare, middle + spare) }
    });
    let frame = Frame { origin: display.point(centre), ..display.frame };
    Rectangle { frame, size }
}

/// What helps where light goes past the display.
pub(super) fn display_remedy(
    finding: Finding,
    setup: &Setup,
    scene: &Scene,
    advice: Option<&DisplayAdvice>,
) -> Finding {
    let Some(advice) = advice else {
        return finding.remedy(
            "no display of reasonable size would cover it: make the image smaller, or turn or move the object so that it spreads the light less",
        );
    };
    let display = if scene.display.pose.is_some() { "the display" } else { "a display" };
    let [w, h] = advice.size;
    let moved = if advice.size == setup.display.size { ", moved," } else { "" };
    let remedy = match advice.image {
        Some([iw, ih]) => format!(
            "the whole image asks for a display more than {MOST_TIMES} times as large: an image of {iw} x {ih} mm is covered by {display}{moved} of {w} x {h} mm"
        ),
        None => format!("{display}{moved} of {w} x {h} mm covers it all"),
    };
    advice.lines(finding.remedy(remedy))
}

/// Plates that are made are not larger than this, mm.
const LARGEST_PLATE: f64 = 1000.0;

/// What helps where light goes past the plate.
pub(super) fn plate_remedy(finding: Finding, setup: &Setup) -> Finding {
    let plate = &setup.plate.rectangle;
    let mut path = Path::new();
    let asked = reach(places().filter_map(|uv| {
        let ray = setup.ray(uv);
        setup.trace(ray, &mut path);
        let met = plate.frame.to_local(setup.remainder(ray, &path)?.at_plate.origin);
        Some([met.x, met.y])
    }));
    let Some([low, high]) = asked else {
        return finding.remedy("no line of sight meets the plate's plane: move the plate behind the image as the eye sees it");
    };
    let needed = [0, 1].map(|axis| ((high[axis] - low[axis]) * (1.0 + 2.0 * ROOM)).ceil());
    if needed.iter().any(|&side| side > LARGEST_PLATE) {
        return finding.remedy(format!(
            "it would take a plate of {:.0} x {:.0} mm: bring the plate nearer to the image, or the eye nearer to the plate's middle",
            needed[0], needed[1]
        ));
    }
    let fits = (0..2).all(|axis| needed[axis] <= plate.size[axis]);
    let size = [0, 1].map(|axis| needed[axis].max(plate.size[axis]));
    let centre = [0, 1].map(|axis| {
        let middle = 0.5 * (low[axis] + high[axis]);
        let spare = (0.5 * (size[axis] - needed[axis])).max(0.0);
        0.0f64.clamp(middle - spare, middle + spare)
    });
    let [x, y, _] = plate.frame.axes;
    let position = plate.frame.origin + x * centre[0] + y * centre[1];
    // Where the plate shifts within its own plane, the display's place stays.
    let remedy = if fits {
        "the plate is large enough if it is shifted within its plane (the display stays)".to_owned()
    } else {
        format!("a plate of {} x {} mm there catches it all (the display stays)", size[0], size[1])
    };
    let finding = finding.remedy(remedy).line("plate.position", millimetres(position.to_array()));
    if fits { finding } else { finding.line("plate.size", size) }
}
