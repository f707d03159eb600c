//! The best set-up within limits, searched for.

use super::{Limit, Measured, Point, Settings, look_at};
use crate::Monitor;
use crate::scene::{Assets, Loaded, SceneEdit, SceneError};
use rayon::prelude::*;
use serde::Serialize;
use sobol_burley::sample;

/// What a search found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Best {
    /// Where was searched.
    pub limits: Vec<Limit>,
    /// The best set-up; of values that cannot be, where there is none.
    pub point: Point,
    /// Its [`Measured::score`], mm².
    pub score: f64,
    /// The score of the scene as it is, mm².
    pub before: f64,
    /// Set-ups that were looked at.
    pub looked_at: usize,
}

/// Set-ups that are spread over all of the limits, for each of them.
const SPREAD: usize = 48;
/// From so many of the best of them the search goes on.
const STARTS: usize = 3;
/// Steps as shares of a limit: the first, and the last.
const STEPS: [f64; 2] = [1.0 / 8.0, 1.0 / 256.0];

/// Searches for the set-up with the best [`Measured::score`]: many spread over the limits first (Owen-scrambled Sobol points), then from the best of them by
/// steps along each value, halved where none leads on (Hooke and Jeeves, Journal of the ACM 8, 212 (1961)). It finds a good set-up, and the best one where
/// there are not many.
///
/// # Errors
/// Where a limit names no key of the scene.
pub fn best(
    loaded: &Loaded,
    limits: &[Limit],
    settings: &Settings,
    files: &(dyn Assets + Sync),
    monitor: &dyn Monitor,
) -> Result<Best, SceneError> {
    let edit = SceneEdit::of(&loaded.text)?;
    for limit in limits {
        edit.get(&limit.path)?;
    }
    let paths: Vec<&str> = limits.iter().map(|limit| limit.path.as_str()).collect();
    let look = |place: &[f64]| -> Point {
        let values: Vec<f64> = place
            .iter()
            .zip(limits)
            .map(|(share, limit)| limit.range[0] + share * (limit.range[1] - limit.range[0]))
            .collect();
        let outcome = look_at(loaded, &edit, &paths, &values, settings, files);
        monitor.advance(1);
        Point { values, outcome, interpolated: false }
    };
    let score = |point: &Point| point.outcome.as_ref().map_or(f64::NEG_INFINITY, Measured::score);
    let before = look_at(loaded, &edit, &[], &[], settings, files);
    let before = before.as_ref().map_or(0.0, Measured::score);

    let count = SPREAD * limits.len().max(1);
    let rounds = (STEPS[0] / STEPS[1]).log2() as usize + 1;
    monitor.stage("set-ups", count + STARTS * rounds * 2 * limits.len());
    let mut spread: Vec<(Vec<f64>, Point)> = (0..count)
        .into_par_iter()
        .filter(|_| !monitor.is_cancelled())
        .map(|i| {
            let place: Vec<f64> =
                (0..limits.len()).map(|d| f64::from(sample(i as u32, d as u32, 7))).collect();
            let point = look(&place);
            (place, point)
        })
        .collect();
    spread.sort_by(|a, b| score(&b.1).total_cmp(&score(&a.1)));
    let mut looked_at = spread.len();
    let mut found: Option<Point> = None;
    for (mut place, mut point) in spread.into_iter().take(STARTS) {
        let mut step = STEPS[0];
        while step >= STEPS[1] && !monitor.is_cancelled() {
            let around: Vec<(Vec<f64>, Point)> = (0..2 * limits.len())
                .into_par_iter()
                .map(|k| {
                    let mut near = place.clone();
                    let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                    near[k / 2] = (near[k / 2] + sign * step).clamp(0.0, 1.0);
                    let point = look(&near);
                    (near, point)
                })
                .collect();
            looked_at += around.len();
            let nearest = around.into_iter().max_by(|a, b| score(&a.1).total_cmp(&score(&b.1)));
            match nearest.filter(|(_, better)| score(better) > score(&point)) {
                Some(better) => (place, point) = better,
                None => step /= 2.0,
            }
        }
        if found.as_ref().is_none_or(|best| score(&point) > score(best)) {
            found = Some(point);
        }
    }
    let point = found.unwrap_or_else(|| {
        let outcome = Err("interrupted".to_owned());
        Point {
            values: limits.iter().map(|limit| limit.range[0]).collect(),
            outcome,
            interpolated: false,
        }
    });
    let score = score(&point);
    Ok(Best { limits: limits.to_vec(), point, score, before, looked_at })
}
