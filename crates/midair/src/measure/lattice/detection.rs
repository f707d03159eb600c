//! Finding the intersections of a lattice in a picture.

use super::super::Plane;
use super::graph::trace_lines;
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
    /// It lies where none of its neighbours would have it: its name is in doubt.
    #[error("it is not where its neighbours would have it")]
    Stranger,
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
    let mut best: Option<((usize, usize, usize), Lattice)> = None;
    let mut partial: Option<Joined> = None;
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
        if (joined.columns, joined.rows) == (lines, lines) {
            let measurement = Measurement { picture, nodes: &nodes, scale, sigma };
            let lattice = measured(&measurement, &joined, lines);
            let found = lattice.found();
            // Names are without doubt in one piece; among searches that saw as much, the one that can be measured best.
            let (largest, crossings) = joined.rank();
            let rank = (largest, crossings, found);
            if best.as_ref().is_none_or(|(other, _)| rank > *other) {
                best = Some((rank, lattice));
            }
            if found == lines * lines {
                break;
            }
        } else if partial.as_ref().is_none_or(|other| joined.rank() > other.rank()) {
            partial = Some(joined);
        }
    }
    if let Some((_, lattice)) = best {
        return Ok(lattice);
    }
    if let Some((columns, rows)) = crowded {
        return Err(LatticeError::TooMany { columns, rows, lines });
    }
    let joined = partial.ok_or(LatticeError::NoLattice)?;
    let nodes = joined.crossings();
    let Joined { columns, rows, left_over, .. } = joined;
    Err(LatticeError::Partial { columns, rows, lines, nodes, left_over })
}

/// Each piece by itself: lines end where they are cut.
fn measured(measurement: &Measurement, joined: &Joined, lines: usize) -> Lattice {
    let mut parts = joined.pieces.iter().map(|piece| measurement.lattice(piece, lines));
    let empty = || Lattice {
        lines,
        intersections: vec![Err(Missing::NotSeen); lines * lines],
        line_width: 0.0,
    };
    let mut lattice = parts.next().unwrap_or_else(empty);
    for part in parts {
        for (found, other) in lattice.intersections.iter_mut().zip(part.intersections) {
            if matches!(found, Err(Missing::NotSeen)) {
                *found = other;
            }
        }
    }
    drop_strangers(&mut lattice);
    lattice
}

/// Crossings further than this share of a step from where all of their neighbours would have them are misnamed: a cut displaces
/// them from the neighbours beyond it only.
const STRANGE: f64 = 0.6;

/// Takes out crossings that no two neighbours in a row confirm; two lines have no such neighbours.
fn drop_strangers(lattice: &mut Lattice) {
    let lines = lattice.lines as isize;
    if lines < 3 {
        return;
    }
    let points = lattice.points();
    let at = |column: isize, row: isize| {
        let inside = (0..lines).contains(&column) && (0..lines).contains(&row);
        if inside { points[(row * lines + column) as usize] } else { None }
    };
    for (index, found) in lattice.intersections.iter_mut().enumerate() {
        let Ok([x, y]) = *found else { continue };
        let (column, row) = (index as isize % lines, index as isize / lines);
        let confirms = |(dc, dr): (isize, isize)| {
            let (near, far) = (at(column + dc, row + dr)?, at(column + 2 * dc, row + 2 * dr)?);
            let [sx, sy] = [near[0] - far[0], near[1] - far[1]];
            let off = (near[0] + sx - x).hypot(near[1] + sy - y);
            Some(off <= STRANGE * sx.hypot(sy))
        };
        let mut told =
            [(1, 0), (0, 1), (-1, 0), (0, -1)].into_iter().filter_map(confirms).peekable();
        if told.peek().is_some() && !told.any(|confirmed| confirmed) {
            *found = Err(Missing::Stranger);
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misnamed_crossing_is_taken_out_and_its_neighbours_are_not() {
        // Bent by a parabola, so that no neighbour's prediction is exact.
        let place = |i: usize| {
            let (column, row) = ((i % 4) as f64, (i / 4) as f64);
            [40.0 * column + row * row, 40.0 * row - 2.0 * column * column]
        };
        let mut intersections: Vec<_> = (0..16).map(|i| Ok(place(i))).collect();
        let mut lattice =
            Lattice { lines: 4, intersections: intersections.clone(), line_width: 3.0 };
        drop_strangers(&mut lattice);
        assert_eq!(lattice.intersections, intersections);
        // Named as the one a column further to the right.
        lattice.intersections[5] = Ok(place(6));
        drop_strangers(&mut lattice);
        intersections[5] = Err(Missing::Stranger);
        assert_eq!(lattice.intersections, intersections);
    }
}
