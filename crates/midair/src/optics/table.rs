//! Values at known places.

/// `ys` at `x` between the points of ascending `xs`, the first of equal ones; the outermost ones go on beyond.
pub(super) fn interpolate(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let above = xs.partition_point(|&known| known < x);
    match (above.checked_sub(1), xs.get(above)) {
        (None, _) => ys[0],
        (_, None) => ys[ys.len() - 1],
        (Some(below), Some(_)) => {
            let share = (x - xs[below]) / (xs[above] - xs[below]);
            ys[below] + share * (ys[above] - ys[below])
        }
    }
}
