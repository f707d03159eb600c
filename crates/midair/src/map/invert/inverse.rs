//! G as what it was found to be, before it is sampled.

use super::dense::solve_densely;
use super::fill::Answers;
use super::pixels::Raster;
use super::plan::plan;
use super::row::Row;
use super::{Accuracy, Effort};
use crate::map::{Map, Status};
use crate::transport::Setup;

/// G on the display as polynomials and single pixels, to be sampled row by row: for those who want each row once and in a form
/// of their own, and no [`Map`] in memory.
#[derive(Debug)]
pub struct Inverse {
    raster: Raster,
    found: Found,
    effort: Effort,
}

#[derive(Debug)]
enum Found {
    Answers(Answers),
    /// Seen through a mesh each pixel is solved by itself: what is found is a map.
    Map(Map),
}

/// Working memory of [`Inverse::rows`], to be kept from call to call.
#[derive(Clone, Debug, Default)]
pub struct RowScratch {
    uv: Vec<[f64; 2]>,
    status: Vec<Status>,
}

impl Inverse {
    /// Finds G on the pixels of the set-up's display.
    pub fn new(setup: &Setup, accuracy: Accuracy) -> Self {
        let [width, height] = setup.resolution;
        let raster = Raster { width, height };
        let (leaves, rays) = plan(setup, raster, accuracy.tolerance);
        match leaves {
            Some(leaves) => {
                let answers = Answers::new(leaves, raster);
                let effort = answers.effort(rays);
                Self { raster, found: Found::Answers(answers), effort }
            }
            None => {
                let mut map = Map::unanswered(width, height);
                let (solved_pixels, dense) = solve_densely(setup, raster, &mut map);
                let effort = Effort { patches: 0, solved_pixels, rays: rays + dense };
                Self { raster, found: Found::Map(map), effort }
            }
        }
    }

    /// Width and height of the display, in pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.raster.width, self.raster.height]
    }

    /// What it took.
    pub fn effort(&self) -> Effort {
        self.effort
    }

    /// Image coordinates of whole rows of pixels, as in [`Map::uv`]: `count` rows from row `first` (0 at the top) on, which the
    /// display must have.
    pub fn rows<'a>(
        &'a self,
        first: usize,
        count: usize,
        scratch: &'a mut RowScratch,
    ) -> &'a [[f64; 2]] {
        let (start, pixels) = (first * self.raster.width, count * self.raster.width);
        match &self.found {
            Found::Map(map) => &map.uv[start..start + pixels],
            Found::Answers(answers) => {
                scratch.uv.resize(pixels, [0.0; 2]);
                scratch.status.resize(pixels, Status::Outside);
                answers.enter(first, Row { uv: &mut scratch.uv, status: &mut scratch.status });
                &scratch.uv
            }
        }
    }
}
