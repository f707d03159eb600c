//! Every intersection at full resolution, from the centres of its two lines.

use rayon::prelude::*;

use super::super::Plane;
use super::curve::Curve;
use super::detection::{Count, Lattice, Missing};
use super::graph::{Node, distance};
use super::ordering::{Piece, Placed};
use super::refinement;
use super::stretch::{Stretch, is_smooth, usual_deviation};

/// What a measurement at full resolution starts from.
pub(super) struct Measurement<'a> {
    pub picture: &'a Plane,
    pub nodes: &'a [Node],
    /// Full-resolution pixels to a pixel of the search.
    pub scale: f64,
    /// The search's sigma, in its pixels.
    pub sigma: f64,
}

/// What is less certain is no measurement: the standard error, in pixels, of a crossing of lines that are seen on both sides of it.
const MOST_ERROR: f64 = 0.15;
/// Of a crossing with a line that is seen on one side only. Curves extrapolate there, and neighbouring centres share pixels, so that it is off by
/// up to four times its standard error (see the tests of cut lattices): an eighth of a pixel.
const MOST_ERROR_ONE_SIDED: f64 = 0.03;

/// The same as shares of the line's width, where that is more.
const MOST_SHARE: f64 = 0.015;
const MOST_SHARE_ONE_SIDED: f64 = 0.005;

/// The slots of an ordered node's arms ([`Placed::arms`]).
const RIGHT: usize = 0;
const DOWN: usize = 1;

/// Measured centres of one line: between crossing i - 1 and crossing i at index i, so that 0 and the
/// last are its free ends. Empty where the line was not traced.
type Line = Vec<Stretch>;

/// What the lattice's lines are like.
#[derive(Clone, Copy)]
struct Lines {
    /// Full width at half height, pixels.
    width: f64,
    /// Usual deviation of their centres from a smooth curve, pixels.
    usually: f64,
}

/// Beyond this distance from a crossing, the crossing line and its blur do not reach into the window across this
/// one, even when they cross at 60 degrees.
fn clear_of(width: f64) -> f64 {
    1.5 * width + 1.5
}

/// The centres between two crossings.
type Segment<'a> = &'a [[f64; 2]];

