//! The paper's evaluation, redone: views rendered as a camera would take them through the plate, and measured; the paper's
//! figures are kept beside ours.
//!
//! [`quality`] is its table 1 and figure 8 (likeness of photographs), [`shape`] its figure 7 (displacement of a
//! lattice over the camera's azimuth); [`Evaluation`] holds what both found.

mod csv;
mod evaluation;
mod run;
mod stage;
#[cfg(test)]
mod tests;

pub use evaluation::{
    Displacements, Evaluation, MEASURES, Measure, PUBLISHED_DISPLACEMENT, PUBLISHED_QUALITY,
    Published, Quality, Scores, Shape, ShapeView, Winner, mean, published, surfaces, winner,
};
pub use run::{Photograph, QualityView, Settings, Subject, quality, shape};
pub use stage::PaperError;
