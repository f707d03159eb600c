//! The paper's evaluation, redone: views rendered as a camera would take them through the plate, measured, and set into the
//! paper's layout with its figures beside ours.
//!
//! [`quality`] is its table 1 and figure 8 (likeness of photographs), [`shape`] its figure 7 (displacement of a
//! lattice over the camera's azimuth); [`Evaluation`] holds what both found and makes the page.

mod run;
mod stage;
mod tables;
#[cfg(test)]
mod tests;

pub use run::{Photograph, QualityView, Settings, Subject, quality, shape};
pub use stage::PaperError;
pub use tables::{
    Evaluation, PUBLISHED_DISPLACEMENT, PUBLISHED_QUALITY, Published, Quality, Scores, Shape,
    ShapeView, StripError, Winner, quality_table, shape_chart, shape_table, strip,
};
