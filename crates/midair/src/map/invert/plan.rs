//! Cutting the image into cells on which the inverse is known.

use super::between::Between;
use super::cell::{Cell, Sample};
use super::patch::Patch;
use super::pixels::{Point, Raster, SAME, Solved, solve_pixels};
use super::pursuit::pursue;
use super::survey::{CELLS, EMPTY, Survey, extend, one_sense};
use super::tally::counted;
use crate::transport::Setup;
use rayon::prelude::*;

/// What answers for the image, all together.
#[derive(Debug, Default)]
pub(super) struct Pieces {
    /// Where the inverse is a polynomial.
    pub patches: Vec<Patch>,
    /// Where pixels were solved one by one.
    pub points: Vec<Point>,
}

/// A part of the image still to be inverted.
enum Task {
    /// A square block of the survey's cells.
    Block { i: usize, j: usize, size: usize },
    /// A cell below the survey's.
    Cell(Cell),
}

/// Degree of a large patch: of the degrees 7 to 15, the one that inverts the paper's set-ups soonest.
const DEGREE: usize = 11;
/// Degree of a patch that covers few pixels: more nodes than pixels would be work for nothing.
const SMALL_DEGREE: usize = 5;
/// A patch pays off from this many pixels on; below, each pixel is solved by itself.
const SMALL_PATCH: f64 = 60.0;
/// Samples this close (in pixels) to each other decide whether a cell near a border is cut by it: what then goes
/// unseen reaches less than two pixels deep into it, so that its pixels lie within one pixel of the border.
const SPACING: f64 = 4.0;

/// Inverts F cell by cell; `None` where it is creased too densely for that. Also returns the number of rays traced.
pub(super) fn plan(setup: &Setup, raster: Raster, tolerance: f64) -> (Option<Pieces>, u64) {
    let survey = Survey::take(setup);
    let mut rays = Survey::RAYS;
    let planner = Planner { setup, raster, tolerance, border: border(&survey), survey };
    let (creased, probed) = counted(|| planner.is_creased());
    rays += probed;
    if creased {
        return (None, rays);
    }
    let mut tasks = vec![Task::Block { i: 0, j: 0, size: CELLS }];
    let mut pieces = Pieces::default();
    let mut leads = Vec::new();
    while !tasks.is_empty() {
        let outcomes: Vec<(Outcome, u64)> =
            tasks.par_iter().map(|task| counted(|| planner.process(task))).collect();
        tasks.clear();
        for (outcome, traced) in outcomes {
            rays += traced;
            match outcome {
                Outcome::Nothing => {}
                Outcome::Patch(patch) => pieces.patches.push(patch),
                Outcome::Solved(solved) => {
                    pieces.points.extend(solved.points);
                    leads.extend(solved.leads);
                }
                Outcome::Split(parts) => tasks.extend(parts),
            }
        }
    }
    let Pieces { patches, points } = &mut pieces;
    let (pursued, traced) = counted(|| pursue(setup, raster, patches, points, leads));
    points.extend(pursued);
    (Some(pieces), rays + traced)
}

enum Outcome {
    Nothing,
    Patch(Patch),
    Solved(Solved),
    Split(Vec<Task>),
}

struct Planner<'a> {
    setup: &'a Setup,
    raster: Raster,
    tolerance: f64,
    survey: Survey,
    /// Cells of the survey that touch a border of a branch, or whose neighbour does.
    border: Vec<bool>,
}

/// The survey's cells within one cell of a border of a branch.
fn border(survey: &Survey) -> Vec<bool> {
    let broken: Vec<bool> = (0..CELLS * CELLS)
        .map(|index| !survey.is_one_branch(index % CELLS, index / CELLS, 1))
        .collect();
    (0..CELLS * CELLS)
        .map(|index| {
            let (i, j) = (index % CELLS, index / CELLS);
            let around = |k: usize| k.saturating_sub(1)..(k + 2).min(CELLS);
            around(j).any(|y| around(i).any(|x| broken[y * CELLS + x]))
        })
        .collect()
}

