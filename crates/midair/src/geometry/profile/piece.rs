//! One piece of a profile.

use super::{SAME, Sag, distance};
use std::f64::consts::TAU;

/// A point of the section: across (from the axis, for what is turned) and up, mm.
pub type Point = [f64; 2];

/// A piece of a profile; what the profile surrounds lies on its left.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    /// Straight.
    Line {
        /// Where it begins.
        from: Point,
        /// Where it ends.
        to: Point,
    },
    /// Part of a circle.
    Arc {
        /// Its centre.
        centre: Point,
        /// Its radius, mm.
        radius: f64,
        /// The angle where it begins, radians from the first axis towards the second.
        from: f64,
        /// The angle where it ends: more than `from` if it goes counter-clockwise (bulging out), else less.
        to: f64,
    },
    /// Half the section of an aspheric surface, from the axis to its rim if its outside is down, else from its rim to the axis.
    Sag(Sag),
}

impl Piece {
    /// The arc that leaves a point in a direction (unit) and ends in another point; a line if they lie along it.
    pub fn tangent_arc(from: Point, direction: Point, to: Point) -> Self {
        let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        let across = direction[0] * dy - direction[1] * dx;
        let chord = dx.hypot(dy);
        // Flatter than this the circle's radius is a million times the chord.
        if across.abs() < 1e-6 * 0.5 * chord {
            return Self::Line { from, to };
        }
        // On the left of the direction if positive.
        let signed = chord * chord / (2.0 * across);
        let radius = signed.abs();
        let mut centre = [from[0] - direction[1] * signed, from[1] + direction[0] * signed];
        // A centre that rounding alone has moved off the axis.
        if centre[0].abs() < 1e-12 * radius {
            centre[0] = 0.0;
        }
        Self::arc(centre, radius, from, to, signed > 0.0)
    }

    /// The arc about a centre from one point to another, one way round or the other; a full turn where they are one point.
    pub fn arc(
        centre: Point,
        radius: f64,
        from: Point,
        to: Point,
        counter_clockwise: bool,
    ) -> Self {
        let angle = |p: Point| (p[1] - centre[1]).atan2(p[0] - centre[0]);
        let begin = angle(from);
        let turn = (angle(to) - begin).rem_euclid(TAU);
        let turn = if turn == 0.0 { TAU } else { turn };
        let to = if counter_clockwise { begin + turn } else { begin + turn - TAU };
        // Clockwise over a full turn.
        let to = if to == begin { begin - TAU } else { to };
        Self::Arc { centre, radius, from: begin, to }
    }

    /// Where it begins.
    pub fn from(&self) -> Point {
        self.at(0.0)
    }

    /// Where it ends.
    pub fn to(&self) -> Point {
        self.at(1.0)
    }

    /// Halfway along it.
    pub fn middle(&self) -> Point {
        self.at(0.5)
    }

    /// A point of it, 0 where it begins and 1 where it ends.
    pub fn at(&self, share: f64) -> Point {
        match self {
            Self::Line { from, to } => {
                [0, 1].map(|axis| from[axis] * (1.0 - share) + to[axis] * share)
            }
            Self::Arc { centre, radius, from, to } => {
                let (s, c) = (from + share * (to - from)).sin_cos();
                [centre[0] + radius * c, centre[1] + radius * s]
            }
            Self::Sag(sag) => {
                let r = sag.reach * if sag.side > 0.0 { 1.0 - share } else { share };
                [r, sag.height(r)]
            }
        }
    }

    /// Its direction (unit) where it begins and where it ends.
    pub fn directions(&self) -> [Point; 2] {
        match self {
            Self::Line { from, to } => {
                let length = distance(*from, *to);
                [[(to[0] - from[0]) / length, (to[1] - from[1]) / length]; 2]
            }
            Self::Arc { from, to, .. } => {
                let way = (to - from).signum();
                [from, to].map(|angle| [-way * angle.sin(), way * angle.cos()])
            }
            Self::Sag(sag) => {
                let rim = -sag.side * sag.slope(sag.reach * sag.reach) * 2.0 * sag.reach;
                let along = |slope: f64| {
                    let length = slope.hypot(1.0);
                    [-sag.side / length, -sag.side * slope / length]
                };
                if sag.side > 0.0 { [along(rim), along(0.0)] } else { [along(0.0), along(rim)] }
            }
        }
    }

    /// Its length, mm; of an asphere, about.
    pub fn length(&self) -> f64 {
        match self {
            Self::Line { from, to } => distance(*from, *to),
            Self::Arc { radius, from, to, .. } => radius * (to - from).abs(),
            Self::Sag(sag) => {
                distance([0.0, sag.vertex], self.at(if sag.side > 0.0 { 0.0 } else { 1.0 }))
            }
        }
    }

    /// The same from its end to its beginning.
    pub fn reversed(&self) -> Self {
        match self.clone() {
            Self::Line { from, to } => Self::Line { from: to, to: from },
            Self::Arc { centre, radius, from, to } => {
                Self::Arc { centre, radius, from: to, to: from }
            }
            Self::Sag(sag) => Self::Sag(Sag { side: -sag.side, ..sag }),
        }
    }

