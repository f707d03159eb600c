//! The first look at F: where it is smooth, where it breaks.

use super::cell::{Cell, Sample};
use crate::transport::Setup;
use rayon::prelude::*;

/// Cells along each side of the survey. With a sample in each cell's interior as well, a region of the image
/// wider than 1/64 is certain to be seen, and a strip of a third of that almost certainly.
pub(super) const CELLS: usize = 64;

/// Points within a block along each side that a patch is held against.
const SEEDS: usize = 8;

/// F at the corners of a grid of cells and at a point within each.
pub(super) struct Survey {
    corners: Vec<Sample>,
    interior: Vec<Sample>,
    /// Branch of each sample, equal numbers for equal branches: corners, then interiors.
    branches: Vec<u32>,
}

impl Survey {
    /// Rays that it takes.
    pub const RAYS: u64 = ((CELLS + 1) * (CELLS + 1) + CELLS * CELLS) as u64;

    pub fn take(setup: &Setup) -> Self {
        let rows = CELLS + 1;
        let corners: Vec<Sample> = (0..rows * rows)
            .into_par_iter()
            .with_min_len(rows)
            .map(|index| Sample::take(setup, corner(index % rows, index / rows)))
            .collect();
        let interior: Vec<Sample> = (0..CELLS * CELLS)
            .into_par_iter()
            .with_min_len(CELLS)
            .map(|index| {
                let (i, j) = (index % CELLS, index / CELLS);
                // Offsets that differ from cell to cell (a Kronecker sequence by the plastic number, Roberts 2018)
                // find strips that lie along the grid.
                let offset = |factor: f64| (0.5 + factor * index as f64).fract();
                Sample::take(
                    setup,
                    [
                        (i as f64 + offset(0.754_877_666_246_692_7)) / CELLS as f64,
                        (j as f64 + offset(0.569_840_290_998_053_2)) / CELLS as f64,
                    ],
                )
            })
            .collect();
        let branches = number_branches(corners.iter().chain(&interior));
        Self { corners, interior, branches }
    }

    pub fn corner(&self, i: usize, j: usize) -> &Sample {
        &self.corners[j * (CELLS + 1) + i]
    }

    pub fn interior(&self, i: usize, j: usize) -> &Sample {
        &self.interior[j * CELLS + i]
    }

    /// Whether all samples of a block of cells lie on one branch.
    pub fn is_one_branch(&self, i: usize, j: usize, size: usize) -> bool {
        let rows = CELLS + 1;
        let first = self.branches[j * rows + i];
        let corners = (j..=j + size)
            .all(|y| self.branches[y * rows + i..=y * rows + i + size].iter().all(|&s| s == first));
        let base = rows * rows;
        corners
            && (j..j + size).all(|y| {
                let start = base + y * CELLS + i;
                self.branches[start..start + size].iter().all(|&s| s == first)
            })
    }

    /// Whether F has the same sense in all cells of a block: no fold is seen in it.
    pub fn has_one_sense(&self, i: usize, j: usize, size: usize) -> bool {
        one_sense(size, |x, y| self.corner(i + x, j + y).arrives().map(|(st, _)| st))
    }

    /// A block's corners and some points within, the first one of them foremost.
    pub fn seeds(&self, i: usize, j: usize, size: usize) -> Vec<Sample> {
        let step = size.div_ceil(SEEDS);
        let within = (0..size)
            .step_by(step)
            .flat_map(|y| (0..size).step_by(step).map(move |x| self.interior(i + x, j + y)));
        let corners = [(i, j), (i + size, j), (i, j + size), (i + size, j + size)];
        within.chain(corners.into_iter().map(|(x, y)| self.corner(x, y))).cloned().collect()
    }

    /// The image cells of a block.
    pub fn block(i: usize, j: usize, size: usize) -> Cell {
        Cell { low: corner(i, j), high: corner(i + size, j + size) }
    }

    /// Bounds in st of a block's samples: lower left, upper right.
    pub fn bounds(&self, i: usize, j: usize, size: usize) -> Option<[[f64; 2]; 2]> {
        let mut bounds = EMPTY;
        // Smooth and without a fold, a block's image is bounded by its border's.
        for k in 0..=size {
            for (x, y) in [(i + k, j), (i + k, j + size), (i, j + k), (i + size, j + k)] {
                extend(&mut bounds, self.corner(x, y).arrives()?.0);
            }
        }
        Some(bounds)
    }
}

pub(super) const EMPTY: [[f64; 2]; 2] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];

pub(super) fn extend(bounds: &mut [[f64; 2]; 2], st: [f64; 2]) {
    for axis in 0..2 {
        bounds[0][axis] = bounds[0][axis].min(st[axis]);
        bounds[1][axis] = bounds[1][axis].max(st[axis]);
    }
}

/// Whether the cells of a grid of `size` x `size`, F given at their corners, all have the same sense.
pub(super) fn one_sense(size: usize, at: impl Fn(usize, usize) -> Option<[f64; 2]>) -> bool {
    let mut senses = (0..size * size).map(|index| {
        let (x, y) = (index % size, index / size);
        sense([at(x, y)?, at(x + 1, y)?, at(x, y + 1)?, at(x + 1, y + 1)?])
    });
    let first = senses.next().flatten();
    first.is_some() && senses.all(|sense| sense == first)
}

/// The sense of a cell's image, if both of its halves (either way it is cut) agree.
pub(super) fn sense([a, b, c, d]: [[f64; 2]; 4]) -> Option<f64> {
    let area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).signum()
    };
    let first = area(a, b, c);
    [area(b, d, c), area(a, b, d), area(a, d, c)].iter().all(|&s| s == first).then_some(first)
}

fn corner(i: usize, j: usize) -> [f64; 2] {
    [i as f64 / CELLS as f64, j as f64 / CELLS as f64]
}

fn number_branches<'a>(samples: impl Iterator<Item = &'a Sample>) -> Vec<u32> {
    let mut known: Vec<&Sample> = Vec::new();
    let mut last = 0;
    samples
        .map(|sample| {
            // Neighbours mostly share their branch.
            if known.get(last).is_none_or(|k| !k.same_branch(sample)) {
                last = known.iter().position(|k| k.same_branch(sample)).unwrap_or_else(|| {
                    known.push(sample);
                    known.len() - 1
                });
            }
            last as u32
        })
        .collect()
}
