//! The scene as it really is: a fit of cameras and elements at once to all that was photographed, from several starts.

use crate::bench::Uncertainty;
use crate::camera::Lens;
use crate::cameras::{self, ViewPoints};
use crate::equations::{Problem, Shot};
use crate::finding::Finding;
use crate::freedom::{Free, bodies, freedoms};
use crate::moved;
use crate::solve::Descent;
use crate::state::State;
use midair::geometry::Frame;
use midair::scene::Loaded;
use midair::transport::{Setup, SetupError};
use midair::{Error, Monitor};
use nalgebra::DVector;
use rayon::prelude::*;

/// How a fit is done.
#[derive(Clone, Debug)]
pub struct Options {
    /// How sure one is of the scene.
    pub uncertainty: Uncertainty,
    /// The lens, if it is known.
    pub lens: Option<Lens>,
    /// Elements that move as one, by name.
    pub together: Vec<Vec<String>>,
    /// Names of what is to be fitted besides the usual.
    pub free: Vec<String>,
    /// Names of what is to stay.
    pub fix: Vec<String>,
    /// From how many places the fit sets out: the scene as assumed, and others over the uncertainty.
    pub starts: usize,
    /// What the other starts are drawn by.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            uncertainty: Uncertainty::default(),
            lens: None,
            together: Vec::new(),
            free: Vec::new(),
            fix: Vec::new(),
            starts: 8,
            seed: 1,
        }
    }
}

/// Points of a shot that the starts are tried with.
const TRIED: usize = 150;

/// A rms above this many display pixels is no fit.
const NO_FIT: f64 = 25.0;

/// Fits the scene to what was photographed.
///
/// # Errors
/// Views with too few points, empty photographs that are no flat picture, names that mean nothing, a fit that did not converge.
pub fn fit(
    loaded: &Loaded,
    views: &[ViewPoints],
    options: &Options,
    monitor: &dyn Monitor,
) -> Result<Finding, Error> {
    let loaded = &standing_still(loaded);
    monitor.stage("cameras", 1);
    let stop = || monitor.is_cancelled();
    let found = cameras::find(loaded, views, options.lens, &stop)?;
    let bodies = bodies(&loaded.scene, &options.together)?;
    let mut free = cameras::freedoms(views.len(), options.lens.is_some());
    let of_cameras = free.len();
    free.extend(freedoms(
        &loaded.scene,
        &bodies,
        &options.uncertainty,
        &options.free,
        &options.fix,
    )?);
    if free.len() == of_cameras {
        return Err(Error::request(
            "there is nothing to fit: all is fixed",
            "give the scene an element, or name what is to be fitted by --free",
        ));
    }
    let shots = |most: usize| -> Vec<Shot> {
        let shots = views.iter().enumerate().flat_map(|(view, points)| {
            [(false, &points.empty), (true, &points.object)].map(|(with_object, points)| Shot {
                view,
                with_object,
                points: points.iter().step_by(points.len().div_ceil(most)).copied().collect(),
            })
        });
        shots.collect()
    };
    let few = Problem { bodies: bodies.clone(), free: free.clone(), shots: shots(TRIED) };
    let all = Problem { bodies, free, shots: shots(usize::MAX) };
    // The cameras' numbers come first in either list: what the lens is off its prior stays known.
    let offset =
        DVector::from_fn(
            all.free.len(),
            |i, _| {
                if i < of_cameras { found.state.offset[i] } else { 0.0 }
            },
        );
    let start = State { offset, ..found.state };
    let others = cameras::other_places(views, options.lens.is_some(), &start, &stop)?;
    let trials = trials(&few, &sides(&start, &others), of_cameras, options, monitor)?;
    let best = trials.first().ok_or_else(no_start)?;
    monitor.stage("fit", 1);
    let polished = all.descend(&best.state, &stop)?;
    let polished = all.settle(polished)?;
    let state = polished.state.clone();
    let Some(finding) = Finding::new(&all, &start, polished, &trials, views)? else {
        return Err(Error::request(
            "the photographs do not tell all that is to be fitted",
            "fix some of it by --fix, or photograph from a further place",
        ));
    };
    if stop() {
        return Err(Error::request("the fit was interrupted", "run it again"));
    }
    moved::refuse(&few, &state, &finding.views, &stop)?;
    if !finding.converged || finding.residual.rms > NO_FIT {
        return Err(Error::request(
            format!(
                "the fit did not converge: {:.1} display pixels rms are left after {} rounds",
                finding.residual.rms, finding.rounds
            ),
            "check the scene's kind and size of object and its [uncertainty], or free its sizes by --free; photograph from a further place",
        ));
    }
    Ok(finding)
}