impl Planner<'_> {
    /// Whether F is creased too densely for patches: seen through a smooth mesh, if patches fail on most of the cells
    /// that are tried.
    fn is_creased(&self) -> bool {
        let meshes = self.setup.elements.iter().any(|e| e.shape.bent_mesh().is_some());
        if !meshes {
            return false;
        }
        const PROBES: usize = 5;
        let step = CELLS / (PROBES + 1);
        let probes = (1..=PROBES).flat_map(|j| (1..=PROBES).map(move |i| (i * step, j * step)));
        let (mut tried, mut failed) = (0, 0);
        for (i, j) in probes {
            let sample = self.survey.interior(i, j);
            let seamless = sample.path.iter().any(|step| step.seamless);
            if seamless
                && self.survey.is_one_branch(i, j, 1)
                && let Some(fit) = self.fit_block(i, j, 1)
            {
                tried += 1;
                failed += usize::from(matches!(fit, Fit::Failed));
            }
        }
        2 * failed > tried
    }

    fn process(&self, task: &Task) -> Outcome {
        match *task {
            Task::Block { i, j, size } => self.block(i, j, size),
            Task::Cell(cell) => self.cell(cell),
        }
    }

    fn block(&self, i: usize, j: usize, size: usize) -> Outcome {
        let at_border =
            (j..j + size).any(|y| self.border[y * CELLS + i..y * CELLS + i + size].contains(&true));
        if !at_border && self.survey.is_one_branch(i, j, size) {
            let sample = self.survey.interior(i, j);
            if sample.arrives().is_none() {
                return Outcome::Nothing;
            }
            if let Some(Fit::Done(outcome)) = self.fit_block(i, j, size) {
                return outcome;
            }
        }
        if size == 1 {
            return self.cell(Survey::block(i, j, 1));
        }
        let half = size / 2;
        Outcome::Split(
            [(i, j), (i + half, j), (i, j + half), (i + half, j + half)]
                .map(|(i, j)| Task::Block { i, j, size: half })
                .into(),
        )
    }

    /// Tries a block that lies on one branch; `None` where a fold is seen in it, or its light does not arrive.
    fn fit_block(&self, i: usize, j: usize, size: usize) -> Option<Fit> {
        let bounds = self.survey.bounds(i, j, size)?;
        if !self.survey.has_one_sense(i, j, size) {
            return None;
        }
        // Between samples the border bulges by less than its distance between samples.
        let seeds = self.survey.seeds(i, j, size);
        Some(self.fit(&seeds, Survey::block(i, j, size), bounds, 0.2 / size as f64))
    }

    fn cell(&self, cell: Cell) -> Outcome {
        let extent = cell.extent() * self.raster.longer_side();
        let n = ((extent / SPACING).ceil() as usize).clamp(2, 16) + 1;
        let samples: Vec<Sample> = (0..n * n)
            .map(|index| {
                let place = |axis: usize, k: usize| {
                    let share = k as f64 / (n - 1) as f64;
                    cell.low[axis] + (cell.high[axis] - cell.low[axis]) * share
                };
                Sample::take(self.setup, [place(0, index % n), place(1, index / n)])
            })
            .collect();
        let arriving: Vec<[f64; 2]> =
            samples.iter().filter_map(|s| s.arrives().map(|(st, _)| st)).collect();
        let one_branch = samples.iter().all(|s| s.same_branch(&samples[0]));
        if one_branch && arriving.is_empty() {
            return Outcome::Nothing;
        }
        let mut bounds = EMPTY;
        arriving.iter().for_each(|&st| extend(&mut bounds, st));
        if one_branch
            && one_sense(n - 1, |x, y| Some(arriving[y * n + x]))
            && let Fit::Done(outcome) = self.fit(&samples, cell, bounds, 0.2 / (n - 1) as f64)
        {
            return outcome;
        }
        if extent > SPACING {
            return Outcome::Split(cell.quarters().map(Task::Cell).into());
        }
        let cut = !(one_branch && continuous(&arriving, n));
        let mut seeds = samples;
        if cut {
            let mut between = Between::new(self.setup);
            for k in 0..n * n {
                let right = (k % n + 1 < n).then_some(k + 1);
                let above = (k + n < n * n).then_some(k + n);
                for other in [right, above].into_iter().flatten() {
                    between.look(&seeds[k], &seeds[other]);
                }
            }
            seeds.extend(between.found);
        }
        Outcome::Solved(solve_pixels(self.setup, self.raster, cell, &seeds, cut))
    }

    /// A smooth cell's patch, or its pixels if they are few. All samples lie on its one branch.
    fn fit(&self, samples: &[Sample], cell: Cell, bounds: [[f64; 2]; 2], bulge: f64) -> Fit {
        let Some(rect) = self.raster.clip(bounds, bulge) else {
            return Fit::Done(Outcome::Nothing);
        };
        let pixels: f64 =
            (0..2).map(|axis| (rect[1][axis] - rect[0][axis]) * self.raster.size(axis)).product();
        if pixels < SMALL_PATCH {
            let points = solve_pixels(self.setup, self.raster, cell, samples, false);
            return Fit::Done(Outcome::Solved(points));
        }
        let sample = &samples[0];
        let degree = if pixels < 900.0 { SMALL_DEGREE } else { DEGREE };
        match Patch::fit(self.setup, &mut sample.path.clone(), cell, rect, degree, self.tolerance) {
            // A fold between the samples: one of its two branches would go unanswered.
            Some(patch) if !samples.iter().all(|s| returns(&patch, s)) => Fit::Failed,
            Some(mut patch) => {
                patch.blocked = sample.arrives().is_some_and(|(_, through_plate)| !through_plate);
                Fit::Done(Outcome::Patch(patch))
            }
            None => Fit::Failed,
        }
    }
}

enum Fit {
    Done(Outcome),
    Failed,
}

/// Whether a patch leads from where a sample's light arrives back to the sample, if it reaches there.
fn returns(patch: &Patch, sample: &Sample) -> bool {
    let Some((st, _)) = sample.arrives() else { return false };
    let reaches = (0..2).all(|k| (patch.rect[0][k]..=patch.rect[1][k]).contains(&st[k]));
    let uv = patch.at(st);
    !reaches || (uv[0] - sample.uv[0]).hypot(uv[1] - sample.uv[1]) < SAME
}

/// Whether samples of one branch on an n x n grid show no jump: on a mesh, light may leave by a face far away from its
/// neighbour's. A jump between two samples is their whole difference and their second difference alike; on a smooth
/// stretch second differences are the smaller.
fn continuous(samples: &[[f64; 2]], n: usize) -> bool {
    let difference = |a: [f64; 2], b: [f64; 2]| [b[0] - a[0], b[1] - a[1]];
    let length = |v: [f64; 2]| v[0].hypot(v[1]);
    let smooth = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        let (first, second) = (difference(a, b), difference(b, c));
        length(difference(first, second)) <= 0.5 * (length(first) + length(second))
    };
    (0..n).all(|j| {
        (2..n).all(|i| {
            smooth(samples[j * n + i - 2], samples[j * n + i - 1], samples[j * n + i])
                && smooth(samples[(i - 2) * n + j], samples[(i - 1) * n + j], samples[i * n + j])
        })
    })
}
