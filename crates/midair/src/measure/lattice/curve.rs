//! The curve of a line near a crossing, from measured centres.

use super::ridge::unit;
use nalgebra::{Cholesky, DMatrix, DVector};

/// A curve in a frame of its own: v = polynomial of t = (u - middle) / half, u along the line.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    origin: [f64; 2],
    along: [f64; 2],
    middle: f64,
    half: f64,
    coefficients: Vec<f64>,
    /// Root mean square distance of the kept points from it, pixels.
    pub residual: f64,
    /// Standard error of its distance across the line at the origin, pixels.
    pub error: f64,
    /// Whether the line is seen on both sides of the crossing.
    pub both_sides: bool,
}

/// Fewer centres than this on a side do not hold a curve there.
const SHORT: usize = 8;

impl Curve {
    /// The curve through the centres of a line on both sides of a crossing near `origin`:
    /// `before[0]` lies between the crossing and the one before it, `before[1]` beyond that one.
    ///
    /// A longer stretch with a stiffer curve averages more noise but follows bends less. Stretches
    /// are tried from the shortest up, as long as their answers at the crossing agree with all earlier ones' within their
    /// errors (Lepski 1990), and of those the most certain is taken.
    pub fn through(
        origin: [f64; 2],
        before: &[&[[f64; 2]]],
        after: &[&[[f64; 2]]],
    ) -> Option<Self> {
        let nearest = |side: &[&[[f64; 2]]]| side.first().map_or(0, |points| points.len());
        let both = nearest(before) >= SHORT && nearest(after) >= SHORT;
        let far = usize::MAX;
        // Segments on either side, and the polynomial's degree. From one side the crossing is
        // extrapolated, where every further degree multiplies noise: begin with parabolas.
        let tries: &[(usize, usize)] = if both {
            &[(1, 4), (2, 5), (3, 6), (far, 7), (far, 5), (far, 4)]
        } else {
            &[(1, 2), (1, 3), (2, 2), (2, 3), (3, 3), (3, 4), (far, 3), (far, 4), (far, 5)]
        };
        let mut taken: Vec<Self> = Vec::new();
        for &(segments, degree) in tries {
            let stretch = |side: &[&[[f64; 2]]]| -> Vec<[f64; 2]> {
                side.iter().take(segments).flat_map(|points| points.iter().copied()).collect()
            };
            let Some(curve) = Self::fit(origin, &stretch(before), &stretch(after), degree) else {
                continue;
            };
            let agrees = |other: &Self| {
                let (here, there) = (curve.tangent(origin).0, other.tangent(origin).0);
                // Neighbouring centres share pixels, so that errors are up to twice what independent
                // ones would make them: this is two standard errors, in truth.
                (here[0] - there[0]).hypot(here[1] - there[1]) <= 4.0 * other.error
            };
            if !taken.iter().all(agrees) {
                break;
            }
            taken.push(curve);
        }
        let best = (0..taken.len()).min_by(|&a, &b| taken[a].error.total_cmp(&taken[b].error))?;
        Some(Self { both_sides: both, ..taken.swap_remove(best) })
    }

    /// A robust least-squares polynomial through all the points.
    fn fit(
        origin: [f64; 2],
        before: &[[f64; 2]],
        after: &[[f64; 2]],
        degree: usize,
    ) -> Option<Self> {
        if before.len() + after.len() < degree + 6 {
            return None;
        }
        let mean = |points: &[[f64; 2]]| {
            if points.is_empty() {
                return origin;
            }
            let sum = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>();
            [sum(0) / points.len() as f64, sum(1) / points.len() as f64]
        };
        let (from, to) = (mean(before), mean(after));
        let along = unit([to[0] - from[0], to[1] - from[1]]);
        let local = |p: &[f64; 2]| {
            let [dx, dy] = [p[0] - origin[0], p[1] - origin[1]];
            (dx * along[0] + dy * along[1], dy * along[0] - dx * along[1])
        };
        let mut points: Vec<(f64, f64)> = before.iter().chain(after).map(local).collect();
        let least = points.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
        let most = points.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
        let (middle, half) = (0.5 * (least + most), 0.5 * (most - least));
        if half.is_nan() || half < 2.0 {
            return None;
        }
        points.iter_mut().for_each(|point| point.0 = (point.0 - middle) / half);
        let mut curve = Self {
            origin,
            along,
            middle,
            half,
            coefficients: Vec::new(),
            residual: 0.0,
            error: 0.0,
            both_sides: false,
        };
        for round in 0.. {
            let (coefficients, variance) = least_squares(&points, degree, -middle / half)?;
            let distance = |&(t, v): &(f64, f64)| (v - horner(&coefficients, t)).abs();
            let mut errors: Vec<f64> = points.iter().map(distance).collect();
            let sum: f64 = errors.iter().map(|error| error * error).sum();
            let freedom = (points.len() - coefficients.len()).max(1) as f64;
            curve.residual = (sum / freedom).sqrt();
            curve.error = curve.residual * variance.sqrt();
            let count = errors.len();
            let (_, &mut median, _) = errors.select_nth_unstable_by(count / 2, f64::total_cmp);
            // 3 standard deviations of a normal distribution, and never below what interpolation
            // between pixels leaves.
            let limit = (3.0 * 1.4826 * median).max(0.02);
            let kept: Vec<_> = points.iter().copied().filter(|p| distance(p) <= limit).collect();
            curve.coefficients = coefficients;
            if round == 2 || kept.len() == points.len() {
                break;
            }
            if kept.len() < degree + 6 {
                return None;
            }
            points = kept;
        }
        Some(curve)
    }

