//! What the photographs say of a guess: where each point's light comes from, how far that is from where it was seen to come from, and how
//! that goes with each free number.

use crate::camera::{pixel_ray, ray_along};
use crate::correspondences::Correspondence;
use crate::freedom::{Body, Free, Freedom};
use crate::state::{Lifted, State, plain};
use midair::geometry::{Dual, Real as _};
use midair::transport::{Path, Setup, SetupError};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Derivatives that are computed in one pass: a camera's six, and ten more.
const AT_ONCE: usize = 16;

/// Derivatives of points that tell of their camera's place only.
const OF_A_CAMERA: usize = 6;

/// Points that are one task.
const TASK: usize = 256;

/// What one photograph's points say, and whether the object was there.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Which view.
    pub view: usize,
    /// Whether the elements were in place.
    pub with_object: bool,
    /// Its points.
    pub points: Vec<Correspondence>,
}

/// What the fit goes by: the photographs, the numbers that are free, and which elements move as one.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Elements that move as one.
    pub bodies: Vec<Body>,
    /// What may change.
    pub free: Vec<Free>,
    /// The photographs.
    pub shots: Vec<Shot>,
}

/// What a search found for a guess: the set-up, and for each point of each shot its path; `None` where its light does not come from the display.
#[derive(Clone, Debug)]
pub struct Paths {
    with_object: Setup,
    empty: Setup,
    /// By shot, by point.
    pub of: Vec<Vec<Option<Path>>>,
}

/// What is known of each point: how much it counts, 0 for one that does not.
pub type Weights = Vec<Vec<f64>>;

/// A shot with all that is known of it: the set-up, its points' paths and weights, and the free numbers that it tells something of.
#[derive(Clone, Copy)]
struct Told<'a> {
    state: &'a State,
    setup: &'a Setup,
    shot: &'a Shot,
    paths: &'a [Option<Path>],
    weights: &'a [f64],
    named: &'a [usize],
}

/// The equations of a step.
#[derive(Clone, Debug)]
pub struct Equations {
    /// The weighted squares' second derivatives, by Gauss and Newton.
    pub curvature: DMatrix<f64>,
    /// The weighted squares' derivative, halved.
    pub slope: DVector<f64>,
    /// The weighted squares.
    pub cost: f64,
}

impl Equations {
    fn zero(count: usize) -> Self {
        Self { curvature: DMatrix::zeros(count, count), slope: DVector::zeros(count), cost: 0.0 }
    }

    fn plus(mut self, other: Self) -> Self {
        self.curvature += other.curvature;
        self.slope += other.slope;
        self.cost += other.cost;
        self
    }
}

/// The same set-up with nothing between viewer and plate; the display stays where it is.
pub fn without_elements(setup: &Setup) -> Setup {
    let mut empty = setup.clone();
    empty.elements.clear();
    empty
}

/// A step must not gain by leading paths to where they cease to exist: such a point costs as much as one that is this many standard deviations off.
const LOST: f64 = 100.0;

impl Problem {
    /// The two set-ups of a guess: with the elements, and without.
    fn setups(state: &State) -> Result<(Setup, Setup), SetupError> {
        let setup = state.setup()?;
        let empty = without_elements(&setup);
        Ok((setup, empty))
    }

    /// Follows each point's light from the camera: a search.
    ///
    /// # Errors
    /// Where the guess cannot be traced.
    pub fn search(&self, state: &State) -> Result<Paths, SetupError> {
        let (with_object, empty) = Self::setups(state)?;
        let of = self
            .shots
            .iter()
            .map(|shot| {
                let setup = if shot.with_object { &with_object } else { &empty };
                let camera = plain(state, setup, shot.view);
                let found = |point: &Correspondence| {
                    let ray = pixel_ray(&camera.camera, &camera.lens, point.pixel);
                    if !ray.direction.is_finite() {
                        return None;
                    }
                    let mut path = Path::new();
                    setup.trace(ray, &mut path).st().map(|_| path)
                };
                shot.points.par_iter().with_min_len(64).map(found).collect()
            })
            .collect();
        Ok(Paths { with_object, empty, of })
    }

