//! Tolerances: how far what is seen moves if the set-up is built a little differently from its description.
//!
//! The display keeps what was computed for the set-up as described. In the set-up as built its pixels are seen elsewhere: an image point uv is
//! seen at uv' where F'(uv') = F(uv), F' the transport as built.

use crate::geometry::{Frame, Vec3};
use crate::map::apply_inverse;
use crate::measure::lattice::LatticeStyle;
use crate::monitor::Monitor;
use crate::optics::plate::Plate;
use crate::transport::{Matter, Path, Setup};
use rayon::prelude::*;
use serde::Serialize;

/// What is built differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Moved to the viewer's right (+x), by a millimetre.
    Right,
    /// Moved up (+y), by a millimetre.
    Up,
    /// Moved along +z, by a millimetre.
    Forward,
    /// Turned about x through its own origin, by a degree.
    TurnX,
    /// Turned about y, by a degree.
    TurnY,
    /// Turned about z, by a degree.
    TurnZ,
    /// Its refractive index larger, by a hundredth.
    Index,
}

impl Measure {
    const MOVES: [Self; 3] = [Self::Right, Self::Up, Self::Forward];
    const TURNS: [Self; 3] = [Self::TurnX, Self::TurnY, Self::TurnZ];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "moved along x",
            Self::Up => "moved along y",
            Self::Forward => "moved along z",
            Self::TurnX => "turned about x",
            Self::TurnY => "turned about y",
            Self::TurnZ => "turned about z",
            Self::Index => "refractive index",
        }
    }

    /// By how much, and its unit.
    pub fn step(self) -> (f64, &'static str) {
        match self {
            Self::Right | Self::Up | Self::Forward => (1.0, "mm"),
            Self::TurnX | Self::TurnY | Self::TurnZ => (1.0, "degrees"),
            Self::Index => (0.01, ""),
        }
    }
}

/// How far the lattice moves for one measure of one part.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Shift {
    /// The part: "eye", "display", "plate", or an element's name.
    pub part: String,
    /// What of it is different.
    pub measure: Measure,
    /// By how much, in mm, degrees or of the index.
    pub step: f64,
    /// How far the lattice's intersections are seen from where they belong, mean over those that are seen, mm on the image.
    pub mean: f64,
    /// The farthest, mm.
    pub most: f64,
    /// The mean over the image's width.
    pub share: f64,
    /// How exactly to measure, for a mean of half a millimetre: in the step's unit. `None` where it moves nothing.
    pub for_half_a_millimetre: Option<f64>,
    /// Intersections that were compared; the others are not seen in one of the two set-ups.
    pub compared: usize,
}

impl Shift {
    /// Part, measure and step in words: "cube, turned about y, 1 degrees".
    pub fn name(&self) -> String {
        let (step, unit) = self.measure.step();
        format!("{}, {}, {step} {unit}", self.part, self.measure.name()).trim_end().to_owned()
    }
}

/// The shifts of all measures of all parts, the largest mean first. `lines` x `lines` intersections of the usual lattice are looked at.
pub fn tolerances(setup: &Setup, lines: usize, monitor: &dyn Monitor) -> Vec<Shift> {
    let places = LatticeStyle { lines, ..LatticeStyle::default() }.intersections_uv();
    let mut shifts = Vec::new();
    let parts = parts(setup);
    monitor.stage("tolerances", parts.len());
    for (part, name, measures) in parts {
        for measure in measures {
            let built = differently(setup, part, measure);
            shifts.push(shift(setup, &built, &places, name.clone(), measure));
        }
        monitor.advance(1);
    }
    shifts.sort_by(|a, b| b.mean.total_cmp(&a.mean));
    shifts
}

#[derive(Clone, Copy)]
enum Part {
    Eye,
    Display,
    Plate,
    Element(usize),
}

fn parts(setup: &Setup) -> Vec<(Part, String, Vec<Measure>)> {
    let placed = [Measure::MOVES, Measure::TURNS].concat();
    let mut parts = vec![
        (Part::Eye, "eye".to_owned(), Measure::MOVES.to_vec()),
        (Part::Display, "display".to_owned(), placed.clone()),
        (Part::Plate, "plate".to_owned(), placed.clone()),
    ];
    for (i, element) in setup.elements.iter().enumerate() {
        let mut measures = placed.clone();
        // Air in a vessel has no index that could be mistaken.
        if matches!(element.matter, Matter::Refractive { index, .. } if index > 1.0) {
            measures.push(Measure::Index);
        }
        parts.push((Part::Element(i), element.name.clone(), measures));
    }
    parts
}

