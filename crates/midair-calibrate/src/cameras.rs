//! The cameras, from photographs without the object: the floating picture is flat and of known pitch, so it is its own calibration target.

use crate::camera::Lens;
use crate::correspondences::Correspondence;
use crate::equations::{Problem, Shot};
use crate::freedom::{Free, Freedom};
use crate::plane::{Pair, camera_of, homography, lens_of};
use crate::solve::Descent;
use crate::state::State;
use midair::Error;
use midair::geometry::{Frame, Vec3};
use midair::scene::Loaded;
use midair::transport::Setup;
use nalgebra::{DVector, Matrix3};

/// The fewest points that tell where a camera stands with some to spare.
pub const FEWEST: usize = 12;

/// How far the empty photographs' points may be from a flat picture, display pixels rms: beyond it something moved or is blurred.
const MOST_OFF: f64 = 5.0;

/// The floating picture's plane: its middle, and unit vectors along s and t, of the display mirrored in the plate.
struct Floating {
    origin: Vec3,
    axes: [Vec3; 2],
    size: [f64; 2],
}

impl Floating {
    fn new(setup: &Setup) -> Self {
        let (plate, display) = (&setup.plate.rectangle, &setup.display);
        let [x, y, _] = display.frame.axes;
        Self {
            origin: plate.mirrored(display.frame.origin),
            axes: [plate.mirrored_direction(x), plate.mirrored_direction(y)],
            size: display.size,
        }
    }

    /// Where a camera would be that sees the picture alike but for perspective: its right and down mirrored in the picture's plane.
    fn on_the_other_side(&self, camera: &Frame) -> Frame {
        let normal = self.axes[0].cross(self.axes[1]).normalized();
        let mirrored = |v: Vec3| v - normal * (2.0 * v.dot(normal));
        let [right, down] = [camera.axes[0], camera.axes[1]].map(mirrored);
        let axes = [right, down, right.cross(down)];
        let seen = camera.to_local(self.origin);
        let place = self.origin - axes[0] * seen.x - axes[1] * seen.y - axes[2] * seen.z;
        Frame { origin: place, axes }
    }