    /// Least and largest coordinates.
    pub fn bounds(&self) -> [Point; 2] {
        let mut points = vec![self.from(), self.to()];
        match self {
            Self::Line { .. } => {}
            Self::Arc { centre, radius, from, to } => {
                let (low, high) = (from.min(*to), from.max(*to));
                let quarter = TAU / 4.0;
                let first = (low / quarter).ceil() as i64;
                let turns = (first..).map(|k| k as f64 * quarter).take_while(|&a| a <= high);
                points.extend(turns.map(|angle| {
                    let (s, c) = angle.sin_cos();
                    [centre[0] + radius * c, centre[1] + radius * s]
                }));
            }
            Self::Sag(sag) => {
                let [low, high] = sag.range([0.0, sag.reach * sag.reach]);
                let height = |fall: f64| sag.vertex - sag.side * fall;
                points.extend([[0.0, height(low)], [0.0, height(high)]]);
            }
        }
        let by = |axis: usize, pick: fn(f64, f64) -> f64, start: f64| {
            points.iter().map(|p| p[axis]).fold(start, pick)
        };
        [
            [by(0, f64::min, f64::INFINITY), by(1, f64::min, f64::INFINITY)],
            [by(0, f64::max, f64::NEG_INFINITY), by(1, f64::max, f64::NEG_INFINITY)],
        ]
    }

    /// How far a point of its unbounded line lies beyond its ends, mm; 0 between them.
    pub fn excess(&self, p: Point) -> f64 {
        match self {
            Self::Line { from, to } => {
                let length = distance(*from, *to);
                let along = ((p[0] - from[0]) * (to[0] - from[0])
                    + (p[1] - from[1]) * (to[1] - from[1]))
                    / length;
                (-along).max(along - length).max(0.0)
            }
            Self::Arc { centre, radius, from, to } => {
                let angle = (p[1] - centre[1]).atan2(p[0] - centre[0]);
                let (low, high) = (from.min(*to), from.max(*to));
                let turned = (angle - low).rem_euclid(TAU);
                let span = high - low;
                (turned - span).min(TAU - turned).max(0.0) * radius
            }
            Self::Sag(sag) => (p[0].abs() - sag.reach).max(0.0),
        }
    }

    /// How often a line from a point to the right meets it; a meeting at its upper end does not count, one at its lower end does.
    pub(super) fn meetings_to_the_right(&self, p: Point) -> usize {
        let rises = |a: Point, b: Point, across: f64| {
            usize::from((a[1] > p[1]) != (b[1] > p[1]) && across > p[0])
        };
        match self {
            Self::Line { from, to } => {
                let share = (p[1] - from[1]) / (to[1] - from[1]);
                rises(*from, *to, from[0] + share * (to[0] - from[0]))
            }
            Self::Arc { centre, radius, .. } => {
                // Between its highest and lowest places it goes one way.
                let mut count = 0;
                for part in self.monotone_in_height() {
                    let half = (radius * radius - (p[1] - centre[1]).powi(2)).max(0.0).sqrt();
                    let right = part.middle()[0] > centre[0];
                    let across = if right { centre[0] + half } else { centre[0] - half };
                    count += rises(part.from(), part.to(), across);
                }
                count
            }
            Self::Sag(_) => {
                let points = self.samples(256);
                points
                    .windows(2)
                    .map(|pair| {
                        let share = (p[1] - pair[0][1]) / (pair[1][1] - pair[0][1]);
                        rises(pair[0], pair[1], pair[0][0] + share * (pair[1][0] - pair[0][0]))
                    })
                    .sum()
            }
        }
    }

    /// An arc cut at its highest and lowest places.
    fn monotone_in_height(&self) -> Vec<Self> {
        let Self::Arc { centre, radius, from, to } = self else { return vec![self.clone()] };
        let (low, high) = (from.min(*to), from.max(*to));
        let half_turn = TAU / 2.0;
        let first = ((low / half_turn - 0.5).floor() + 1.5) * half_turn;
        let mut angles = vec![low];
        let cuts = (0..).map(|k| first + f64::from(k) * half_turn);
        angles.extend(cuts.take_while(|&a| a < high));
        angles.push(high);
        let part = |pair: &[f64]| Self::Arc {
            centre: *centre,
            radius: *radius,
            from: pair[0],
            to: pair[1],
        };
        angles.windows(2).map(part).collect()
    }

    /// Points along it without its end: of a line its beginning, of what is bent also points between.
    pub fn samples(&self, between: usize) -> Vec<Point> {
        let count = if matches!(self, Self::Line { .. }) { 1 } else { between };
        (0..count).map(|k| self.at(k as f64 / count as f64)).collect()
    }

    /// Whether it lies on the axis, where a solid of revolution has no surface.
    pub fn is_on_axis(&self) -> bool {
        matches!(self, Self::Line { from, to } if from[0].abs() < SAME && to[0].abs() < SAME)
    }
}