/// The set-up with one measure of one part larger by its step.
fn differently(setup: &Setup, part: Part, measure: Measure) -> Setup {
    let mut built = setup.clone();
    let (step, _) = measure.step();
    let moved = |frame: Frame| {
        let along = |axis: Vec3| Frame { origin: frame.origin + axis * step, ..frame };
        let turned = |rotation: [f64; 3]| {
            let turn = Frame::new(Vec3::ZERO, rotation);
            Frame { axes: frame.axes.map(|axis| turn.to_world_direction(axis)), ..frame }
        };
        match measure {
            Measure::Right => along(Vec3::new(1.0, 0.0, 0.0)),
            Measure::Up => along(Vec3::new(0.0, 1.0, 0.0)),
            Measure::Forward => along(Vec3::new(0.0, 0.0, 1.0)),
            Measure::TurnX => turned([step, 0.0, 0.0]),
            Measure::TurnY => turned([0.0, step, 0.0]),
            Measure::TurnZ => turned([0.0, 0.0, step]),
            Measure::Index => frame,
        }
    };
    match part {
        Part::Eye => {
            built.viewpoint = moved(Frame { origin: setup.viewpoint, ..Frame::WORLD }).origin;
        }
        Part::Display => built.display.frame = moved(setup.display.frame),
        Part::Plate => {
            let mut rectangle = setup.plate.rectangle;
            rectangle.frame = moved(rectangle.frame);
            built.plate = Plate::new(rectangle, setup.plate.model().clone());
        }
        Part::Element(i) => {
            let element = &mut built.elements[i];
            element.frame = moved(element.frame);
            if let (Matter::Refractive { index, .. }, Measure::Index) =
                (&mut element.matter, measure)
            {
                *index += step;
            }
        }
    }
    built
}

fn shift(
    setup: &Setup,
    built: &Setup,
    places: &[[f64; 2]],
    part: String,
    measure: Measure,
) -> Shift {
    let [width, height] = setup.image.size;
    let moved: Vec<f64> = places
        .iter()
        .filter_map(|&uv| {
            let seen = seen_at(setup, built, uv)?;
            Some(((seen[0] - uv[0]) * width).hypot((seen[1] - uv[1]) * height))
        })
        .collect();
    let count = moved.len().max(1) as f64;
    let mean = moved.iter().sum::<f64>() / count;
    let (step, _) = measure.step();
    Shift {
        part,
        measure,
        step,
        mean,
        most: moved.iter().copied().fold(0.0, f64::max),
        share: mean / width,
        // A nanometre is rounding.
        for_half_a_millimetre: (mean > 1e-6).then(|| 0.5 * step / mean),
        compared: moved.len(),
    }
}

/// Iterations at most; Newton's method doubles the digits with each.
const ITERATIONS: usize = 12;
/// A step of less of the image's width is rounding.
const DONE: f64 = 1e-12;

/// Where image points uv of the set-up as described are seen in the one as built, whose display shows what was computed for the former:
/// uv' where F'(uv') = F(uv). NaN where they are not seen in one of the two.
pub fn seen(setup: &Setup, built: &Setup, places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    places.par_iter().map(|&uv| seen_at(setup, built, uv).unwrap_or([f64::NAN; 2])).collect()
}

