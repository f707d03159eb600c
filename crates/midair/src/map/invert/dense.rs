//! Inverting a branch that is creased everywhere: seen through a mesh, F has a crease along each triangle's edge, so no
//! polynomial holds over more than a few pixels, and each pixel is solved by itself.

use super::cell::{Cell, Sample};
use super::fill::{clear, hide_blocked};
use super::newton::{apply_inverse, solve};
use super::pixels::{Point, Raster, SAME};
use super::row::{Row, enter, from_centre};
use super::survey::{EMPTY, extend, sense};
use super::tally::counted;
use crate::map::{Map, Status, pixel_centre};
use crate::transport::Setup;
use rayon::prelude::*;

/// Side of a cell in image pixels: with a sample at each corner, a bilinear guess within it is good enough for one
/// Newton step to meet the bound mostly.
const SIDE: f64 = 2.0;
/// Cells along each side of a tile, which one thread takes at a time.
const TILE: usize = 16;
/// Tiles between two looks at what is known: enough to keep threads busy, few enough that much is known soon.
const ROUND: usize = 32;

/// A cell that is not smooth is quartered this often: to half a pixel. What lies between its corners then is less than a
/// pixel of the image; a scanned mesh, whose bumps fold the image a hundredfold, is left at that.
const FINE: usize = 2;

/// Fills the map by a grid of cells over the whole image; returns how many image points were found and the rays that they took.
///
/// From the image's centre outwards: of a folded pixel's image points the one nearest to the centre is shown, so that
/// once two are known, those further out need not be solved.
pub(super) fn solve_densely(setup: &Setup, raster: Raster, map: &mut Map) -> (usize, u64) {
    let columns = (raster.width as f64 / SIDE).ceil() as usize;
    let rows = (raster.height as f64 / SIDE).ceil() as usize;
    let corner = |i: usize, j: usize| [i as f64 / columns as f64, j as f64 / rows as f64];
    let mut tiles: Vec<[usize; 2]> = (0..rows)
        .step_by(TILE)
        .flat_map(|j| (0..columns).step_by(TILE).map(move |i| [i, j]))
        .collect();
    let middle = |&[i, j]: &[usize; 2]| from_centre(corner(i + TILE / 2, j + TILE / 2));
    tiles.sort_by(|a, b| middle(a).total_cmp(&middle(b)));

    clear(&mut map.uv, &mut map.status);
    let (mut solved, mut rays) = (0, 0);
    let mut errors = vec![0.0f32; map.uv.len()];
    for round in tiles.chunks(ROUND) {
        let known = Known { setup, raster, map };
        let solve = |&[first, bottom]: &[usize; 2]| {
            let (last, top) = ((first + TILE).min(columns), (bottom + TILE).min(rows));
            let sample_row = |j: usize| -> Vec<Sample> {
                (first..=last).map(|i| Sample::take(setup, corner(i, j))).collect()
            };
            let mut points = Vec::new();
            let mut below = sample_row(bottom);
            for j in bottom..top {
                let above = sample_row(j + 1);
                for i in first..last {
                    let cell = Cell { low: corner(i, j), high: corner(i + 1, j + 1) };
                    let k = i - first;
                    let corners = [&below[k], &below[k + 1], &above[k], &above[k + 1]];
                    known.solve_cell(cell, corners, 0, &mut points);
                }
                below = above;
            }
            points
        };
        let found: Vec<(Vec<Point>, u64)> =
            round.par_iter().map(|tile| counted(|| solve(tile))).collect();
        for (points, traced) in found {
            solved += points.len();
            rays += traced;
            for point in points {
                let at = point.row as usize * raster.width + point.column as usize;
                enter(&mut map.uv[at], &mut map.status[at], point.uv, point.blocked);
                errors[at] = errors[at].max(point.error);
            }
        }
    }
    hide_blocked(Row { uv: &mut map.uv, status: &mut map.status });
    // Where several answers meet none is the exact one.
    let errors = errors.iter().zip(&map.status).filter(|(_, status)| **status == Status::Ok);
    map.error_bound = errors.fold(0.0, |worst, (&error, _)| worst.max(f64::from(error)));
    (solved, rays)
}

/// A set-up with what is known of its map.
#[derive(Clone, Copy)]
struct Known<'a> {
    setup: &'a Setup,
    raster: Raster,
    map: &'a Map,
}

