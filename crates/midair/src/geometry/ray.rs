//! Rays, and what they meet.

use super::{Frame, Real, Vec3};

/// A half-line. In transport its direction has length 1, so distances along it are mm.
#[derive(Clone, Copy, Debug)]
pub struct Ray<T = f64> {
    /// Where it starts.
    pub origin: Vec3<T>,
    /// Which way it goes.
    pub direction: Vec3<T>,
}

impl<T: Real> Ray<T> {
    /// The point at distance `t`.
    #[inline]
    pub fn at(&self, t: T) -> Vec3<T> {
        self.origin + self.direction.scaled(t)
    }

    /// The same ray in a thing's own frame; lengths along it stay as they are.
    #[inline]
    pub fn to_local(&self, frame: &Frame) -> Self {
        Self {
            origin: frame.to_local(self.origin),
            direction: frame.to_local_direction(self.direction),
        }
    }

    /// The ray without derivatives.
    #[inline]
    pub fn value(&self) -> Ray {
        Ray { origin: self.origin.value(), direction: self.direction.value() }
    }
}

/// Which of a surface's two meetings with a line is meant: a solid's way in or its way out; for an
/// open sheet the first or the second along the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Crossing {
    /// Into the solid, or the first meeting.
    Enter,
    /// Out of the solid, or the second meeting.
    Leave,
}

/// A meeting of a ray with a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, mm.
    pub t: f64,
    /// Which of the shape's faces (a box's side, a mesh's triangle).
    pub face: u32,
    /// Which way through it.
    pub crossing: Crossing,
}

/// What a search along a ray may find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// For a solid: its way in or its way out, whichever fits where the ray is now. `None` for a sheet.
    pub crossing: Option<Crossing>,
    /// Hits at or before this distance do not count.
    pub after: f64,
    /// The face that the ray has just left, if this is the shape that it stands on.
    pub standing_on: Option<u32>,
}
