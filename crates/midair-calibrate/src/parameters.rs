//! What was fitted, by the names and in the numbers that a scene file has.

use crate::camera::LENS_NUMBERS;
use crate::cameras::ViewPoints;
use crate::equations::Problem;
use crate::freedom::{AXES, Freedom, sizes};
use crate::state::State;
use midair::geometry::{Frame, Vec3};
use midair::scene::model::{Index, Material};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// A number that was fitted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its key in the scene file, such as `element.cube.position.x`; cameras' begin with `view`, the lens' with `camera`.
    pub name: String,
    /// What was found; mm, degrees, or of no unit.
    pub value: f64,
    /// One standard deviation.
    pub sigma: f64,
    /// What was assumed; of cameras and lens, what the empty photographs by themselves said.
    pub start: f64,
    /// Whether the photographs tell it: its deviation is less than a third of what it was before them.
    pub determined: bool,
}

/// The share of its former deviation below which a number counts as told.
pub(crate) const TOLD: f64 = 1.0 / 3.0;

/// A camera's frame as a scene would have it: +x right, +y up, looking along -z.
pub fn upright(camera: &Frame) -> Frame {
    let [right, down, ahead] = camera.axes;
    Frame { origin: camera.origin, axes: [right, -down, -ahead] }
}

/// What a row of the covariance is of.
pub(crate) fn row_name(
    what: Freedom,
    problem: &Problem,
    found: &State,
    views: &[ViewPoints],
) -> String {
    let element = |element: usize| format!("element.{}", found.scene().elements[element].name);
    let first = |body: usize| element(problem.bodies[body][0]);
    match what {
        Freedom::CameraShift { view, axis } => {
            format!("view.{}.shift.{}", views[view].name, AXES[axis])
        }
        Freedom::CameraTurn { view, axis } => {
            format!("view.{}.turn.{}", views[view].name, ["right", "down", "ahead"][axis])
        }
        Freedom::Lens { number } => format!("camera.{}", LENS_NUMBERS[number]),
        Freedom::Shift { body, axis } => format!("{}.shift.{}", first(body), AXES[axis]),
        Freedom::Turn { body, axis } => format!("{}.turn.{}", first(body), AXES[axis]),
        Freedom::Ior { element: e } => format!("{}.ior", element(e)),
        Freedom::Size { element: e, size } => {
            let key = sizes(&found.scene().elements[e]).get(size).map(|length| length.key);
            format!("{}.shape.{}", element(e), key.unwrap_or_default())
        }
        Freedom::PlateShift { axis } => format!("plate.shift.{}", AXES[axis]),
        Freedom::PlateTurn { axis } => format!("plate.turn.{}", AXES[axis]),
    }
}

/// Something that was turned: as it was assumed and as it was found, and for each of its own axes that it may turn about the row of the covariance.
struct Turned {
    name: String,
    start: Frame,
    found: Frame,
    axes: Vec<(usize, usize)>,
}

