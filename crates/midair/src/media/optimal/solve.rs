//! Bounded least squares by projected conjugate gradients.

use super::operator::SparseRows;
use rayon::prelude::*;

/// Pixels that a task of the thread pool takes at a time.
const BAND: usize = 8192;

/// The problem: minimise sum of weight * (A x - target)^2 over x in \[0, 1\], three channels at once.
pub(super) struct Problem<'a> {
    pub(super) forward: &'a SparseRows,
    pub(super) backward: &'a SparseRows,
    pub(super) target: &'a [[f32; 4]],
    pub(super) weight: &'a [[f32; 4]],
}

/// How long to go on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Conjugate-gradient steps in all.
    pub(super) steps: usize,
    /// Steps between projections onto \[0, 1\].
    pub(super) steps_per_face: usize,
    /// Stop once a face lowers the objective by less than this share.
    pub(super) tolerance: f64,
    /// Stop once no channel's objective is above this.
    pub(super) negligible: f64,
}

type Pixels = Vec<[f32; 4]>;

/// Channelwise quotient, 0 where there is nothing to divide by.
fn ratio(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|c| if b[c] > 0.0 { a[c] / b[c] } else { 0.0 })
}

impl Problem<'_> {
    /// Lowers the objective from `x`, which must lie in \[0, 1\]; the steps taken.
    ///
    /// As Moré and Toraldo (1991): conjugate gradients (preconditioned by the diagonal) on the
    /// pixels that are free, then a projected search along the step found, which changes the set of free
    /// pixels; and again.
    pub(super) fn solve(&self, x: &mut Pixels, effort: Effort) -> usize {
        let (rows, count) = (self.forward.rows(), x.len());
        let inverse_diagonal: Pixels = self
            .backward
            .squared_row_sums(self.weight)
            .into_iter()
            .map(|sum| sum.map(|s| if s > 0.0 { 1.0 / s } else { 0.0 }))
            .collect();
        let mut residual: Pixels = vec![[0.0; 4]; rows];
        let mut objective = self.residual(x, &mut residual);
        let mut direction: Pixels = vec![[0.0; 4]; count];
        let mut image: Pixels = vec![[0.0; 4]; rows];
        let mut weighted: Pixels = vec![[0.0; 4]; rows];
        let mut gradient: Pixels = vec![[0.0; 4]; count];
        let mut remainder: Pixels = vec![[0.0; 4]; count];
        let mut step: Pixels = vec![[0.0; 4]; count];
        let mut trial: Pixels = vec![[0.0; 4]; count];
        let mut taken = 0;
        while taken < effort.steps && (0..3).any(|c| objective[c] > effort.negligible) {
            weighted.par_chunks_mut(BAND).enumerate().for_each(|(band, chunk)| {
                for (i, value) in chunk.iter_mut().enumerate() {
                    let row = band * BAND + i;
                    for c in 0..4 {
                        value[c] = self.weight[row][c] * residual[row][c];
                    }
                }
            });
            // Steepest descent on the free pixels: `remainder` = -gradient there, 0 elsewhere. A free
            // pixel stays free for the whole face; the bound ones are known by a zero in `mask`.
            let mask = &inverse_diagonal;
            let start = &*x;
            let mut rz = self.backward.multiply(&weighted, &mut remainder, |i, g| {
                let mut down = [0.0f32; 4];
                let mut sum = [0.0f64; 4];
                for c in 0..4 {
                    let bound = (start[i][c] <= 0.0 && g[c] > 0.0)
                        || (start[i][c] >= 1.0 && g[c] < 0.0)
                        || mask[i][c] == 0.0;
                    down[c] = if bound { 0.0 } else { -g[c] };
                    sum[c] = f64::from(down[c] * down[c] * mask[i][c]);
                }
                (down, sum)
            });
            // Bound pixels are those whose remainder is exactly 0 here: remember them.
            gradient.copy_from_slice(&remainder);
            direction.par_iter_mut().enumerate().with_min_len(BAND).for_each(|(i, p)| {
                for c in 0..4 {
                    p[c] = remainder[i][c] * inverse_diagonal[i][c];
                }
            });
            step.par_iter_mut().with_min_len(BAND).for_each(|s| *s = [0.0; 4]);
            let first = rz;
            let mut inner = 0;
            while inner < effort.steps_per_face && taken < effort.steps {
                let curvature = self.forward.multiply(&direction, &mut image, |row, q| {
                    let w = &self.weight[row];
                    let scaled = std::array::from_fn(|c| w[c] * q[c]);
                    (scaled, std::array::from_fn(|c| f64::from(w[c] * q[c] * q[c])))
                });
                let alpha = ratio(rz, curvature).map(|a| a as f32);
                let previous = rz;
                let (free, old) = (&gradient, &remainder);
                rz = self.backward.multiply(&image, &mut trial, |i, hp| {
                    let mut next = [0.0f32; 4];
                    let mut sum = [0.0f64; 4];
                    for c in 0..4 {
                        if free[i][c] != 0.0 {
                            next[c] = old[i][c] - alpha[c] * hp[c];
                            sum[c] = f64::from(next[c] * next[c] * inverse_diagonal[i][c]);
                        }
                    }
                    (next, sum)
                });
                std::mem::swap(&mut remainder, &mut trial);
                let beta = ratio(rz, previous).map(|b| b as f32);
                let remainder = &remainder;
                let inverse_diagonal = &inverse_diagonal;
                let bands = direction.par_chunks_mut(BAND).zip(step.par_chunks_mut(BAND));
                bands.enumerate().for_each(|(band, (direction, step))| {
                    for (i, (p, s)) in direction.iter_mut().zip(step).enumerate() {
                        let pixel = band * BAND + i;
                        for c in 0..4 {
                            s[c] += alpha[c] * p[c];
                            p[c] =
                                remainder[pixel][c] * inverse_diagonal[pixel][c] + beta[c] * p[c];
                        }
                    }
                });
                taken += 1;
                inner += 1;
                // The face is solved: 1e-6 of the squared gradient is a thousandth of it.
                if (0..3).all(|c| rz[c] <= 1e-6 * first[c]) {
                    break;
                }
            }
            let before = objective;
            self.projected_search(x, &step, &mut objective, &mut residual, &mut trial, &mut image);
            if (0..3).all(|c| before[c] - objective[c] <= effort.tolerance * before[c]) {
                break;
            }
        }
        taken
    }

    /// `residual = A x - target`; its weighted sum of squares per channel.
    fn residual(&self, x: &[[f32; 4]], residual: &mut [[f32; 4]]) -> [f64; 4] {
        self.forward.multiply(x, residual, |row, value| {
            let r: [f32; 4] = std::array::from_fn(|c| value[c] - self.target[row][c]);
            (r, std::array::from_fn(|c| f64::from(self.weight[row][c] * r[c] * r[c])))
        })
    }

    /// Moves `x` along `step`, clamped to \[0, 1\], halving the step of a channel until its objective
    /// is no larger than before.
    fn projected_search(
        &self,
        x: &mut Pixels,
        step: &[[f32; 4]],
        objective: &mut [f64; 4],
        residual: &mut Pixels,
        trial: &mut Pixels,
        trial_residual: &mut Pixels,
    ) {
        let mut length = [1.0f32; 4];
        for halving in 0..12 {
            let start = &*x;
            trial.par_iter_mut().enumerate().with_min_len(BAND).for_each(|(i, value)| {
                for c in 0..4 {
                    value[c] = (start[i][c] + length[c] * step[i][c]).clamp(0.0, 1.0);
                }
            });
            let reached = self.residual(trial, trial_residual);
            let mut done = true;
            for c in 0..4 {
                if reached[c] > objective[c] {
                    done = false;
                    // A channel that no step improves stays as it is.
                    length[c] = if halving < 9 { 0.5 * length[c] } else { 0.0 };
                }
            }
            if done {
                std::mem::swap(x, trial);
                std::mem::swap(residual, trial_residual);
                *objective = reached;
                return;
            }
        }
    }
}
