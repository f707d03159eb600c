//! Where lines meet, and which meetings one line joins.

use super::ridge::{RidgeField, unit};

/// A place where ridges meet, with the lines that leave it.
pub(super) struct Node {
    pub place: [f64; 2],
    /// In the order of their direction's angle (x towards y).
    pub arms: Vec<Arm>,
}

/// One line leaving a node.
pub(super) struct Arm {
    /// Unit vector from the node along the line.
    pub direction: [f64; 2],
    /// Ridge points from near the node to where the trace ended, about one pixel apart.
    pub trace: Vec<[f64; 2]>,
    /// The node that the trace came to.
    pub reached: Option<usize>,
    /// The node and its arm that the line leads to, where that arm leads back.
    pub link: Option<(usize, usize)>,
}

/// Ridges weaker than this share of the strong ones are ground, at first: noise of 2 % reaches 1 % of a
/// line's strength, light that falls to a fifth across the picture still passes.
pub(super) const WEAKEST_RIDGE: f64 = 0.12;
/// The same for a second look, where light falls to a twentieth: what is ground may pass then.
pub(super) const FAINTEST_RIDGE: f64 = 0.04;
/// Half of the picture is ground: ridges there have the strength of noise, and are rarely stronger
/// than this many times their median.
const NOISE_RIDGE: f64 = 3.0;
/// Two lines of equal strength have equal curvatures where they cross, less what saturation takes
/// (a line is not brighter where another crosses it): a third remains when sigma is half the
/// width. On a single line the ratio is noise, about 1 %.
const WEAKEST_CROSSING: f32 = 0.08;
/// Distance, in sigmas, at which a crossing has resolved into separate arms.
const ARMS_AT: f64 = 4.0;

/// Nodes and links found at one scale, on ridges down to a share of the strong ones; empty when the picture has no contrast.
pub(super) fn trace_lines(field: &RidgeField, share: f64) -> Vec<Node> {
    let Some(weakest) = weakest_ridge(field, share) else { return Vec::new() };
    let mut nodes = candidates(field, weakest);
    for node in &mut nodes {
        node.arms = arms(field, node.place, weakest);
    }
    nodes.retain(is_meeting);
    let owners = owners(field, &nodes);
    for (at, node) in nodes.iter_mut().enumerate() {
        for arm in &mut node.arms {
            (arm.trace, arm.reached) =
                follow(field, &owners, at, node.place, arm.direction, weakest);
        }
    }
    link(&mut nodes, field.sigma);
    nodes
}

/// Whether the arms are those of a meeting, and not of a knot that noise tied in a single line.
fn is_meeting(node: &Node) -> bool {
    let count = node.arms.len();
    let angle = |arm: usize| {
        let [x, y] = node.arms[arm % count].direction;
        y.atan2(x)
    };
    let gap = |arm: usize| (angle(arm + 1) - angle(arm)).rem_euclid(std::f64::consts::TAU);
    let widest = (0..count).map(gap).fold(0.0, f64::max).to_degrees();
    match count {
        0 | 1 => false,
        // A corner: its lines meet at 50 to 130 degrees.
        2 => (230.0..310.0).contains(&widest),
        // A line's rounded end seems to have several arms to one side.
        _ => widest < 250.0,
    }
}

/// The strength below which a ridge is taken for ground.
fn weakest_ridge(field: &RidgeField, share: f64) -> Option<f64> {
    let mut strengths: Vec<f32> = field.strength.iter().step_by(3).copied().collect();
    if strengths.is_empty() {
        return None;
    }
    // Thin lines cover at least a few per cent of a picture that a lattice fills half-way.
    let rank = strengths.len() - 1 - strengths.len() / 200;
    let (_, &mut strong, _) = strengths.select_nth_unstable_by(rank, f32::total_cmp);
    let middle = strengths.len() / 2;
    let (_, &mut typical, _) = strengths.select_nth_unstable_by(middle, f32::total_cmp);
    let (strong, typical) = (f64::from(strong), f64::from(typical));
    // A line one grey level of 255 above its ground has about half that strength.
    (strong > 0.002 && strong > 3.0 * typical)
        .then_some((share * strong).max(NOISE_RIDGE * typical))
}

