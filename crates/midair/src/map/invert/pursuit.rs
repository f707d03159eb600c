//! Pursuing branches over the display, beyond the cells of the image in which they were found.
//!
//! A branch that is too thin in uv for any sample of a cell may be wide on the display, where its inverse is smooth. So where
//! a branch goes on beyond a cell and nobody answers for it there, it is followed from pixel to pixel until it ends.

use super::cell::{Cell, Sample};
use super::newton::{determinant, solve};
use super::patch::Patch;
use super::pixels::{Lead, Point, Raster, SAME};
use crate::transport::Setup;
use std::collections::HashMap;

/// The answers that no cell gave, from where branches go on.
pub(super) fn pursue(
    setup: &Setup,
    raster: Raster,
    patches: &[Patch],
    points: &[Point],
    leads: Vec<Lead>,
) -> Vec<Point> {
    if leads.is_empty() {
        return Vec::new();
    }
    let mut known = Known::new(raster, patches, points);
    let mut found = Vec::new();
    let mut open = leads;
    while let Some(mut lead) = open.pop() {
        let Lead { pixel, solution, through_plate, .. } = lead;
        if known.has(pixel, solution.uv, SAME) {
            continue;
        }
        let st = raster.centre(pixel);
        let traced = Sample::take(setup, solution.uv);
        let arrives_so = traced.arrives().is_some_and(|(_, through)| through == through_plate);
        let reaches = traced.reaches(st, solution.jacobian, raster.pixel());
        if !(arrives_so && traced.path == lead.path && reaches) {
            continue;
        }
        known.add(pixel, solution.uv);
        let point = Point::new(setup, raster, pixel, &solution, &mut lead.path, !through_plate);
        found.push(point);
        let sense = determinant(solution.jacobian).signum();
        for to in raster.around(pixel) {
            let guess = solution.towards(st, raster.centre(to));
            // A guess errs by a fraction of its step.
            let step = (guess[0] - solution.uv[0]).hypot(guess[1] - solution.uv[1]);
            if known.has(to, guess, SAME.min(0.3 * step)) {
                continue;
            }
            let mut path = lead.path.clone();
            if let Some(next) = solve(setup, &mut path, raster.centre(to), guess, solution.uv)
                && next.in_image()
                && determinant(next.jacobian).signum() == sense
            {
                open.push(Lead { pixel: to, solution: next, path, through_plate });
            }
        }
    }
    found
}

/// Parts of the image along each side by which patches are looked up.
const PARTS: usize = 64;

/// What is answered already.
struct Known<'a> {
    raster: Raster,
    /// For each part of the image the patches that answer for some of it.
    patches: Vec<Vec<&'a Patch>>,
    points: HashMap<(usize, usize), Vec<[f64; 2]>>,
}

impl<'a> Known<'a> {
    fn new(raster: Raster, patches: &'a [Patch], points: &[Point]) -> Self {
        let mut by_part = vec![Vec::new(); PARTS * PARTS];
        for patch in patches {
            let Cell { low, high } = patch.cell;
            let ([i, j], [last_i, last_j]) = (low.map(part), high.map(part));
            for j in j..=last_j {
                for i in i..=last_i {
                    by_part[j * PARTS + i].push(patch);
                }
            }
        }
        let mut known = Self { raster, patches: by_part, points: HashMap::new() };
        for point in points {
            known.add((point.column as usize, point.row as usize), point.uv);
        }
        known
    }

    fn add(&mut self, pixel: (usize, usize), uv: [f64; 2]) {
        self.points.entry(pixel).or_default().push(uv);
    }

    /// Whether a pixel has an answer this close to an image point.
    fn has(&self, pixel: (usize, usize), uv: [f64; 2], within: f64) -> bool {
        let near = |other: [f64; 2]| (other[0] - uv[0]).hypot(other[1] - uv[1]) < within;
        if self.points.get(&pixel).is_some_and(|known| known.iter().copied().any(near)) {
            return true;
        }
        let st = self.raster.centre(pixel);
        let [i, j] = uv.map(part);
        self.patches[j * PARTS + i].iter().any(|patch| {
            let inside = (0..2)
                .all(|axis| patch.rect[0][axis] <= st[axis] && st[axis] <= patch.rect[1][axis]);
            inside && patch.cell.holds(uv, within) && near(patch.at(st))
        })
    }
}

/// Which part of the image a coordinate lies in.
fn part(c: f64) -> usize {
    // A negative number becomes 0.
    ((c * PARTS as f64) as usize).min(PARTS - 1)
}
