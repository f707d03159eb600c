//! Solving pixels one by one, where a cell is cut by a border, folded, or small.

use super::cell::{Cell, Sample};
use super::newton::{ITERATIONS, apply_inverse, determinant, solve};
use super::tally::count_ray;
use crate::map::{pixel_at, pixel_centre};
use crate::transport::Setup;
use std::collections::HashSet;

/// One image point that reaches a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub column: u32,
    pub row: u32,
    pub uv: [f64; 2],
    pub blocked: bool,
}

impl Point {
    fn pixel(&self, raster: Raster) -> [f64; 2] {
        pixel_centre(self.column as usize, self.row as usize, raster.width, raster.height)
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

/// All image points of `cell` that reach pixels, on the branches of the samples and, if `cut` (a border may run through
/// the cell), on those that turn up.
pub(super) fn solve_pixels(
    setup: &Setup,
    raster: Raster,
    cell: Cell,
    samples: &[Sample],
    cut: bool,
) -> Vec<Point> {
    let mut seeds: Vec<Sample> =
        samples.iter().filter(|s| s.arrives().is_some()).cloned().collect();
    let mut spreads: Vec<Spread> = Vec::new();
    let mut points: Vec<Point> = Vec::new();
    let mut next = 0;
    // Far more branches in one small cell are noise (the vertex of a faceted crystal).
    while next < seeds.len().min(256) {
        let mut seed = seeds[next].clone();
        next += 1;
        let Some((_, through_plate)) = seed.arrives() else { continue };
        count_ray();
        let (_, jacobian) = setup.follow_with_jacobian(seed.uv, &mut seed.path);
        let sense = determinant(jacobian).signum();
        let of_seed = |s: &Spread| s.sense == sense && s.branch.same_branch(&seed);
        let index = spreads.iter().position(of_seed).unwrap_or_else(|| {
            spreads.push(Spread { branch: seed.clone(), sense, visited: HashSet::new() });
            spreads.len() - 1
        });
        for solved in spreads[index].run(setup, raster, cell, &seed) {
            let point = Point { blocked: !through_plate, ..solved };
            if cut {
                let found = Sample::take(setup, point.uv);
                if !(found.same_branch(&seed) && found.reaches(point.pixel(raster))) {
                    if found.arrives().is_some() && !seeds.iter().any(|s| s.same_branch(&found)) {
                        seeds.push(found);
                    }
                    continue;
                }
            }
            points.push(point);
        }
    }
    points
}

/// One branch in one sense within a cell, spreading from pixel to pixel.
struct Spread {
    branch: Sample,
    sense: f64,
    visited: HashSet<(usize, usize)>,
}

impl Spread {
    /// Solves the pixels around a seed, each started from its neighbour: where F changes as the root of the distance
    /// to a border, its inverse is smooth, and so on the display's side every step is a short one.
    ///
    /// Pixels whose image point lies around the cell are passed through, so that a thin region is found whole;
    /// only those within count.
    fn run(&mut self, setup: &Setup, raster: Raster, cell: Cell, seed: &Sample) -> Vec<Point> {
        let mut points = Vec::new();
        let Some((st, _)) = seed.arrives() else { return points };
        let start = raster.nearest(st);
        let mut queue = vec![(start, seed.uv, seed.path.clone())];
        while let Some((pixel, guess, mut path)) = queue.pop() {
            if self.visited.contains(&pixel) {
                continue;
            }
            let st = pixel_centre(pixel.0, pixel.1, raster.width, raster.height);
            let Some(solution) = solve(setup, &mut path, st, guess, ITERATIONS) else { continue };
            if determinant(solution.jacobian).signum() != self.sense {
                continue;
            }
            self.visited.insert(pixel);
            // Half a cell, and one pixel: cells may be smaller than those.
            let pixel_step = [[1.0 / raster.size(0), 0.0], [0.0, 1.0 / raster.size(1)]]
                .map(|step| apply_inverse(solution.jacobian, step))
                .map(|[u, v]| u.abs().max(v.abs()));
            let around = 0.5 * cell.extent() + pixel_step[0].max(pixel_step[1]);
            if pixel != start && !cell.holds(solution.uv, around) {
                continue;
            }
            if cell.holds(solution.uv, 1e-9) {
                let (column, row) = (pixel.0 as u32, pixel.1 as u32);
                points.push(Point { column, row, uv: solution.uv, blocked: false });
            }
            let mut push = |column: Option<usize>, row: Option<usize>| {
                if let (Some(column), Some(row)) = (column, row)
                    && column < raster.width
                    && row < raster.height
                    && !self.visited.contains(&(column, row))
                {
                    let to = pixel_centre(column, row, raster.width, raster.height);
                    let step = apply_inverse(solution.jacobian, [to[0] - st[0], to[1] - st[1]]);
                    let guess = [solution.uv[0] + step[0], solution.uv[1] + step[1]];
                    queue.push(((column, row), guess, path.clone()));
                }
            };
            let (x, y) = pixel;
            push(x.checked_sub(1), Some(y));
            push(Some(x + 1), Some(y));
            push(Some(x), y.checked_sub(1));
            push(Some(x), Some(y + 1));
        }
        points
    }
}
