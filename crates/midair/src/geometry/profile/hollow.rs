//! What is inside of a wall, and what lies below a level.

use super::{Piece, Point, Profile, ProfileError, SAME, distance};
use std::f64::consts::{PI, TAU};

/// Directions that differ by less join without a bend, radians.
const BEND: f64 = 1e-6;

impl Profile {
    /// What is left inside of a wall of even thickness, mm. `turned`: pieces on the axis are no surface and get no wall. `open`: nor do the flat pieces at
    /// the top.
    ///
    /// # Errors
    /// When no room is left somewhere, a piece is aspheric, or nothing flat lies at the top that is to be open.
    pub fn inside(&self, wall: f64, turned: bool, open: bool) -> Result<Self, ProfileError> {
        let pieces = self.pieces();
        let [_, high] = self.bounds();
        let lid = |piece: &Piece| match piece {
            Piece::Line { from, to } => [from, to].iter().all(|p| (p[1] - high[1]).abs() < SAME),
            _ => false,
        };
        if open && !pieces.iter().any(lid) {
            return Err(ProfileError::NoTop);
        }
        let walls: Vec<f64> = pieces
            .iter()
            .map(
                |piece| if open && lid(piece) || turned && piece.is_on_axis() { 0.0 } else { wall },
            )
            .collect();
        let n = pieces.len();
        let too_thick = |near: Point| ProfileError::WallTooThick { wall, near };
        let carriers = pieces
            .iter()
            .zip(&walls)
            .map(|(piece, &wall)| parallel(piece, wall))
            .collect::<Result<Vec<_>, _>>()?;
        // For each corner between a piece and the next: where the inner one ends, and where the next begins.
        let mut joints = Vec::with_capacity(n);
        for i in 0..n {
            let next = (i + 1) % n;
            let corner = pieces[i].to();
            let [[_, a], [b, _]] = [pieces[i].directions(), pieces[next].directions()];
            let turn = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
            let even = walls[i] == walls[next];
            let inward = |d: Point, wall: f64| [corner[0] - d[1] * wall, corner[1] + d[0] * wall];
            joints.push(if even && (turn.abs() < BEND || walls[i] == 0.0) {
                [inward(a, walls[i]); 2]
            } else if even && turn < 0.0 {
                // A corner that points inwards: what is at an even distance from it is an arc about it.
                [inward(a, wall), inward(b, wall)]
            } else {
                let place = meeting(&carriers[i], &carriers[next], corner);
                [place.ok_or_else(|| too_thick(corner))?; 2]
            });
        }
        let mut inner = Vec::new();
        for i in 0..n {
            let (from, to) = (joints[(i + n - 1) % n][1], joints[i][0]);
            inner.extend(
                between(&carriers[i], &pieces[i], from, to)
                    .ok_or_else(|| too_thick(pieces[i].middle()))?,
            );
            let [end, begin] = joints[i];
            if distance(end, begin) > SAME {
                inner.push(Piece::arc(pieces[i].to(), wall, end, begin, false));
            }
        }
        match Self::new(inner) {
            Ok(inside) if inside.area() < self.area() && self.contains(some_point_of(&inside)) => {
                Ok(inside)
            }
            Err(ProfileError::CrossesItself(near)) => Err(too_thick(near)),
            _ => Err(too_thick(pieces[0].middle())),
        }
    }

    /// What of it lies below a level, closed by flat pieces at the level.
    ///
    /// # Errors
    /// When nothing does, or a piece is aspheric.
    pub fn below(&self, level: f64) -> Result<Self, ProfileError> {
        let [low, high] = self.bounds();
        if level <= low[1] + SAME {
            return Err(ProfileError::NoLiquid);
        }
        if level >= high[1] - SAME {
            return Ok(self.clone());
        }
        let mut parts = Vec::new();
        for piece in self.pieces() {
            parts.extend(cut(piece, level)?);
        }
        let kept = |part: &Piece| part.middle()[1] < level - SAME;
        let n = parts.len();
        let mut below = Vec::new();
        let mut ends = Vec::new();
        for i in 0..n {
            if kept(&parts[i]) {
                below.push(parts[i].clone());
            }
            if kept(&parts[i]) != kept(&parts[(i + 1) % n]) {
                ends.push(parts[i].to()[0]);
            }
        }
        ends.sort_by(f64::total_cmp);
        below.extend(
            ends.chunks_exact(2)
                .filter(|pair| pair[1] - pair[0] > SAME)
                .map(|pair| Piece::Line { from: [pair[1], level], to: [pair[0], level] }),
        );
        Ok(Self { pieces: in_order(below) })
    }
}

/// Pieces of one or several closed lines, each followed by the one that begins where it ends.
fn in_order(mut pieces: Vec<Piece>) -> Vec<Piece> {
    for i in 1..pieces.len() {
        let end = pieces[i - 1].to();
        let next = (i..pieces.len()).find(|&j| distance(pieces[j].from(), end) < 2.0 * SAME);
        pieces.swap(i, next.unwrap_or(i));
    }
    pieces
}

/// A point of its line, a little inwards.
fn some_point_of(profile: &Profile) -> Point {
    let piece = &profile.pieces()[0];
    let (middle, [a, b]) = (piece.middle(), piece.directions());
    let d = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
    [middle[0] - 1e-6 * d[1], middle[1] + 1e-6 * d[0]]
}