/// All parameters by name, with what they were and how sure they are.
pub(crate) fn parameters(
    problem: &Problem,
    start: &State,
    found: &State,
    covariance: &DMatrix<f64>,
    views: &[ViewPoints],
) -> Vec<Parameter> {
    let mut parameters = Vec::new();
    let mut turned: Vec<Turned> = Vec::new();
    for (i, free) in problem.free.iter().enumerate() {
        let sigma = covariance[(i, i)].sqrt();
        let determined = free.prior.is_none_or(|prior| sigma < TOLD * prior);
        let mut plain = |name: String, value: f64, start: f64| {
            parameters.push(Parameter { name, value, sigma, start, determined });
        };
        let view = |view: usize| format!("view.{}", views[view].name);
        let mut turn = |name: String, start: Frame, found: Frame, axis: usize| match turned
            .iter_mut()
            .find(|known| known.name == name)
        {
            Some(known) => known.axes.push((axis, i)),
            None => turned.push(Turned { name, start, found, axes: vec![(axis, i)] }),
        };
        let element = |element: usize| &found.scene().elements[element];
        let assumed = |element: usize| &start.scene().elements[element];
        match free.what {
            Freedom::CameraShift { view: v, axis } => {
                let at = |state: &State| state.cameras[v].origin.to_array()[axis];
                plain(format!("{}.position.{}", view(v), AXES[axis]), at(found), at(start));
            }
            // About the camera's own right, down and ahead: upright, the last two are reversed, and so is the turn about them.
            Freedom::CameraTurn { view: v, axis } => {
                let name = format!("{}.rotation", view(v));
                turn(name, upright(&start.cameras[v]), upright(&found.cameras[v]), axis);
            }
            Freedom::Lens { number } => {
                let at = |state: &State| state.lens.numbers()[number];
                plain(format!("camera.{}", LENS_NUMBERS[number]), at(found), at(start));
            }
            Freedom::Shift { body, axis } => {
                let first = problem.bodies[body][0];
                let name = format!("element.{}.position.{}", element(first).name, AXES[axis]);
                plain(name, element(first).pose.position[axis], assumed(first).pose.position[axis]);
            }
            Freedom::Turn { body, axis } => {
                let first = problem.bodies[body][0];
                let name = format!("element.{}.rotation", element(first).name);
                turn(name, assumed(first).pose.frame(), element(first).pose.frame(), axis);
            }
            Freedom::Ior { element: e } => {
                let at = |state: &State| match state.scene().elements[e].material {
                    Material::Refractive { index: Index::Constant(n), .. } => n,
                    _ => f64::NAN,
                };
                plain(format!("element.{}.ior", element(e).name), at(found), at(start));
            }
            Freedom::Size { element: e, size } => {
                let (now, then) = (sizes(element(e)), sizes(assumed(e)));
                let (Some(now), Some(then)) = (now.get(size), then.get(size)) else { continue };
                let item = now.item.map(|item| format!(".{}", AXES[item])).unwrap_or_default();
                let name = format!("element.{}.shape.{}{item}", element(e).name, now.key);
                plain(name, now.value, then.value);
            }
            Freedom::PlateShift { axis } => {
                let at = |state: &State| state.scene().plate.rectangle.pose.position[axis];
                plain(format!("plate.position.{}", AXES[axis]), at(found), at(start));
            }
            Freedom::PlateTurn { axis } => {
                let at = |state: &State| state.scene().plate.rectangle.pose.frame();
                turn("plate.rotation".to_owned(), at(start), at(found), axis);
            }
        }
    }
    for turned in &turned {
        parameters.extend(rotation(problem, covariance, turned));
    }
    for parameter in &mut parameters {
        // What rounding leaves of nothing is nothing, and not less.
        for number in [&mut parameter.value, &mut parameter.start] {
            if number.abs() < 1e-9 {
                *number = 0.0;
            }
        }
    }
    parameters.sort_by_key(|parameter| order(&parameter.name));
    parameters
}

/// Elements first, then the plate, cameras and the lens.
fn order(name: &str) -> usize {
    ["element.", "plate.", "view.", "camera."]
        .iter()
        .position(|start| name.starts_with(start))
        .unwrap_or(4)
}

/// A rotation's three angles as a scene file has them, from turns about own axes; those that no turn changes are left out.
fn rotation(problem: &Problem, covariance: &DMatrix<f64>, turned: &Turned) -> Vec<Parameter> {
    let Turned { name, start, found, axes } = turned;
    // How the angles go with small turns, by differences of the closed form.
    let step = 1e-3;
    let by = |axis: usize, degrees: f64| {
        let about = found.axes[axis];
        let (sin, cos) = degrees.to_radians().sin_cos();
        let turn = |v: Vec3| v * cos + about.cross(v) * sin + about * (about.dot(v) * (1.0 - cos));
        Frame { axes: found.axes.map(turn), ..*found }.rotation()
    };
    let slopes: Vec<[f64; 3]> = axes
        .iter()
        .map(|&(axis, _)| {
            let (plus, minus) = (by(axis, step), by(axis, -step));
            std::array::from_fn(|k| around(plus[k] - minus[k]) / (2.0 * step))
        })
        .collect();
    let is_camera = name.starts_with("view.");
    // A camera's down and ahead are the upright frame's axes reversed.
    let sign = |axis: usize| if is_camera && axis > 0 { -1.0 } else { 1.0 };
    let (value, assumed) = (found.rotation(), start.rotation());
    // Where a part is round about an axis, only as many of the three angles mean something as there are turns that light can tell: those that go with
    // them most.
    let slope = |k: usize| slopes.iter().map(|slope| slope[k].powi(2)).sum::<f64>();
    let mut told = [0, 1, 2];
    told.sort_by(|&a, &b| slope(b).total_cmp(&slope(a)));
    let told = &told[..axes.len().min(3)];
    let angle = |k: usize| {
        let row = DVector::from_fn(axes.len(), |a, _| slopes[a][k] * sign(axes[a].0));
        let of =
            DMatrix::from_fn(axes.len(), axes.len(), |a, b| covariance[(axes[a].1, axes[b].1)]);
        let variance = row.dot(&(of * &row));
        let before: Option<f64> = axes
            .iter()
            .enumerate()
            .map(|(a, &(_, i))| problem.free[i].prior.map(|prior| (row[a] * prior).powi(2)))
            .sum();
        told.contains(&k).then(|| Parameter {
            name: format!("{name}.{}", AXES[k]),
            value: value[k],
            sigma: variance.max(0.0).sqrt(),
            start: value[k] + around(assumed[k] - value[k]),
            determined: before.is_none_or(|before| variance.sqrt() < TOLD * before.sqrt()),
        })
    };
    (0..3).filter_map(angle).collect()
}

/// An angle within half a turn.
fn around(degrees: f64) -> f64 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}
