//! Solving pixels one by one, where a cell is cut by a border, folded, or small.

use super::cell::{Cell, Sample};
use super::newton::{Solution, apply_inverse, determinant, solve};
use super::tally::count_ray;
use crate::map::{Map, Status, pixel_at, pixel_centre};
use crate::transport::{Path, Setup, Step};
use std::collections::{HashMap, HashSet};

/// One image point that reaches a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub column: u32,
    pub row: u32,
    pub uv: [f64; 2],
    /// Bound of |uv - exact|.
    pub error: f32,
    pub blocked: bool,
}

impl Point {
    /// A solution as a pixel's answer; `path` is its own.
    pub fn new(
        setup: &Setup,
        raster: Raster,
        pixel: (usize, usize),
        solution: &Solution,
        path: &mut [Step],
        blocked: bool,
    ) -> Self {
        let error = solution.error(setup, path, raster.centre(pixel)) as f32;
        Self {
            column: pixel.0 as u32,
            row: pixel.1 as u32,
            uv: solution.uv,
            error: error.next_up(),
            blocked,
        }
    }

    /// Its error, if it is the one answer of its pixel.
    pub fn error_in(&self, map: &Map) -> Option<f64> {
        let at = self.row as usize * map.width + self.column as usize;
        (map.status[at] == Status::Ok && !self.blocked).then_some(f64::from(self.error))
    }
}

/// The display's pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Raster {
    pub width: usize,
    pub height: usize,
}

impl Raster {
    pub fn size(&self, axis: usize) -> f64 {
        if axis == 0 { self.width as f64 } else { self.height as f64 }
    }

    pub fn longer_side(&self) -> f64 {
        self.width.max(self.height) as f64
    }

    /// Bounds widened by a share of their size and a pixel, and cut to the display; `None` if nothing is left.
    pub fn clip(&self, bounds: [[f64; 2]; 2], share: f64) -> Option<[[f64; 2]; 2]> {
        self.widen_by(bounds, share, 1.0)
    }

    /// Bounds widened by a share of their size, and cut to the display; `None` if nothing is left.
    pub fn widen(&self, bounds: [[f64; 2]; 2], share: f64) -> Option<[[f64; 2]; 2]> {
        self.widen_by(bounds, share, 0.0)
    }

    fn widen_by(&self, bounds: [[f64; 2]; 2], share: f64, pixels: f64) -> Option<[[f64; 2]; 2]> {
        let mut clipped = bounds;
        for axis in 0..2 {
            let extra = share * (bounds[1][axis] - bounds[0][axis]) + pixels / self.size(axis);
            clipped[0][axis] = (bounds[0][axis] - extra).max(0.0);
            clipped[1][axis] = (bounds[1][axis] + extra).min(1.0);
            if !(clipped[0][axis] < clipped[1][axis]) {
                return None;
            }
        }
        Some(clipped)
    }

    /// A pixel's size in st.
    pub fn pixel(&self) -> [f64; 2] {
        [1.0 / self.size(0), 1.0 / self.size(1)]
    }

    /// The place of a pixel's centre.
    pub fn centre(&self, (column, row): (usize, usize)) -> [f64; 2] {
        pixel_centre(column, row, self.width, self.height)
    }

    /// The pixels that share a side with one.
    pub fn around(&self, (column, row): (usize, usize)) -> impl Iterator<Item = (usize, usize)> {
        let Self { width, height } = *self;
        [
            (column.wrapping_sub(1), row),
            (column + 1, row),
            (column, row.wrapping_sub(1)),
            (column, row + 1),
        ]
        .into_iter()
        .filter(move |&(x, y)| x < width && y < height)
    }

    /// Column and row of the pixel nearest to a place.
    pub fn nearest(&self, st: [f64; 2]) -> (usize, usize) {
        pixel_at(st, self.width, self.height)
    }

    /// The columns and rows whose centres lie within a rectangle of st: first and one past the last.
    pub fn pixels_in(&self, rect: [[f64; 2]; 2]) -> [std::ops::Range<usize>; 2] {
        let index = |x: f64, n: usize| (x.ceil().max(0.0) as usize).min(n);
        let (w, h) = (self.width, self.height);
        let columns = index(rect[0][0] * w as f64 - 0.5, w)..index(rect[1][0] * w as f64 + 0.5, w);
        let rows = index((1.0 - rect[1][1]) * h as f64 - 0.5, h)
            ..index((1.0 - rect[0][1]) * h as f64 + 0.5, h);
        [columns, rows]
    }
}

/// Two solutions closer than this are one: a fortieth of a pixel at 1024, three times what the loosest patches (those
/// through meshes) may err.
pub(super) const SAME: f64 = 2.5e-5;

/// A solution that belongs to another cell than the one that was searched: a branch goes on there.
#[derive(Clone, Debug)]
pub(super) struct Lead {
    pub pixel: (usize, usize),
    pub solution: Solution,
    pub path: Path,
    pub through_plate: bool,
}

/// What was found in a cell that is solved pixel by pixel.
#[derive(Debug, Default)]
pub(super) struct Solved {
    pub points: Vec<Point>,
    /// Where branches go on beyond the cell.
    pub leads: Vec<Lead>,
}

