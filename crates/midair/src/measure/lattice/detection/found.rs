//! A lattice that was found, crossing by crossing, and why one was not.

use super::super::graph::distance;
use super::super::ordering::Piece;
use serde::Serialize;

/// How many lines a lattice has each way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct Count {
    /// Lines that run down.
    pub columns: usize,
    /// Lines that run across.
    pub rows: usize,
}

impl Count {
    /// Intersections in all.
    pub fn intersections(self) -> usize {
        self.columns * self.rows
    }

    pub(super) fn holds(self, piece: &Piece) -> bool {
        piece.columns <= self.columns && piece.rows <= self.rows
    }
}

impl From<usize> for Count {
    fn from(lines: usize) -> Self {
        Self { columns: lines, rows: lines }
    }
}

impl std::fmt::Display for Count {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} x {}", self.columns, self.rows)
    }
}

/// A lattice found in a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Lines in each direction.
    pub count: Count,
    /// The intersections row by row from the top left, in pixels from the picture's
    /// top left corner (x right, y down); a missing one says why.
    pub intersections: Vec<Result<[f64; 2], Missing>>,
    /// The lines' full width at half height, pixels.
    pub line_width: f64,
    /// Crossings seen beside it that no line joins to the rest: which ones they are cannot be told, and they are left out.
    pub left_out: usize,
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

    /// The median distance from line to line, pixels; `None` where no two neighbours were found.
    pub fn spacing(&self) -> Option<f64> {
        let (points, columns) = (self.points(), self.count.columns);
        let step = |at: usize, by: usize| Some(distance(points[at]?, (*points.get(at + by)?)?));
        let right = |at: usize| if at % columns + 1 < columns { step(at, 1) } else { None };
        let mut steps: Vec<f64> =
            (0..points.len()).flat_map(|at| [right(at), step(at, columns)]).flatten().collect();
        let middle = steps.len() / 2;
        let steps =
            (!steps.is_empty()).then(|| steps.select_nth_unstable_by(middle, f64::total_cmp));
        steps.map(|(_, &mut median, _)| median)
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
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// Fewer than two lines were asked for.
    #[error("a lattice has at least 2 lines each way; {count} were asked for")]
    TooFewLines {
        /// Lines asked for.
        count: Count,
    },
    /// The picture is too small to hold it.
    #[error("a picture of {width} x {height} pixels is too small for {count} lines")]
    TooSmall {
        /// Picture width.
        width: usize,
        /// Picture height.
        height: usize,
        /// Lines asked for.
        count: Count,
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
    /// Lines cross, but no crossing can be located.
    #[error(
        "{crossings} crossings of a lattice are seen, and none of them can be measured: lines are {line_width:.0} pixels wide, \
         too wide for their distance, too faint or too ragged"
    )]
    NothingMeasured {
        /// Crossings seen.
        crossings: usize,
        /// The lines' full width at half height, pixels.
        line_width: f64,
    },
    /// Fewer lines than asked for: which ones are missing cannot be told.
    #[error(
        "only {seen} joined lines of a {count} lattice are seen ({crossings} crossings{}): which ones they are cannot be told",
        beside(*left_out)
    )]
    Partial {
        /// Lines seen, of the largest piece.
        seen: Count,
        /// Lines asked for.
        count: Count,
        /// Crossings seen in it.
        crossings: usize,
        /// Crossings seen beside it that no line joins to it.
        left_out: usize,
    },
    /// More lines than asked for: which ones do not belong cannot be told.
    #[error(
        "{seen} joined lines are seen where {count} were asked for: \
         a doubled image, another pattern, or another count of lines"
    )]
    TooMany {
        /// Lines seen.
        seen: Count,
        /// Lines asked for.
        count: Count,
    },
}

fn beside(left_out: usize) -> String {
    match left_out {
        0 => String::new(),
        more => format!(", and {more} more that no line joins to them"),
    }
}
