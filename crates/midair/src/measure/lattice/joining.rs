//! Pieces of one lattice that an edge cuts apart, as an edge of a glass cube does: put together again.

use std::collections::BTreeMap;

use super::graph::{Node, distance};
use super::ordering::{Piece, Placed};

/// Pieces on one grid: their cells are counted from the left and top of all of them together.
pub(super) struct Joined {
    pub pieces: Vec<Piece>,
    pub columns: usize,
    pub rows: usize,
    /// Pieces that do not fit with the others, or fit in more than one way.
    pub left_over: usize,
}

impl Joined {
    /// Crossings in all pieces together.
    pub fn crossings(&self) -> usize {
        self.pieces.iter().map(|piece| piece.cells.len()).sum()
    }
}

impl Joined {
    /// What makes one search that did not find all lines better than another: the largest piece, where names are without
    /// doubt, then the rest.
    pub fn rank(&self) -> (usize, usize) {
        let largest = self.pieces.first().map_or(0, |piece| piece.cells.len());
        (largest, self.crossings())
    }
}

/// A piece is not joined across more than this many cells beyond where a whole lattice would have it.
const FURTHEST: f64 = 1.2;
/// Crossings nearer to one another than this share of a step are one crossing seen twice.
const SAME: f64 = 0.3;
/// Steps near the cut agree with those beyond it to this share of one (root mean square).
const STEADY: f64 = 0.3;
/// The next best way of joining must be off by this many times more.
const CLEARLY: f64 = 2.0;

/// Joins to the first piece (the largest) all others that fit with it within `lines` by `lines` cells in one way only.
///
/// Across the cut, the lattice goes on with the same steps but is displaced. How far, in cells, a least-squares
/// fit of both sides tells: the place of cell (c, r) is A (c, r) and one origin for each side. Which whole number of cells is the
/// truth, the count of lines decides where it can, and else nearness, if no other number comes near.
pub(super) fn join(nodes: &[Node], pieces: Vec<Piece>, lines: usize) -> Option<Joined> {
    let mut rest = pieces.into_iter();
    let first = rest.next()?;
    // Cells may be left of or above the first piece's own: signed until all are there.
    let mut placed: BTreeMap<[i32; 2], usize> = BTreeMap::new();
    let signed = |piece: &Piece| -> Vec<([i32; 2], usize)> {
        piece.cells.iter().map(|(&(c, r), p)| ([c as i32, r as i32], p.node)).collect()
    };
    placed.extend(signed(&first));
    let mut taken: Vec<(Piece, [i32; 2])> = vec![(first, [0; 2])];
    let mut waiting: Vec<Piece> = rest.collect();
    // A piece that fits in several ways at first may fit in one only once others are there.
    loop {
        let before = waiting.len();
        let mut open = Vec::new();
        for piece in waiting {
            let cells = signed(&piece);
            match offset(nodes, &placed, &cells, lines) {
                Some([dc, dr]) => {
                    placed.extend(cells.into_iter().map(|([c, r], node)| ([c + dc, r + dr], node)));
                    taken.push((piece, [dc, dr]));
                }
                None => open.push(piece),
            }
        }
        waiting = open;
        if waiting.is_empty() || waiting.len() == before {
            break;
        }
    }
    let ([left, top], [right, bottom]) = bounds(placed.keys())?;
    let (columns, rows) = ((right - left + 1) as usize, (bottom - top + 1) as usize);
    let moved = |(piece, [dc, dr]): (Piece, [i32; 2])| Piece {
        columns,
        rows,
        cells: piece
            .cells
            .into_iter()
            .map(|((c, r), cell): (_, Placed)| {
                (((c as i32 + dc - left) as usize, (r as i32 + dr - top) as usize), cell)
            })
            .collect(),
    };
    let left_over = waiting.len();
    Some(Joined { pieces: taken.into_iter().map(moved).collect(), columns, rows, left_over })
}

fn bounds<'a>(cells: impl Iterator<Item = &'a [i32; 2]>) -> Option<([i32; 2], [i32; 2])> {
    cells.fold(None, |bounds, &cell| {
        let (low, high) = bounds.unwrap_or((cell, cell));
        let [c, r] = cell;
        Some(([low[0].min(c), low[1].min(r)], [high[0].max(c), high[1].max(r)]))
    })
}

