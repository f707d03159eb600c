//! Bounded least squares by projected conjugate gradients.

use super::Weights;
use super::operator::{Rgb, SparseRows};
use rayon::prelude::*;

/// Pixels that a task of the thread pool takes at a time.
const BAND: usize = 8192;

/// The problem: minimise sum of weight * (A x - target)^2 over x in \[0, 1\], three channels at once.
pub(super) struct Problem<'a> {
    pub(super) forward: &'a SparseRows,
    pub(super) backward: &'a SparseRows,
    pub(super) target: &'a [Rgb],
    pub(super) weights: &'a Weights,
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

/// Channelwise quotient, 0 where there is nothing to divide by.
fn ratio(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| if b[c] > 0.0 { a[c] / b[c] } else { 0.0 })
}

/// A preconditioner's value with the upper half of a float's bits: any positive diagonal is as right, and half as much is read.
#[derive(Clone, Copy)]
struct Coarse([u16; 3]);

impl Coarse {
    fn reciprocal(value: Rgb) -> Self {
        Self(
            value.map(
                |v| if v > 0.0 { ((1.0 / v).min(f32::MAX).to_bits() >> 16) as u16 } else { 0 },
            ),
        )
    }

    #[inline]
    fn get(self) -> Rgb {
        self.0.map(|bits| f32::from_bits(u32::from(bits) << 16))
    }
}

