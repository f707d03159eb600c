//! From a guess to the best guess: Levenberg and Marquardt's steps along fixed paths, with paths searched anew between.

use crate::equations::{Equations, Paths, Problem, Weights};
use crate::plane::median;
use crate::state::State;
use midair::transport::SetupError;
use nalgebra::{DMatrix, DVector};

/// What a descent ended in.
#[derive(Clone, Debug)]
pub struct Descent {
    /// The guess.
    pub state: State,
    /// Its points' paths.
    pub paths: Paths,
    /// How much each point counts there.
    pub weights: Weights,
    /// How much larger the points' scatter is than they were said to be, by shot: 1 or more.
    pub scale: Vec<f64>,
    /// How badly the points fit, wrong ones counted up to a bound: comparable between descents.
    pub score: f64,
    /// Whether further steps change nothing.
    pub converged: bool,
    /// Searches that it took.
    pub rounds: usize,
}

/// Scale of Cauchy's loss, in standard deviations: 95 % efficient where all errors are normal (Holland and Welsch 1977).
const CAUCHY: f64 = 2.385;

/// Weighted squares below which a step gains nothing: it changes no number by more than a thirtieth of its standard deviation.
const LEAST_GAIN: f64 = 1e-3;

/// The most searches. A descent that needs more goes to and fro between paths.
const MOST_ROUNDS: usize = 40;

impl Problem {
    /// Goes down from a guess until steps change nothing, wrong points counting little (Cauchy's loss, its scale the median's).
    ///
    /// # Errors
    /// Where a guess cannot be traced.
    pub fn descend(&self, start: &State, stop: &dyn Fn() -> bool) -> Result<Descent, SetupError> {
        let mut state = start.clone();
        let mut rounds = 0;
        let mut converged = false;
        loop {
            let paths = self.search(&state)?;
            let residuals = self.residuals(&state, &paths)?;
            let scale = self.scales(&residuals);
            let weights = self.robust_weights(&residuals, &scale);
            let score = self.score(&state, &residuals);
            if converged || rounds >= MOST_ROUNDS || stop() {
                return Ok(Descent { state, paths, weights, scale, score, converged, rounds });
            }
            rounds += 1;
            let (next, moved) = self.descend_along(&state, &paths, &weights)?;
            // A twentieth of what the points can tell: below it the next search finds the same.
            converged = moved < 0.05;
            state = next;
        }
    }

    /// As [`descend`](Self::descend) from where it ended, with the points that do not fit left out and the others at their full weight: what
    /// standard deviations are computed of.
    ///
    /// # Errors
    /// Where a guess cannot be traced.
    pub fn settle(&self, mut from: Descent) -> Result<Descent, SetupError> {
        for _ in 0..10 {
            let residuals = self.residuals(&from.state, &from.paths)?;
            from.scale = self.scales(&residuals);
            from.weights = self.kept(&residuals, &from.scale);
            let (state, moved) = self.descend_along(&from.state, &from.paths, &from.weights)?;
            from.paths = self.search(&state)?;
            from.state = state;
            from.rounds += 1;
            from.converged = moved < 0.05;
            if from.converged {
                break;
            }
        }
        let residuals = self.residuals(&from.state, &from.paths)?;
        from.scale = self.scales(&residuals);
        from.weights = self.kept(&residuals, &from.scale);
        from.score = self.score(&from.state, &residuals);
        Ok(from)
    }

    /// Steps along fixed paths with fixed weights; how far it went, in standard deviations along its direction.
    fn descend_along(
        &self,
        start: &State,
        paths: &Paths,
        weights: &Weights,
    ) -> Result<(State, f64), SetupError> {
        let count = self.free.len();
        let mut state = start.clone();
        let mut went = DVector::zeros(count);
        let mut lambda = 1e-4;
        let mut equations = self.equations(&state, paths, weights);
        let first = equations.curvature.clone();
        for _ in 0..6 {
            let mut better = None;
            while better.is_none() && lambda < 1e9 {
                if let Some(step) = damped(&equations, lambda) {
                    let trial = state.stepped(&self.free, &self.bodies, &step);
                    let cost = self.cost(&trial, paths, weights)?;
                    if cost <= equations.cost {
                        better = Some((trial, step, equations.cost - cost));
                        lambda = (lambda * 0.2).max(1e-12);
                        continue;
                    }
                }
                lambda *= 8.0;
            }
            let Some((trial, step, gain)) = better else { break };
            let small = gain < LEAST_GAIN;
            went += step;
            state = trial;
            if small {
                break;
            }
            equations = self.equations_after(&state, paths, weights)?;
        }
        // In the points' own measure: a number that they hardly tell may go far at no cost.
        let farthest = went.dot(&(first * &went)).max(0.0).sqrt();
        Ok((state, farthest))
    }

