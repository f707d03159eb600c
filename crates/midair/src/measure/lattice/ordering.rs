//! Rows and columns, from links alone: how far lines bend or fan out does not matter.

use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::{FRAC_PI_2, TAU};

use super::graph::{Node, distance};

/// Steps in the grid for the slots right, down, left and up.
const STEPS: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];
/// A link more than this many times longer than its continuation has skipped a crossing.
const LONGEST_STEP: f64 = 1.7;

/// A node with its place in the grid.
#[derive(Clone, Copy)]
pub(super) struct Placed {
    pub node: usize,
    /// The node's arm in each slot: right, down, left, up.
    pub arms: [Option<usize>; 4],
}

/// A connected piece of the lattice; cells are counted from its own left and top.
pub(super) struct Piece {
    pub columns: usize,
    pub rows: usize,
    pub cells: BTreeMap<(usize, usize), Placed>,
}

/// The connected pieces of two and more nodes, the largest first.
///
/// Pieces are grown over whole meshes first: beside a cut a line may seem to go on in one that runs across it, but then no mesh
/// closes. What hangs on by less than a mesh is added where it goes straight on, and never joins two pieces.
pub(super) fn pieces(nodes: &[Node]) -> Vec<Piece> {
    let mut taken = vec![false; nodes.len()];
    // Full crossings in the middle of everything order their arms without doubt: begin there.
    let links = |node: &Node| node.arms.iter().filter(|arm| arm.link.is_some()).count();
    let mut seeds: Vec<usize> = (0..nodes.len()).filter(|&at| links(&nodes[at]) >= 2).collect();
    let centre = [0, 1].map(|axis| {
        seeds.iter().map(|&at| nodes[at].place[axis]).sum::<f64>() / seeds.len().max(1) as f64
    });
    let rank =
        |at: usize| (std::cmp::Reverse(links(&nodes[at])), distance(nodes[at].place, centre));
    seeds.sort_by(|&a, &b| rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal));
    let meshed = meshed(nodes);
    let mut grown: Vec<Cells> = Vec::new();
    let begin = |at: usize, taken: &mut [bool]| {
        taken[at] = true;
        Cells::from([(
            (0, 0),
            Placed { node: at, arms: slots(&nodes[at], rightmost(&nodes[at]), 0) },
        )])
    };
    for &seed in &seeds {
        if !taken[seed] && meshed[seed].contains(&true) {
            let mut cells = begin(seed, &mut taken);
            grow(nodes, &mut cells, &mut taken, |node, _, arm| meshed[node][arm]);
            grown.push(cells);
        }
    }
    grown.sort_by_key(|cells| std::cmp::Reverse(cells.len()));
    for cells in &mut grown {
        grow(nodes, cells, &mut taken, |node, arms, arm| goes_straight_on(nodes, node, arms, arm));
    }
    for seed in seeds {
        if !taken[seed] {
            let mut cells = begin(seed, &mut taken);
            grow(nodes, &mut cells, &mut taken, |_, _, _| true);
            grown.push(cells);
        }
    }
    grown.retain(|cells| cells.len() > 1);
    let mut pieces: Vec<Piece> = grown.into_iter().map(piece).collect();
    pieces.sort_by_key(|piece| std::cmp::Reverse(piece.cells.len()));
    pieces
}

/// Nodes by column and row, counted from wherever the growth began; in order, so that every run finds the same.
type Cells = BTreeMap<(i32, i32), Placed>;

fn rightmost(node: &Node) -> usize {
    (0..node.arms.len())
        .max_by(|&a, &b| node.arms[a].direction[0].total_cmp(&node.arms[b].direction[0]))
        .unwrap_or(0)
}

/// The least and greatest angle of a mesh, in degrees: lines that meet in less than 30 are not measured either.
const MESH_ANGLES: std::ops::Range<f64> = 30.0..150.0;

fn alike(a: f64, b: f64) -> bool {
    a <= LONGEST_STEP * b && b <= LONGEST_STEP * a
}