impl Measurement<'_> {
    /// The lattice of a piece that spans `count` cells at most.
    pub fn lattice(&self, piece: &Piece, count: Count) -> Lattice {
        let Count { columns, rows } = count;
        let cell = |column: usize, row: usize| piece.cells.get(&(column, row));
        let all: Vec<&Placed> = piece.cells.values().collect();
        let width = self.line_width(&all);
        let line = |(index, slot): (usize, usize)| -> Vec<Vec<[f64; 2]>> {
            let along = |at: usize| if slot == RIGHT { cell(at, index) } else { cell(index, at) };
            let crossed = if slot == RIGHT { columns } else { rows };
            (0..=crossed).map(|at| self.segment(at, slot, crossed, width, &along)).collect()
        };
        let named = |at: usize| if at < rows { (at, RIGHT) } else { (at - rows, DOWN) };
        let centres: Vec<_> = (0..rows + columns).into_par_iter().map(named).map(line).collect();
        let usually = usual_deviation(centres.iter().flatten().map(Vec::as_slice));
        // A window across the line reaches over a cut that crosses it at 45 degrees from as far away.
        let stretch = |centres: Vec<[f64; 2]>| Stretch::new(centres, clear_of(width), usually);
        let shared = |line: Vec<_>| -> Line { line.into_iter().map(stretch).collect() };
        let mut across: Vec<Line> = centres.into_par_iter().map(shared).collect();
        let down = across.split_off(rows);
        let scale = Lines { width, usually };
        let intersections = (0..columns * rows)
            .into_par_iter()
            .map(|at| {
                let (column, row) = (at % columns, at / columns);
                let placed = cell(column, row).ok_or(Missing::NotSeen)?;
                self.intersection(placed, (&across[row], column), (&down[column], row), scale)
            })
            .collect();
        Lattice { count, intersections, line_width: width, left_out: 0 }
    }

    /// The typical line's width: the median over crossings.
    fn line_width(&self, placed: &[&Placed]) -> f64 {
        let reach = 4.0 * self.sigma * self.scale;
        let mut widths: Vec<f64> = placed
            .par_iter()
            .filter_map(|cell| {
                let arm = cell
                    .arms
                    .iter()
                    .flatten()
                    .find(|&&arm| self.nodes[cell.node].arms[arm].reached.is_some())?;
                let stations = self.stations(cell.node, *arm, reach);
                // Ten profiles across one line average enough.
                let apart = stations.len().div_ceil(10).max(1);
                let stations: Vec<_> = stations.into_iter().step_by(apart).collect();
                refinement::line_width(self.picture, &stations, reach)
            })
            .collect();
        if widths.is_empty() {
            return 2.0 * self.sigma * self.scale;
        }
        let middle = widths.len() / 2;
        *widths.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// Where an arm is measured: `clear` of the crossings at its ends.
    fn stations(&self, node: usize, arm: usize, clear: f64) -> refinement::Stations {
        let node = &self.nodes[node];
        let arm = &node.arms[arm];
        let (Some(&first), Some(&last)) = (arm.trace.first(), arm.trace.last()) else {
            return Vec::new();
        };
        let traced: f64 = arm.trace.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
        let to_first = distance(node.place, first);
        let length = match arm.reached {
            Some(other) => to_first + traced + distance(last, self.nodes[other].place),
            None => to_first + traced,
        };
        let length = self.scale * length;
        let to = match arm.reached {
            Some(_) => length - clear.min(0.4 * length),
            // The end of a line is rounded off by blur.
            None => length - 3.0 * self.sigma * self.scale,
        };
        // Close crossings leave little between them: measure the middle fifth at least.
        refinement::stations(node.place, &arm.trace, self.scale, [clear.min(0.4 * length), to])
    }

    /// The centres between the crossings `at - 1` and `at` of a line; beyond its ends, those of the free
    /// arm.
    fn segment<'p>(
        &self,
        at: usize,
        slot: usize,
        lines: usize,
        width: f64,
        along: &impl Fn(usize) -> Option<&'p Placed>,
    ) -> Vec<[f64; 2]> {
        let arm_of = |placed: Option<&'p Placed>, slot: usize| {
            let placed = placed?;
            Some((placed.node, placed.arms[slot]?))
        };
        let (before, after) =
            (at.checked_sub(1).and_then(along), (at < lines).then(|| along(at)).flatten());
        let leads = |from: Option<&'p Placed>, slot: usize, to: Option<&'p Placed>| {
            let (node, arm) = arm_of(from, slot)?;
            // Only what leads to the next crossing is between them; beyond the last, what leads
            // nowhere.
            (self.nodes[node].arms[arm].reached == to.map(|to| to.node)).then_some((node, arm))
        };
        let opposite = (slot + 2) % 4;
        let (found, backwards) = match leads(before, slot, after) {
            Some(found) => (Some(found), false),
            None => (leads(after, opposite, before), true),
        };
        let Some((node, arm)) = found else { return Vec::new() };
        let clear = clear_of(width);
        // The smoothing that loses least to noise has the line's own profile (matched filter).
        let sigma = (0.42 * width).max(1.0);
        let mut centres: Vec<[f64; 2]> = self
            .stations(node, arm, clear)
            .into_iter()
            .filter_map(|station| refinement::centre(self.picture, station, sigma))
            .collect();
        if backwards {
            centres.reverse();
        }
        centres
    }

    /// How far from its crossing a line was traced, pixels.
    fn reach(&self, placed: &Placed, slot: usize) -> f64 {
        let node = &self.nodes[placed.node];
        let Some(arm) = placed.arms[slot].map(|arm| &node.arms[arm]) else { return 0.0 };
        let traced: f64 = arm.trace.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
        let to_first = arm.trace.first().map_or(0.0, |&first| distance(node.place, first));
        self.scale * (to_first + traced)
    }

    fn intersection(
        &self,
        placed: &Placed,
        (row, column): (&Line, usize),
        (other, at): (&Line, usize),
        Lines { width, usually }: Lines,
    ) -> Result<[f64; 2], Missing> {
        let place = self.nodes[placed.node].place;
        let origin = [self.scale * place[0], self.scale * place[1]];
        let curve = |line: &Line, at: usize, slot: usize| {
            let (before, after) = around(line, at);
            // Within the lattice a line goes on: one that ends right at a crossing was cut there, and what lies beyond the cut
            // reaches into the other line's window too.
            let ends = |slot: usize| self.reach(placed, slot) < 2.0 * clear_of(width);
            if (at > 0 && before.is_empty() && ends((slot + 2) % 4))
                || (at + 2 < line.len() && after.is_empty() && ends(slot))
            {
                return Err(Missing::Broken);
            }
            // A cut next to the crossing displaces one side from the other.
            if let (Some(near), Some(next)) = (before.first(), after.first())
                && !is_smooth(&[*near, *next].concat(), 4, usually)
            {
                return Err(Missing::Broken);
            }
            Curve::through(origin, &before, &after).ok_or(Missing::LineTooShort)
        };
        let (row, column) = (curve(row, column, RIGHT)?, curve(other, at, DOWN)?);
        // A line that is whole is measured to a fraction of its width.
        if row.residual.max(column.residual) > 0.25 * width + 0.25 {
            return Err(Missing::Broken);
        }
        // A thick line's centre is known to a smaller share of its width, not to the same share of a pixel.
        let most = match row.both_sides && column.both_sides {
            true => MOST_ERROR.max(MOST_SHARE * width),
            false => MOST_ERROR_ONE_SIDED.max(MOST_SHARE_ONE_SIDED * width),
        };
        if row.error.hypot(column.error) > most {
            return Err(Missing::LineTooShort);
        }
        let found = row.meet(&column).ok_or(Missing::Broken)?;
        // The search sees a crossing to within about its sigma.
        if distance(found, origin) > 3.0 * self.sigma * self.scale {
            return Err(Missing::Broken);
        }
        Ok(found)
    }
}

/// The centres on both sides of crossing `at`, nearest segment first, as far as the line is whole.
fn around(line: &Line, at: usize) -> (Vec<Segment<'_>>, Vec<Segment<'_>>) {
    (
        unbroken(line[..=at].iter().rev(), Stretch::end),
        unbroken(line[at + 1..].iter(), Stretch::start),
    )
}

/// Segments up to the first that is broken, and of that one the part on this side.
fn unbroken<'a>(
    stretches: impl Iterator<Item = &'a Stretch>,
    near: fn(&Stretch) -> Segment<'_>,
) -> Vec<Segment<'a>> {
    let mut segments = Vec::new();
    for stretch in stretches {
        let segment = near(stretch);
        if !segment.is_empty() {
            segments.push(segment);
        }
        if !stretch.is_whole() {
            break;
        }
    }
    segments
}