    /// The equations at a guess that was stepped to along known paths: its own set-up, the paths' steps.
    fn equations_after(
        &self,
        state: &State,
        paths: &Paths,
        weights: &Weights,
    ) -> Result<Equations, SetupError> {
        Ok(self.equations(state, &self.on(state, paths)?, weights))
    }

    /// How much larger each shot's scatter is than its points were said to be, by the median: 1 or more.
    fn scales(&self, residuals: &[Vec<[f64; 2]>]) -> Vec<f64> {
        let scales = self.shots.iter().zip(residuals).map(|(shot, residuals)| {
            let off: Vec<f64> = shot
                .points
                .iter()
                .zip(residuals)
                .map(|(point, [x, y])| x.hypot(*y) / point.sigma)
                .filter(|off| off.is_finite())
                .collect();
            // The median distance of points with unit scatter along both axes is sqrt(2 ln 2).
            (median(&off) / 1.1774).max(1.0)
        });
        scales.collect()
    }

    fn weigh(
        &self,
        residuals: &[Vec<[f64; 2]>],
        scale: &[f64],
        weight: impl Fn(f64) -> f64,
    ) -> Weights {
        let shots = self.shots.iter().zip(residuals).zip(scale);
        shots
            .map(|((shot, residuals), scale)| {
                let points = shot.points.iter().zip(residuals);
                points
                    .map(|(point, [x, y])| {
                        let off = x.hypot(*y) / (point.sigma * scale);
                        if off.is_finite() { weight(off) / (scale * scale) } else { 0.0 }
                    })
                    .collect()
            })
            .collect()
    }

    /// Cauchy's weights.
    fn robust_weights(&self, residuals: &[Vec<[f64; 2]>], scale: &[f64]) -> Weights {
        self.weigh(residuals, scale, |off| 1.0 / (1.0 + (off / CAUCHY).powi(2)))
    }

    /// Full weight for points within five standard deviations: of a million that are right one in four is lost.
    fn kept(&self, residuals: &[Vec<[f64; 2]>], scale: &[f64]) -> Weights {
        self.weigh(residuals, scale, |off| f64::from(u8::from(off <= 5.0)))
    }

    /// How badly the points fit: squares in units of half a display pixel or the point's own deviation, whichever is more, each point's share bounded, a lost point
    /// at the bound.
    fn score(&self, state: &State, residuals: &[Vec<[f64; 2]>]) -> f64 {
        let bound: f64 = 16.0;
        let mut score = 0.0;
        for (shot, residuals) in self.shots.iter().zip(residuals) {
            for (point, [x, y]) in shot.points.iter().zip(residuals) {
                let off = (x * x + y * y) / point.sigma.max(0.5).powi(2);
                score += if off.is_nan() { bound } else { off.min(bound) };
            }
        }
        let priors = self.free.iter().zip(state.offset.iter());
        score + priors.filter_map(|(f, off)| Some((off / f.prior?).powi(2))).sum::<f64>()
    }
}

/// The step of damped equations; `None` where they have no solution.
fn damped(equations: &Equations, lambda: f64) -> Option<DVector<f64>> {
    let (scaled, root) = unit_diagonal(&equations.curvature);
    let count = scaled.nrows();
    let damped = scaled + DMatrix::identity(count, count) * lambda;
    let slope = DVector::from_fn(count, |i, _| equations.slope[i] / root[i]);
    let step = -damped.cholesky()?.solve(&slope);
    let step = DVector::from_fn(count, |i, _| step[i] / root[i]);
    step.iter().all(|s| s.is_finite()).then_some(step)
}

/// A symmetric matrix scaled to a diagonal of ones, and the roots that it was divided by: numbers of different units lose no digits.
fn unit_diagonal(matrix: &DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
    let root: Vec<f64> = (0..matrix.nrows())
        .map(|i| matrix[(i, i)].sqrt())
        // What nothing depends on stays where it is.
        .map(|root| if root > 0.0 { root } else { 1.0 })
        .collect();
    (
        DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| {
            matrix[(i, j)] / (root[i] * root[j])
        }),
        root,
    )
}

/// The inverse of a curvature: the covariance. `None` where something is not told at all.
pub fn covariance(curvature: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (scaled, root) = unit_diagonal(curvature);
    let inverse = scaled.cholesky()?.inverse();
    let covariance = DMatrix::from_fn(inverse.nrows(), inverse.ncols(), |i, j| {
        inverse[(i, j)] / (root[i] * root[j])
    });
    covariance.iter().all(|c| c.is_finite()).then_some(covariance)
}