/// Local maxima of the crossing measure on ridges, no two closer than two sigmas.
fn candidates(field: &RidgeField, weakest: f64) -> Vec<Node> {
    let (width, height) = (field.width(), field.height());
    let mut peaks = Vec::new();
    for row in 2..height.saturating_sub(2) {
        for column in 2..width.saturating_sub(2) {
            let at = row * width + column;
            let value = field.crossing[at];
            if f64::from(field.strength[at]) < weakest
                || value < WEAKEST_CROSSING * field.strength[at]
            {
                continue;
            }
            let around = [at - width - 1, at - width, at - width + 1, at - 1];
            let after = [at + 1, at + width - 1, at + width, at + width + 1];
            if around.iter().all(|&i| field.crossing[i] <= value)
                && after.iter().all(|&i| field.crossing[i] < value)
            {
                peaks.push((value, [column as f64 + 0.5, row as f64 + 0.5]));
            }
        }
    }
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    // No lattice has more: what is beyond this is texture.
    peaks.truncate(2000);
    let mut nodes: Vec<Node> = Vec::new();
    for (_, place) in peaks {
        if nodes.iter().all(|node| distance(node.place, place) > 2.0 * field.sigma) {
            nodes.push(Node { place, arms: Vec::new() });
        }
    }
    nodes
}

/// The lines that cross a circle about a node, in the order of their angles.
fn arms(field: &RidgeField, place: [f64; 2], weakest: f64) -> Vec<Arm> {
    const STEPS: usize = 72;
    let radius = ARMS_AT * field.sigma;
    let direction = |step: usize| {
        let (sin, cos) = (step as f64 * std::f64::consts::TAU / STEPS as f64).sin_cos();
        [cos, sin]
    };
    let strengths: Vec<f64> = (0..STEPS)
        .map(|step| {
            let [cos, sin] = direction(step);
            let on = [place[0] + radius * cos, place[1] + radius * sin];
            if !field.contains(on) {
                return 0.0;
            }
            let jet = field.jet(on);
            // The ridge must lead away from the node, not past it.
            let radial = jet.along[0] * cos + jet.along[1] * sin;
            if radial.abs() > 0.7 { jet.strength } else { 0.0 }
        })
        .collect();
    let mut peaks: Vec<usize> = (0..STEPS)
        .filter(|&step| {
            // Strongest within 25 degrees on either side.
            strengths[step] > weakest
                && (1..=5).all(|by| {
                    strengths[(step + STEPS - by) % STEPS] <= strengths[step]
                        && strengths[(step + by) % STEPS] < strengths[step]
                })
        })
        .collect();
    peaks.sort_by(|&a, &b| strengths[b].total_cmp(&strengths[a]));
    let mut apart: Vec<usize> = Vec::new();
    for peak in peaks {
        let gap = |&other: &usize| {
            (peak + STEPS - other).rem_euclid(STEPS).min((other + STEPS - peak) % STEPS)
        };
        // 40 degrees: what is nearer is the same line, or no lattice.
        if apart.len() < 4 && apart.iter().all(|other| gap(other) >= 8) {
            apart.push(peak);
        }
    }
    let mut peaks = apart;
    peaks.sort_unstable();
    peaks
        .into_iter()
        .map(|step| Arm {
            direction: direction(step),
            trace: Vec::new(),
            reached: None,
            link: None,
        })
        .collect()
}

