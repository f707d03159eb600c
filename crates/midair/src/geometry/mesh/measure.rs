//! Plain measures of a mesh: volume, bounds, inside.

use super::TriangleMesh;
use crate::geometry::Vec3;
use std::f64::consts::TAU;

impl TriangleMesh {
    /// A triangle's corners. Panics if the triangle or its indices are out of range, which
    /// [`super::read`] refuses.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }

    /// The mesh with every coordinate times a positive factor.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.positions.iter_mut().for_each(|p| *p = *p * factor);
        self
    }

    /// The least and greatest coordinates; infinite and inside out without vertices.
    pub fn bounds(&self) -> [Vec3; 2] {
        bounds(self.positions.iter().copied())
    }

    /// The volume that the surface encloses, positive where faces are counter-clockwise seen from
    /// outside, in cubed units of length: a sixth of the sum of the corners' triple products (divergence
    /// theorem). Means nothing for an open surface.
    pub fn signed_volume(&self) -> f64 {
        // About a point near the surface, so that a mesh far from the origin loses no digits.
        let Some(&origin) = self.positions.first() else { return 0.0 };
        let sum: f64 = (0..self.triangles.len())
            .map(|t| {
                let [a, b, c] = self.corners(t).map(|p| p - origin);
                a.dot(b.cross(c))
            })
            .sum();
        sum / 6.0
    }

    /// Whether a point lies inside the closed surface: its winding number is not zero.
    pub fn contains(&self, point: Vec3) -> bool {
        let [low, high] = self.bounds();
        let beyond = |p: f64, low: f64, high: f64| !(low..=high).contains(&p);
        if beyond(point.x, low.x, high.x)
            || beyond(point.y, low.y, high.y)
            || beyond(point.z, low.z, high.z)
        {
            return false;
        }
        self.winding_number(point).round() != 0.0
    }

    /// How many times the surface winds round a point: the sum of the triangles' solid angles over
    /// 4 pi. Solid angles by van Oosterom and Strackee (1983), equation 8.
    pub fn winding_number(&self, point: Vec3) -> f64 {
        winding_number((0..self.triangles.len()).map(|t| self.corners(t)), point)
    }
}

pub(super) fn bounds(points: impl Iterator<Item = Vec3>) -> [Vec3; 2] {
    let inf = f64::INFINITY;
    points.fold([Vec3::new(inf, inf, inf), Vec3::new(-inf, -inf, -inf)], |[low, high], p| {
        [
            Vec3::new(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z)),
            Vec3::new(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z)),
        ]
    })
}

pub(super) fn winding_number(triangles: impl Iterator<Item = [Vec3; 3]>, point: Vec3) -> f64 {
    let sum: f64 = triangles
        .map(|corners| {
            let [a, b, c] = corners.map(|p| p - point);
            let [la, lb, lc] = [a, b, c].map(Vec3::length);
            let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            a.dot(b.cross(c)).atan2(below)
        })
        .sum();
    // Each arc tangent is half a solid angle.
    sum / TAU
}
