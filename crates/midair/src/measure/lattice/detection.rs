//! Finding the intersections of a lattice in a picture.

mod found;

use super::super::Plane;
use super::graph::{FAINTEST_RIDGE, WEAKEST_RIDGE, distance, trace_lines};
use super::measurement::Measurement;
use super::ordering::pieces;
use super::ridge::RidgeField;
pub use found::{Count, Lattice, LatticeError, Missing};
use std::borrow::Cow;

/// Pictures are searched at no more than this many pixels on the longer side, and measured at
/// full resolution.
const SEARCH_SIZE: usize = 800;
/// Scales of the search, in pixels of the searched picture, the likeliest first. Crossings are
/// seen when sigma is between a third of the line's width and about twice it: 1 to 24 pixels in all.
const SCALES: [f64; 5] = [2.0, 3.2, 1.2, 5.0, 8.0];

/// Finds the intersections of a lattice of so many bright lines.
///
/// Ridges are traced from crossing to crossing, so the lattice may be turned by up to 45 degrees,
/// seen in perspective, bent and unevenly lit; every crossing is then measured at full resolution
/// from the centres of the two lines on all sides of it. Rows and columns are told from one
/// another by which lines join, not by where they are. Where an edge (of a glass cube, say) cuts the lattice, what no line joins to the
/// rest is left out: behind an edge columns may be missing, seen twice or in another order, so that its place in the
/// lattice would be a guess. [`detect_at`] names it by where it is expected. Values in linear light
/// ([`Plane::luminance`]) are located best; a picture of dark lines is measured as
/// [`Plane::inverted`].
///
/// # Errors
/// When no lattice is seen, when more or fewer joined lines are seen than asked for, so that naming the
/// crossings would be a guess, or when none can be measured.
pub fn detect(picture: &Plane, count: impl Into<Count>) -> Result<Lattice, LatticeError> {
    let count = count.into();
    match search(picture, count)? {
        Search { whole: Some(lattice), .. } => some_found(lattice),
        Search { crowded: Some(seen), .. } => Err(LatticeError::TooMany { seen, count }),
        Search { part: Some(part), .. } => {
            let Part { lattice, crossings } = part;
            let Lattice { count: seen, left_out, .. } = lattice;
            Err(LatticeError::Partial { seen, count, crossings, left_out })
        }
        _ => Err(LatticeError::NoLattice),
    }
}

/// Finds the largest piece of a lattice of at most so many lines, of which not all need be seen: rows and columns are counted from the piece's own
/// top left, whichever part of the lattice it is.
///
/// # Errors
/// When no lattice is seen, or more lines than asked for, or when no crossing can be measured.
pub fn detect_part(picture: &Plane, at_most: impl Into<Count>) -> Result<Lattice, LatticeError> {
    let count = at_most.into();
    match search(picture, count)? {
        Search { whole: Some(lattice), .. } => some_found(lattice),
        Search { crowded: Some(seen), .. } => Err(LatticeError::TooMany { seen, count }),
        Search { part: Some(part), .. } => some_found(part.lattice),
        _ => Err(LatticeError::NoLattice),
    }
}

