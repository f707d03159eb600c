//! Finding the intersections of a lattice in a picture.

use super::super::Plane;
use super::graph::{Node, trace_lines};
use super::joining::{Joined, join};
use super::measurement::Measurement;
use super::ordering::pieces;
use super::ridge::RidgeField;

/// A lattice found in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Lines in each direction.
    pub lines: usize,
    /// `lines * lines` intersections row by row from the top left, in pixels from the picture's
    /// top left corner (x right, y down); a missing one says why.
    pub intersections: Vec<Result<[f64; 2], Missing>>,
    /// The lines' full width at half height, pixels.
    pub line_width: f64,
}

impl Lattice {
    /// The intersections with None for missing ones, in the same order.
    pub fn points(&self) -> Vec<Option<[f64; 2]>> {
        self.intersections.iter().map(|found| found.as_ref().ok().copied()).collect()
    }

    /// How many intersections were found.
    pub fn found(&self) -> usize {
        self.intersections.iter().filter(|found| found.is_ok()).count()
    }
}

/// Why an intersection of a lattice that was found is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
pub enum Missing {
    /// Nothing that two lines cross at is seen there, or it is cut off from the others.
    #[error("no crossing joined to the rest is seen there")]
    NotSeen,
    /// One of the two lines is too short or too faint there to be measured.
    #[error("one of the two lines is too short or too faint there")]
    LineTooShort,
    /// The measured places of a line do not lie on a smooth curve: it is broken or doubled there.
    #[error("a line is broken or doubled there")]
    Broken,
}

/// Why no lattice was found.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LatticeError {
    /// Fewer than two lines were asked for.
    #[error("a lattice has at least 2 lines each way; {lines} were asked for")]
    TooFewLines {
        /// Lines asked for.
        lines: usize,
    },
    /// The picture is too small to hold it.
    #[error("a picture of {width} x {height} pixels is too small for {lines} lines each way")]
    TooSmall {
        /// Picture width.
        width: usize,
        /// Picture height.
        height: usize,
        /// Lines asked for.
        lines: usize,
    },
    /// A value is NaN or infinite.
    #[error("the picture holds a value that is not a number, at column {column}, row {row}")]
    NotFinite {
        /// Column of the first such pixel.
        column: usize,
        /// Row of the first such pixel, from the top.
        row: usize,
    },
    /// No crossing lines at all.
    #[error(
        "no lattice is seen: bright lines that cross, on a darker ground, were looked for \
         (for dark lines on a bright ground, invert the picture)"
    )]
    NoLattice,
    /// Fewer lines than asked for: which ones are missing cannot be told.
    #[error(
        "only {columns} x {rows} joined lines of a {lines} x {lines} lattice are seen ({nodes} crossings\
         {}): show all of it, in focus and evenly lit, or ask for another count of lines",
        beside(*left_over)
    )]
    Partial {
        /// Vertical lines seen.
        columns: usize,
        /// Horizontal lines seen.
        rows: usize,
        /// Lines asked for.
        lines: usize,
        /// Crossings seen.
        nodes: usize,
        /// Pieces seen beside it of which it cannot be told where they belong.
        left_over: usize,
    },
    /// More lines than asked for: which ones do not belong cannot be told.
    #[error(
        "{columns} x {rows} joined lines are seen where {lines} x {lines} were asked for: \
         a doubled image, another pattern, or another count of lines"
    )]
    TooMany {
        /// Vertical lines seen.
        columns: usize,
        /// Horizontal lines seen.
        rows: usize,
        /// Lines asked for.
        lines: usize,
    },
}

fn beside(left_over: usize) -> String {
    match left_over {
        0 => String::new(),
        1 => "; where another piece belongs cannot be told".to_owned(),
        more => format!("; where {more} other pieces belong cannot be told"),
    }
}

/// Pictures are searched at no more than this many pixels on the longer side, and measured at
/// full resolution.
const SEARCH_SIZE: usize = 800;
/// Scales of the search, in pixels of the searched picture, the likeliest first. Crossings are
/// seen when sigma is between a third of the line's width and about twice it: 1 to 15 pixels in all.
const SCALES: [f64; 4] = [2.0, 3.2, 1.2, 5.0];

