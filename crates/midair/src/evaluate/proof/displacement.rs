//! The lattice's displacement, measured and exact.

use crate::map::{Map, Status};
use crate::measure::Plane;
use crate::measure::lattice::{
    Displacement, Lattice, LatticeStyle, detect, detect_at, displacement,
};
use crate::picture::Picture;
use crate::simulate::Camera;
use crate::transport::{Path, Setup};

/// A view of the lattice and how far its intersections are from where they belong.
#[derive(Clone, Debug)]
pub struct Shape {
    /// The view; linear light.
    pub view: Picture,
    /// The intersections found in the view, in its pixels from the top left, row by row from the top left; `None` where
    /// there is none.
    pub seen: Vec<Option<[f64; 2]>>,
    /// Where they belong, in the same order.
    pub belongs: Vec<[f64; 2]>,
    /// Between the intersections found in the view and those found in the reference, view pixels; or why it could
    /// not be measured. An intersection has its name from the transport, to a third of the way to the next: an edge of the object may drop, repeat and
    /// reorder lines, so that the picture by itself does not tell which is which.
    pub measured: Result<Displacement, String>,
    /// From the transport itself, without looking at a view; view pixels. Empty where no intersection is formed.
    pub exact: Displacement,
    /// The same over the intersections that were measured: what the measurement should give.
    pub exact_there: Option<Displacement>,
    /// Crossings in the view that no intersection is expected next to, or that could not be measured.
    pub left_out: usize,
}

/// What is seen of a display, by calculation.
pub(in crate::evaluate) struct Sight<'a> {
    pub setup: &'a Setup,
    pub map: &'a Map,
}

impl Sight<'_> {
    /// The image point that the display shows where the viewer looks at `uv`: the map at F(uv).
    pub fn compensated(&self, uv: [f64; 2]) -> Option<[f64; 2]> {
        let st = self.setup.transport(uv, &mut Path::new()).formed()?;
        // The viewer who looks at `uv` sees what belongs at `shown`; to first order that is seen as far on the other side.
        let shown = interpolated(self.map, st)?;
        Some([2.0 * uv[0] - shown[0], 2.0 * uv[1] - shown[1]])
    }

    /// Where the viewer sees a point of the display: the map itself.
    pub fn uncompensated(&self, st: [f64; 2]) -> Option<[f64; 2]> {
        interpolated(self.map, st)
    }
}

/// The map between its samples, bilinear as the display's pixels are seen; `None` next to a pixel that is not ok.
pub(in crate::evaluate) fn interpolated(map: &Map, [s, t]: [f64; 2]) -> Option<[f64; 2]> {
    if map.width < 2 || map.height < 2 || ![s, t].iter().all(|c| (0.0..=1.0).contains(c)) {
        return None;
    }
    let (x, y) = (s * map.width as f64 - 0.5, (1.0 - t) * map.height as f64 - 0.5);
    let column = (x.max(0.0) as usize).min(map.width - 2);
    let row = (y.max(0.0) as usize).min(map.height - 2);
    let (a, b) = (x - column as f64, y - row as f64);
    let mut uv = [0.0; 2];
    for (dx, dy, weight) in
        [(0, 0, (1.0 - a) * (1.0 - b)), (1, 0, a * (1.0 - b)), (0, 1, (1.0 - a) * b), (1, 1, a * b)]
    {
        let index = (row + dy) * map.width + column + dx;
        if map.status[index] != Status::Ok {
            return None;
        }
        uv[0] += weight * map.uv[index][0];
        uv[1] += weight * map.uv[index][1];
    }
    Some(uv)
}

/// The lattice as it should be seen.
pub(super) struct Measure<'a> {
    style: &'a LatticeStyle,
    reference: Result<Lattice, String>,
}

impl<'a> Measure<'a> {
    /// From the reference view.
    pub fn new(style: &'a LatticeStyle, reference: &Picture) -> Self {
        Self { style, reference: found(reference, style.lines) }
    }

    /// The shape seen in a view. `place` says where by calculation an intersection is seen.
    pub fn shape(
        &self,
        view: Picture,
        place: impl Fn([f64; 2]) -> Option<[f64; 2]>,
        camera: &Camera,
    ) -> Shape {
        let uv = self.style.intersections_uv();
        let belongs: Vec<[f64; 2]> = uv.iter().map(|&uv| camera.view_position(uv)).collect();
        let wanted: Vec<_> = belongs.iter().copied().map(Some).collect();
        let calculated: Vec<_> =
            uv.iter().map(|&uv| place(uv).map(|uv| camera.view_position(uv))).collect();
        let nothing = Displacement { mean: f64::NAN, max: f64::NAN, points: vec![None; uv.len()] };
        let exact = displacement(&calculated, &wanted).unwrap_or(nothing);
        // What leaves the view is not looked for at its border.
        let [width, height] = camera.size.map(|side| side as f64);
        let in_view = |[x, y]: &[f64; 2]| (0.0..=width).contains(x) && (0.0..=height).contains(y);
        let expected: Vec<_> = calculated.iter().map(|place| place.filter(in_view)).collect();
        let seen = detect_at(&Plane::luminance(&view), self.style.lines, &expected)
            .map_err(|error| error.to_string());
        let measured = match (&seen, &self.reference) {
            (Ok(seen), Ok(reference)) => {
                displacement(&seen.points(), &reference.points()).map_err(|e| e.to_string())
            }
            (Err(why), _) => Err(why.clone()),
            (_, Err(why)) => Err(format!("the reference: {why}")),
        };
        let exact_there = measured.as_ref().ok().and_then(|measured| {
            let there = calculated.iter().zip(&measured.points);
            let there: Vec<_> = there.map(|(place, off)| off.and(*place)).collect();
            displacement(&there, &wanted).ok()
        });
        let left_out = seen.as_ref().map_or(0, |lattice| lattice.left_out);
        let seen = seen.map_or_else(|_| vec![None; uv.len()], |lattice| lattice.points());
        Shape { view, seen, belongs, measured, exact, exact_there, left_out }
    }
}

fn found(view: &Picture, lines: usize) -> Result<Lattice, String> {
    detect(&Plane::luminance(view), lines).map_err(|error| error.to_string())
}