    fn pairs(&self, points: &[Correspondence], seen: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<Pair> {
        points
            .iter()
            .map(|point| Pair {
                on_plane: [0, 1].map(|c| (point.st[c] - 0.5) * self.size[c]),
                seen: seen(point.pixel),
            })
            .filter(|pair| pair.seen.iter().all(|c| c.is_finite()))
            .collect()
    }
}

/// A view's points: what was decoded without the object, and with it.
#[derive(Clone, Debug)]
pub struct ViewPoints {
    /// What the view is called.
    pub name: String,
    /// Without the object.
    pub empty: Vec<Correspondence>,
    /// With it.
    pub object: Vec<Correspondence>,
}

/// What the fit knows of each number of a lens before any photograph, where the lens is to be found: nothing of focal length and centre; a lens' distortion
/// is seldom more than this.
const LENS_PRIORS: [Option<f64>; 9] =
    [None, None, None, None, Some(0.5), Some(1.0), Some(0.01), Some(0.01), Some(1.0)];

/// The cameras' free numbers: each view's pose, and the lens' numbers unless it is known.
pub fn freedoms(views: usize, lens_is_known: bool) -> Vec<Free> {
    let mut free = Vec::new();
    for view in 0..views {
        for axis in 0..3 {
            free.push(Free { what: Freedom::CameraShift { view, axis }, prior: None });
            free.push(Free { what: Freedom::CameraTurn { view, axis }, prior: None });
        }
    }
    if !lens_is_known {
        let lens = LENS_PRIORS.iter().enumerate();
        free.extend(lens.map(|(number, &prior)| Free { what: Freedom::Lens { number }, prior }));
    }
    free
}

/// A view's empty photographs, at most so many points of them.
fn empty_shot(view: usize, points: &ViewPoints, most: usize) -> Shot {
    let points = points.empty.iter().step_by(points.empty.len().div_ceil(most)).copied();
    Shot { view, with_object: false, points: points.collect() }
}

/// The cameras as the empty photographs tell them.
///
/// # Errors
/// Views with too few points, or whose points are no flat picture.
pub fn find(
    loaded: &Loaded,
    views: &[ViewPoints],
    known: Option<Lens>,
    stop: &dyn Fn() -> bool,
) -> Result<Descent, Error> {
    let setup = Setup::new(loaded)?;
    let floating = Floating::new(&setup);
    for view in views {
        for (points, what) in [(&view.empty, "empty"), (&view.object, "object")] {
            if points.len() < FEWEST {
                return Err(Error::request(
                    format!(
                        "view `{}`: its {what} photographs have {} points; {FEWEST} are the least",
                        view.name,
                        points.len()
                    ),
                    "photograph the floating picture larger, sharper and in a darker room, and let nothing move between the photographs",
                ));
            }
        }
    }
    let unseen = |name: &str| {
        Error::request(
            format!("view `{name}`: its empty photographs' points are not a flat picture"),
            "photograph the patterns again with the camera on a tripod, the same display in the same place",
        )
    };
    let lens = match known {
        Some(lens) => lens,
        None => first_lens(&floating, views, &unseen)?,
    };
    let mut cameras: Vec<Frame> = Vec::new();
    for view in views {
        let pairs = floating.pairs(&view.empty, |pixel| lens.direction(pixel));
        let h: Option<Matrix3<f64>> = homography(&pairs);
        let camera = h.and_then(|h| camera_of(&h, floating.origin, floating.axes));
        cameras.push(camera.ok_or_else(|| unseen(&view.name))?);
    }
    let shots = views.iter().enumerate();
    let problem = Problem {
        bodies: Vec::new(),
        shots: shots.map(|(view, points)| empty_shot(view, points, usize::MAX)).collect(),
        free: freedoms(views.len(), known.is_some()),
    };
    let offset = DVector::zeros(problem.free.len());
    let start = State { loaded: loaded.clone(), cameras, lens, offset };
    let found = problem.descend(&start, stop)?;
    let found = problem.settle(found)?;
    let residuals = problem.residuals(&found.state, &found.paths)?;
    for ((view, residuals), weights) in views.iter().zip(&residuals).zip(&found.weights) {
        let kept = || residuals.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
        let count = kept().count();
        let rms =
            (kept().map(|([x, y], _)| x * x + y * y).sum::<f64>() / count.max(1) as f64).sqrt();
        if 2 * count < residuals.len() || rms > MOST_OFF {
            return Err(Error::request(
                format!(
                    "view `{}`: its empty photographs do not fit a flat picture: {count} of {} points fit, to {rms:.1} display pixels",
                    view.name,
                    residuals.len()
                ),
                "the camera or the display moved between photographs, they are blurred, or [camera] is another camera's: photograph again from a tripod",
            ));
        }
    }
    Ok(found)
}

/// By how much less the empty photographs may fit from another place that is still to be thought of, in squared standard deviations.
const AMBIGUOUS: f64 = 50.0;

/// Points of each view that other places are tried with.
const TRIED: usize = 400;

/// The other place of each camera that its empty photographs fit about as well, the best first. From afar a flat picture looks the same from either side
/// of its normal: only perspective, or what else is photographed, tells which it is.
///
/// # Errors
/// Where the scene cannot be traced.
pub fn other_places(
    views: &[ViewPoints],
    lens_is_known: bool,
    found: &State,
    stop: &dyn Fn() -> bool,
) -> Result<Vec<(usize, Frame)>, Error> {
    let floating = Floating::new(&found.setup()?);
    let mut others = Vec::new();
    for (view, points) in views.iter().enumerate() {
        // Another view's points tell nothing of this camera, and the lens stays.
        let problem = Problem {
            shots: vec![empty_shot(view, points, TRIED)],
            free: freedoms(views.len(), true)
                .into_iter()
                .filter(|f| f.what.is_of_view(view))
                .collect(),
            bodies: Vec::new(),
        };
        let offset = DVector::zeros(problem.free.len());
        let here = State { offset: offset.clone(), ..found.clone() };
        let mut there = here.clone();
        there.cameras[view] = floating.on_the_other_side(&found.cameras[view]);
        let (here, there) = (problem.descend(&here, stop)?, problem.descend(&there, stop)?);
        let [a, b] = [&here, &there].map(|end| end.state.cameras[view]);
        let worse = problem.cost(&there.state, &there.paths, &here.weights)?
            - problem.cost(&here.state, &here.paths, &here.weights)?;
        // The lens' own numbers, where they are found as well, make either place a little less sure.
        let most = if lens_is_known { AMBIGUOUS } else { 2.0 * AMBIGUOUS };
        let apart = (a.origin - b.origin).length() / (a.origin - floating.origin).length();
        if apart > 0.01
            && worse < most * points.empty.len() as f64 / problem.shots[0].points.len() as f64
        {
            others.push((worse, view, b));
        }
    }
    others.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(others.into_iter().map(|(_, view, camera)| (view, camera)).collect())
}

/// A first lens, by Zhang's closed form.
fn first_lens(
    floating: &Floating,
    views: &[ViewPoints],
    unseen: &dyn Fn(&str) -> Error,
) -> Result<Lens, Error> {
    let mut homographies = Vec::new();
    for view in views {
        let pairs = floating.pairs(&view.empty, |pixel| pixel);
        homographies.push(homography(&pairs).ok_or_else(|| unseen(&view.name))?);
    }
    lens_of(&homographies).ok_or_else(|| {
        Error::request(
            "the empty photographs do not tell the camera's lens: they look from too much the same direction",
            "photograph from places 15 degrees or more apart, one of them from above; or give [camera]",
        )
    })
}
