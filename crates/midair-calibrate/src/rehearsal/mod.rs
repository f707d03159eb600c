//! Benches that exist in thought only: a scene as it really is, one as it was assumed, and what photographs of the former would be decoded to.
//!
//! The points come from [`Setup::trace`], a search in plain numbers; the fit follows known paths over numbers with derivatives.

pub mod film;

use crate::bench::Uncertainty;
use crate::camera::{Lens, looking_at, seen_at};
use crate::cameras::ViewPoints;
use crate::correspondences::Correspondence;
use crate::equations::without_elements;
use crate::freedom::{bodies, freedoms};
use crate::state::State;
use midair::Error;
use midair::geometry::{Frame, Vec3};
use midair::scene::Loaded;
use midair::transport::{Path, Setup};
use nalgebra::DVector;

/// What chance is drawn by.
pub type Dice = fastrand::Rng;

/// Chance that is the same for the same seed.
pub fn dice(seed: u64) -> Dice {
    Dice::with_seed(seed)
}

/// A normal number, by Box and Muller's way.
pub fn normal(draw: &mut fastrand::Rng) -> f64 {
    let radius = (-2.0 * (1.0 - draw.f64()).ln()).sqrt();
    radius * (std::f64::consts::TAU * draw.f64()).cos()
}

/// A scene off by as much as one is unsure of it: each free number is drawn anew.
///
/// # Errors
/// Names in `together` that mean nothing.
pub fn disturbed(
    loaded: &Loaded,
    uncertainty: &Uncertainty,
    together: &[Vec<String>],
    free: &[String],
    draw: &mut fastrand::Rng,
) -> Result<Loaded, Error> {
    let bodies = bodies(&loaded.scene, together)?;
    let free = freedoms(&loaded.scene, &bodies, uncertainty, free, &[])?;
    let step =
        DVector::from_fn(free.len(), |i, _| normal(draw) * free[i].prior.unwrap_or_default());
    let state = State {
        loaded: loaded.clone(),
        cameras: Vec::new(),
        lens: Lens { focal: [1.0; 2], centre: [0.0; 2], distortion: [0.0; 5] },
        offset: DVector::zeros(free.len()),
    };
    Ok(state.stepped(&free, &bodies, &step).loaded)
}

/// A camera that looks at a scene's image, turned about the vertical and raised by degrees against the viewpoint.
pub fn camera(setup: &Setup, right: f64, up: f64) -> Frame {
    let pivot = setup.image.frame.origin;
    let arm = setup.viewpoint - pivot;
    let about = |v: Vec3, axis: Vec3, degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
    };
    let arm = about(arm, Vec3::new(0.0, 1.0, 0.0), right);
    let across = looking_at(pivot + arm, pivot).axes[0];
    looking_at(pivot + about(arm, -across, up), pivot)
}

/// A lens that shows what lies at the image's distance from the viewpoint, twice as wide as the image, on 6000 x 4000 pixels.
pub fn lens(setup: &Setup) -> Lens {
    let distance = (setup.viewpoint - setup.image.frame.origin).length();
    let focal = 3000.0 * distance / setup.image.size[0].max(setup.image.size[1]);
    Lens {
        focal: [focal, focal],
        centre: [3000.0, 2000.0],
        distortion: [-0.08, 0.05, 0.0004, -0.0003, 0.0],
    }
}

/// What a view's photographs would be decoded to: about `count` points for each, st off by `noise` mm on the display along each of its axes.
pub fn view(
    name: &str,
    setup: &Setup,
    camera: &Frame,
    lens: &Lens,
    count: usize,
    noise: f64,
    draw: &mut fastrand::Rng,
) -> ViewPoints {
    let empty = without_elements(setup);
    let floating = |st: [f64; 2]| setup.plate.rectangle.mirrored(setup.display.point(st));
    let points = |setup: &Setup, aim: &dyn Fn([f64; 2]) -> Vec3, draw: &mut fastrand::Rng| {
        let side = (count as f64).sqrt().round() as usize;
        let mut points = Vec::new();
        for i in 0..side * side {
            // Not on a lattice: pixels are where they are.
            let at = [i % side, i / side].map(|k| (k as f64 + draw.f64()) / side as f64);
            let point = aim(at);
            let Some(pixel) = seen_at(camera, lens, point) else { continue };
            let direction = (point - camera.origin).normalized();
            let ray = midair::geometry::Ray { origin: camera.origin, direction };
            let Some(st) = setup.trace(ray, &mut Path::new()).formed() else { continue };
            let pitch = setup.pixel_pitch();
            let st = [0, 1].map(|c| st[c] + noise * normal(draw) / setup.display.size[c]);
            let on_edge = st.iter().any(|c| !(0.0..=1.0).contains(c));
            if !on_edge {
                // One deviation for both axes.
                let sigma = (noise / pitch[0].min(pitch[1])).max(1e-3);
                points.push(Correspondence { pixel, st, sigma });
            }
        }
        points
    };
    ViewPoints {
        name: name.to_owned(),
        empty: points(&empty, &floating, draw),
        object: points(setup, &|uv| setup.image.point(uv), draw),
    }
}

/// How far a lattice's crossings are from where they belong, in pixels of a picture 1024 wide over the image.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Displacement {
    /// The mean.
    pub mean: f64,
    /// The largest.
    pub largest: f64,
    /// Crossings that were compared: those that the real bench forms and the map answers for.
    pub compared: usize,
    /// Of how many.
    pub of: usize,
}

/// What a viewer at the real bench sees of a lattice of `lines` by `lines` that the display shows through a map: each line of sight leads to a display
/// point, and what the map puts there belongs elsewhere by so much.
pub fn displacement(real: &Setup, eye: Vec3, map: &midair::map::Map, lines: usize) -> Displacement {
    let mut off = Vec::new();
    for i in 0..lines * lines {
        let uv = [i % lines, i / lines].map(|k| (k as f64 + 0.5) / lines as f64);
        let end = real.trace(real.ray_from(eye, uv), &mut Path::new());
        if let Some(shown) = end.formed().and_then(|st| value_at(map, st)) {
            off.push(1024.0 * (shown[0] - uv[0]).hypot(shown[1] - uv[1]));
        }
    }
    Displacement {
        mean: off.iter().sum::<f64>() / off.len().max(1) as f64,
        largest: off.iter().copied().fold(0.0, f64::max),
        compared: off.len(),
        of: lines * lines,
    }
}

/// A map between its pixels' centres; `None` where one of the four around has no answer.
pub fn value_at(map: &midair::map::Map, [s, t]: [f64; 2]) -> Option<[f64; 2]> {
    let (x, y) = (s * map.width as f64 - 0.5, (1.0 - t) * map.height as f64 - 0.5);
    let (left, top) = (x.floor(), y.floor());
    if left < 0.0 || top < 0.0 {
        return None;
    }
    let (column, row) = (left as usize, top as usize);
    if column + 1 >= map.width || row + 1 >= map.height {
        return None;
    }
    let (a, b) = (x - left, y - top);
    let mut value = [0.0; 2];
    for i in 0..4 {
        let uv = map.answer((row + i / 2) * map.width + column + i % 2)?;
        let weight = [1.0 - a, a][i % 2] * [1.0 - b, b][i / 2];
        value = [value[0] + weight * uv[0], value[1] + weight * uv[1]];
    }
    Some(value)
}