/// What to add to a piece's cells so that it goes on where `placed` was cut off.
fn offset(
    nodes: &[Node],
    placed: &BTreeMap<[i32; 2], usize>,
    cells: &[([i32; 2], usize)],
    lines: usize,
) -> Option<[i32; 2]> {
    let jump = jump(nodes, placed, cells)?;
    let ([left, top], [right, bottom]) = bounds(placed.keys())?;
    let ([from_c, from_r], [to_c, to_r]) = bounds(cells.iter().map(|(cell, _)| cell))?;
    let reach = lines as i32;
    let fits = |dc: i32, dr: i32| {
        right.max(to_c + dc) - left.min(from_c + dc) < reach
            && bottom.max(to_r + dr) - top.min(from_r + dr) < reach
            && cells.iter().all(|([c, r], _)| !placed.contains_key(&[c + dc, r + dr]))
    };
    let mut ways: Vec<(f64, [i32; 2])> = Vec::new();
    for dc in -2 * reach..=2 * reach {
        for dr in -2 * reach..=2 * reach {
            if fits(dc, dr) {
                let off = (jump[0] - f64::from(dc)).hypot(jump[1] - f64::from(dr));
                ways.push((off, [dc, dr]));
            }
        }
    }
    ways.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(best, way) = ways.first()?;
    let next = ways.get(1).map_or(f64::INFINITY, |way| way.0);
    (best <= FURTHEST && next >= CLEARLY * best).then_some(way)
}

/// How many cells (columns, rows) lie between the origins of two pieces, which need not be whole numbers.
fn jump(
    nodes: &[Node],
    placed: &BTreeMap<[i32; 2], usize>,
    cells: &[([i32; 2], usize)],
) -> Option<[f64; 2]> {
    let at = |node: usize| nodes[node].place;
    let nearest = |from: [f64; 2], others: &mut dyn Iterator<Item = usize>| {
        others.map(|node| distance(from, at(node))).fold(f64::INFINITY, f64::min)
    };
    // Lattices bend: what is near the cut counts most.
    let here = placed.iter().map(|(&cell, &node)| {
        let away = nearest(at(node), &mut cells.iter().map(|&(_, node)| node));
        (cell, node, away, [1.0, 0.0])
    });
    let there = cells.iter().map(|&(cell, node)| {
        let away = nearest(at(node), &mut placed.values().copied());
        (cell, node, away, [0.0, 1.0])
    });
    let all: Vec<_> = here.chain(there).collect();
    let closest = all.iter().map(|(_, _, away, _)| *away).fold(f64::INFINITY, f64::min);
    if !(closest > 0.0 && closest.is_finite()) {
        return None;
    }
    let mut normal = [[0.0; 4]; 4];
    let mut right = [[0.0; 4]; 2];
    let weight = |away: f64| (closest / away).powi(4);
    let terms = |cell: [i32; 2], [a, b]: [f64; 2]| [f64::from(cell[0]), f64::from(cell[1]), a, b];
    for &(cell, node, away, side) in &all {
        let (weight, terms) = (weight(away), terms(cell, side));
        for row in 0..4 {
            for column in 0..4 {
                normal[row][column] += weight * terms[row] * terms[column];
            }
            for axis in 0..2 {
                right[axis][row] += weight * terms[row] * at(node)[axis];
            }
        }
    }
    let [x, y] = [solve(normal, right[0])?, solve(normal, right[1])?];
    let step = x[0].hypot(y[0]).min(x[1].hypot(y[1]));
    let (mut squares, mut weights) = (0.0, 0.0);
    for &(cell, node, away, side) in &all {
        let terms = terms(cell, side);
        let along = |x: [f64; 4]| x.iter().zip(terms).map(|(a, b)| a * b).sum::<f64>();
        squares += weight(away) * distance([along(x), along(y)], at(node)).powi(2);
        weights += weight(away);
    }
    if !(closest >= SAME * step && (squares / weights).sqrt() <= STEADY * step) {
        return None;
    }
    // A (dc, dr) = origin there - origin here.
    let (dx, dy) = (x[3] - x[2], y[3] - y[2]);
    let determinant = x[0] * y[1] - x[1] * y[0];
    // The steps to the right and down are no less than a seventh of a right angle apart.
    let lengths = x[0].hypot(y[0]) * x[1].hypot(y[1]);
    if !(determinant > 0.2 * lengths) {
        return None;
    }
    Some([(dx * y[1] - dy * x[1]) / determinant, (dy * x[0] - dx * y[0]) / determinant])
}

