//! The map by adaptive inversion with an error bound.
//!
//! The image is cut into cells. On a cell where F is one smooth branch without a fold, the exact
//! inverse is found at Chebyshev nodes of the display rectangle that the cell fills (Newton's
//! method with the derivatives that dual numbers carry), and a polynomial through them answers for
//! all pixels of the rectangle whose image point lies in the cell; residuals of F between the nodes bound
//! its error. Cells that a border or a fold cuts are halved down to a few pixels, and their
//! pixels solved one by one on every branch that reaches them. Each image point belongs to exactly one cell, so
//! counting a pixel's answers tells the folded ones.

mod between;
mod cell;
mod dense;
mod fill;
mod inverse;
mod newton;
mod patch;
mod pixels;
mod plan;
mod pursuit;
mod row;
mod survey;
mod tally;
#[cfg(test)]
mod tests;

use cell::Cell;
use dense::solve_densely;
use fill::Answers;
use pixels::Raster;
use plan::plan;

pub use inverse::{Inverse, InverseRows};
pub(crate) use newton::apply_inverse;

use super::{Map, Status};
use crate::transport::Setup;

/// How finely a map is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Largest |uv - exact| that is accepted.
    pub tolerance: f64,
}

impl Default for Accuracy {
    /// 1e-6: a thousandth of a pixel of a 1024-pixel image.
    fn default() -> Self {
        Self { tolerance: 1e-6 }
    }
}

/// What the inversion did.
#[derive(Clone, Copy, Debug, PartialEq, Default, serde::Serialize)]
pub struct Effort {
    /// Polynomial patches.
    pub patches: usize,
    /// Pixels solved one by one.
    pub solved_pixels: usize,
    #[serde(skip)]
    /// Rays traced: points of the image at which F, with or without its derivatives, was worked out.
    pub rays: u64,
}

/// G on the display's pixels.
pub fn invert(setup: &Setup, accuracy: Accuracy) -> (Map, Effort) {
    let [width, height] = setup.resolution;
    // Zeroed memory is handed out untouched: the threads that fill the map touch it first, each its own part.
    let mut map = Map {
        width,
        height,
        uv: vec![[0.0; 2]; width * height],
        status: vec![Status::Outside; width * height],
        error_bound: 0.0,
    };
    let effort = invert_into(setup, accuracy, &mut map);
    (map, effort)
}

/// [`invert`] into a map that is already there, of any size: its memory is used again.
pub fn invert_into(setup: &Setup, accuracy: Accuracy, map: &mut Map) -> Effort {
    let raster = Raster { width: map.width, height: map.height };
    let (pieces, rays) = plan(setup, raster, accuracy.tolerance);
    let Some(pieces) = pieces else {
        let (solved_pixels, dense) = solve_densely(setup, raster, map);
        return Effort { patches: 0, solved_pixels, rays: rays + dense };
    };
    let answers = Answers::new(pieces, raster);
    answers.fill(map);
    answers.effort(rays)
}
