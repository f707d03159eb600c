//! Writing the cells' answers into the display's pixels.

use super::Leaf;
use super::patch::Patch;
use super::pixels::{Point, Raster, SAME};
use crate::map::{Map, Status};
use rayon::prelude::*;

/// Rows of pixels that one thread fills at a time: with 1024 columns, 17 bytes a pixel, they stay in its cache.
const BAND: usize = 16;

/// Fills the map from all cells; a band of rows at a time, so that each pixel is written to memory once.
pub(super) fn fill(leaves: &[Leaf], raster: Raster, tolerance: f64, map: &mut Map) {
    let width = raster.width;
    let mut patches = Vec::new();
    let mut points: Vec<Point> = Vec::new();
    for leaf in leaves {
        match leaf {
            Leaf::Patch(patch) => patches.push((patch, raster.pixels_in(patch.rect))),
            Leaf::Points(p) => points.extend(p),
        }
    }
    points.sort_unstable_by_key(|p| p.row);
    map.uv
        .par_chunks_mut(BAND * width)
        .zip(map.status.par_chunks_mut(BAND * width))
        .enumerate()
        .for_each(|(index, (uv, status))| {
            uv.fill([f64::NAN; 2]);
            status.fill(Status::Outside);
            let rows = index * BAND..(index * BAND + status.len() / width);
            let mut scratch = Scratch::default();
            for (patch, [columns, patch_rows]) in &patches {
                for row in rows.start.max(patch_rows.start)..rows.end.min(patch_rows.end) {
                    let from = (row - rows.start) * width;
                    let (uv, status) =
                        (&mut uv[from..from + width], &mut status[from..from + width]);
                    fill_row(
                        patch,
                        columns.clone(),
                        row,
                        raster,
                        tolerance,
                        uv,
                        status,
                        &mut scratch,
                    );
                }
            }
            let first = points.partition_point(|p| (p.row as usize) < rows.start);
            for point in points[first..].iter().take_while(|p| (p.row as usize) < rows.end) {
                let at = (point.row as usize - rows.start) * width + point.column as usize;
                answer(&mut uv[at], &mut status[at], point.uv, point.blocked);
            }
        });
    map.error_bound = patches.iter().fold(1e-12, |worst, (patch, _)| worst.max(patch.error));
    if patches.iter().all(|(patch, _)| !patch.blocked) && points.iter().all(|p| !p.blocked) {
        return;
    }
    for (uv, status) in map.uv.iter_mut().zip(&map.status) {
        if *status == Status::Blocked {
            *uv = [f64::NAN; 2];
        }
    }
}

#[derive(Default)]
struct Scratch {
    u: Vec<f64>,
    v: Vec<f64>,
}

fn fill_row(
    patch: &Patch,
    columns: std::ops::Range<usize>,
    row: usize,
    raster: Raster,
    tolerance: f64,
    uv: &mut [[f64; 2]],
    status: &mut [Status],
    scratch: &mut Scratch,
) {
    let [s, t] = crate::map::pixel_centre(columns.start, row, raster.width, raster.height);
    let step = patch.scaled(s + 1.0 / raster.width as f64, 0) - patch.scaled(s, 0);
    scratch.u.resize(columns.len(), 0.0);
    scratch.v.resize(columns.len(), 0.0);
    patch.row(patch.scaled(t, 1)).evaluate_row(
        patch.scaled(s, 0),
        step,
        &mut scratch.u,
        &mut scratch.v,
    );
    // Seams between cells: both may claim a pixel (that is told by their equal answers), none may leave it out.
    let margin = 2.0 * tolerance;
    let ([u0, v0], [u1, v1]) = (patch.cell.low, patch.cell.high);
    let (u0, v0, u1, v1) = (u0 - margin, v0 - margin, u1 + margin, v1 + margin);
    let answers = scratch.u.iter().zip(&scratch.v);
    let pixels = uv[columns.clone()].iter_mut().zip(&mut status[columns]);
    for ((&u, &v), (uv, status)) in answers.zip(pixels) {
        if u >= u0 && u <= u1 && v >= v0 && v <= v1 {
            answer(uv, status, [u, v], patch.blocked);
        }
    }
}

/// Enters one answer of a pixel. Of several, the image point nearest to the image's centre is shown.
#[inline]
fn answer(uv: &mut [f64; 2], status: &mut Status, found: [f64; 2], blocked: bool) {
    // Seam margins reach beyond the image's own edge by less than the error bound.
    let found = found.map(|c| c.clamp(0.0, 1.0));
    match *status {
        Status::Outside => {
            *uv = found;
            *status = if blocked { Status::Blocked } else { Status::Ok };
        }
        Status::Blocked => {
            if !blocked {
                *uv = found;
                *status = Status::Ok;
            }
        }
        Status::Ok | Status::Folded => {
            if blocked || (uv[0] - found[0]).hypot(uv[1] - found[1]) < SAME {
                return;
            }
            let from_centre = |p: [f64; 2]| (p[0] - 0.5).hypot(p[1] - 0.5);
            if from_centre(found) < from_centre(*uv) {
                *uv = found;
            }
            *status = Status::Folded;
        }
    }
}
