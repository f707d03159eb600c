//! Rows and columns, from links alone: how far lines bend or fan out does not matter.

use std::collections::{HashMap, VecDeque};
use std::f64::consts::{FRAC_PI_2, TAU};

use super::graph::{Node, distance};

/// Steps in the grid for the slots right, down, left and up.
const STEPS: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];
/// A link more than this many times longer than its continuation has skipped a crossing.
const LONGEST_STEP: f64 = 1.7;

/// A node with its place in the grid.
pub(super) struct Placed {
    pub node: usize,
    /// The node's arm in each slot: right, down, left, up.
    pub arms: [Option<usize>; 4],
}

/// A connected piece of the lattice; cells are counted from its own left and top.
pub(super) struct Piece {
    pub columns: usize,
    pub rows: usize,
    pub cells: HashMap<(usize, usize), Placed>,
}

/// The connected pieces of two and more nodes, the largest first.
pub(super) fn pieces(nodes: &[Node]) -> Vec<Piece> {
    let mut taken = vec![false; nodes.len()];
    let mut pieces = Vec::new();
    // Full crossings in the middle of everything order their arms without doubt: begin there.
    let links = |node: &Node| node.arms.iter().filter(|arm| arm.link.is_some()).count();
    let mut seeds: Vec<usize> = (0..nodes.len()).filter(|&at| links(&nodes[at]) >= 2).collect();
    let centre = [0, 1].map(|axis| {
        seeds.iter().map(|&at| nodes[at].place[axis]).sum::<f64>() / seeds.len().max(1) as f64
    });
    let rank =
        |at: usize| (std::cmp::Reverse(links(&nodes[at])), distance(nodes[at].place, centre));
    seeds.sort_by(|&a, &b| rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal));
    for seed in seeds {
        if !taken[seed] {
            let piece = grow(nodes, seed, &mut taken);
            if piece.cells.len() > 1 {
                pieces.push(piece);
            }
        }
    }
    pieces.sort_by_key(|piece| std::cmp::Reverse(piece.cells.len()));
    pieces
}

fn grow(nodes: &[Node], seed: usize, taken: &mut [bool]) -> Piece {
    let mut cells: HashMap<(i32, i32), Placed> = HashMap::new();
    let mut queue = VecDeque::new();
    let rightmost = (0..nodes[seed].arms.len())
        .max_by(|&a, &b| {
            nodes[seed].arms[a].direction[0].total_cmp(&nodes[seed].arms[b].direction[0])
        })
        .unwrap_or(0);
    taken[seed] = true;
    cells.insert((0, 0), Placed { node: seed, arms: slots(&nodes[seed], rightmost, 0) });
    queue.push_back((0, 0));
    while let Some(cell) = queue.pop_front() {
        let Placed { node, arms } = cells[&cell];
        for (slot, step) in STEPS.iter().enumerate() {
            let Some(arm) = arms[slot] else { continue };
            let Some((to, arrival)) = nodes[node].arms[arm].link else { continue };
            let next = (cell.0 + step.0, cell.1 + step.1);
            if taken[to] || cells.contains_key(&next) || skips(nodes, node, &arms, slot) {
                continue;
            }
            taken[to] = true;
            let arms = slots(&nodes[to], arrival, (slot + 2) % 4);
            cells.insert(next, Placed { node: to, arms });
            queue.push_back(next);
        }
    }
    let least = |pick: fn(&(i32, i32)) -> i32| cells.keys().map(pick).min().unwrap_or(0);
    let most = |pick: fn(&(i32, i32)) -> i32| cells.keys().map(pick).max().unwrap_or(0);
    let (left, top) = (least(|cell| cell.0), least(|cell| cell.1));
    let columns = (most(|cell| cell.0) - left + 1) as usize;
    let rows = (most(|cell| cell.1) - top + 1) as usize;
    let from_corner = |((column, row), placed): ((i32, i32), Placed)| {
        (((column - left) as usize, (row - top) as usize), placed)
    };
    Piece { columns, rows, cells: cells.into_iter().map(from_corner).collect() }
}

/// Whether the link in a slot is so much longer than the opposite one that it must have passed a
/// crossing that was not seen.
fn skips(nodes: &[Node], node: usize, arms: &[Option<usize>; 4], slot: usize) -> bool {
    let length = |slot: usize| {
        let (to, _) = nodes[node].arms[arms[slot]?].link?;
        Some(distance(nodes[node].place, nodes[to].place))
    };
    match (length(slot), length((slot + 2) % 4)) {
        (Some(there), Some(back)) => there > LONGEST_STEP * back,
        _ => false,
    }
}

