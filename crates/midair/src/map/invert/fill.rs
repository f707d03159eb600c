//! Entering the cells' answers into the display's pixels.

use super::Effort;
use super::patch::Patch;
use super::pixels::{Point, Raster};
use super::plan::Pieces;
use super::row::{Row, Stretch, enter};
use crate::map::{Map, Status, pixel_centre};
use rayon::prelude::*;
use std::ops::Range;

/// Rows of pixels that one thread fills at a time: with 1024 columns, 17 bytes a pixel, they stay in its cache.
const BAND: usize = 16;

/// The answers of all cells, in the order in which rows ask for them.
#[derive(Debug)]
pub(super) struct Answers {
    raster: Raster,
    /// Each with the columns and rows that it reaches.
    patches: Vec<(Patch, [Range<usize>; 2])>,
    /// By rows.
    points: Vec<Point>,
    any_blocked: bool,
}

impl Answers {
    pub fn new(Pieces { patches, mut points }: Pieces, raster: Raster) -> Self {
        let reached = |patch: Patch| {
            let reached = raster.pixels_in(patch.rect);
            (patch, reached)
        };
        let patches: Vec<_> = patches.into_iter().map(reached).collect();
        points.sort_unstable_by_key(|p: &Point| p.row);
        let any_blocked =
            patches.iter().any(|(patch, _)| patch.blocked) || points.iter().any(|p| p.blocked);
        Self { raster, patches, points, any_blocked }
    }

    /// What they took, with so many rays.
    pub fn effort(&self, rays: u64) -> Effort {
        Effort { patches: self.patches.len(), solved_pixels: self.points.len(), rays }
    }

    /// The bound of a map that these answers filled: the patches', and that of each pixel which has one answer and has it from a
    /// point.
    fn error_bound(&self, map: &Map) -> f64 {
        let of_patches = self.patches.iter().map(|(patch, _)| patch.error);
        let of_points = self.points.iter().filter_map(|point| point.error_in(map));
        of_patches.chain(of_points).fold(0.0, f64::max)
    }

    /// Fills the map, a band of rows at a time, so that each pixel is written to memory once.
    pub fn fill(&self, map: &mut Map) {
        let size = (BAND * self.raster.width).max(1);
        let bands = map.uv.par_chunks_mut(size).zip(map.status.par_chunks_mut(size));
        bands.enumerate().for_each(|(index, (uv, status))| {
            self.enter(index * BAND, Row { uv, status });
        });
        map.error_bound = self.error_bound(map);
    }

    /// Fills whole rows of the map, from row `first` on.
    pub fn enter(&self, first: usize, Row { uv, status }: Row<'_>) {
        let width = self.raster.width;
        let rows = first..first + status.len() / width;
        let here: Vec<_> = self
            .patches
            .iter()
            .filter(|(_, [_, of])| of.start < rows.end && rows.start < of.end)
            .collect();
        for ((uv, status), row) in
            uv.chunks_mut(width).zip(status.chunks_mut(width)).zip(rows.clone())
        {
            let stretches = here.iter().filter(|(_, [_, of])| of.contains(&row));
            fill_row(stretches.copied(), row, self.raster, Row { uv, status });
        }
        let before = self.points.partition_point(|p| (p.row as usize) < rows.start);
        for point in self.points[before..].iter().take_while(|p| (p.row as usize) < rows.end) {
            let at = (point.row as usize - rows.start) * width + point.column as usize;
            enter(&mut uv[at], &mut status[at], point.uv, point.blocked);
        }
        if self.any_blocked {
            hide_blocked(Row { uv, status });
        }
    }
}

/// Takes back the answers of blocked pixels, which served to tell them from others.
pub(super) fn hide_blocked(Row { uv, status }: Row<'_>) {
    for (uv, status) in uv.iter_mut().zip(status) {
        if *status == Status::Blocked {
            *uv = [f64::NAN; 2];
        }
    }
}

/// A stretch of the map that has no answers yet.
pub(super) fn clear(uv: &mut [[f64; 2]], status: &mut [Status]) {
    uv.fill([f64::NAN; 2]);
    status.fill(Status::Outside);
}

/// A row of the map from the patches that it crosses, each with its columns.
fn fill_row<'a>(
    mut patches: impl Iterator<Item = &'a (Patch, [Range<usize>; 2])>,
    row: usize,
    raster: Raster,
    Row { uv, status }: Row<'_>,
) {
    status.fill(Status::Outside);
    let first = patches.next();
    // The first patch writes NaN itself where it has no answer.
    let written = first.map_or(0..0, |(_, [columns, _])| columns.clone());
    uv[..written.start].fill([f64::NAN; 2]);
    uv[written.end..].fill([f64::NAN; 2]);
    for (patch, [columns, _]) in first.into_iter().chain(patches) {
        let [s, t] = pixel_centre(columns.start, row, raster.width, raster.height);
        let start = patch.scaled(s, 0);
        let step = patch.scaled(s + 1.0 / raster.width as f64, 0) - start;
        // Seams between cells: both may claim a pixel (that is told by their equal answers), none may leave it out.
        let margin = 2.0 * patch.tolerance;
        let within = patch.cell.claimed(margin);
        let (uv, status) = (&mut uv[columns.clone()], &mut status[columns.clone()]);
        let polynomial = patch.row(patch.scaled(t, 1));
        let stretch = Stretch { start, step, within, blocked: patch.blocked };
        polynomial.enter(&stretch, Row { uv, status });
    }
}
