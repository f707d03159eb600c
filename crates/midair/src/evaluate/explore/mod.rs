//! Where can an image be formed? Set-ups that are alike but for some values, each looked at on its own; or the best of them, searched for.
//!
//! ```
//! use midair::evaluate::explore::{Axis, Settings, explore};
//! use midair::scene::{Folder, load};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = load("../../scenes/ball.toml".as_ref())?;
//! let axes: Vec<Axis> = vec!["image.position.z=-20..20:5".parse()?, "image.size=10,20".parse()?];
//! let found = explore(&scene, &axes, &Settings::default(), &Folder("../../scenes".into()), &())?;
//! let best = found.best(1)[0];
//! assert!(found.points[best].outcome.as_ref().unwrap().formed > 0.9);
//! # Ok(())
//! # }
//! ```

mod axis;
mod grid;
mod measured;
mod search;
#[cfg(test)]
mod tests;

pub use axis::{Axis, AxisError, Limit};
pub use measured::{Measured, NAMES, SHARES};
pub use search::{Best, best};

use super::csv::{self, Table};
use crate::Monitor;
use crate::scene::{Assets, Loaded, SceneEdit, SceneError};
use crate::transport::Setup;
use grid::Grid;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How finely set-ups are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Pixels of the map, and image points, along each side.
    pub resolution: usize,
    /// Between neighbours whose shares of formed, folded and lost points differ by no more than this, set-ups are interpolated; 0: none is. What is
    /// narrower than the coarse steps can be overlooked then.
    pub settle: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { resolution: 128, settle: 0.0 }
    }
}

impl Settings {
    /// With maps of so many pixels a side.
    pub fn resolution(self, resolution: usize) -> Self {
        Self { resolution, ..self }
    }

    /// With interpolation between neighbours that differ by no more than this.
    pub fn settle(self, settle: f64) -> Self {
        Self { settle, ..self }
    }
}

/// A set-up that was looked at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// The values, in the axes' order.
    pub values: Vec<f64>,
    /// What was found; why not, where there is no such set-up.
    pub outcome: Result<Measured, String>,
    /// Whether it is interpolated between its neighbours, and was not looked at itself.
    pub interpolated: bool,
}

/// What an exploration found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Exploration {
    /// What was varied.
    pub axes: Vec<Axis>,
    /// All combinations of values; the last axis runs fastest.
    pub points: Vec<Point>,
}

impl Exploration {
    /// The best set-ups that were looked at themselves, at most so many, the best first: their places in [`points`](Self::points).
    pub fn best(&self, most: usize) -> Vec<usize> {
        let score =
            |i: usize| self.points[i].outcome.as_ref().map_or(f64::NEG_INFINITY, Measured::score);
        let mut places: Vec<usize> = (0..self.points.len())
            .filter(|&i| !self.points[i].interpolated && self.points[i].outcome.is_ok())
            .collect();
        places.sort_by(|&a, &b| score(b).total_cmp(&score(a)));
        places.truncate(most);
        places
    }

    /// Where a point stands along each axis: the number of its value there.
    pub fn places(&self, point: usize) -> Vec<usize> {
        axis::places(&self.axes, point)
    }

    /// The point at these places along the axes.
    pub fn at(&self, places: &[usize]) -> &Point {
        &self.points[axis::number(&self.axes, places)]
    }

    /// All set-ups, a row each: the values, what was found, and why it was refused. What is not known is empty.
    pub fn to_csv(&self) -> String {
        let more = NAMES.into_iter().chain(["score", "interpolated", "refused"]);
        let axes = self.axes.iter().map(|axis| axis.path.as_str());
        let mut table = Table::new(axes.chain(more).map(str::to_owned).collect());
        for point in &self.points {
            let mut fields: Vec<String> = point.values.iter().map(f64::to_string).collect();
            match &point.outcome {
                Ok(measured) => {
                    let numbers = measured.numbers().into_iter().chain([measured.score()]);
                    fields.extend(numbers.map(|number| csv::number(Some(number))));
                }
                Err(_) => fields.extend(vec![String::new(); NAMES.len() + 1]),
            }
            fields.push(point.interpolated.to_string());
            fields.push(point.outcome.as_ref().err().cloned().unwrap_or_default());
            table.row(fields);
        }
        table.finish()
    }
}

