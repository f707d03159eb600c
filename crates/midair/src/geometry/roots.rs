//! Real roots of functions along a ray.

use smallvec::SmallVec;

/// Roots of one polynomial, in their order.
pub(super) type Roots = SmallVec<[f64; 8]>;

/// The real roots of a polynomial (its coefficients from the constant on) within an interval, in their order.
///
/// Between two neighbouring roots of its derivative a polynomial is monotone, so that a change of sign there is one root: none is missed but pairs
/// that rounding cannot tell apart (a ray that touches).
pub(super) fn polynomial_roots(coefficients: &[f64], [low, high]: [f64; 2]) -> Roots {
    let mut roots = Roots::new();
    if coefficients.len() < 2 || !(low < high) {
        return roots;
    }
    if let &[c, slope] = coefficients {
        let x = -c / slope;
        if x >= low && x <= high {
            roots.push(x);
        }
        return roots;
    }
    let derivative: SmallVec<[f64; 8]> =
        coefficients.iter().enumerate().skip(1).map(|(power, c)| power as f64 * c).collect();
    let value = |x: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
    let turns = polynomial_roots(&derivative, [low, high]);
    let mut from = (low, value(low));
    for to in turns.into_iter().chain([high]) {
        let to = (to, value(to));
        if (from.1 > 0.0) != (to.1 > 0.0) {
            roots.push(bracketed_root(value, [from.0, to.0], [from.1, to.1]));
        }
        from = to;
    }
    roots
}

/// A root between two points of opposite signs: Newton-like steps kept within the bracket (Ridders 1979).
pub(super) fn bracketed_root(f: impl Fn(f64) -> f64, bracket: [f64; 2], values: [f64; 2]) -> f64 {
    let ([mut a, mut b], [mut fa, mut fb]) = (bracket, values);
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        let fm = f(middle);
        let root = (fm * fm - fa * fb).sqrt();
        if root == 0.0 {
            return middle;
        }
        let x = middle + (middle - a) * fm / root * (fa - fb).signum();
        let fx = f(x);
        if fx == 0.0 || (b - a).abs() < 1e-13 * (1.0 + a.abs()) {
            return x;
        }
        if (fm > 0.0) != (fx > 0.0) {
            (a, fa, b, fb) = (middle, fm, x, fx);
        } else if (fa > 0.0) != (fx > 0.0) {
            (b, fb) = (x, fx);
        } else {
            (a, fa) = (x, fx);
        }
        if (b - a).abs() < 1e-13 * (1.0 + a.abs()) {
            return 0.5 * (a + b);
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The coefficients of the product of (x - r).
    fn with_roots(roots: &[f64]) -> Vec<f64> {
        let mut c = vec![1.0];
        for r in roots {
            let mut next = vec![0.0; c.len() + 1];
            for (i, value) in c.iter().enumerate() {
                next[i + 1] += value;
                next[i] -= r * value;
            }
            c = next;
        }
        c
    }

    #[test]
    fn known_roots_are_found_within_the_interval_only() {
        let known = [-0.9, -0.25, 0.125, 0.7];
        let c = with_roots(&known);
        let found = polynomial_roots(&c, [-1.0, 1.0]);
        assert_eq!(found.len(), 4);
        for (found, known) in found.iter().zip(known) {
            // Roots a tenth apart: conditioning of a hundred at most.
            assert!((found - known).abs() < 1e-13, "{found} {known}");
        }
        assert_eq!(polynomial_roots(&c, [-0.5, 0.5]).len(), 2);
        assert!(polynomial_roots(&[1.0, 0.0, 1.0], [-9.0, 9.0]).is_empty());
        assert!(polynomial_roots(&[1.0, 0.0], [-9.0, 9.0]).is_empty());
    }
}
