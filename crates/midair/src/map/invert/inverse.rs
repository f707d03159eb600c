//! G as what it was found to be, before it is sampled.

use super::dense::solve_densely;
use super::fill::Answers;
use super::pixels::Raster;
use super::plan::plan;
use super::row::Row;
use super::{Accuracy, Effort};
use crate::map::{Map, Status};
use crate::transport::Setup;
use std::ops::Range;

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

/// Some rows of an inverse and the memory that they take, to be kept from one [`Inverse::sample`] to the next.
#[derive(Clone, Debug, Default)]
pub struct InverseRows {
    rows: Range<usize>,
    uv: Vec<[f64; 2]>,
    status: Vec<Status>,
}

impl InverseRows {
    /// Which rows they are.
    pub fn range(&self) -> Range<usize> {
        self.rows.clone()
    }
}

impl Inverse {
    /// One whose answers are made up.
    #[cfg(test)]
    pub fn of_map(map: Map) -> Self {
        let raster = Raster { width: map.width, height: map.height };
        let effort = Effort { patches: 0, solved_pixels: 0, rays: 0 };
        Self { raster, found: Found::Map(map), effort }
    }

    /// Finds G on the pixels of the set-up's display.
    pub fn new(setup: &Setup, accuracy: Accuracy) -> Self {
        let [width, height] = setup.resolution;
        let raster = Raster { width, height };
        let (pieces, rays) = plan(setup, raster, accuracy.tolerance);
        match pieces {
            Some(pieces) => {
                let answers = Answers::new(pieces, raster);
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

    /// Works whole rows of pixels out (0 at the top), which the display must have.
    pub fn sample(&self, rows: Range<usize>, into: &mut InverseRows) {
        if let Found::Answers(answers) = &self.found {
            let pixels = rows.len() * self.raster.width;
            // Memory only grows: what is there is written over.
            if into.uv.len() < pixels {
                into.uv.resize(pixels, [0.0; 2]);
                into.status.resize(pixels, Status::Outside);
            }
            let (uv, status) = (&mut into.uv[..pixels], &mut into.status[..pixels]);
            answers.enter(rows.start, Row { uv, status });
        }
        into.rows = rows;
    }

    /// Image coordinates of rows that this inverse [`sample`](Self::sample)d, as in [`Map::uv`].
    pub fn uv<'a>(&'a self, rows: &'a InverseRows) -> &'a [[f64; 2]] {
        match &self.found {
            Found::Answers(_) => &rows.uv[..rows.rows.len() * self.raster.width],
            Found::Map(map) => &map.uv[rows.rows.start * map.width..rows.rows.end * map.width],
        }
    }
}