/// Looks at all combinations of values: coarsely first, then between neighbours that differ.
///
/// # Errors
/// Where an axis names no key of the scene. A set-up that cannot be is a [`Point`] that says why.
pub fn explore(
    loaded: &Loaded,
    axes: &[Axis],
    settings: &Settings,
    files: &(dyn Assets + Sync),
    monitor: &dyn Monitor,
) -> Result<Exploration, SceneError> {
    explore_further(loaded, axes, settings, files, monitor, &|_| None, &|_, _| ())
}

/// As [`explore`], with what an earlier run has found of the set-ups by their numbers (`known`), and told of each as it is found. Where the monitor
/// cancels, what was not looked at yet says so.
///
/// # Errors
/// As [`explore`].
pub fn explore_further(
    loaded: &Loaded,
    axes: &[Axis],
    settings: &Settings,
    files: &(dyn Assets + Sync),
    monitor: &dyn Monitor,
    known: &(dyn Fn(usize) -> Option<Point> + Sync),
    keep: &(dyn Fn(usize, &Point) + Sync),
) -> Result<Exploration, SceneError> {
    let edit = SceneEdit::of(&loaded.text)?;
    // Misspelt paths are told before any work is done.
    for axis in axes {
        edit.get(&axis.path)?;
    }
    let paths: Vec<&str> = axes.iter().map(|axis| axis.path.as_str()).collect();
    let look = |values: &[f64]| look_at(loaded, &edit, &paths, values, settings, files);
    let mut grid = Grid::new(axes);
    let mut todo = grid.begin();
    monitor.stage("set-ups", grid.len());
    loop {
        let found: Vec<(usize, Point)> = todo
            .into_par_iter()
            .map(|number| {
                let point = known(number).unwrap_or_else(|| {
                    let values = grid.values(number);
                    let outcome = if monitor.is_cancelled() {
                        Err("interrupted".to_owned())
                    } else {
                        look(&values)
                    };
                    let point = Point { values, outcome, interpolated: false };
                    if !monitor.is_cancelled() {
                        keep(number, &point);
                    }
                    point
                });
                monitor.advance(1);
                (number, point)
            })
            .collect();
        grid.put(found);
        match grid.finer(settings.settle, monitor) {
            Some(next) => todo = next,
            None => break,
        }
    }
    Ok(Exploration { axes: axes.to_vec(), points: grid.into_points() })
}

/// One set-up.
fn look_at(
    loaded: &Loaded,
    edit: &SceneEdit,
    paths: &[&str],
    values: &[f64],
    settings: &Settings,
    files: &(dyn Assets + Sync),
) -> Result<Measured, String> {
    let varied = varied(edit, paths, values);
    let varied = varied.and_then(|edit| loaded.changed(&edit, files));
    let varied = varied.map_err(|error| error.message.clone())?;
    let setup = Setup::new(&varied).map_err(|error| error.to_string())?;
    let setup = setup.with_resolution([settings.resolution; 2]);
    Ok(measured::measure(&setup, &varied.scene.plate.model, settings.resolution))
}

/// The scene with other values at these paths.
///
/// # Errors
/// [`SceneError`] where there is no such key, or a value does not conform.
pub fn varied(edit: &SceneEdit, paths: &[&str], values: &[f64]) -> Result<SceneEdit, SceneError> {
    let mut edit = edit.clone();
    for (path, &value) in paths.iter().zip(values) {
        axis::put(&mut edit, path, value)?;
    }
    Ok(edit)
}
