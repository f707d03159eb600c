//! A page that shows what was found: one HTML file that stands on its own.
//!
//! A [`Page`] is plain data: rows of a summary, then sections of text, pictures, charts, tables
//! and notes. [`Page::to_html`] sets it for screens and paper, large and small, light and dark, with
//! every picture inside the file and nothing loaded from elsewhere. All text is escaped.

mod chart;
mod html;
mod model;
#[cfg(test)]
mod tests;
mod vectors;

pub use chart::{LineChart, Series};
pub(crate) use html::escaped;
pub use model::{Block, Cell, Figure, FigureError, Image, Page, Section, SummaryRow, Table};
pub use vectors::VectorChart;
