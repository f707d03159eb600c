//! What a fit found: each number with its standard deviation, what is left, and what the photographs could not tell.

use crate::advice::{Advice, advice};
use crate::camera::Lens;
use crate::cameras::ViewPoints;
use crate::equations::Problem;
use crate::moved;
use crate::parameters::{Parameter, parameters, row_name, upright};
use crate::solve::{Descent, covariance};
use crate::state::State;
use midair::geometry::Frame;
use midair::scene::Loaded;
use midair::transport::SetupError;
use nalgebra::DMatrix;
use serde::Serialize;

/// Root mean squares of how far points are from where they were seen to come from, display pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Residual {
    /// With the fitted scene.
    pub rms: f64,
    /// With the scene as it was assumed.
    pub before: f64,
}

/// What became of a photograph's points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Used {
    /// They agree with the fitted scene.
    pub used: usize,
    /// They do not.
    pub rejected: usize,
    /// By the fitted scene their light does not come from the display.
    pub lost: usize,
}

/// What was found of a view.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct View {
    /// Its name.
    pub name: String,
    /// Where the camera stood, mm.
    pub position: [f64; 3],
    /// How it was turned, degrees: +x right, +y up, it looks along its -z.
    pub rotation: [f64; 3],
    /// The points without the object.
    pub empty: Used,
    /// The points with it.
    pub object: Used,
    /// Root mean square of the points with the object, display pixels.
    pub rms: f64,
    /// The share of their squares that would go if the camera had stood elsewhere for them than for the empty photographs; 0 where that is chance.
    pub apart: f64,
}

/// How the several starts ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Starts {
    /// How many there were.
    pub tried: usize,
    /// How many ended where the best one did.
    pub agree: usize,
}

/// What a fit found.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// All that was fitted.
    pub parameters: Vec<Parameter>,
    /// What is left.
    #[serde(rename = "residual_px")]
    pub residual: Residual,
    /// The views.
    pub views: Vec<View>,
    /// The lens.
    pub camera: Lens,
    /// The starts.
    pub starts: Starts,
    /// What the photographs do not tell, in words, and what would.
    pub undetermined: Vec<String>,
    /// A further photograph that would tell more.
    pub advice: Option<Advice>,
    /// What else should be known.
    pub notes: Vec<String>,
    /// Rounds of the fit.
    pub rounds: usize,
    /// Whether further rounds change nothing.
    pub converged: bool,
    /// The covariance of the free numbers, in the fit's own order: shifts in mm along the world's axes, turns in degrees about a part's own.
    #[serde(skip)]
    pub covariance: DMatrix<f64>,
    /// What the rows of the covariance are of.
    #[serde(skip)]
    pub names: Vec<String>,
    /// The fitted scene with its files.
    #[serde(skip)]
    pub loaded: Loaded,
    /// The cameras: their axes are right, down and ahead.
    #[serde(skip)]
    pub cameras: Vec<Frame>,
}

