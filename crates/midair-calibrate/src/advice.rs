//! Which further photograph would tell what these do not: tried in thought, by the same derivatives.

use crate::camera::{looking_at, seen_at};
use crate::correspondences::{Correspondence, USUAL_SIGMA};
use crate::equations::{Problem, Shot};
use crate::parameters::TOLD;
use crate::solve::{Descent, covariance};
use midair::geometry::Vec3;
use midair::transport::{Path, SetupError};
use nalgebra::DMatrix;
use serde::Serialize;

/// A further photograph that would tell more.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Advice {
    /// Where the camera would stand, mm.
    pub position: [f64; 3],
    /// The same in words, from the first view.
    pub from: String,
    /// How many of the numbers that are not determined would be.
    pub tells: usize,
    /// Of how many.
    pub of: usize,
}

impl Advice {
    /// As a sentence.
    pub fn in_words(&self) -> String {
        // No minus before nothing.
        let [x, y, z] = self.position.map(|place| place.round() + 0.0);
        format!(
            "A further photograph from {} (camera at {x}, {y}, {z}) would determine {} of the {} numbers that are not.",
            self.from, self.tells, self.of
        )
    }
}

/// Degrees to the right and upwards from the first view.
const PLACES: [[f64; 2]; 10] = [
    [20.0, 0.0],
    [-20.0, 0.0],
    [40.0, 0.0],
    [-40.0, 0.0],
    [0.0, 20.0],
    [0.0, -20.0],
    [20.0, 20.0],
    [-20.0, 20.0],
    [40.0, 20.0],
    [-40.0, 20.0],
];

/// Points across the image that such a photograph is thought to have, in each direction.
const GRID: usize = 15;

/// The place, of some that a tripod reaches, from which a photograph would determine most; `None` where all is determined, or none of them would.
pub(crate) fn advice(
    problem: &Problem,
    found: &Descent,
    curvature: &DMatrix<f64>,
    known: &DMatrix<f64>,
) -> Result<Option<Advice>, SetupError> {
    let untold = |covariance: &DMatrix<f64>| {
        let free = problem.free.iter().enumerate();
        free.filter(|(i, free)| {
            free.prior.is_some_and(|prior| covariance[(*i, *i)].sqrt() >= TOLD * prior)
        })
        .count()
    };
    let of = untold(known);
    if of == 0 {
        return Ok(None);
    }
    let setup = found.state.setup()?;
    let first = &found.state.cameras[0];
    let pivot = setup.image.frame.origin;
    let mut best: Option<Advice> = None;
    for [right, up] in PLACES {
        let arm = first.origin - pivot;
        let eye = pivot + about(about(arm, Vec3::new(0.0, 1.0, 0.0), right), -first.axes[0], up);
        let camera = looking_at(eye, pivot);
        let mut points = Vec::new();
        for i in 0..GRID * GRID {
            let uv = [i % GRID, i / GRID].map(|k| (k as f64 + 0.5) / GRID as f64);
            let seen = seen_at(&camera, &found.state.lens, setup.image.point(uv));
            let end = setup.trace(setup.ray_from(eye, uv), &mut Path::new());
            if let (Some(pixel), Some(st)) = (seen, end.formed()) {
                points.push(Correspondence { pixel, st, sigma: USUAL_SIGMA });
            }
        }
        // A photograph of less than half the picture is not one to ask for.
        if 2 * points.len() < GRID * GRID {
            continue;
        }
        let mut state = found.state.clone();
        state.cameras.push(camera);
        let weights = vec![vec![1.0; points.len()]];
        let shots = vec![Shot { view: state.cameras.len() - 1, with_object: true, points }];
        let further = Problem { shots, ..problem.clone() };
        let paths = further.search(&state)?;
        let more = further.data_equations(&state, &paths, &weights).curvature;
        let Some(covariance) = covariance(&(curvature + more)) else { continue };
        let tells = of - untold(&covariance).min(of);
        if tells > best.as_ref().map_or(0, |best| best.tells) {
            best = Some(Advice { position: eye.to_array(), from: in_words(right, up), tells, of });
        }
    }
    Ok(best)
}

fn about(v: Vec3, axis: Vec3, degrees: f64) -> Vec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}

fn in_words(right: f64, up: f64) -> String {
    let mut words = Vec::new();
    for (angle, [positive, negative]) in
        [(right, ["to the right", "to the left"]), (up, ["up", "down"])]
    {
        if angle != 0.0 {
            let way = if angle > 0.0 { positive } else { negative };
            words.push(format!("{:.0} degrees {way}", angle.abs()));
        }
    }
    format!("{} of the first view", words.join(" and "))
}