impl Problem<'_> {
    /// Lowers the objective from `x`, which must lie in \[0, 1\]; the steps taken.
    ///
    /// As Moré and Toraldo (1991): conjugate gradients (preconditioned by the diagonal) on the
    /// pixels that are free, then a projected search along the step found, which changes the set of free
    /// pixels; and again.
    pub(super) fn solve(&self, x: &mut Vec<Rgb>, effort: Effort) -> usize {
        let (rows, count) = (self.forward.rows(), x.len());
        let weight = |row: usize| self.weights.at(self.target[row]);
        let inverse_diagonal = self.backward.squared_row_sums(weight, Coarse::reciprocal);
        // Between faces the weighted residual, W (A x - target); within a face, which does not need it, the direction's weighted image.
        let mut in_view: Vec<Rgb> = vec![[0.0; 3]; rows];
        let mut objective = self.residual(x, &mut in_view);
        let mut direction: Vec<Rgb> = vec![[0.0; 3]; count];
        let mut remainder: Vec<Rgb> = vec![[0.0; 3]; count];
        let mut step: Vec<Rgb> = vec![[0.0; 3]; count];
        // A bit for each channel that may move.
        let mut free = vec![0u8; count];
        let mut taken = 0;
        while taken < effort.steps && (0..3).any(|c| objective[c] > effort.negligible) {
            // Steepest descent on the free pixels: `remainder` = -gradient there, 0 elsewhere. A free
            // pixel stays free for the whole face.
            let (mask, start) = (&inverse_diagonal, &*x);
            let mut rz = self.backward.multiply(&in_view, &mut remainder, |i, g, _| {
                let (mut down, mut sum, mask) = ([0.0f32; 3], [0.0f64; 3], mask[i].get());
                for c in 0..3 {
                    let bound = (start[i][c] <= 0.0 && g[c] > 0.0)
                        || (start[i][c] >= 1.0 && g[c] < 0.0)
                        || mask[c] == 0.0;
                    down[c] = if bound { 0.0 } else { -g[c] };
                    sum[c] = f64::from(down[c] * down[c] * mask[c]);
                }
                (down, sum)
            });
            let bands = direction.par_chunks_mut(BAND).zip(step.par_chunks_mut(BAND));
            bands.zip(free.par_chunks_mut(BAND)).enumerate().for_each(
                |(band, ((direction, step), free))| {
                    let places = direction.iter_mut().zip(step).zip(free).enumerate();
                    for (i, ((p, s), free)) in places {
                        let i = band * BAND + i;
                        let (down, inverse) = (remainder[i], mask[i].get());
                        *free = (0..3).map(|c| u8::from(down[c] != 0.0) << c).sum();
                        *p = std::array::from_fn(|c| down[c] * inverse[c]);
                        *s = [0.0; 3];
                    }
                },
            );
            let first = rz;
            let mut inner = 0;
            while inner < effort.steps_per_face && taken < effort.steps {
                let curvature = self.forward.multiply(&direction, &mut in_view, |row, q, _| {
                    let w = weight(row);
                    let scaled = std::array::from_fn(|c| w[c] * q[c]);
                    (scaled, std::array::from_fn(|c| f64::from(w[c] * q[c] * q[c])))
                });
                let alpha = ratio(rz, curvature).map(|a| a as f32);
                let previous = rz;
                rz = self.backward.multiply(&in_view, &mut remainder, |i, hp, old| {
                    let (mut next, mut sum, inverse) = ([0.0f32; 3], [0.0f64; 3], mask[i].get());
                    for c in 0..3 {
                        if free[i] >> c & 1 == 1 {
                            next[c] = old[c] - alpha[c] * hp[c];
                            sum[c] = f64::from(next[c] * next[c] * inverse[c]);
                        }
                    }
                    (next, sum)
                });
                let beta = ratio(rz, previous).map(|b| b as f32);
                let bands = direction.par_chunks_mut(BAND).zip(step.par_chunks_mut(BAND));
                bands.enumerate().for_each(|(band, (direction, step))| {
                    for (i, (p, s)) in direction.iter_mut().zip(step).enumerate() {
                        let (down, inverse) =
                            (remainder[band * BAND + i], mask[band * BAND + i].get());
                        for c in 0..3 {
                            s[c] += alpha[c] * p[c];
                            p[c] = down[c] * inverse[c] + beta[c] * p[c];
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
            // The direction is used up: its memory serves the search.
            let moved =
                self.projected_search(x, &step, &mut objective, &mut in_view, &mut direction);
            if !moved || (0..3).all(|c| before[c] - objective[c] <= effort.tolerance * before[c]) {
                break;
            }
        }
        taken
    }

    /// `residual = W (A x - target)`; the weighted sum of squares per channel.
    fn residual(&self, x: &[Rgb], residual: &mut [Rgb]) -> [f64; 3] {
        self.forward.multiply(x, residual, |row, value, _| {
            let target = self.target[row];
            let w = self.weights.at(target);
            let r: Rgb = std::array::from_fn(|c| value[c] - target[c]);
            let weighted: Rgb = std::array::from_fn(|c| w[c] * r[c]);
            (weighted, std::array::from_fn(|c| f64::from(weighted[c] * r[c])))
        })
    }

    /// Moves `x` along `step`, clamped to \[0, 1\], halving the step of a channel until its objective
    /// is no larger than before, and `residual` becomes the new one's; whether there was such a step (if not, `x` stays and `residual` has no
    /// meaning).
    fn projected_search(
        &self,
        x: &mut Vec<Rgb>,
        step: &[Rgb],
        objective: &mut [f64; 3],
        residual: &mut [Rgb],
        trial: &mut Vec<Rgb>,
    ) -> bool {
        let mut length = [1.0f32; 3];
        for halving in 0..12 {
            let start = &*x;
            trial.par_iter_mut().enumerate().with_min_len(BAND).for_each(|(i, value)| {
                for c in 0..3 {
                    value[c] = (start[i][c] + length[c] * step[i][c]).clamp(0.0, 1.0);
                }
            });
            let reached = self.residual(trial, residual);
            let mut done = true;
            for c in 0..3 {
                if reached[c] > objective[c] {
                    done = false;
                    // A channel that no step improves stays as it is.
                    length[c] = if halving < 9 { 0.5 * length[c] } else { 0.0 };
                }
            }
            if done {
                std::mem::swap(x, trial);
                *objective = reached;
                return true;
            }
        }
        false
    }
}