impl Finding {
    /// `None` where the photographs do not tell something of which nothing was known before.
    pub(crate) fn new(
        problem: &Problem,
        start: &State,
        found: Descent,
        trials: &[Descent],
        views: &[ViewPoints],
    ) -> Result<Option<Self>, SetupError> {
        let curvature = problem.equations(&found.state, &found.paths, &found.weights).curvature;
        let Some(covariance) = covariance(&curvature) else { return Ok(None) };
        let parameters = parameters(problem, start, &found.state, &covariance, views);
        let residuals = problem.residuals(&found.state, &found.paths)?;
        let before = problem.residuals(start, &problem.search(start)?)?;
        let of_objects = |residuals: &[Vec<[f64; 2]>], counted: &dyn Fn(usize, usize) -> bool| {
            let mut squares = Vec::new();
            for (shot, of) in problem.shots.iter().enumerate() {
                if of.with_object {
                    let points = residuals[shot].iter().enumerate();
                    let kept = points
                        .filter(|(i, [x, y])| x.is_finite() && y.is_finite() && counted(shot, *i));
                    squares.extend(kept.map(|(_, [x, y])| x * x + y * y));
                }
            }
            root_of_mean(&squares)
        };
        let residual = Residual {
            rms: of_objects(&residuals, &|shot, i| found.weights[shot][i] > 0.0),
            before: of_objects(&before, &|_, _| true),
        };
        let used = |view: usize, with_object: bool| {
            let (mut used, mut squares) = (Used::default(), Vec::new());
            for (shot, of) in problem.shots.iter().enumerate() {
                if of.view != view || of.with_object != with_object {
                    continue;
                }
                for ([x, y], weight) in residuals[shot].iter().zip(&found.weights[shot]) {
                    match (x.is_finite() && y.is_finite(), *weight > 0.0) {
                        (false, _) => used.lost += 1,
                        (true, false) => used.rejected += 1,
                        (true, true) => {
                            used.used += 1;
                            squares.push(x * x + y * y);
                        }
                    }
                }
            }
            (used, root_of_mean(&squares))
        };
        let apart = moved::shares(problem, &found, &residuals);
        let told_views: Vec<View> = views
            .iter()
            .enumerate()
            .map(|(view, points)| {
                let upright = upright(&found.state.cameras[view]);
                let (object, rms) = used(view, true);
                View {
                    name: points.name.clone(),
                    position: upright.origin.to_array(),
                    rotation: upright.rotation(),
                    empty: used(view, false).0,
                    object,
                    rms,
                    apart: apart[view],
                }
            })
            .collect();
        let (starts, mut notes) = starts(trials);
        notes.extend(told_views.iter().filter_map(edges));
        notes.extend(told_views.iter().filter_map(moved::in_words));
        let advice = advice(problem, &found, &curvature, &covariance)?;
        let undetermined =
            parameters.iter().filter(|parameter| !parameter.determined).map(in_words).collect();
        Ok(Some(Self {
            parameters,
            residual,
            views: told_views,
            camera: found.state.lens,
            starts,
            undetermined,
            advice,
            notes,
            rounds: found.rounds,
            converged: found.converged,
            covariance,
            names: problem
                .free
                .iter()
                .map(|free| row_name(free.what, problem, &found.state, views))
                .collect(),
            loaded: found.state.loaded,
            cameras: found.state.cameras,
        }))
    }

    /// The parameter of this name.
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }
}

/// The share of a view's points above which it is told that the scene forms nothing where they are seen.
const MANY_LOST: f64 = 0.02;

/// What is told of points that are seen where the fitted scene forms nothing.
fn edges(view: &View) -> Option<String> {
    let Used { used, rejected, lost } = view.object;
    let share = lost as f64 / (used + rejected + lost).max(1) as f64;
    (share > MANY_LOST).then(|| {
        format!(
            "view `{}`: {:.0} % of its points are seen where the fitted scene forms no image: the object's edges stand elsewhere, by some of what is not determined",
            view.name,
            100.0 * share
        )
    })
}

/// Root mean square of some squares; 0 of none.
fn root_of_mean(squares: &[f64]) -> f64 {
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// What is told of a parameter that the photographs do not tell.
fn in_words(parameter: &Parameter) -> String {
    let Parameter { name, sigma, .. } = parameter;
    let (what, unit, else_by) = if name.contains(".rotation.") {
        ("its turn", "degrees", "a view from further round the object")
    } else if name.ends_with(".ior") {
        ("its index", "", "a view at a slant through it, or its size measured with a caliper")
    } else if name.contains(".shape.") {
        ("its size", "mm", "a caliper")
    } else {
        ("its place along this axis", "mm", "a view from further aside or above")
    };
    format!(
        "{name}: {what} is not told by these photographs (one standard deviation {sigma:.3} {unit}): it matters little for these viewpoints; {else_by} would tell it"
    )
    .replace(" )", ")")
}

/// Whether the starts agree.
fn starts(trials: &[Descent]) -> (Starts, Vec<String>) {
    let points = |descent: &Descent| descent.weights.iter().map(Vec::len).sum::<usize>() as f64;
    let best = trials.first().map_or(0.0, |best| best.score);
    // A score within a twentieth of a unit for each point fits as well.
    let agrees = |descent: &&Descent| descent.score <= best + 0.05 * points(descent);
    let starts = Starts { tried: trials.len(), agree: trials.iter().filter(agrees).count() };
    let mut notes = Vec::new();
    if starts.agree < starts.tried {
        notes.push(format!(
            "{} of {} starts ended elsewhere and fit worse; the best was kept",
            starts.tried - starts.agree,
            starts.tried
        ));
    }
    (starts, notes)
}
