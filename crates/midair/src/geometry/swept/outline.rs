//! The lines of what a profile sweeps.

use super::{Sweep, Swept};
use crate::geometry::profile::{Piece, Point, Profile};
use crate::geometry::{Fold, Outline, Vec3};
use std::f64::consts::TAU;

/// Steps around an axis.
const AROUND: usize = 72;
/// Steps along a bent piece.
const ALONG: usize = 12;
/// Pieces whose directions differ by more join at an edge, radians.
const EDGE: f64 = 0.02;

/// Edges where pieces join at an angle; between neighbours of a fine grid over the surface the folds that its contour is made of.
pub(in crate::geometry) fn of_swept(swept: &Swept) -> Outline {
    match swept.sweep() {
        Sweep::AlongZ(half) => of_prism(swept.profile(), half),
        Sweep::AboutY => turned(swept.profile(), |p| p),
        Sweep::AboutZ => turned(swept.profile(), |p| Vec3::new(p.x, -p.z, p.y)),
    }
}

/// A short stretch of the profile, and the direction of its outside.
struct Stretch {
    ends: [Point; 2],
    normal: Point,
    /// Whether an edge lies at its end.
    edge: bool,
}

fn stretches(profile: &Profile) -> Vec<Stretch> {
    let pieces = profile.pieces();
    let mut all = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        let next = &pieces[(i + 1) % pieces.len()];
        let ([_, a], [b, _]) = (piece.directions(), next.directions());
        let edge = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]).abs() > EDGE;
        let count = if matches!(piece, Piece::Line { .. }) { 1 } else { ALONG };
        for k in 0..count {
            let at = |k: usize| piece.at(k as f64 / count as f64);
            let ends = [at(k), at(k + 1)];
            let [dx, dy] = [0, 1].map(|axis| ends[1][axis] - ends[0][axis]);
            let length = dx.hypot(dy);
            let normal = [dy / length, -dx / length];
            all.push(Stretch { ends, normal, edge: edge && k + 1 == count });
        }
    }
    all
}

/// About y; `place` puts it where it belongs.
fn turned(profile: &Profile, place: impl Fn(Vec3) -> Vec3) -> Outline {
    let mut outline = Outline::default();
    let around = |p: Point, step: usize| {
        let (s, c) = (step as f64 / AROUND as f64 * TAU).sin_cos();
        place(Vec3::new(p[0] * s, p[1], p[0] * c))
    };
    // A normal half a step further on: that of the strip between two steps.
    let facing = |n: Point, half_steps: usize| {
        let (s, c) = (half_steps as f64 / (2 * AROUND) as f64 * TAU).sin_cos();
        place(Vec3::new(n[0] * s, n[1], n[0] * c))
    };
    let stretches = stretches(profile);
    for (i, stretch) in stretches.iter().enumerate() {
        let [from, to] = stretch.ends;
        let next = &stretches[(i + 1) % stretches.len()];
        if stretch.edge && to[0] > 1e-9 {
            outline.edges.push((0..=AROUND).map(|step| around(to, step)).collect());
        }
        if from[0] < 1e-9 && to[0] < 1e-9 {
            continue;
        }
        for step in 0..AROUND {
            // Along the profile, between two strips.
            outline.folds.push(Fold {
                ends: [around(from, step), around(to, step)],
                normals: [
                    facing(stretch.normal, (2 * step + 2 * AROUND - 1) % (2 * AROUND)),
                    facing(stretch.normal, 2 * step + 1),
                ],
            });
            // Around the axis, between this stretch and the next.
            if to[0] > 1e-9 && !stretch.edge {
                outline.folds.push(Fold {
                    ends: [around(to, step), around(to, step + 1)],
                    normals: [
                        facing(stretch.normal, 2 * step + 1),
                        facing(next.normal, 2 * step + 1),
                    ],
                });
            }
        }
    }
    outline
}

fn of_prism(profile: &Profile, half: f64) -> Outline {
    let mut outline = Outline::default();
    let stretches = stretches(profile);
    for z in [-half, half] {
        let mut edge: Vec<Vec3> =
            stretches.iter().map(|s| Vec3::new(s.ends[0][0], s.ends[0][1], z)).collect();
        edge.extend(edge.first().copied());
        outline.edges.push(edge);
    }
    for (i, stretch) in stretches.iter().enumerate() {
        let [x, y] = stretch.ends[1];
        let ends = [Vec3::new(x, y, -half), Vec3::new(x, y, half)];
        if stretch.edge {
            outline.edges.push(ends.to_vec());
        } else {
            let next = &stretches[(i + 1) % stretches.len()];
            let normals = [stretch, next].map(|s| Vec3::new(s.normal[0], s.normal[1], 0.0));
            outline.folds.push(Fold { ends, normals });
        }
    }
    outline
}