    /// The curve's point at a place's u, and the unit tangent there.
    fn tangent(&self, place: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let [dx, dy] = [place[0] - self.origin[0], place[1] - self.origin[1]];
        let [ax, ay] = self.along;
        let u = dx * ax + dy * ay;
        let t = (u - self.middle) / self.half;
        let v = horner(&self.coefficients, t);
        let powers = self.coefficients.iter().enumerate().skip(1);
        let slopes: Vec<f64> = powers.map(|(power, c)| power as f64 * c).collect();
        let slope = horner(&slopes, t) / self.half;
        let on = [self.origin[0] + u * ax - v * ay, self.origin[1] + u * ay + v * ax];
        (on, unit([ax - slope * ay, ay + slope * ax]))
    }

    /// Where two curves meet, by Newton's method from their common origin.
    pub fn meet(&self, other: &Self) -> Option<[f64; 2]> {
        let mut place = self.origin;
        for _ in 0..20 {
            let ((p, s), (q, t)) = (self.tangent(place), other.tangent(place));
            let sine = s[0] * t[1] - s[1] * t[0];
            // Lines that meet at less than 6 degrees do not locate a point.
            if sine.abs() < 0.1 {
                return None;
            }
            let [dx, dy] = [q[0] - p[0], q[1] - p[1]];
            let along = (dx * t[1] - dy * t[0]) / sine;
            let next = [p[0] + along * s[0], p[1] + along * s[1]];
            let moved = (next[0] - place[0]).hypot(next[1] - place[1]);
            place = next;
            if moved < 1e-9 {
                return Some(place);
            }
        }
        None
    }
}

fn horner(coefficients: &[f64], t: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

/// The least-squares polynomial of t in \[-1, 1\], and the variance of its value at `at` in units
/// of one point's, by a Cholesky factor of the normal equations.
pub(super) fn least_squares(
    points: &[(f64, f64)],
    degree: usize,
    at: f64,
) -> Option<(Vec<f64>, f64)> {
    let n = degree + 1;
    let mut moments = vec![0.0; 2 * n - 1];
    let mut right = DVector::zeros(n);
    for &(t, v) in points {
        let mut power = 1.0;
        for (order, moment) in moments.iter_mut().enumerate() {
            *moment += power;
            if order < n {
                right[order] += power * v;
            }
            power *= t;
        }
    }
    let normal = DMatrix::from_fn(n, n, |row, column| moments[row + column]);
    let factor = Cholesky::new(normal)?;
    let lower = factor.l();
    // All t in fewer places than the polynomial has coefficients.
    if lower.diagonal().iter().any(|pivot| pivot * pivot < 1e-10 * moments[0]) {
        return None;
    }
    let powers = DVector::from_fn(n, |power, _| at.powi(power as i32));
    let variance = lower.solve_lower_triangular(&powers)?.norm_squared();
    let coefficients = factor.solve(&right).data.into();
    Some((coefficients, variance))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_recovered_and_its_variance_is_that_of_a_mean() {
        let exact = |t: f64| 0.3 - 0.7 * t + 2.0 * t.powi(3) - 0.1 * t.powi(7);
        let points: Vec<(f64, f64)> =
            (0..60).map(|i| (i as f64 / 29.5 - 1.0, exact(i as f64 / 29.5 - 1.0))).collect();
        let (found, _) = least_squares(&points, 7, 0.4).unwrap();
        for (power, expected) in [0.3, -0.7, 0.0, 2.0, 0.0, 0.0, 0.0, -0.1].into_iter().enumerate()
        {
            // Normal equations of degree 7: condition number about 1e6.
            assert!((found[power] - expected).abs() < 1e-8, "{found:?}");
        }
        let (_, variance) = least_squares(&points, 0, 0.4).unwrap();
        assert!((variance - 1.0 / 60.0).abs() < 1e-12);
        // Extrapolating a straight line to t = 3: 1/n + t^2 / sum t^2.
        let squares: f64 = points.iter().map(|p| p.0 * p.0).sum();
        let (_, variance) = least_squares(&points, 1, 3.0).unwrap();
        assert!((variance - (1.0 / 60.0 + 9.0 / squares)).abs() < 1e-12);
    }

    #[test]
    fn a_circle_and_a_line_meet_where_they_do_despite_outliers() {
        // The circle of radius 200 about (0, 200), and the line x = 1.5 + y / 4.
        let circle = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            [200.0 * sin, 200.0 - 200.0 * cos]
        };
        let arc =
            |from: i32| (from..from + 40).map(|i| circle(0.4 * f64::from(i))).collect::<Vec<_>>();
        let (left, mut right) = (arc(-50), arc(10));
        right[5] = [right[5][0], right[5][1] + 3.0];
        let line = |from: i32| (from..from + 40).map(|y| [1.5 + 0.25 * f64::from(y), f64::from(y)]);
        let (above, below): (Vec<_>, Vec<_>) = (line(-55).collect(), line(15).collect());
        let across = Curve::through([1.0, 1.0], &[&left], &[&right]).unwrap();
        let down = Curve::through([1.0, 1.0], &[&above], &[&below]).unwrap();
        let [x, y] = across.meet(&down).unwrap();
        // A quartic follows the circle over +-20 degrees to (x/R)^6 R / 16 = 0.02 at the ends.
        assert!((x * x + (y - 200.0).powi(2) - 4e4).abs() < 400.0 * 2e-3, "{x} {y}");
        assert!((x - 1.5 - 0.25 * y).abs() < 1e-9);
        assert!(across.meet(&across).is_none(), "a line does not cross itself");
    }
}
