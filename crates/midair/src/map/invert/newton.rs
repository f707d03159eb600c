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
/// No start that leads somewhere is further off than this, in images.
const FAR: f64 = 4.0;
/// What rounding makes of places along a path, mm: those of a metre are known to 2^-53 of it, 1e-13 mm, and a hundred operations
/// lead from one end to the other.
const ROUNDING: f64 = 1e-11;
/// Where F is steepest (beside grazing rays) its rounding keeps steps from getting smaller than about this.
const NOISE: f64 = 1e-7;
/// Newton steps enough from any start that leads somewhere.
const ITERATIONS: usize = 24;

/// The solution that Newton's method finds from `start`, F continued along `path`, whose faces it brings up to date.
///
/// The start was extrapolated from a point `near` it, where F exists: nearer to that it exists as well, should it not do so at the
/// start.
pub(super) fn solve(
    setup: &Setup,
    path: &mut [Step],
    st: [f64; 2],
    start: [f64; 2],
    near: [f64; 2],
) -> Option<Solution> {
    let mut uv = start;
    let mut last = [start[0] - near[0], start[1] - near[1]];
    let mut jacobian = None;
    for _ in 0..ITERATIONS {
        count_ray();
        let (at, here) = setup.follow_with_jacobian(uv, path);
        let step = apply_inverse(here, [st[0] - at[0], st[1] - at[1]]);
        let length = step[0].abs().max(step[1].abs());
        if !(length < FAR) {
            // The branch does not reach here, or nearly ends: half as far may do.
            last = last.map(|c| 0.5 * c);
            if !(last[0].abs().max(last[1].abs()) > 0.0) {
                return None;
            }
            uv = [uv[0] - last[0], uv[1] - last[1]];
            jacobian = None;
            continue;
        }
        uv = [uv[0] + step[0], uv[1] + step[1]];
        if length < STEP {
            return Some(Solution { uv, jacobian: here });
        }
        last = step;
        jacobian = (length < NOISE).then_some(here);
    }
    jacobian.map(|jacobian| Solution { uv, jacobian })
}

impl Solution {
    /// A guess for the image point of another place nearby.
    pub fn towards(&self, from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
        let step = apply_inverse(self.jacobian, [to[0] - from[0], to[1] - from[1]]);
        [self.uv[0] + step[0], self.uv[1] + step[1]]
    }

    /// Whether it is a point of the image.
    pub fn in_image(&self) -> bool {
        self.uv.iter().all(|c| (0.0..=1.0).contains(c))
    }

    /// How far it is from exact: the residual of F there, through the inverse Jacobian, and what rounding may hide of it.
    pub fn error(&self, setup: &Setup, path: &mut [Step], st: [f64; 2]) -> f64 {
        count_ray();
        let at = setup.follow(self.uv, path);
        let left = apply_inverse(self.jacobian, [at[0] - st[0], at[1] - st[1]]);
        // Rounding at the display, seen from the image, and at the image itself.
        let [width, height] = setup.display.size.map(|mm| ROUNDING / mm);
        let hidden = [[width, 0.0], [0.0, height]].map(|off| apply_inverse(self.jacobian, off));
        let at_image = ROUNDING / setup.image.size[0].min(setup.image.size[1]);
        let length = |v: [f64; 2]| v[0].hypot(v[1]);
        length(left) + length(hidden[0]) + length(hidden[1]) + at_image
    }
}

/// `jacobian^-1 * v`.
pub(crate) fn apply_inverse([[a, b], [c, d]]: [[f64; 2]; 2], v: [f64; 2]) -> [f64; 2] {
    let inverse = 1.0 / (a * d - b * c);
    [(d * v[0] - b * v[1]) * inverse, (a * v[1] - c * v[0]) * inverse]
}

pub(super) fn determinant([[a, b], [c, d]]: [[f64; 2]; 2]) -> f64 {
    a * d - b * c
}