    /// Known paths on the set-up of another guess.
    ///
    /// # Errors
    /// Where the guess cannot be traced.
    pub fn on(&self, state: &State, paths: &Paths) -> Result<Paths, SetupError> {
        let (with_object, empty) = Self::setups(state)?;
        Ok(Paths { with_object, empty, of: paths.of.clone() })
    }

    /// How far each point's light is from where it was seen to come from, in display pixels; NaN where it has no path.
    ///
    /// # Errors
    /// Where the guess cannot be traced.
    pub fn residuals(
        &self,
        state: &State,
        paths: &Paths,
    ) -> Result<Vec<Vec<[f64; 2]>>, SetupError> {
        let (with_object, empty) = Self::setups(state)?;
        let resolution = with_object.resolution.map(|r| r as f64);
        Ok(self
            .shots
            .iter()
            .zip(&paths.of)
            .map(|(shot, paths)| {
                let setup = if shot.with_object { &with_object } else { &empty };
                let parts = plain(state, setup, shot.view);
                let off = |(point, path): (&Correspondence, &Option<Path>)| {
                    let Some(path) = path else { return [f64::NAN; 2] };
                    let ray = pixel_ray(&parts.camera, &parts.lens, point.pixel);
                    let st = setup.follow_moved(ray, &mut path.clone(), &parts.parts);
                    [0, 1].map(|c| (st[c] - point.st[c]) * resolution[c])
                };
                shot.points.par_iter().with_min_len(64).zip(paths).map(off).collect()
            })
            .collect())
    }

    /// The weighted squares of a guess, its priors among them.
    ///
    /// # Errors
    /// Where the guess cannot be traced.
    pub fn cost(&self, state: &State, paths: &Paths, weights: &Weights) -> Result<f64, SetupError> {
        let residuals = self.residuals(state, paths)?;
        let mut cost = self.prior_cost(state);
        for ((shot, residuals), weights) in self.shots.iter().zip(&residuals).zip(weights) {
            for ((point, [x, y]), weight) in shot.points.iter().zip(residuals).zip(weights) {
                if *weight > 0.0 {
                    let squares = (x * x + y * y) / point.sigma.powi(2);
                    cost += weight * if squares.is_nan() { LOST * LOST } else { squares };
                }
            }
        }
        Ok(cost)
    }

    fn prior_cost(&self, state: &State) -> f64 {
        let squares = self.free.iter().zip(state.offset.iter());
        squares.map(|(free, off)| free.prior.map_or(0.0, |prior| (off / prior).powi(2))).sum()
    }

    /// The equations of a step from a guess along known paths.
    pub fn equations(&self, state: &State, paths: &Paths, weights: &Weights) -> Equations {
        let mut all = self.data_equations(state, paths, weights);
        all.cost += self.prior_cost(state);
        for (i, free) in self.free.iter().enumerate() {
            if let Some(prior) = free.prior {
                all.curvature[(i, i)] += prior.powi(-2);
                all.slope[i] += state.offset[i] * prior.powi(-2);
            }
        }
        all
    }

    /// As [`equations`](Self::equations), without what was known before.
    pub fn data_equations(&self, state: &State, paths: &Paths, weights: &Weights) -> Equations {
        let mut all = Equations::zero(self.free.len());
        for ((shot, paths_of), weights) in self.shots.iter().zip(&paths.of).zip(weights) {
            let setup = if shot.with_object { &paths.with_object } else { &paths.empty };
            let named = self.concerning(shot);
            let told = Told { state, setup, shot, paths: paths_of, weights, named: &named };
            // Derivatives that nobody asks for take as long as the others.
            let sum = match named.len() {
                0..=OF_A_CAMERA => self.of_shot::<OF_A_CAMERA>(&told),
                _ => self.of_shot::<AT_ONCE>(&told),
            };
            all.cost += sum.cost;
            for (j, &a) in named.iter().enumerate() {
                all.slope[a] += sum.slope[j];
                for (k, &b) in named.iter().enumerate() {
                    all.curvature[(a, b)] += sum.curvature[(j.min(k), j.max(k))];
                }
            }
        }
        all
    }