/// For each arm of each node, whether its link is a side of a mesh: four links that lead back to where they began, each the next one
/// round the node, opposite ones alike in length (a line that meets the cut's end of another is taken for a crossing).
fn meshed(nodes: &[Node]) -> Vec<Vec<bool>> {
    let mut meshed: Vec<Vec<bool>> =
        nodes.iter().map(|node| vec![false; node.arms.len()]).collect();
    // The next arm round the node, if a mesh may lie between the two.
    let next = |node: usize, arm: usize| {
        let arms = &nodes[node].arms;
        let other = (arm + 1) % arms.len();
        let angle = |arm: usize| arms[arm].direction[1].atan2(arms[arm].direction[0]);
        let between = (angle(other) - angle(arm)).rem_euclid(TAU).to_degrees();
        MESH_ANGLES.contains(&between).then_some(other)
    };
    for start in 0..nodes.len() {
        for arm in 0..nodes[start].arms.len() {
            let mut sides = Vec::with_capacity(4);
            let mut leaving = Some((start, arm));
            while let Some((node, arm)) = leaving
                && sides.len() < 4
            {
                let Some((to, arrival)) = nodes[node].arms[arm].link else { break };
                sides.push((node, arm));
                leaving = next(to, arrival).map(|arm| (to, arm));
            }
            let closes = sides.len() == 4 && leaving == Some((start, arm));
            let length = |side: usize| {
                let ((from, _), (to, _)) = (sides[side], sides[(side + 1) % 4]);
                distance(nodes[from].place, nodes[to].place)
            };
            if closes && alike(length(0), length(2)) && alike(length(1), length(3)) {
                for (node, arm) in sides {
                    meshed[node][arm] = true;
                    if let Some((to, arrival)) = nodes[node].arms[arm].link {
                        meshed[to][arrival] = true;
                    }
                }
            }
        }
    }
    meshed
}

/// Whether the step through an arm goes on, within 30 degrees and about as far, as the step from the opposite arm came.
fn goes_straight_on(nodes: &[Node], node: usize, arms: &[Option<usize>; 4], arm: usize) -> bool {
    let towards = |arm: usize| {
        let (to, _) = nodes[node].arms[arm].link?;
        Some([0, 1].map(|axis| nodes[to].place[axis] - nodes[node].place[axis]))
    };
    let Some(slot) = arms.iter().position(|&other| other == Some(arm)) else { return false };
    match (towards(arm), arms[(slot + 2) % 4].and_then(towards)) {
        (Some([ax, ay]), Some([bx, by])) => {
            let (ahead, back) = (ax.hypot(ay), bx.hypot(by));
            alike(ahead, back) && -(ax * bx + ay * by) > 0.87 * ahead * back
        }
        // Nothing leads the other way: at the end of a line.
        _ => true,
    }
}

/// Adds to the cells what links lead to, as far as the links are `trusted` (node, its arms by slot, arm).
fn grow(
    nodes: &[Node],
    cells: &mut Cells,
    taken: &mut [bool],
    trusted: impl Fn(usize, &[Option<usize>; 4], usize) -> bool,
) {
    let mut queue: VecDeque<(i32, i32)> = cells.keys().copied().collect();
    while let Some(cell) = queue.pop_front() {
        let Placed { node, arms } = cells[&cell];
        for (slot, step) in STEPS.iter().enumerate() {
            let Some(arm) = arms[slot] else { continue };
            let Some((to, arrival)) = nodes[node].arms[arm].link else { continue };
            let next = (cell.0 + step.0, cell.1 + step.1);
            if taken[to]
                || cells.contains_key(&next)
                || skips(nodes, node, &arms, slot)
                || !trusted(node, &arms, arm)
            {
                continue;
            }
            taken[to] = true;
            let arms = slots(&nodes[to], arrival, (slot + 2) % 4);
            cells.insert(next, Placed { node: to, arms });
            queue.push_back(next);
        }
    }
}

/// The cells counted from their own left and top.
fn piece(cells: Cells) -> Piece {
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
        let found = pieces(&grid(5, square, |a, b| (a.min(b), a.max(b)) == (6, 7)));
        assert!(is_reading_order(&found[0], 5));
        // No mesh holds a corner to the rest: whether it belongs there is not for links to tell.
        let found = pieces(&grid(5, square, |a, b| a.min(b) == 6));
        assert_eq!(found.iter().map(|piece| piece.cells.len()).collect::<Vec<_>>(), [21, 4]);
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