impl Known<'_> {
    /// Whether nothing in a cell can change a pixel's answer any more.
    fn is_settled(&self, (column, row): (usize, usize), cell: Cell) -> bool {
        let at = row * self.raster.width + column;
        self.map.status[at] == Status::Folded
            && from_centre(self.map.uv[at]) <= from_centre(cell.nearest([0.5; 2]))
    }

    fn solve_cell(&self, cell: Cell, corners: [&Sample; 4], depth: usize, points: &mut Vec<Point>) {
        let mut bounds = EMPTY;
        corners.iter().filter_map(|c| c.arrives()).for_each(|(st, _)| extend(&mut bounds, st));
        // An empty one, too, is nowhere on the display.
        let Some(around) = self.raster.clip(bounds, 1.0) else { return };
        let [columns, rows] = self.raster.pixels_in(around);
        if rows.into_iter().all(|y| columns.clone().all(|x| self.is_settled((x, y), cell))) {
            return;
        }
        if let Some(st) = smooth(corners) {
            return self.solve_smooth(cell, corners[0], st, points);
        }
        if depth < FINE {
            let middle =
                |a: usize, b: usize| [0, 1].map(|k| 0.5 * (corners[a].uv[k] + corners[b].uv[k]));
            let [bottom, left, centre, right, top] =
                [middle(0, 1), middle(0, 2), middle(0, 3), middle(1, 3), middle(2, 3)]
                    .map(|uv| Sample::take(self.setup, uv));
            let [a, b, c, d] = corners;
            let parts = [
                [a, &bottom, &left, &centre],
                [&bottom, b, &centre, &right],
                [&left, &centre, c, &top],
                [&centre, &right, &top, d],
            ];
            for (quarter, corners) in cell.quarters().into_iter().zip(parts) {
                self.solve_cell(quarter, corners, depth + 1, points);
            }
            return;
        }
        self.solve_cut(cell, corners, points);
    }

    /// A cell cut by a border, a jump or a fold, much smaller than a pixel: the pixel nearest to each corner's light, if its
    /// image point lies within.
    fn solve_cut(&self, cell: Cell, corners: [&Sample; 4], points: &mut Vec<Point>) {
        let known = points.len();
        for corner in corners {
            let Some((st, through_plate)) = corner.arrives() else { continue };
            let (column, row) = self.raster.nearest(st);
            if self.is_settled((column, row), cell) {
                continue;
            }
            let target = pixel_centre(column, row, self.raster.width, self.raster.height);
            let mut path = corner.path.clone();
            let Some(solution) = solve(self.setup, &mut path, target, corner.uv, corner.uv) else {
                continue;
            };
            let uv = solution.uv;
            let again = |p: &Point| {
                (p.column as usize, p.row as usize) == (column, row)
                    && (p.uv[0] - uv[0]).hypot(p.uv[1] - uv[1]) < SAME
            };
            if !cell.claims(uv) || points[known..].iter().any(again) {
                continue;
            }
            let found = Sample::take(self.setup, uv);
            let reaches = found.reaches(target, solution.jacobian, self.raster.pixel());
            if found.same_branch(corner) && reaches {
                let pixel = (column, row);
                points.push(Point::new(
                    self.setup,
                    self.raster,
                    pixel,
                    &solution,
                    &mut path,
                    !through_plate,
                ));
            }
        }
    }

    fn solve_smooth(
        &self,
        cell: Cell,
        corner: &Sample,
        st: [[f64; 2]; 4],
        points: &mut Vec<Point>,
    ) {
        let mut bounds = EMPTY;
        st.iter().for_each(|&st| extend(&mut bounds, st));
        // Creases bend the sides of the cell's image by a fraction of it.
        let Some(rect) = self.raster.widen(bounds, 0.1) else { return };
        let [columns, rows] = self.raster.pixels_in(rect);
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let Some((_, through_plate)) = corner.arrives() else { return };
        let mut path = corner.path.clone();
        for row in rows {
            for column in columns.clone() {
                if self.is_settled((column, row), cell) {
                    continue;
                }
                let target = pixel_centre(column, row, self.raster.width, self.raster.height);
                let Some(share) = inverse_bilinear(st, target) else { continue };
                // A guess errs by a fraction of a cell.
                if share.iter().any(|s| !(-0.3..=1.3).contains(s)) {
                    continue;
                }
                let guess = [0, 1]
                    .map(|axis| cell.low[axis] + share[axis] * (cell.high[axis] - cell.low[axis]));
                let Some(solution) = solve(self.setup, &mut path, target, guess, guess) else {
                    // It may have strayed far over the mesh.
                    path.clone_from(&corner.path);
                    continue;
                };
                if cell.claims(solution.uv) {
                    points.push(Point::new(
                        self.setup,
                        self.raster,
                        (column, row),
                        &solution,
                        &mut path,
                        !through_plate,
                    ));
                }
            }
        }
    }
}
/// The corners' places on the display, if they lie on one branch without a jump or a fold between them.
fn smooth(corners: [&Sample; 4]) -> Option<[[f64; 2]; 4]> {
    if !corners[1..].iter().all(|c| c.same_branch(corners[0])) {
        return None;
    }
    let mut st = [[0.0; 2]; 4];
    for (st, corner) in st.iter_mut().zip(corners) {
        *st = corner.arrives()?.0;
    }
    let [a, b, c, d] = st;
    let length = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
    // Opposite sides of the cell's image are alike: a jump would lengthen one and not the other.
    let alike = |p: f64, q: f64| p < 2.0 * q && q < 2.0 * p;
    (sense(st).is_some() && alike(length(a, b), length(c, d)) && alike(length(a, c), length(b, d)))
        .then_some(st)
}

/// Where a point lies between four corners (lower left, lower right, upper left, upper right), as shares from the left
/// and from below: two Newton steps from the affine guess.
fn inverse_bilinear([a, b, c, d]: [[f64; 2]; 4], p: [f64; 2]) -> Option<[f64; 2]> {
    let along = [b[0] - a[0], b[1] - a[1]];
    let up = [c[0] - a[0], c[1] - a[1]];
    let twist = [d[0] - c[0] - along[0], d[1] - c[1] - along[1]];
    let mut share = [0.5; 2];
    for _ in 0..2 {
        let [x, y] = share;
        let at = [0, 1].map(|k| a[k] + x * along[k] + y * up[k] + x * y * twist[k]);
        let jacobian = [0, 1].map(|k| [along[k] + y * twist[k], up[k] + x * twist[k]]);
        let step = apply_inverse(jacobian, [p[0] - at[0], p[1] - at[1]]);
        share = [x + step[0], y + step[1]];
    }
    (share[0].is_finite() && share[1].is_finite()).then_some(share)
}