    /// The equations of one shot's points, by `N` derivatives in a pass.
    fn of_shot<const N: usize>(&self, told: &Told<'_>) -> Equations {
        let Told { state, setup, shot, named, .. } = *told;
        let chunks: Vec<Lifted<Dual<N>>> = named
            .chunks(N)
            .map(|named| state.lifted(setup, shot.view, &self.free, &self.bodies, named))
            .collect();
        let lens_is_free = named.iter().any(|&i| matches!(self.free[i].what, Freedom::Lens { .. }));
        let resolution = setup.resolution.map(|r| r as f64);
        let of_task = |first: usize| {
            let mut sum = Equations::zero(named.len());
            let mut rows = vec![[0.0; 2]; named.len()];
            for i in first..(first + TASK).min(shot.points.len()) {
                let (Some(path), weight) = (&told.paths[i], told.weights[i]) else { continue };
                if weight == 0.0 {
                    continue;
                }
                let point = &shot.points[i];
                let mut off = [f64::NAN; 2];
                let mut path = path.clone();
                let direction = (!lens_is_free).then(|| state.lens.direction(point.pixel));
                for (part, lifted) in chunks.iter().enumerate() {
                    let ray = match direction {
                        Some(known) => ray_along(&lifted.camera, known.map(Dual::constant)),
                        None => pixel_ray(&lifted.camera, &lifted.lens, point.pixel),
                    };
                    let st = setup.follow_moved(ray, &mut path, &lifted.parts);
                    for c in 0..2 {
                        let scale = resolution[c] / point.sigma;
                        off[c] = (st[c].re - point.st[c]) * scale;
                        for (k, row) in rows[part * N..].iter_mut().take(N).enumerate() {
                            row[c] = st[c].d[k] * scale;
                        }
                    }
                }
                let is_finite = off.iter().chain(rows.as_flattened()).all(|x| x.is_finite());
                if !is_finite {
                    sum.cost += weight * LOST * LOST;
                    continue;
                }
                sum.cost += weight * (off[0] * off[0] + off[1] * off[1]);
                for (j, a) in rows.iter().enumerate() {
                    sum.slope[j] += weight * (a[0] * off[0] + a[1] * off[1]);
                    for (k, b) in rows[..=j].iter().enumerate() {
                        sum.curvature[(k, j)] += weight * (a[0] * b[0] + a[1] * b[1]);
                    }
                }
            }
            sum
        };
        let firsts: Vec<usize> = (0..shot.points.len()).step_by(TASK).collect();
        // Tasks' sums are joined in their order: the same photographs give the same scene to the last digit.
        let sums: Vec<Equations> = firsts.into_par_iter().map(of_task).collect();
        sums.into_iter().fold(Equations::zero(named.len()), Equations::plus)
    }

    /// The free numbers that a shot tells something of.
    fn concerning(&self, shot: &Shot) -> Vec<usize> {
        let concerns = |free: &Free| match free.what {
            Freedom::CameraShift { view, .. } | Freedom::CameraTurn { view, .. } => {
                view == shot.view
            }
            Freedom::Lens { .. } | Freedom::PlateShift { .. } | Freedom::PlateTurn { .. } => true,
            Freedom::Shift { .. }
            | Freedom::Turn { .. }
            | Freedom::Ior { .. }
            | Freedom::Size { .. } => shot.with_object,
        };
        (0..self.free.len()).filter(|&i| concerns(&self.free[i])).collect()
    }
}