/// For each pixel, the node whose surroundings it belongs to.
fn owners(field: &RidgeField, nodes: &[Node]) -> Vec<u16> {
    let mut owners = vec![u16::MAX; field.width() * field.height()];
    let radius = 2.0 * field.sigma;
    for (index, node) in nodes.iter().enumerate() {
        let span = |at: f64, size: usize| {
            ((at - radius).max(0.0) as usize)..((at + radius + 1.0) as usize).min(size)
        };
        for row in span(node.place[1], field.height()) {
            for column in span(node.place[0], field.width()) {
                let centre = [column as f64 + 0.5, row as f64 + 0.5];
                if distance(centre, node.place) <= radius {
                    owners[row * field.width() + column] = index as u16;
                }
            }
        }
    }
    owners
}

/// Follows a ridge from a node: its points, and the node that it reaches.
fn follow(
    field: &RidgeField,
    owners: &[u16],
    origin: usize,
    from: [f64; 2],
    direction: [f64; 2],
    weakest: f64,
) -> (Vec<[f64; 2]>, Option<usize>) {
    let mut trace = Vec::new();
    let mut heading = direction;
    // Start half-way to where the arm was seen; the ridge is centred from there on.
    let start = 0.75 * ARMS_AT * field.sigma;
    let mut place = [from[0] + start * heading[0], from[1] + start * heading[1]];
    let mut faint = 0;
    for _ in 0..2 * (field.width() + field.height()) {
        if !field.contains(place) {
            break;
        }
        let jet = field.jet(place);
        if jet.strength < weakest {
            faint += 1;
            if faint > 3 {
                break;
            }
        } else {
            faint = 0;
            let ahead = jet.along[0] * heading[0] + jet.along[1] * heading[1];
            // Where another ridge confuses this one, keep the heading.
            if ahead.abs() > 0.8 {
                let [dx, dy] = jet.to_centre;
                let scale = (1.0 / dx.hypot(dy)).min(1.0);
                place = [place[0] + scale * dx, place[1] + scale * dy];
                let along = [jet.along[0] * ahead.signum(), jet.along[1] * ahead.signum()];
                heading = unit([heading[0] + along[0], heading[1] + along[1]]);
            }
            trace.push(place);
        }
        if !field.contains(place) {
            break;
        }
        let owner = owners[place[1] as usize * field.width() + place[0] as usize];
        if owner != u16::MAX && usize::from(owner) != origin {
            return (trace, Some(usize::from(owner)));
        }
        place = [place[0] + heading[0], place[1] + heading[1]];
    }
    (trace, None)
}

/// Links arms whose traces lead to one another.
fn link(nodes: &mut [Node], sigma: f64) {
    // The arm of `at` that points to where `trace` came from.
    let arrival = |nodes: &[Node], at: usize, trace: &[[f64; 2]]| -> Option<usize> {
        let place = nodes[at].place;
        let far = trace.iter().rev().find(|&&p| distance(p, place) >= ARMS_AT * sigma);
        let seen = far.or(trace.first())?;
        let back = unit([seen[0] - place[0], seen[1] - place[1]]);
        let cosine = |arm: &Arm| arm.direction[0] * back[0] + arm.direction[1] * back[1];
        let best = (0..nodes[at].arms.len())
            .max_by(|&a, &b| cosine(&nodes[at].arms[a]).total_cmp(&cosine(&nodes[at].arms[b])))?;
        // 35 degrees.
        (cosine(&nodes[at].arms[best]) > 0.82).then_some(best)
    };
    let lead = |arm: &Arm| {
        let to = arm.reached?;
        Some((to, arrival(nodes, to, &arm.trace)?))
    };
    let leads: Vec<Vec<_>> =
        nodes.iter().map(|node| node.arms.iter().map(lead).collect()).collect();
    for at in 0..nodes.len() {
        for arm in 0..nodes[at].arms.len() {
            nodes[at].arms[arm].link =
                leads[at][arm].filter(|&(to, its)| leads[to][its] == Some((at, arm)));
        }
    }
}

pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
