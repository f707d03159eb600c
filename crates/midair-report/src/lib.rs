//! What midair finds, as pictures and pages for people: nothing is computed here but how it looks.
//!
//! [`page`] is a page that stands on its own, with charts, tables and pictures; [`drawing`] makes pictures with legends and
//! scales; [`paper`] sets the paper's evaluation into its layout.

pub mod drawing;
pub mod page;
pub mod paper;

pub use midair::evaluate::percent;