/// Gauss's elimination with the largest pivots; None where the equations leave something open.
fn solve(mut matrix: [[f64; 4]; 4], mut right: [f64; 4]) -> Option<[f64; 4]> {
    let size = (0..4).map(|i| matrix[i][i]).fold(0.0, f64::max);
    for column in 0..4 {
        let pivot = (column..4)
            .max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()))?;
        if !(matrix[pivot][column].abs() > 1e-9 * size) {
            return None;
        }
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        for row in column + 1..4 {
            let factor = matrix[row][column] / matrix[column][column];
            for k in column..4 {
                matrix[row][k] -= factor * matrix[column][k];
            }
            right[row] -= factor * right[column];
        }
    }
    for row in (0..4).rev() {
        let known: f64 = (row + 1..4).map(|k| matrix[row][k] * right[k]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    Some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces of a 7 x 7 grid with spacing 10, cells shared out by `of`, each piece displaced.
    fn cut(
        shift: &[[f64; 2]],
        of: impl Fn(usize, usize) -> Option<usize>,
    ) -> (Vec<Node>, Vec<Piece>) {
        let mut nodes = Vec::new();
        let mut cells: Vec<Vec<([usize; 2], usize)>> = vec![Vec::new(); shift.len()];
        for r in 0..7 {
            for c in 0..7 {
                let piece = of(c, r);
                let [dx, dy] = piece.map_or([0.0; 2], |piece| shift[piece]);
                let place = [10.0 * c as f64 + dx, 10.0 * r as f64 + dy];
                if let Some(piece) = piece {
                    cells[piece].push(([c, r], nodes.len()));
                }
                nodes.push(Node { place, arms: Vec::new() });
            }
        }
        let piece = |cells: Vec<([usize; 2], usize)>| {
            let least = |axis: usize| cells.iter().map(|cell| cell.0[axis]).min().unwrap();
            let most = |axis: usize| cells.iter().map(|cell| cell.0[axis]).max().unwrap();
            let (left, top) = (least(0), least(1));
            let (columns, rows) = (most(0) - left + 1, most(1) - top + 1);
            let cells = cells
                .into_iter()
                .map(|([c, r], node)| ((c - left, r - top), Placed { node, arms: [None; 4] }))
                .collect();
            Piece { columns, rows, cells }
        };
        (nodes, cells.into_iter().map(piece).collect())
    }

    fn is_whole(joined: &Joined) -> bool {
        (joined.columns, joined.rows) == (7, 7)
            && joined
                .pieces
                .iter()
                .flat_map(|piece| &piece.cells)
                .all(|(&(c, r), placed)| placed.node == r * 7 + c)
    }

    #[test]
    fn two_pieces_are_joined_however_far_apart_they_are_if_the_count_leaves_no_choice() {
        for shift in [[0.0, 0.0], [4.0, -3.0], [-4.5, 4.5], [9.0, 5.0], [0.0, 9.0]] {
            let (nodes, pieces) = cut(&[[0.0; 2], shift], |c, _| Some(if c < 5 { 0 } else { 1 }));
            let joined = join(&nodes, pieces, 7).unwrap();
            assert!(is_whole(&joined) && joined.left_over == 0, "{shift:?}");
            assert_eq!(joined.crossings(), 49);
        }
    }

    #[test]
    fn a_piece_that_could_be_named_in_two_ways_is_left_out() {
        // Column 4 is not seen: whether the last two are columns 5 and 6 or 4 and 5 is open at half a cell.
        let of = |c: usize, _| [Some(0), None, Some(1)][usize::from(c >= 4) + usize::from(c > 4)];
        let (nodes, pieces) = cut(&[[0.0; 2], [-5.0, 0.0]], of);
        let joined = join(&nodes, pieces, 7).unwrap();
        assert_eq!((joined.columns, joined.left_over), (4, 1));
        let (nodes, pieces) = cut(&[[0.0; 2], [-2.0, 0.0]], of);
        assert!(is_whole(&join(&nodes, pieces, 7).unwrap()));
    }

    #[test]
    fn corners_and_steps_are_joined() {
        // An oblique cut, and a corner cut off by another one.
        let of = |c: usize, r: usize| Some(if c + r > 9 { 2 } else { usize::from(2 * c > r + 7) });
        let (nodes, mut pieces) = cut(&[[0.0; 2], [3.0, 2.0], [-2.0, 3.0]], of);
        pieces.sort_by_key(|piece| std::cmp::Reverse(piece.cells.len()));
        assert!(is_whole(&join(&nodes, pieces, 7).unwrap()));
    }

    #[test]
    fn lines_in_a_row_and_strangers_are_left_out() {
        // A single column tells no step to the right, but the other piece does; two of them do not.
        let (nodes, pieces) = cut(&[[0.0; 2], [2.0, 0.0]], |c, _| Some(usize::from(c == 6)));
        assert!(is_whole(&join(&nodes, pieces, 7).unwrap()));
        let of = |c: usize, _| (c < 2).then_some(c);
        let (nodes, pieces) = cut(&[[0.0; 2], [2.0, 0.0]], of);
        assert_eq!(join(&nodes, pieces, 7).unwrap().left_over, 1);
        // A second sight of crossings that are there already.
        let (mut nodes, mut pieces) = cut(&[[0.0; 2]], |c, _| (c < 6).then_some(0));
        let mut twice = |c: usize, r: usize| {
            nodes.push(Node { place: [10.0 * c as f64 + 1.0, 10.0 * r as f64], arms: Vec::new() });
            Placed { node: nodes.len() - 1, arms: [None; 4] }
        };
        let cells = [(0, 0), (0, 1)].map(|(c, r)| ((c, r), twice(5, 2 + r))).into_iter().collect();
        pieces.push(Piece { columns: 1, rows: 2, cells });
        assert_eq!(join(&nodes, pieces, 7).unwrap().left_over, 1);
        // What lies three cells away belongs to something else.
        let (nodes, pieces) = cut(&[[0.0; 2], [30.0, 0.0]], |c, _| Some(usize::from(c >= 5)));
        assert_eq!(join(&nodes, pieces, 7).unwrap().left_over, 1);
    }
}