fn no_start() -> Error {
    Error::request(
        "no start of the fit can be traced",
        "check the scene with `midair check`: its object may stand in the plate's or the viewer's way",
    )
}

/// The scene with its display's place said: left out it goes by the mirrors and the viewpoint, and the display that was photographed does not.
pub fn standing_still(loaded: &Loaded) -> Loaded {
    let mut loaded = loaded.clone();
    if loaded.scene.display.pose.is_none() {
        let display = loaded.scene.display_rectangle();
        loaded.scene.display.pose = Some(midair::scene::model::Pose {
            position: display.frame.origin.to_array(),
            rotation: display.frame.rotation(),
        });
    }
    loaded
}

/// Of views that may have been taken from either of two places, the most of which all combinations are tried.
const MOST_SIDES: usize = 3;

/// Combinations that all starts are tried with: those that fit best from the scene as it was assumed.
const LIKELIEST: usize = 2;

/// The start with each combination of the places where its cameras may have been.
fn sides(start: &State, others: &[(usize, Frame)]) -> Vec<State> {
    let others = &others[..others.len().min(MOST_SIDES)];
    let combination = |mask: usize| {
        let mut state = start.clone();
        for (bit, (view, camera)) in others.iter().enumerate() {
            if mask >> bit & 1 == 1 {
                state.cameras[*view] = *camera;
            }
        }
        state
    };
    (0..1 << others.len()).map(combination).collect()
}

/// Descents from several starts with some of the points, the best first: those whose cameras set out where the best one's did. Starts that cannot be traced
/// are left out.
fn trials(
    problem: &Problem,
    sides: &[State],
    of_cameras: usize,
    options: &Options,
    monitor: &dyn Monitor,
) -> Result<Vec<Descent>, Error> {
    let mut draw = fastrand::Rng::with_seed(options.seed);
    let steps: Vec<DVector<f64>> =
        (1..options.starts).map(|_| drawn(&problem.free, of_cameras, &mut draw)).collect();
    monitor.stage("starts", sides.len() + LIKELIEST.min(sides.len()) * steps.len());
    let descend = |starts: Vec<(usize, State)>| -> Result<Vec<(usize, Descent)>, SetupError> {
        let starts = starts.into_par_iter().filter(|(_, state)| Setup::new(&state.loaded).is_ok());
        starts
            .map(|(side, state)| {
                let descent = problem.descend(&state, &|| monitor.is_cancelled())?;
                monitor.advance(1);
                Ok((side, descent))
            })
            .collect()
    };
    let by_score =
        |(_, a): &(usize, Descent), (_, b): &(usize, Descent)| a.score.total_cmp(&b.score);
    let mut descents = descend(sides.iter().cloned().enumerate().collect())?;
    descents.sort_by(by_score);
    let likeliest = descents.iter().take(LIKELIEST).map(|(side, _)| *side);
    let further = likeliest.flat_map(|side| {
        let stepped = move |step| sides[side].stepped(&problem.free, &problem.bodies, step);
        steps.iter().map(move |step| (side, stepped(step)))
    });
    descents.extend(descend(further.collect())?);
    descents.sort_by(by_score);
    let best = descents.first().map(|(side, _)| *side);
    Ok(descents.into_iter().filter(|(side, _)| Some(*side) == best).map(|(_, d)| d).collect())
}

/// A step from where things were assumed, drawn by how sure one is of them; cameras stay.
fn drawn(free: &[Free], of_cameras: usize, draw: &mut fastrand::Rng) -> DVector<f64> {
    DVector::from_fn(free.len(), |i, _| {
        // Box and Muller's way to a normal number.
        let radius = (-2.0 * (1.0 - draw.f64()).ln()).sqrt();
        let normal = radius * (std::f64::consts::TAU * draw.f64()).cos();
        match free[i].prior {
            Some(prior) if i >= of_cameras => normal * prior,
            _ => 0.0,
        }
    })
}
