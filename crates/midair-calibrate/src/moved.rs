//! Whether a camera stood elsewhere for its object photographs than for its empty ones: what the fit would gain if it had.

use crate::cameras;
use crate::equations::{Equations, Problem};
use crate::finding::View;
use crate::solve::{Descent, covariance};
use crate::state::State;
use midair::Error;
use nalgebra::{DMatrix, DVector};

/// Weighted squares below which a gain is chance: 6 are expected where nothing is wrong, and 60 are not met once in 10 billion views.
const CHANCE: f64 = 60.0;

/// The share of what a view's object photographs leave from which on it is told that a camera of their own would take it off. Where nothing is wrong it was
/// at most 0.02 on benches with 400 points a view.
const TOLD: f64 = 0.2;

/// The share from which on it is tried whether all views fit with such a camera.
const TRIED: f64 = 0.9;

/// How much larger than it was said to be the points' scatter may be in views that fit.
const FITS: f64 = 2.0;

/// How far a camera that was touched is, as a share of its distance from the image: far cameras' places are told to a hundredth or so.
const NEAR: f64 = 0.03;

/// The numbers of a camera's place.
const OF_A_CAMERA: usize = 6;

/// For each view the share of its object photographs' squares that a camera of their own would take off, by one step of the equations at the best guess; 0 where
/// it is chance.
///
/// `residuals` are those at that guess.
pub(crate) fn shares(problem: &Problem, found: &Descent, residuals: &[Vec<[f64; 2]>]) -> Vec<f64> {
    let views = found.state.cameras.len();
    // Every camera twice: once for the empty photographs, once for those with the object.
    let mut twice = problem.clone();
    twice.free.extend(cameras::freedoms(2 * views, true).split_off(views * OF_A_CAMERA));
    twice.shots.iter_mut().filter(|shot| shot.with_object).for_each(|shot| shot.view += views);
    let mut state = found.state.clone();
    state.cameras.extend_from_within(..);
    let apart = twice.equations(&state, &found.paths, &found.weights);
    let count = problem.free.len();
    (0..views)
        .map(|tested| {
            // Only this view's two are apart: the others' second numbers are the first ones again, which come before all others, in the same order.
            let to = |i: usize| match i.checked_sub(count) {
                None => i,
                Some(second) if second / OF_A_CAMERA == tested => count + second % OF_A_CAMERA,
                Some(second) => second,
            };
            let gain = gain(&joined(&apart, count + OF_A_CAMERA, to), count);
            let left = left(problem, found, residuals, tested);
            if gain > CHANCE && left > 0.0 { (gain / left).min(1.0) } else { 0.0 }
        })
        .collect()
}

/// Equations in which some numbers are one: `to` says which.
fn joined(equations: &Equations, count: usize, to: impl Fn(usize) -> usize) -> Equations {
    let mut curvature = DMatrix::zeros(count, count);
    let mut slope = DVector::zeros(count);
    for i in 0..equations.slope.len() {
        slope[to(i)] += equations.slope[i];
        for j in 0..equations.slope.len() {
            curvature[(to(i), to(j))] += equations.curvature[(i, j)];
        }
    }
    Equations { curvature, slope, cost: equations.cost }
}

/// How much less the weighted squares are after a step of all numbers than after one of the first `count`; 0 where some are not told at all.
fn gain(equations: &Equations, count: usize) -> f64 {
    let by = |count: usize| -> Option<f64> {
        let curvature = equations.curvature.view((0, 0), (count, count)).into_owned();
        let slope = equations.slope.rows(0, count).into_owned();
        Some(slope.dot(&(covariance(&curvature)? * &slope)))
    };
    match (by(equations.slope.len()), by(count)) {
        (Some(all), Some(first)) => (all - first).max(0.0),
        _ => 0.0,
    }
}

/// The weighted squares of a view's object photographs.
fn left(problem: &Problem, found: &Descent, residuals: &[Vec<[f64; 2]>], view: usize) -> f64 {
    let mut sum = 0.0;
    for (shot, of) in problem.shots.iter().enumerate() {
        if of.view == view && of.with_object {
            let points = of.points.iter().zip(&residuals[shot]).zip(&found.weights[shot]);
            let squares = points
                .map(|((point, [x, y]), weight)| weight * (x * x + y * y) / point.sigma.powi(2));
            sum += squares.filter(|square| square.is_finite()).sum::<f64>();
        }
    }
    sum
}

/// What is told of a view whose object photographs want a camera of their own.
pub(crate) fn in_words(view: &View) -> Option<String> {
    (view.apart > TOLD).then(|| {
        format!(
            "view `{}`: {:.0} % of what its object photographs leave would go if the camera had stood elsewhere for them than for the empty ones: something was touched in between, or the object's sizes (--free) or the display's width and height are not the scene's",
            view.name,
            100.0 * view.apart
        )
    })
}

/// Refuses a finding with a view whose object photographs were taken from elsewhere: with a camera of their own all views fit. Where they do not, it is
/// something else that is wrong: an object of another kind also leaves what a camera's place could make good in part.
///
/// # Errors
/// Such a view; and where the guess cannot be traced.
pub(crate) fn refuse(
    problem: &Problem,
    found: &State,
    views: &[View],
    stop: &dyn Fn() -> bool,
) -> Result<(), Error> {
    let mut best: Option<(f64, &View)> = None;
    for (tested, view) in views.iter().enumerate().filter(|(_, view)| view.apart > TRIED) {
        let apart = with_own_camera(problem, found, tested, stop)?;
        let fits = apart.converged && apart.scale.iter().all(|scale| *scale <= FITS);
        let cameras = [tested, views.len()].map(|view| apart.state.cameras[view].origin);
        let distance = cameras[0] - apart.state.setup()?.image.frame.origin;
        let near = (cameras[0] - cameras[1]).length() < NEAR * distance.length();
        if fits && near && best.is_none_or(|(score, _)| apart.score < score) {
            best = Some((apart.score, view));
        }
    }
    match best {
        None => Ok(()),
        Some((_, view)) => Err(Error::request(
            format!(
                "view `{}`: the camera stood elsewhere for its object photographs than for its empty ones: from one place they leave {:.1} display pixels rms, from two all views fit",
                view.name, view.rms
            ),
            "photograph both sets of this view again, and touch neither camera, display nor plate between them; or leave the view out",
        )),
    }
}

/// The best guess if one view's object photographs have a camera of their own, which comes after the others.
fn with_own_camera(
    problem: &Problem,
    found: &State,
    tested: usize,
    stop: &dyn Fn() -> bool,
) -> Result<Descent, Error> {
    let own = found.cameras.len();
    let mut problem = problem.clone();
    problem.free.extend(cameras::freedoms(own + 1, true).split_off(own * OF_A_CAMERA));
    let with_object = problem.shots.iter_mut().filter(|shot| shot.with_object);
    with_object.filter(|shot| shot.view == tested).for_each(|shot| shot.view = own);
    let mut start = found.clone();
    start.cameras.push(start.cameras[tested]);
    start.offset = start.offset.resize_vertically(problem.free.len(), 0.0);
    Ok(problem.descend(&start, stop)?)
}