/// The node's arms by slot, given which slot one of them belongs to. Arms are in the order of
/// their angles and so are slots: four arms fit in one way, fewer take the slots whose quarter
/// turns they come nearest to.
fn slots(node: &Node, known: usize, slot: usize) -> [Option<usize>; 4] {
    let count = node.arms.len();
    let angle = |arm: usize| node.arms[arm].direction[1].atan2(node.arms[arm].direction[0]);
    let others: Vec<usize> = (1..count).map(|by| (known + by) % count).collect();
    let turn = |arm: usize| (angle(arm) - angle(known)).rem_euclid(TAU);
    let mut best = (f64::INFINITY, 0);
    // Every choice of quarter turns 1..3, as bits.
    for chosen in 0_usize..8 {
        if chosen.count_ones() as usize != others.len() {
            continue;
        }
        let quarters = (1..4).filter(|quarter| chosen & (1 << (quarter - 1)) != 0);
        let error: f64 = quarters
            .zip(&others)
            .map(|(quarter, &arm)| (turn(arm) - f64::from(quarter) * FRAC_PI_2).powi(2))
            .sum();
        if error < best.0 {
            best = (error, chosen);
        }
    }
    let mut arms = [None; 4];
    arms[slot] = Some(known);
    let quarters = (1..4).filter(|quarter| best.1 & (1 << (quarter - 1)) != 0);
    for (quarter, &arm) in quarters.zip(&others) {
        arms[(slot + quarter) % 4] = Some(arm);
    }
    arms
}

#[cfg(test)]
mod tests {
    use super::super::graph::Arm;
    use super::*;

    /// An n x n grid of nodes bent by `place`, linked to their neighbours except across `cut`.
    fn grid(
        n: usize,
        place: impl Fn(f64, f64) -> [f64; 2],
        cut: impl Fn(usize, usize) -> bool,
    ) -> Vec<Node> {
        let at = |c: i32, r: i32| (r * n as i32 + c) as usize;
        let inside = |c: i32, r: i32| (0..n as i32).contains(&c) && (0..n as i32).contains(&r);
        let mut nodes = Vec::new();
        let mut ends = Vec::new();
        for r in 0..n as i32 {
            for c in 0..n as i32 {
                let here = place(c.into(), r.into());
                let mut arms: Vec<(f64, [f64; 2], usize)> = Vec::new();
                for (dc, dr) in STEPS {
                    if inside(c + dc, r + dr) {
                        let next = place((c + dc).into(), (r + dr).into());
                        let towards = [next[0] - here[0], next[1] - here[1]];
                        arms.push((towards[1].atan2(towards[0]), towards, at(c + dc, r + dr)));
                    }
                }
                arms.sort_by(|a, b| a.0.total_cmp(&b.0));
                ends.push(arms.iter().map(|arm| arm.2).collect::<Vec<_>>());
                let arm = |(angle, ..): &(f64, [f64; 2], usize)| Arm {
                    direction: [angle.cos(), angle.sin()],
                    trace: Vec::new(),
                    reached: None,
                    link: None,
                };
                nodes.push(Node { place: here, arms: arms.iter().map(arm).collect() });
            }
        }
        for node in 0..nodes.len() {
            for arm in 0..ends[node].len() {
                let to = ends[node][arm];
                let back = ends[to].iter().position(|&end| end == node).unwrap();
                if !cut(node, to) {
                    nodes[node].arms[arm].link = Some((to, back));
                }
            }
        }
        nodes
    }

    fn is_reading_order(piece: &Piece, n: usize) -> bool {
        piece.cells.len() == n * n
            && piece.cells.iter().all(|(&(c, r), placed)| placed.node == r * n + c)
    }

    #[test]
    fn a_fan_bent_by_eighty_degrees_is_read_in_order() {
        // Rows run along arcs: the direction of "right" turns by 80 degrees across the lattice.
        let fan = |c: f64, r: f64| {
            let (sin, cos) = (0.233 * (c - 3.0)).sin_cos();
            [(500.0 - 30.0 * r) * sin, -(500.0 - 30.0 * r) * cos]
        };
        let found = pieces(&grid(7, fan, |_, _| false));
        assert_eq!((found.len(), found[0].columns, found[0].rows), (1, 7, 7));
        assert!(is_reading_order(&found[0], 7));
    }

    #[test]
    fn a_cut_leaves_two_pieces_and_a_missing_link_none() {
        let square = |c: f64, r: f64| [10.0 * c, 10.0 * r];
        let across = |a: usize, b: usize| (a % 5 == 1 && b % 5 == 2) || (a % 5 == 2 && b % 5 == 1);
        let found = pieces(&grid(5, square, across));
        let sizes: Vec<_> = found.iter().map(|piece| (piece.columns, piece.rows)).collect();
        assert_eq!(sizes, [(3, 5), (2, 5)]);
        let found = pieces(&grid(5, square, |a, b| a.min(b) == 6));
        assert!(is_reading_order(&found[0], 5));
    }

    #[test]
    fn a_link_past_an_unseen_crossing_is_not_one_step() {
        let square = |c: f64, r: f64| [10.0 * c, 10.0 * r];
        let mut nodes = grid(5, square, |_, _| false);
        // The middle node is not seen: its neighbours link to one another through it.
        for (a, b) in [(11, 13), (7, 17)] {
            let to = |nodes: &[Node], from: usize| {
                nodes[from].arms.iter().position(|arm| arm.link.is_some_and(|l| l.0 == 12)).unwrap()
            };
            let (arm_a, arm_b) = (to(&nodes, a), to(&nodes, b));
            nodes[a].arms[arm_a].link = Some((b, arm_b));
            nodes[b].arms[arm_b].link = Some((a, arm_a));
        }
        nodes[12].arms.clear();
        let found = pieces(&nodes);
        assert_eq!((found[0].columns, found[0].rows, found[0].cells.len()), (5, 5, 24));
        assert!(found[0].cells.iter().all(|(&(c, r), placed)| placed.node == r * 5 + c));
    }
}
