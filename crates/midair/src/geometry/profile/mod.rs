//! The line that a solid of revolution or a prism has as its section: straight pieces, arcs of circles, and aspheres.

mod hollow;
mod integrals;
mod piece;
mod sag;
mod smooth;
#[cfg(test)]
mod tests;

pub use piece::{Piece, Point};
pub use sag::Sag;
pub use smooth::smooth;

/// Two ends nearer than this are one point, mm.
pub(super) const SAME: f64 = 1e-9;

/// A closed line around the section of a solid, counter-clockwise: what it surrounds lies on its left.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    pieces: Vec<Piece>,
}

/// Why a line surrounds nothing, or its inside cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// It surrounds no area.
    #[error("the line surrounds nothing")]
    Empty,
    /// It crosses or touches itself.
    #[error("the line crosses itself near [{:.3}, {:.3}]", .0[0], .0[1])]
    CrossesItself(Point),
    /// It lies on the axis' other side.
    #[error("the line crosses the axis near [{:.3}, {:.3}]", .0[0], .0[1])]
    CrossesAxis(Point),
    /// No room is left inside of the wall.
    #[error("a wall of {wall} mm leaves no room near [{:.3}, {:.3}]", .near[0], .near[1])]
    WallTooThick {
        /// The wall, mm.
        wall: f64,
        /// Where, in the section.
        near: Point,
    },
    /// A surface whose parallel surface is none of the forms here.
    #[error("an aspheric surface has no inner surface at an even distance")]
    Aspheric,
    /// Nothing flat at its top could be left open.
    #[error("it has no flat top that could be open")]
    NoTop,
    /// A liquid below the bottom.
    #[error("a liquid of that height has no room")]
    NoLiquid,
}

impl Profile {
    /// A closed line of pieces that join, each beginning where the one before ends; turned round if it is clockwise.
    ///
    /// # Errors
    /// When it surrounds nothing, or crosses itself.
    pub fn new(pieces: Vec<Piece>) -> Result<Self, ProfileError> {
        let mut pieces: Vec<Piece> = pieces.into_iter().filter(|p| p.length() > SAME).collect();
        let area: f64 = pieces.iter().map(Piece::area_term).sum();
        if pieces.is_empty() || !(area.abs() > SAME) {
            return Err(ProfileError::Empty);
        }
        if area < 0.0 {
            pieces = pieces.iter().rev().map(Piece::reversed).collect();
        }
        let profile = Self { pieces };
        match profile.crossing() {
            Some(place) => Err(ProfileError::CrossesItself(place)),
            None => Ok(profile),
        }
    }

    /// The section of a solid of revolution from its profile: points [from the axis, along it], from one end to the other. Ends that are
    /// not on the axis are joined to it by flat faces; a line that ends where it began is a ring.
    ///
    /// # Errors
    /// As [`Self::new`], and where it crosses the axis.
    pub fn turned(line: Vec<Piece>) -> Result<Self, ProfileError> {
        let mut pieces = line;
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
            return Err(ProfileError::Empty);
        };
        let (start, end) = (first.from(), last.to());
        if distance(start, end) > SAME {
            let axis = |p: Point| [0.0, p[1]];
            pieces.push(Piece::Line { from: end, to: axis(end) });
            pieces.push(Piece::Line { from: axis(end), to: axis(start) });
            pieces.push(Piece::Line { from: axis(start), to: start });
        }
        let profile = Self::new(pieces)?;
        for piece in &profile.pieces {
            let [low, _] = piece.bounds();
            if low[0] < -SAME {
                return Err(ProfileError::CrossesAxis(piece.middle()));
            }
        }
        Ok(profile)
    }

    /// Its pieces, in their order.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Least and largest coordinates.
    pub fn bounds(&self) -> [Point; 2] {
        let mut all = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for [low, high] in self.pieces.iter().map(Piece::bounds) {
            for axis in 0..2 {
                all[0][axis] = all[0][axis].min(low[axis]);
                all[1][axis] = all[1][axis].max(high[axis]);
            }
        }
        all
    }

    /// Whether a point lies within: a line from it to the right meets the pieces an odd number of times.
    pub fn contains(&self, point: Point) -> bool {
        self.pieces.iter().map(|piece| piece.meetings_to_the_right(point)).sum::<usize>() % 2 == 1
    }

    /// Points along it, for drawings and for what need not be exact: the ends of pieces, and points between them on what is bent.
    pub fn points(&self) -> Vec<Point> {
        self.pieces.iter().flat_map(|piece| piece.samples(BETWEEN)).collect()
    }

    /// A place where it crosses itself, by its points.
    fn crossing(&self) -> Option<Point> {
        let points = self.points();
        let n = points.len();
        let segment = |i: usize| (points[i], points[(i + 1) % n]);
        for i in 0..n {
            for j in i + 2..n {
                if i == 0 && j == n - 1 {
                    continue;
                }
                let ((a, b), (c, d)) = (segment(i), segment(j));
                if cross_each_other(a, b, c, d) {
                    return Some([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
                }
            }
        }
        None
    }
}

/// Points on each bent piece.
const BETWEEN: usize = 12;

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Whether two segments cross within both, ends apart.
fn cross_each_other(a: Point, b: Point, c: Point, d: Point) -> bool {
    let side = |p: Point, q: Point, r: Point| {
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    let opposite = |x: f64, y: f64| x * y < 0.0;
    opposite(side(a, b, c), side(a, b, d)) && opposite(side(c, d, a), side(c, d, b))
}