/// Finds the intersections of a lattice whose places are `expected`, row by row, to a fraction of a step: each is the crossing seen next to its place, if
/// that is nearer than `NAMED_WITHIN` of the way to the next intersection. The lattice may be cut, folded over and seen
/// the other way round; what is found lies where lines cross in the picture, not where it was expected.
///
/// # Errors
/// When no crossing is seen at an expected place, or none of those can be measured.
pub fn detect_at(
    picture: &Plane,
    count: impl Into<Count>,
    expected: &[Option<[f64; 2]>],
) -> Result<Lattice, LatticeError> {
    let count = count.into();
    check(picture, count)?;
    assert_eq!(expected.len(), count.intersections(), "a place for each intersection");
    let others = |at: usize| {
        let here = expected[at]?;
        let apart = expected.iter().enumerate().filter(|(other, _)| *other != at);
        let nearest = apart.filter_map(|(_, there)| Some(distance(here, (*there)?)));
        Some((here, NAMED_WITHIN * nearest.fold(f64::INFINITY, f64::min)))
    };
    let named: Vec<Option<([f64; 2], f64)>> = (0..expected.len()).map(others).collect();
    let (searched, scale) = reduced(picture);
    let mut best: Option<(usize, usize, Lattice)> = None;
    for sigma in SCALES {
        let nodes = trace_lines(&RidgeField::new(&searched, sigma), WEAKEST_RIDGE);
        let measurement = Measurement { picture, nodes: &nodes, scale, sigma };
        let mut found = vec![(f64::INFINITY, Err(Missing::NotSeen)); expected.len()];
        let (mut seen, mut width) = (0, None);
        for piece in pieces(&nodes) {
            let own = Count { columns: piece.columns, rows: piece.rows };
            let lattice = measurement.lattice(&piece, own);
            width = width.or(Some(lattice.line_width));
            for (cell, placed) in &piece.cells {
                let measured = lattice.intersections[cell.1 * own.columns + cell.0];
                let place = measured.unwrap_or(nodes[placed.node].place.map(|x| scale * x));
                let off = |at: &usize| {
                    let (there, within) = named[*at]?;
                    Some(distance(place, there)).filter(|off| *off <= within)
                };
                let nearest = (0..named.len()).filter_map(|at| Some((off(&at)?, at)));
                let Some((off, at)) = nearest.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
                seen += 1;
                // One that is measured is better than one that is only seen.
                let rank = |(off, found): &(f64, Result<_, _>)| (found.is_err(), *off);
                if rank(&(off, measured)) < rank(&found[at]) {
                    found[at] = (off, measured);
                }
            }
        }
        let lattice = Lattice {
            count,
            intersections: found.into_iter().map(|(_, found)| found).collect(),
            line_width: width.unwrap_or_default(),
            left_out: nodes.len().saturating_sub(seen),
        };
        let measured = lattice.found();
        if best.as_ref().is_none_or(|(most, ..)| measured > *most) {
            best = Some((measured, seen, lattice));
        }
        if measured == expected.iter().flatten().count() {
            break;
        }
    }
    match best {
        Some((_, seen, lattice)) if seen > 0 => some_found(lattice),
        _ => Err(LatticeError::NoLattice),
    }
}

/// A crossing has the name of an expected place if it is nearer than this share of the way from there to the next expected one.
pub const NAMED_WITHIN: f64 = 0.35;

/// At a scale of more than so many widths of a line nothing is found that is not found at a smaller one as well.
const BLURRED: f64 = 2.5;

/// What a search saw.
#[derive(Default)]
struct Search {
    /// A lattice with all its lines.
    whole: Option<Lattice>,
    /// The largest piece of one with fewer.
    part: Option<Part>,
    /// Lines of one with more.
    crowded: Option<Count>,
}

/// A piece of a lattice, by its own count.
struct Part {
    lattice: Lattice,
    crossings: usize,
}

