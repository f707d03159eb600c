//! Solving F(uv) = st on one branch of the transport.

use super::tally::count_ray;
use crate::transport::{Setup, Step};

/// A solution on a branch, with the Jacobian of F there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solution {
    pub uv: [f64; 2],
    pub jacobian: [[f64; 2]; 2],
}

/// Newton doubles the digits at each step, so a step this small leaves an error of about its square
/// times the branch's curvature: below 1e-12 for any curvature under 1e4.
const STEP: f64 = 1e-8;
/// Newton steps enough from any start that leads somewhere.
pub(super) const ITERATIONS: usize = 12;

/// The solution that Newton's method finds from `start`, F continued along `path`, whose faces it brings up to date.
pub(super) fn solve(
    setup: &Setup,
    path: &mut [Step],
    st: [f64; 2],
    start: [f64; 2],
    iterations: usize,
) -> Option<Solution> {
    let mut uv = start;
    for _ in 0..iterations {
        count_ray();
        let (at, jacobian) = setup.follow_with_jacobian(uv, path);
        let step = apply_inverse(jacobian, [st[0] - at[0], st[1] - at[1]]);
        let length = step[0].abs().max(step[1].abs());
        // NaN: the branch does not reach here. A long way off: this start leads nowhere.
        if !(length < 4.0) {
            return None;
        }
        uv = [uv[0] + step[0], uv[1] + step[1]];
        if length < STEP {
            return Some(Solution { uv, jacobian });
        }
    }
    None
}

/// `jacobian^-1 * v`.
pub(super) fn apply_inverse([[a, b], [c, d]]: [[f64; 2]; 2], v: [f64; 2]) -> [f64; 2] {
    let inverse = 1.0 / (a * d - b * c);
    [(d * v[0] - b * v[1]) * inverse, (a * v[1] - c * v[0]) * inverse]
}

pub(super) fn determinant([[a, b], [c, d]]: [[f64; 2]; 2]) -> f64 {
    a * d - b * c
}