/// The unbounded line at a distance inwards.
fn parallel(piece: &Piece, wall: f64) -> Result<Piece, ProfileError> {
    Ok(match *piece {
        Piece::Line { from, to } => {
            let [d, _] = piece.directions();
            let shift = |p: Point| [p[0] - d[1] * wall, p[1] + d[0] * wall];
            Piece::Line { from: shift(from), to: shift(to) }
        }
        Piece::Arc { centre, radius, from, to } => {
            let radius = if to > from { radius - wall } else { radius + wall };
            if radius <= SAME {
                return Err(ProfileError::WallTooThick { wall, near: piece.middle() });
            }
            Piece::Arc { centre, radius, from, to }
        }
        Piece::Sag(_) if wall == 0.0 => piece.clone(),
        Piece::Sag(_) => return Err(ProfileError::Aspheric),
    })
}

/// The part of a parallel line between two of its points, in the original's sense; `None` if it would go the other way. Nothing where the points are one.
fn between(carrier: &Piece, original: &Piece, from: Point, to: Point) -> Option<Option<Piece>> {
    match (carrier, original) {
        (Piece::Line { .. }, _) => {
            let [d, _] = original.directions();
            let along = (to[0] - from[0]) * d[0] + (to[1] - from[1]) * d[1];
            if along < -SAME {
                return None;
            }
            Some((along > SAME).then_some(Piece::Line { from, to }))
        }
        (&Piece::Arc { centre, radius, .. }, &Piece::Arc { from: a, to: b, .. }) => {
            let span = (b - a).abs();
            if span > TAU - BEND {
                return Some(Some(Piece::Arc { centre, radius, from: a, to: b }));
            }
            if distance(from, to) < SAME {
                return Some(None);
            }
            let arc = Piece::arc(centre, radius, from, to, b > a);
            let Piece::Arc { from: c, to: d, .. } = arc else { return None };
            ((d - c).abs() < span + PI.min(TAU - span)).then_some(Some(arc))
        }
        _ => Some(Some(carrier.clone())),
    }
}

/// Where two unbounded lines meet, nearest to a place.
fn meeting(a: &Piece, b: &Piece, near: Point) -> Option<Point> {
    let places: Vec<Point> = match (a, b) {
        (Piece::Line { from: p, .. }, Piece::Line { from: q, .. }) => {
            let ([d, _], [e, _]) = (a.directions(), b.directions());
            let across = d[0] * e[1] - d[1] * e[0];
            let t = ((q[0] - p[0]) * e[1] - (q[1] - p[1]) * e[0]) / across;
            vec![[p[0] + t * d[0], p[1] + t * d[1]]]
        }
        (Piece::Line { from, .. }, Piece::Arc { centre, radius, .. })
        | (Piece::Arc { centre, radius, .. }, Piece::Line { from, .. }) => {
            let [d, _] = if matches!(a, Piece::Line { .. }) { a } else { b }.directions();
            let along = (centre[0] - from[0]) * d[0] + (centre[1] - from[1]) * d[1];
            let foot = [from[0] + along * d[0], from[1] + along * d[1]];
            let half = (radius * radius - distance(foot, *centre).powi(2)).sqrt();
            [half, -half].map(|s| [foot[0] + s * d[0], foot[1] + s * d[1]]).to_vec()
        }
        (Piece::Arc { centre: p, radius: r, .. }, Piece::Arc { centre: q, radius: s, .. }) => {
            let apart = distance(*p, *q);
            let along = (apart * apart + r * r - s * s) / (2.0 * apart);
            let half = (r * r - along * along).sqrt();
            let d = [(q[0] - p[0]) / apart, (q[1] - p[1]) / apart];
            [half, -half]
                .map(|h| [p[0] + along * d[0] - h * d[1], p[1] + along * d[1] + h * d[0]])
                .to_vec()
        }
        _ => Vec::new(),
    };
    let finite = places.into_iter().filter(|p| p.iter().all(|c| c.is_finite()));
    finite.min_by(|x, y| distance(*x, near).total_cmp(&distance(*y, near)))
}

/// A piece cut where it passes a level.
fn cut(piece: &Piece, level: f64) -> Result<Vec<Piece>, ProfileError> {
    Ok(match *piece {
        Piece::Line { from, to } => {
            let share = (level - from[1]) / (to[1] - from[1]);
            // At the level itself, or too near to an end to tell: whole.
            if !(share > 0.0 && share < 1.0) {
                return Ok(vec![piece.clone()]);
            }
            let at = [from[0] + share * (to[0] - from[0]), level];
            let parts = [Piece::Line { from, to: at }, Piece::Line { from: at, to }];
            parts.into_iter().filter(|part| part.length() > SAME).collect()
        }
        Piece::Arc { centre, radius, from, to } => {
            let sine = (level - centre[1]) / radius;
            if sine.abs() >= 1.0 {
                return Ok(vec![piece.clone()]);
            }
            let (low, high) = (from.min(to), from.max(to));
            let mut angles = vec![low, high];
            for angle in [sine.asin(), PI - sine.asin()] {
                let first = low + (angle - low).rem_euclid(TAU);
                if first > low && first < high {
                    angles.push(first);
                }
            }
            angles.sort_by(f64::total_cmp);
            if to < from {
                angles.reverse();
            }
            let part = |pair: &[f64]| Piece::Arc { centre, radius, from: pair[0], to: pair[1] };
            angles.windows(2).map(part).filter(|part| part.length() > SAME).collect()
        }
        Piece::Sag(_) => return Err(ProfileError::Aspheric),
    })
}
