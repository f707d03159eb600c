//! An intersection to a fraction of a pixel: each line's centre is measured across the line at
//! many places on both sides of the crossing, a curve is laid through them, and the two curves
//! are intersected.

use super::super::Plane;
use super::graph::distance;
use super::ridge::{bilinear, unit};

/// Points along one arm with the unit vector across the line at each.
pub(super) type Stations = Vec<([f64; 2], [f64; 2])>;

/// Places on a traced line whose distance along it from the crossing is within [from, to], about a
/// pixel apart (at most 49 of them), in full-resolution pixels: `scale` of the trace's.
pub(super) fn stations(
    crossing: [f64; 2],
    trace: &[[f64; 2]],
    scale: f64,
    [from, to]: [f64; 2],
) -> Stations {
    let step = ((to - from) / 48.0).max(1.0);
    let mut stations = Vec::new();
    let Some(&first) = trace.first() else { return stations };
    let mut travelled = scale * distance(first, crossing);
    let mut next = from.max(travelled);
    for at in 1..trace.len() {
        let [a, b] = [trace[at - 1], trace[at]].map(|p| [scale * p[0], scale * p[1]]);
        let length = distance(a, b);
        while length > 0.0 && next <= travelled + length && next <= to {
            let t = (next - travelled) / length;
            // The trace trembles by a fraction of a pixel: take its direction from a longer chord.
            let (back, ahead) = (trace[at.saturating_sub(4)], trace[(at + 3).min(trace.len() - 1)]);
            let [x, y] = unit([ahead[0] - back[0], ahead[1] - back[1]]);
            stations.push(([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])], [-y, x]));
            next += step;
        }
        travelled += length;
    }
    stations
}

/// The line's centre near a station: the maximum, along the normal, of the profile smoothed by a
/// Gaussian of `sigma` pixels (smoothing across the line only, so that curvature does not shift it).
pub(super) fn centre(
    picture: &Plane,
    (from, across): ([f64; 2], [f64; 2]),
    sigma: f64,
) -> Option<[f64; 2]> {
    let taps = (7.0 * sigma).ceil().max(6.0) as i32;
    let step = 3.5 * sigma / f64::from(taps);
    let mut offset = 0.0_f64;
    for _ in 0..6 {
        // First and second derivative of the smoothed profile at the offset, up to a factor.
        let (mut slope, mut bend, mut weights) = (0.0, 0.0, 0.0);
        for tap in -taps..=taps {
            let t = f64::from(tap) * step;
            let weight = (-0.5 * (t / sigma).powi(2)).exp();
            let (x, y) = (from[0] + (offset + t) * across[0], from[1] + (offset + t) * across[1]);
            let value = bilinear(&picture.values, picture.width, picture.height, x, y);
            slope += weight * t * value;
            bend += weight * ((t / sigma).powi(2) - 1.0) * value;
            weights += weight;
        }
        // The contrast below which a profile is ground: half a grey level of 255.
        if bend > -0.002 * weights {
            return None;
        }
        let newton = -slope / bend;
        offset += newton.clamp(-sigma, sigma);
        if offset.abs() > 4.0 * sigma {
            return None;
        }
        if newton.abs() < 1e-4 {
            return Some([from[0] + offset * across[0], from[1] + offset * across[1]]);
        }
    }
    None
}

/// Full width at half height, in pixels, of the mean profile over stations.
pub(super) fn line_width(
    picture: &Plane,
    stations: &[([f64; 2], [f64; 2])],
    reach: f64,
) -> Option<f64> {
    const STEPS_PER_PIXEL: f64 = 4.0;
    let half = (reach * STEPS_PER_PIXEL).ceil() as i32;
    let mut profile = vec![0.0; (2 * half + 1) as usize];
    for (place, across) in stations {
        for (at, sum) in profile.iter_mut().enumerate() {
            let t = f64::from(at as i32 - half) / STEPS_PER_PIXEL;
            let (x, y) = (place[0] + t * across[0], place[1] + t * across[1]);
            *sum += bilinear(&picture.values, picture.width, picture.height, x, y);
        }
    }
    let least = profile.iter().copied().fold(f64::INFINITY, f64::min);
    let most = profile.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let level = 0.5 * (least + most);
    // Measured outwards from the middle, so that a neighbouring line does not count.
    let middle = half as usize;
    let right = profile[middle..].iter().position(|&value| value < level)?;
    let left = profile[..=middle].iter().rev().position(|&value| value < level)?;
    Some((left + right).saturating_sub(1).max(1) as f64 / STEPS_PER_PIXEL)
}
