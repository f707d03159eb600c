//! A smooth line through points, of arcs that join without a bend.

use super::{Piece, Point, SAME, distance};

/// Arcs and straight lines through points. A point that is given twice is a corner; everywhere else the line goes on without a bend, and where three
/// neighbours lie on a circle it follows that circle. Between two points lie two arcs (a biarc: Bolton 1975). A line that ends in the point where it
/// began is smooth there as well. `axis`: the ends that lie on the axis (first coordinate 0) meet it at a right angle, so that what is turned is smooth
/// there.
pub fn smooth(points: &[Point], axis: bool) -> Vec<Piece> {
    let mut runs: Vec<Vec<Point>> = vec![Vec::new()];
    for &p in points {
        let run = runs.last_mut().expect("there is one");
        if run.last().is_some_and(|&last| distance(last, p) < SAME) {
            runs.push(vec![p]);
        } else {
            run.push(p);
        }
    }
    let whole = runs.len() == 1;
    runs.iter().filter(|run| run.len() > 1).flat_map(|run| of_run(run, axis, whole)).collect()
}

fn of_run(run: &[Point], axis: bool, whole: bool) -> Vec<Piece> {
    let n = run.len();
    let closed = whole && n > 3 && distance(run[0], run[n - 1]) < SAME;
    let mut directions: Vec<Point> = (0..n)
        .map(|i| match (i, closed) {
            (0, true) => circle_direction(run[n - 2], run[0], run[1]),
            (i, true) if i == n - 1 => circle_direction(run[n - 2], run[0], run[1]),
            (i, _) if i == 0 || i == n - 1 => [0.0; 2],
            (i, _) => circle_direction(run[i - 1], run[i], run[i + 1]),
        })
        .collect();
    if !closed {
        let on_axis = |p: Point| axis && p[0].abs() < SAME;
        // Away from the axis, or towards it.
        directions[0] = if on_axis(run[0]) {
            [1.0, 0.0]
        } else {
            end_direction(run[0], run[1], (n > 2).then(|| directions[1]))
        };
        directions[n - 1] = if on_axis(run[n - 1]) {
            [-1.0, 0.0]
        } else {
            let before = if n > 2 || on_axis(run[0]) { Some(directions[n - 2]) } else { None };
            end_direction(run[n - 2], run[n - 1], before)
        };
    }
    (1..n).flat_map(|i| biarc(run[i - 1], directions[i - 1], run[i], directions[i])).collect()
}

/// Direction at b of the circle through three points, from a to c: seen by inversion about b, which makes the circle a line parallel to its tangent.
fn circle_direction(a: Point, b: Point, c: Point) -> Point {
    let [h1, h2] = [distance(a, b), distance(b, c)];
    unit([0, 1].map(|k| (b[k] - a[k]) / (h1 * h1) + (c[k] - b[k]) / (h2 * h2)))
}

/// Direction at one end of a segment so that one arc leads to the other end with the direction there; along the segment where none is known.
fn end_direction(from: Point, to: Point, other: Option<Point>) -> Point {
    let chord = unit([to[0] - from[0], to[1] - from[1]]);
    let Some(other) = other else { return chord };
    let along = other[0] * chord[0] + other[1] * chord[1];
    [0, 1].map(|k| 2.0 * along * chord[k] - other[k])
}

fn unit([x, y]: Point) -> Point {
    let length = x.hypot(y);
    [x / length, y / length]
}

/// Two arcs with given directions at both ends that join without a bend halfway, the distances from the ends to where their tangents meet the joint's
/// being equal; one where one does.
fn biarc(from: Point, d1: Point, to: Point, d2: Point) -> Vec<Piece> {
    let v = [to[0] - from[0], to[1] - from[1]];
    let dot = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1];
    let t = [d1[0] + d2[0], d1[1] + d2[1]];
    let (vv, vt, away) = (dot(v, v), dot(v, t), 2.0 * (1.0 - dot(d1, d2)));
    let d = if away < 1e-12 {
        vv / (4.0 * dot(v, d2))
    } else {
        (-vt + (vt * vt + away * vv).sqrt()) / away
    };
    let joint = [0, 1].map(|k| 0.5 * (from[k] + to[k] + d * (d1[k] - d2[k])));
    if !joint.iter().all(|c| c.is_finite()) {
        return vec![Piece::Line { from, to }];
    }
    let first = Piece::tangent_arc(from, d1, joint);
    // Backwards from its end, whose direction is known.
    let second = Piece::tangent_arc(to, [-d2[0], -d2[1]], joint).reversed();
    match (&first, &second) {
        (
            &Piece::Arc { centre: a, radius: r, .. },
            &Piece::Arc { centre: b, radius: s, from: _, to: _ },
        ) if distance(a, b) < 1e-9 * r && (r - s).abs() < 1e-9 * r => {
            vec![Piece::tangent_arc(from, d1, to)]
        }
        (Piece::Line { .. }, Piece::Line { .. }) => vec![Piece::Line { from, to }],
        _ => vec![first, second],
    }
}