/// Where an image point of the set-up as described is seen in the one as built; `None` where it is not seen in one of them.
fn seen_at(setup: &Setup, built: &Setup, uv: [f64; 2]) -> Option<[f64; 2]> {
    let mut path = Path::new();
    let st = setup.transport(uv, &mut path).formed()?;
    // The path as it is there, followed smoothly from the same image point on.
    built.transport(uv, &mut path).st()?;
    let mut seen = uv;
    for _ in 0..ITERATIONS {
        let (at, jacobian) = built.follow_with_jacobian(seen, &mut path);
        let step = apply_inverse(jacobian, [st[0] - at[0], st[1] - at[1]]);
        seen = [seen[0] + step[0], seen[1] + step[1]];
        // NaN where the path ceases to exist, or far beyond the image: it is not seen.
        if !seen.iter().all(|c| (-2.0..=3.0).contains(c)) {
            return None;
        }
        if step[0].hypot(step[1]) < DONE {
            return Some(seen);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::bench_setup::{ACRYLIC, block, element, setup};

    fn of(shifts: &[Shift], part: &str, measure: Measure) -> Shift {
        shifts.iter().find(|s| s.part == part && s.measure == measure).unwrap().clone()
    }

    #[test]
    fn without_an_object_all_is_mirror_geometry() {
        let bare = setup(20.0, vec![]);
        let shifts = tolerances(&bare, 7, &());
        assert_eq!(shifts.len(), 3 + 6 + 6);
        assert!(shifts.windows(2).all(|pair| pair[0].mean >= pair[1].mean));
        // The display's mirror image is the image: it moves as the display does, sideways by as much.
        let right = of(&shifts, "display", Measure::Right);
        assert!((right.mean - 1.0).abs() < 1e-9 && (right.most - 1.0).abs() < 1e-9, "{right:?}");
        assert!((right.share - 0.05).abs() < 1e-9 && right.compared == 49);
        assert!((right.for_half_a_millimetre.unwrap() - 0.5).abs() < 1e-9);
        // What stands in space is seen in its place from everywhere.
        let eye = of(&shifts, "eye", Measure::Up);
        assert!(eye.most < 1e-9 && eye.for_half_a_millimetre.is_none(), "{eye:?}");
        // A plate that moves within its own plane changes nothing; x lies in it.
        assert!(of(&shifts, "plate", Measure::Right).most < 1e-9);
    }

    #[test]
    fn a_plate_moves_the_image_twice_as_far_along_its_normal() {
        let bare = setup(20.0, vec![]);
        let built = differently(&bare, Part::Plate, Measure::Forward);
        // 1 mm along z is 1 / sqrt(2) along the normal (0, 1, 1) / sqrt(2): the image moves by (0, 1, 1).
        let seen = seen_at(&bare, &built, [0.5, 0.5]).unwrap();
        assert_eq!(super::seen(&bare, &built, &[[0.5, 0.5]]), [seen]);
        let expected = 1.0 * 800.0 / 799.0;
        assert!(((seen[1] - 0.5) * 20.0 - expected).abs() < 1e-9, "{seen:?}");
        // A turn by a degree about x through the plate's middle turns the image by two degrees about it, 150 mm behind.
        let built = differently(&bare, Part::Plate, Measure::TurnX);
        let seen = seen_at(&bare, &built, [0.5, 0.5]).unwrap();
        let (s, c) = 2f64.to_radians().sin_cos();
        let image = Vec3::new(0.0, -150.0 * s, -150.0 + 150.0 * c);
        let on_plane = image.y * 800.0 / (800.0 - image.z);
        assert!(((seen[1] - 0.5) * 20.0 - on_plane).abs() < 1e-9, "{seen:?} {on_plane}");
    }

    /// The lateral shift of a plane-parallel slab (Hecht, Optics, 4.4), of 50 mm.
    fn slab(degrees: f64, index: f64) -> f64 {
        let (s, c) = degrees.to_radians().sin_cos();
        50.0 * s * (1.0 - c / (index * index - s * s).sqrt())
    }

    #[test]
    fn a_turned_block_shifts_by_the_textbooks_formula() {
        let cube = element(block(50.0, 50.0, 50.0), ACRYLIC, [0.0; 3], [0.0, 15.8, 0.0], 0);
        let mut bench = setup(20.0, vec![cube]);
        // So far off that lines of sight are parallel to a part in a million.
        bench.viewpoint = Vec3::new(0.0, 0.0, 1e8);
        bench.display.size = [60.0; 2];
        for (measure, expected) in [
            (Measure::TurnY, slab(16.8, 1.49) - slab(15.8, 1.49)),
            (Measure::Index, slab(15.8, 1.5) - slab(15.8, 1.49)),
            (Measure::Right, 0.0),
        ] {
            let built = differently(&bench, Part::Element(0), measure);
            let seen = seen_at(&bench, &built, [0.5, 0.5]).unwrap();
            let moved = ((seen[0] - 0.5) * 20.0).abs();
            assert!((moved - expected).abs() < 1e-5, "{measure:?} {moved} {expected}");
        }
    }
}