/// More branches than so many samples find in one small cell are noise (the vertex of a faceted crystal).
const MOST_SEEDS: usize = 2000;

/// All image points of `cell` that reach pixels, on the branches of the samples and, if `cut` (a border may run through
/// the cell), on those that turn up.
pub(super) fn solve_pixels(
    setup: &Setup,
    raster: Raster,
    cell: Cell,
    samples: &[Sample],
    cut: bool,
) -> Solved {
    let mut seeds: Vec<Sample> =
        samples.iter().filter(|s| s.arrives().is_some()).cloned().collect();
    let mut spreads: Vec<Spread> = Vec::new();
    let mut solved = Solved::default();
    let mut next = 0;
    while next < seeds.len().min(MOST_SEEDS) {
        let mut seed = seeds[next].clone();
        next += 1;
        let Some((_, through_plate)) = seed.arrives() else { continue };
        count_ray();
        let (_, jacobian) = setup.follow_with_jacobian(seed.uv, &mut seed.path);
        let sense = determinant(jacobian).signum();
        let of_seed = |s: &Spread| s.sense == sense && s.branch.same_branch(&seed);
        let index = spreads.iter().position(of_seed).unwrap_or_else(|| {
            spreads.push(Spread::new(seed.clone(), sense));
            spreads.len() - 1
        });
        for mut lead in spreads[index].run(setup, raster, cell, &seed, jacobian) {
            let within = cell.claims(lead.solution.uv);
            if within {
                let found = Sample::take(setup, lead.solution.uv);
                let st = raster.centre(lead.pixel);
                let reaches = found.reaches(st, lead.solution.jacobian, raster.pixel());
                if !(found.same_branch(&seed) && reaches) {
                    if cut
                        && found.arrives().is_some()
                        && !seeds.iter().any(|s| s.same_branch(&found))
                    {
                        seeds.push(found);
                    }
                    continue;
                }
            }
            if within {
                let Lead { pixel, ref solution, ref mut path, .. } = lead;
                let point = Point::new(setup, raster, pixel, solution, path, !through_plate);
                solved.points.push(point);
            } else if cut {
                solved.leads.push(lead);
            }
        }
    }
    solved
}

/// One branch in one sense within a cell, spreading from pixel to pixel.
struct Spread {
    branch: Sample,
    sense: f64,
    visited: HashSet<(usize, usize)>,
    /// How often a pixel could not be solved.
    failed: HashMap<(usize, usize), u32>,
}

/// So often a pixel is tried from different sides.
const TRIES: u32 = 4;

impl Spread {
    fn new(branch: Sample, sense: f64) -> Self {
        Self { branch, sense, visited: HashSet::new(), failed: HashMap::new() }
    }

    /// Solves the pixels around a seed, each started from its neighbour: where F changes as the root of the distance
    /// to a border, its inverse is smooth, and so on the display's side every step is a short one.
    ///
    /// Pixels whose image point lies around the cell are passed through, so that a thin region is found whole.
    fn run(
        &mut self,
        setup: &Setup,
        raster: Raster,
        cell: Cell,
        seed: &Sample,
        jacobian: [[f64; 2]; 2],
    ) -> Vec<Lead> {
        let mut found = Vec::new();
        let Some((st, through_plate)) = seed.arrives() else { return found };
        let start = Solution { uv: seed.uv, jacobian };
        // The seed's own pixel's centre may lie beyond the border that the seed is near.
        let own = raster.nearest(st);
        let mut queue: Vec<_> = raster
            .around(own)
            .chain([own])
            .map(|pixel| {
                let guess = start.towards(st, raster.centre(pixel));
                (pixel, guess, seed.uv, seed.path.clone(), true)
            })
            .collect();
        while let Some((pixel, guess, near, mut path, first)) = queue.pop() {
            if self.visited.contains(&pixel)
                || self.failed.get(&pixel).is_some_and(|&failed| failed >= TRIES)
            {
                continue;
            }
            let st = raster.centre(pixel);
            let solution = solve(setup, &mut path, st, guess, near)
                .filter(|found| determinant(found.jacobian).signum() == self.sense);
            let Some(solution) = solution else {
                *self.failed.entry(pixel).or_default() += 1;
                continue;
            };
            self.visited.insert(pixel);
            // Half a cell, and one pixel: cells may be smaller than those.
            let pixel_step = [[1.0 / raster.size(0), 0.0], [0.0, 1.0 / raster.size(1)]]
                .map(|step| apply_inverse(solution.jacobian, step))
                .map(|[u, v]| u.abs().max(v.abs()));
            let around = 0.5 * cell.extent() + pixel_step[0].max(pixel_step[1]);
            if first || cell.holds(solution.uv, around) {
                for to in raster.around(pixel).filter(|to| !self.visited.contains(to)) {
                    let guess = solution.towards(st, raster.centre(to));
                    queue.push((to, guess, solution.uv, path.clone(), false));
                }
            }
            if solution.in_image() {
                found.push(Lead { pixel, solution, path, through_plate });
            }
        }
        found
    }
}
