//! A rectangle of the image that is inverted on its own.

use super::newton::apply_inverse;
use super::tally::count_ray;
use crate::transport::{End, Path, Setup};

/// Solutions this close to a cell count as its own: far more than what they err, far less than a pixel.
const SEAM: f64 = 1e-9;

/// A rectangle of image coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Cell {
    pub fn centre(&self) -> [f64; 2] {
        [0, 1].map(|axis| 0.5 * (self.low[axis] + self.high[axis]))
    }

    /// The four quarters, in the order of `corners`.
    pub fn quarters(&self) -> [Self; 4] {
        let centre = self.centre();
        let ([a, b], [c, d], [x, y]) = (self.low, self.high, centre);
        [
            Self { low: [a, b], high: [x, y] },
            Self { low: [x, b], high: [c, y] },
            Self { low: [a, y], high: [x, d] },
            Self { low: [x, y], high: [c, d] },
        ]
    }

    /// The image points that the cell answers for, lower left and upper right: its own and those within `margin` of it, so that no
    /// rounding leaves a seam between cells, but none beyond the image's edge.
    pub fn claimed(&self, margin: f64) -> [[f64; 2]; 2] {
        [
            self.low.map(|c| if c > 0.0 { c - margin } else { c }),
            self.high.map(|c| if c < 1.0 { c + margin } else { c }),
        ]
    }

    /// Whether a solution belongs to the cell: see [`Cell::claimed`].
    pub fn claims(&self, uv: [f64; 2]) -> bool {
        let [low, high] = self.claimed(SEAM);
        (0..2).all(|axis| uv[axis] >= low[axis] && uv[axis] <= high[axis])
    }

    /// Whether a point lies in the cell or within `margin` of it.
    pub fn holds(&self, uv: [f64; 2], margin: f64) -> bool {
        (0..2)
            .all(|axis| uv[axis] >= self.low[axis] - margin && uv[axis] <= self.high[axis] + margin)
    }

    /// The cell's point nearest to another.
    pub fn nearest(&self, uv: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| uv[axis].clamp(self.low[axis], self.high[axis]))
    }

    /// The longer side.
    pub fn extent(&self) -> f64 {
        (self.high[0] - self.low[0]).max(self.high[1] - self.low[1])
    }
}

/// F at one image point.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    pub uv: [f64; 2],
    pub end: End,
    pub path: Path,
}

impl Sample {
    pub fn take(setup: &Setup, uv: [f64; 2]) -> Self {
        let mut path = Path::new();
        count_ray();
        let end = setup.transport(uv, &mut path);
        Self { uv, end, path }
    }

    /// Whether its light reaches the display's plane, through the plate or past its edge.
    pub fn arrives(&self) -> Option<([f64; 2], bool)> {
        match self.end {
            End::Display { st, through_plate } => Some((st, through_plate)),
            _ => None,
        }
    }

    /// Whether it is the solution that it was traced from: its light arrives at the solution's place `st`, to a hundred times what
    /// Newton's method leaves. Where F is so steep that rounding alone leaves more (`jacobian` tells), it is enough to be exact to a tenth
    /// of the tolerance in the image, and within a hundredth of a pixel (`pixel` is its size in st) on the display.
    pub fn reaches(&self, st: [f64; 2], jacobian: [[f64; 2]; 2], pixel: [f64; 2]) -> bool {
        const EXACT: f64 = 1e-9;
        let Some((at, _)) = self.arrives() else { return false };
        let off = [at[0] - st[0], at[1] - st[1]];
        let in_image = apply_inverse(jacobian, off);
        off[0].hypot(off[1]) < EXACT
            || in_image[0].hypot(in_image[1]) < 1e-7
                && (0..2).all(|axis| off[axis].abs() < 0.01 * pixel[axis])
    }

    /// Whether both lie on the same branch. Light that does not arrive has its branches, too: between two of them there may be
    /// one that arrives.
    pub fn same_branch(&self, other: &Self) -> bool {
        let ends_alike = match (self.arrives(), other.arrives()) {
            (Some((_, a)), Some((_, b))) => a == b,
            (None, None) => self.end == other.end,
            _ => false,
        };
        ends_alike && self.path == other.path
    }
}