/// Finds the `lines` x `lines` intersections of a lattice of bright lines.
///
/// Ridges are traced from crossing to crossing, so the lattice may be turned by up to 45 degrees,
/// seen in perspective, bent and unevenly lit; every crossing is then measured at full resolution
/// from the centres of the two lines on all sides of it. Rows and columns are told from one
/// another by which lines join, not by where they are; where an edge (of a glass cube, say) cuts the lattice into
/// pieces, they are put together if that can be done in one way only. Values in linear light
/// ([`Plane::luminance`]) are located best; a picture of dark lines is measured as
/// [`Plane::inverted`].
///
/// # Errors
/// When no lattice is seen, or when more or fewer lines are seen than asked for, so that naming the
/// crossings would be a guess.
pub fn detect(picture: &Plane, lines: usize) -> Result<Lattice, LatticeError> {
    check(picture, lines)?;
    let mut searched = std::borrow::Cow::Borrowed(picture);
    let mut scale = 1.0;
    while searched.width.max(searched.height) > SEARCH_SIZE {
        searched = std::borrow::Cow::Owned(halved(&searched));
        scale *= 2.0;
    }
    let mut best: Option<(Vec<Node>, Joined, f64)> = None;
    let mut crowded = None;
    for sigma in SCALES {
        let nodes = trace_lines(&RidgeField::new(&searched, sigma));
        let pieces = pieces(&nodes);
        if let Some(piece) = pieces.first()
            && (piece.columns > lines || piece.rows > lines)
        {
            crowded = crowded.or(Some((piece.columns, piece.rows)));
            continue;
        }
        let Some(joined) = join(&nodes, pieces, lines) else { continue };
        let complete = joined.crossings() == lines * lines;
        if best.as_ref().is_none_or(|(_, other, _)| joined.rank(lines) > other.rank(lines)) {
            best = Some((nodes, joined, sigma));
        }
        if complete {
            break;
        }
    }
    let Some((nodes, joined, sigma)) = best else {
        let (columns, rows) = crowded.ok_or(LatticeError::NoLattice)?;
        return Err(LatticeError::TooMany { columns, rows, lines });
    };
    if (joined.columns, joined.rows) != (lines, lines) {
        if let Some((columns, rows)) = crowded {
            return Err(LatticeError::TooMany { columns, rows, lines });
        }
        let Joined { columns, rows, left_over, .. } = joined;
        return Err(LatticeError::Partial {
            columns,
            rows,
            lines,
            nodes: joined.crossings(),
            left_over,
        });
    }
    let measurement = Measurement { picture, nodes: &nodes, scale, sigma };
    // Each piece by itself: lines end where they are cut.
    let mut parts = joined.pieces.iter().map(|piece| measurement.lattice(piece, lines));
    let mut lattice = parts.next().ok_or(LatticeError::NoLattice)?;
    for part in parts {
        for (found, other) in lattice.intersections.iter_mut().zip(part.intersections) {
            if matches!(found, Err(Missing::NotSeen)) {
                *found = other;
            }
        }
    }
    Ok(lattice)
}

fn check(picture: &Plane, lines: usize) -> Result<(), LatticeError> {
    if lines < 2 {
        return Err(LatticeError::TooFewLines { lines });
    }
    let (width, height) = (picture.width, picture.height);
    // A line, its neighbour and a gap on either side need some eight pixels.
    if width.min(height) < 8 * lines || picture.values.len() != width * height {
        return Err(LatticeError::TooSmall { width, height, lines });
    }
    match picture.values.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(LatticeError::NotFinite { column: at % width, row: at / width }),
        None => Ok(()),
    }
}

/// Each 2 x 2 pixels' mean; an odd last row or column is left out.
fn halved(picture: &Plane) -> Plane {
    Plane::from_fn(picture.width / 2, picture.height / 2, |column, row| {
        let (c, r) = (2 * column, 2 * row);
        let upper = picture.at(c, r) + picture.at(c + 1, r);
        0.25 * (upper + picture.at(c, r + 1) + picture.at(c + 1, r + 1))
    })
}
