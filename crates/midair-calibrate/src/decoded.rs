//! What the pixels of a camera see of the display: a status and a display point each, and what becomes of them.

use crate::correspondences::Correspondence;
use rayon::prelude::*;
use serde::Serialize;

/// What a camera pixel sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[repr(u8)]
pub enum Seen {
    /// Nothing of the display.
    None,
    /// Something of it, but not which point.
    Unsure,
    /// A point of it, by stray light.
    Stray,
    /// A point of it.
    Real,
}

/// What the camera pixels of one state of a view see.
#[derive(Clone, Debug)]
pub struct Decoded {
    /// Width of the photographs, px.
    pub width: usize,
    /// Height, px.
    pub height: usize,
    /// Each pixel's status, row 0 at the top.
    pub seen: Vec<Seen>,
    /// The display point that it sees, st; NaN where none.
    pub st: Vec<[f32; 2]>,
    /// How far along either axis the sinusoids lie from the middle of the stripes that they agree with, on the average, in stripes: about 0 unless something moved.
    pub lag: [f64; 2],
    /// What should be known of the photographs.
    pub notes: Vec<String>,
}

/// How many pixels have each status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SeenCounts {
    /// Of a display point.
    pub real: usize,
    /// Of a display point by stray light.
    pub stray: usize,
    /// Of something.
    pub unsure: usize,
    /// Of nothing.
    pub none: usize,
}

impl Decoded {
    /// How many pixels have each status.
    pub fn counts(&self) -> SeenCounts {
        let mut counts = SeenCounts::default();
        for seen in &self.seen {
            *match seen {
                Seen::Real => &mut counts.real,
                Seen::Stray => &mut counts.stray,
                Seen::Unsure => &mut counts.unsure,
                Seen::None => &mut counts.none,
            } += 1;
        }
        counts
    }

    /// The display point that is seen at a place between pixel centres, by the plane through what the pixels around it see; `None` where they see no smooth
    /// piece of the display.
    pub fn around(&self, [x, y]: [f64; 2], resolution: [usize; 2]) -> Option<[f64; 2]> {
        // Five pixels wide: a fifth of one pixel's noise, and as sharp as a lens.
        const REACH: f64 = 2.0;
        let from = [x, y].map(|c| c.floor() - REACH);
        let inside = from[0] >= 0.0
            && from[1] >= 0.0
            && from[0] + 2.0 * REACH < self.width as f64
            && from[1] + 2.0 * REACH < self.height as f64;
        if !inside {
            return None;
        }
        let side = (2.0 * REACH) as usize + 1;
        let points = self.real_within([from[0] as usize, from[1] as usize], side, resolution);
        let (plane, _, kept) = fitted(points, [x, y])?;
        // Most of them, on all sides.
        (3 * kept >= 2 * side * side).then(|| [0, 1].map(|c| plane[c][0] / resolution[c] as f64))
    }

    /// The pixels of a square that see a display point: their middles, and the point in display pixels.
    fn real_within(
        &self,
        [left, top]: [usize; 2],
        side: usize,
        resolution: [usize; 2],
    ) -> Vec<([f64; 2], [f64; 2])> {
        let mut points = Vec::with_capacity(side * side);
        for y in top..top + side {
            for x in left..left + side {
                let pixel = y * self.width + x;
                if self.seen[pixel] == Seen::Real {
                    let at = [x as f64 + 0.5, y as f64 + 0.5];
                    let st = [0, 1].map(|c| f64::from(self.st[pixel][c]) * resolution[c] as f64);
                    points.push((at, st));
                }
            }
        }
        points
    }

    /// Correspondences of the pixels that see a display point: one for each block of pixels that see one smooth piece of it, of which there are at most about `most`.
    pub fn correspondences(&self, resolution: [usize; 2], most: usize) -> Vec<Correspondence> {
        let real = self.seen.iter().filter(|seen| **seen == Seen::Real).count();
        let side = ((real as f64 / most.max(1) as f64).sqrt().ceil() as usize).max(4);
        let rows: Vec<usize> = (0..self.height / side).collect();
        let of_row = |row: usize| -> Vec<Correspondence> {
            (0..self.width / side).filter_map(|k| self.block(k, row, side, resolution)).collect()
        };
        rows.into_par_iter().flat_map_iter(of_row).collect()
    }

    /// A block's middle, by the plane through what its pixels see; `None` where they see no smooth piece.
    fn block(
        &self,
        column: usize,
        row: usize,
        side: usize,
        resolution: [usize; 2],
    ) -> Option<Correspondence> {
        let points = self.real_within([column * side, row * side], side, resolution);
        if 2 * points.len() < side * side {
            return None;
        }
        let middle = points.iter().fold([0.0; 2], |m, (at, _)| [m[0] + at[0], m[1] + at[1]]);
        let middle = middle.map(|m| m / points.len() as f64);
        let (plane, rms, kept) = fitted(points, middle)?;
        (2 * kept >= side * side).then(|| Correspondence {
            pixel: middle,
            st: [0, 1].map(|c| plane[c][0] / resolution[c] as f64),
            // Neighbouring pixels' errors go together: the mean of n of them is little better than that of a quarter as many.
            sigma: (rms * 2.0 / (kept as f64).sqrt()).max(0.05),
        })
    }
}

/// The planes through points, those that are far off left out: the planes about a middle, how far the points are off them, rms, and how many are left. `None`
/// where they are no plane: over an edge, or where several images lie over one another.
fn fitted(
    mut points: Vec<([f64; 2], [f64; 2])>,
    middle: [f64; 2],
) -> Option<([[f64; 3]; 2], f64, usize)> {
    let mut rms = 0.0;
    for _ in 0..2 {
        let plane = plane(&points, middle)?;
        let off = |(at, st): &([f64; 2], [f64; 2])| {
            let (dx, dy) = (at[0] - middle[0], at[1] - middle[1]);
            let off = [0, 1].map(|c| plane[c][0] + plane[c][1] * dx + plane[c][2] * dy - st[c]);
            off[0].hypot(off[1])
        };
        rms = (points.iter().map(|p| off(p).powi(2)).sum::<f64>() / points.len() as f64).sqrt();
        let bound = (3.0 * rms).max(0.1);
        points.retain(|point| off(point) <= bound);
    }
    (rms < 3.0).then_some((plane(&points, middle)?, rms, points.len()))
}

/// The planes through values over places: value at the middle, slopes along x and y; `None` where they are not told.
fn plane(points: &[([f64; 2], [f64; 2])], middle: [f64; 2]) -> Option<[[f64; 3]; 2]> {
    let mut normal = nalgebra::Matrix3::<f64>::zeros();
    let mut right = [nalgebra::Vector3::<f64>::zeros(); 2];
    for (at, st) in points {
        let row = nalgebra::Vector3::new(1.0, at[0] - middle[0], at[1] - middle[1]);
        normal += row * row.transpose();
        right[0] += row * st[0];
        right[1] += row * st[1];
    }
    let solver = normal.cholesky()?;
    Some(right.map(|r| {
        let plane = solver.solve(&r);
        [plane.x, plane.y, plane.z]
    }))
}
