//! What a page holds.

use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::{LineChart, VectorChart, html};
use midair::files::write_bytes_atomically;
use midair::map::format::FileError;
use midair::picture::{Picture, srgb};

/// A page: its title, what it found in a few rows, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// Heading and window title.
    pub title: String,
    /// One sentence under the heading.
    pub lead: String,
    /// The answer, in a few rows.
    pub summary: Vec<SummaryRow>,
    /// Everything else.
    pub sections: Vec<Section>,
    /// The last line: what made the page, from what.
    pub colophon: String,
}

/// One line of the summary.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SummaryRow {
    /// What was measured.
    pub label: String,
    /// What came out, with its unit.
    pub value: String,
    /// What it is to be held against; may be empty.
    pub note: String,
}

/// A part of the page under a heading.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// The heading.
    pub heading: String,
    /// In the order in which they are shown.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// Pictures or charts side by side (below one another where the screen is narrow).
    Figures(Vec<Figure>),
    /// A table.
    Table(Table),
    /// Remarks and assumptions, as a list.
    Notes(Vec<String>),
}

/// A picture with its caption.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What is shown.
    pub image: Image,
    /// The text below it.
    pub caption: String,
}

/// What a figure shows.
#[derive(Clone, Debug, PartialEq)]
pub enum Image {
    /// The bytes of a PNG file.
    Png(Vec<u8>),
    /// Curves over an axis.
    Line(LineChart),
    /// Arrows over a lattice.
    Vectors(VectorChart),
}

/// A table; the first cell of each row is its heading.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The text above it.
    pub caption: String,
    /// Headings above the columns: a row of (text, columns it spans), and further rows below it.
    pub head: Vec<Vec<(String, usize)>>,
    /// Rows of cells, as many as the columns that the headings span.
    pub rows: Vec<Vec<Cell>>,
    /// Rows set apart below the others: means, totals.
    pub foot: Vec<Vec<Cell>>,
}

/// A table's cell.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// Its text.
    pub text: String,
    /// Whether it is the better one of those it is compared with: set in bold.
    pub best: bool,
}

impl Cell {
    /// A cell of text.
    pub fn text(text: impl Into<String>) -> Self {
        Self { text: text.into(), best: false }
    }

    /// A number to so many decimals; a dash where there is none or it is not finite.
    pub fn number(value: Option<f64>, decimals: usize) -> Self {
        let shown = value.filter(|value| value.is_finite());
        // -0.000 is 0.000.
        let text = shown.map_or("–".to_owned(), |value| {
            let text = format!("{value:.decimals$}");
            let zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
            if zero { text.replace('-', "") } else { text.replace('-', "−") }
        });
        Self::text(text)
    }

    /// The same cell, marked as the better one.
    pub fn best(self) -> Self {
        Self { best: true, ..self }
    }
}

/// A picture that cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// PNG has no pictures without pixels, nor with more than it counts.
    #[error("a picture of {width} x {height} pixels cannot be written as PNG: {problem}")]
    Encoding {
        /// Its width.
        width: usize,
        /// Its height.
        height: usize,
        /// What the encoder says.
        problem: String,
    },
}

impl Figure {
    /// A picture as a screen shows it (sRGB, 8 bits, over black), with its caption.
    ///
    /// # Errors
    /// When the picture has no pixels or too many.
    pub fn picture(picture: &Picture, caption: impl Into<String>) -> Result<Self, FigureError> {
        Ok(Self { image: Image::Png(png(picture)?), caption: caption.into() })
    }
}

/// The bytes of an 8-bit sRGB PNG file of a picture over black.
pub(crate) fn png(picture: &Picture) -> Result<Vec<u8>, FigureError> {
    let (width, height) = (picture.width, picture.height);
    let wrong = |problem: String| FigureError::Encoding { width, height, problem };
    if width == 0 || height == 0 || picture.pixels.len() != width * height {
        return Err(wrong("it has no pixels, or not as many as its size says".to_owned()));
    }
    let size = |pixels: usize| u32::try_from(pixels).map_err(|error| wrong(error.to_string()));
    let codes: Vec<[u8; 3]> =
        picture.pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(srgb::encode_8)).collect();
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(codes.as_flattened(), size(width)?, size(height)?, ExtendedColorType::Rgb8)
        .map_err(|error| wrong(error.to_string()))?;
    Ok(bytes)
}

impl Page {
    /// The page as one HTML document.
    pub fn to_html(&self) -> String {
        html::document(self)
    }

    /// Writes the page; the file is there whole or not at all.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write_atomically(&self, path: &Path) -> Result<(), FileError> {
        write_bytes_atomically(path, self.to_html().as_bytes())
    }
}