/// Looks at all scales, for faint lines only where strong ones do not make a lattice.
fn search(picture: &Plane, count: Count) -> Result<Search, LatticeError> {
    check(picture, count)?;
    let (searched, scale) = reduced(picture);
    let mut all = Search::default();
    // What makes one search better than another: the crossings that can be measured; of parts those that lines join.
    let (mut best, mut largest) = (0, 0);
    for share in [WEAKEST_RIDGE, FAINTEST_RIDGE] {
        for sigma in SCALES {
            let nodes = trace_lines(&RidgeField::new(&searched, sigma), share);
            let pieces = pieces(&nodes);
            let Some((piece, rest)) = pieces.split_first() else { continue };
            let seen = Count { columns: piece.columns, rows: piece.rows };
            if !count.holds(piece) {
                all.crowded = all.crowded.or(Some(seen));
                continue;
            }
            let crossings = piece.cells.len();
            let measurement = Measurement { picture, nodes: &nodes, scale, sigma };
            let measured = |count: Count| {
                let mut lattice = measurement.lattice(piece, count);
                lattice.left_out = rest.iter().map(|piece| piece.cells.len()).sum();
                drop_strangers(&mut lattice);
                lattice
            };
            if seen == count {
                let lattice = measured(count);
                // So much blur joins what a cut has torn apart.
                if sigma * scale > BLURRED * lattice.line_width {
                    continue;
                }
                if all.whole.is_none() || lattice.found() > best {
                    best = lattice.found();
                    all.whole = Some(lattice);
                }
                if best == count.intersections() {
                    return Ok(all);
                }
            } else if all.whole.is_none() && crossings > largest {
                largest = crossings;
                all.part = Some(Part { lattice: measured(seen), crossings });
            }
        }
        // A second look among the ground's ridges is for light that falls off: most of the lattice was measured without it.
        if 10 * best >= 9 * count.intersections() {
            break;
        }
    }
    Ok(all)
}

/// A lattice of which something was found.
fn some_found(lattice: Lattice) -> Result<Lattice, LatticeError> {
    if lattice.found() > 0 {
        return Ok(lattice);
    }
    let seen = |found: &&Result<_, Missing>| !matches!(found, Err(Missing::NotSeen));
    let crossings = lattice.intersections.iter().filter(seen).count();
    Err(LatticeError::NothingMeasured { crossings, line_width: lattice.line_width })
}

/// The picture as it is searched, and how many of its pixels are one there.
fn reduced(picture: &Plane) -> (Cow<'_, Plane>, f64) {
    let mut searched = Cow::Borrowed(picture);
    let mut scale = 1.0;
    while searched.width.max(searched.height) > SEARCH_SIZE {
        searched = Cow::Owned(halved(&searched));
        scale *= 2.0;
    }
    (searched, scale)
}

/// Crossings further than this share of a step from where all of their neighbours would have them are misnamed: a cut displaces
/// them from the neighbours beyond it only.
const STRANGE: f64 = 0.6;

/// Takes out crossings that no two neighbours in a row confirm; two lines have no such neighbours.
fn drop_strangers(lattice: &mut Lattice) {
    let [columns, rows] = [lattice.count.columns, lattice.count.rows].map(|lines| lines as isize);
    if columns.max(rows) < 3 {
        return;
    }
    let points = lattice.points();
    let at = |column: isize, row: isize| {
        let inside = (0..columns).contains(&column) && (0..rows).contains(&row);
        if inside { points[(row * columns + column) as usize] } else { None }
    };
    for (index, found) in lattice.intersections.iter_mut().enumerate() {
        let Ok([x, y]) = *found else { continue };
        let (column, row) = (index as isize % columns, index as isize / columns);
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

fn check(picture: &Plane, count: Count) -> Result<(), LatticeError> {
    if count.columns.min(count.rows) < 2 {
        return Err(LatticeError::TooFewLines { count });
    }
    let (width, height) = (picture.width, picture.height);
    // A line, its neighbour and a gap on either side need some eight pixels.
    if width < 8 * count.columns
        || height < 8 * count.rows
        || picture.values.len() != width * height
    {
        return Err(LatticeError::TooSmall { width, height, count });
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
        let mut lattice = Lattice {
            count: 4.into(),
            intersections: intersections.clone(),
            line_width: 3.0,
            left_out: 0,
        };
        drop_strangers(&mut lattice);
        assert_eq!(lattice.intersections, intersections);
        // Named as the one a column further to the right.
        lattice.intersections[5] = Ok(place(6));
        drop_strangers(&mut lattice);
        intersections[5] = Err(Missing::Stranger);
        assert_eq!(lattice.intersections, intersections);
    }
}
