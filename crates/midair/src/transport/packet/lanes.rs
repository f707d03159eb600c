//! Rays as plain arrays.

use crate::geometry::{Ray, Vec3};

/// Rays of a packet: some rounds of the widest instructions, while all arrays stay in the first cache.
pub(crate) const LANES: usize = 32;

/// Rays side by side.
#[derive(Clone, Copy)]
pub(crate) struct Lanes {
    origin: [[f64; LANES]; 3],
    direction: [[f64; LANES]; 3],
}

impl Lanes {
    pub(crate) fn new() -> Self {
        Self { origin: [[0.0; LANES]; 3], direction: [[0.0; LANES]; 3] }
    }

    #[inline(always)]
    pub(crate) fn ray(&self, i: usize) -> Ray {
        let vector = |v: &[[f64; LANES]; 3]| Vec3::new(v[0][i], v[1][i], v[2][i]);
        Ray { origin: vector(&self.origin), direction: vector(&self.direction) }
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, ray: &Ray) {
        let (o, d) = (ray.origin, ray.direction);
        (self.origin[0][i], self.origin[1][i], self.origin[2][i]) = (o.x, o.y, o.z);
        (self.direction[0][i], self.direction[1][i], self.direction[2][i]) = (d.x, d.y, d.z);
    }
}

/// Whether so many rays left the course that another one is worth looking for.
pub(crate) fn is_lost(kept: &[bool; LANES]) -> bool {
    2 * kept.iter().filter(|&&kept| kept).count() < LANES
}
