//! The paths of a bundle, lane by lane.

use super::{Chance, LANES, Ray};
use crate::transport::packet::{Lanes, is_lost};

/// A bundle of paths under way.
pub(in crate::simulate) struct Bundle {
    pub(super) rays: Lanes,
    pub(super) chance: [f64; LANES],
    /// The state at the start, for those who leave the course.
    pub(super) start: (Lanes, [f64; LANES]),
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
            rays: Lanes::new(),
            chance: none,
            start: (Lanes::new(), none),
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
        self.rays.ray(i)
    }

    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, ray: &Ray) {
        self.rays.set(i, ray);
    }

    /// Whether so many paths left the course that another one is worth looking for.
    pub(in crate::simulate) fn is_lost(&self) -> bool {
        is_lost(&self.kept)
    }

    /// The ray that a path set out with, and its chance.
    pub(in crate::simulate) fn first(&self, i: usize) -> (Ray, Chance) {
        let (rays, chance) = &self.start;
        (rays.ray(i), Chance(chance[i]))
    }
}
