//! The paths of a bundle, lane by lane.

use super::{Chance, LANES, Ray, Vec3};

/// A bundle of paths under way.
pub(in crate::simulate) struct Bundle {
    pub(super) origin: [[f64; LANES]; 3],
    pub(super) direction: [[f64; LANES]; 3],
    pub(super) chance: [f64; LANES],
    /// The state at the start, for those who leave the course.
    pub(super) start: ([[f64; LANES]; 3], [[f64; LANES]; 3], [f64; LANES]),
    /// Whether the path kept to the course.
    pub(super) kept: [bool; LANES],
    pub(super) inside: [bool; LANES],
    /// Whether it ends dark, if it kept to the course.
    pub(super) dark: [bool; LANES],
    /// Way through the solid, mm.
    pub(super) length: [f64; LANES],
    pub(super) mirrors: [[f64; LANES]; 2],
    pub(super) faces: [f64; LANES],
    pub(super) cos_t: [f64; LANES],
    pub(super) st: [[f64; LANES]; 2],
}

impl Bundle {
    pub(in crate::simulate) fn new() -> Self {
        let none = [0.0; LANES];
        Self {
            origin: [none; 3],
            direction: [none; 3],
            chance: none,
            start: ([none; 3], [none; 3], none),
            kept: [true; LANES],
            inside: [false; LANES],
            dark: [false; LANES],
            length: none,
            mirrors: [none; 2],
            faces: none,
            cos_t: none,
            st: [none; 2],
        }
    }

    #[inline(always)]
    pub(super) fn ray(&self, i: usize) -> Ray {
        let vector = |v: &[[f64; LANES]; 3]| Vec3::new(v[0][i], v[1][i], v[2][i]);
        Ray { origin: vector(&self.origin), direction: vector(&self.direction) }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, ray: &Ray) {
        let (o, d) = (ray.origin, ray.direction);
        (self.origin[0][i], self.origin[1][i], self.origin[2][i]) = (o.x, o.y, o.z);
        (self.direction[0][i], self.direction[1][i], self.direction[2][i]) = (d.x, d.y, d.z);
    }

    /// Whether so many paths left the course that another one is worth looking for.
    pub(in crate::simulate) fn is_lost(&self) -> bool {
        2 * self.kept.iter().filter(|&&kept| kept).count() < LANES
    }

    /// The ray that a path set out with, and its chance.
    pub(in crate::simulate) fn first(&self, i: usize) -> (Ray, Chance) {
        let (origin, direction, chance) = &self.start;
        let vector = |v: &[[f64; LANES]; 3]| Vec3::new(v[0][i], v[1][i], v[2][i]);
        (Ray { origin: vector(origin), direction: vector(direction) }, Chance(chance[i]))
    }
}
