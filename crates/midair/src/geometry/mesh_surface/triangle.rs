//! A triangle as a ray meets it: its plane, its barycentric coordinates, the watertight test.

use crate::geometry::{Crossing, Ray, Real, Vec3};

#[derive(Clone, Copy)]
pub(super) struct Triangle {
    pub(super) corners: [Vec3; 3],
    /// Unit normal, outward by the corners' sense.
    pub(super) normal: Vec3,
    /// Gradients of the barycentric coordinates of corners 1 and 2.
    pub(super) gradients: [Vec3; 2],
}

impl Triangle {
    pub(super) fn new(corners: [Vec3; 3]) -> Self {
        let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
        let area = e1.cross(e2);
        let inverse = 1.0 / area.squared_length();
        Self {
            corners,
            normal: area.normalized(),
            gradients: [e2.cross(area) * inverse, area.cross(e1) * inverse],
        }
    }

    pub(super) fn crossing(&self, direction: Vec3) -> Crossing {
        if direction.dot(self.normal) < 0.0 { Crossing::Enter } else { Crossing::Leave }
    }

    pub(super) fn plane_distance<T: Real>(&self, ray: &Ray<T>) -> T {
        (Vec3::constant(self.corners[0]) - ray.origin).dot_plain(self.normal)
            / ray.direction.dot_plain(self.normal)
    }

    /// Barycentric coordinates of a point of the plane.
    pub(super) fn weights<T: Real>(&self, point: Vec3<T>) -> [T; 3] {
        let p = point - Vec3::constant(self.corners[0]);
        let (b, c) = (p.dot_plain(self.gradients[0]), p.dot_plain(self.gradients[1]));
        [-(b + c) + 1.0, b, c]
    }
}

/// A ray prepared for the watertight triangle test of Woop, Benthin and Wald (JCGT 2013): in axes permuted and sheared
/// so that it runs along z, an edge's side is decided by the same arithmetic for both triangles that share it.
pub(super) struct Sheared {
    origin: Vec3,
    axes: [usize; 3],
    shear: [f64; 3],
}

impl Sheared {
    pub(super) fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let z = (0..3).max_by(|&a, &b| d[a].abs().total_cmp(&d[b].abs())).unwrap_or(2);
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        Self { origin: ray.origin, axes: [x, y, z], shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]] }
    }

    pub(super) fn hit(&self, triangle: &Triangle) -> Option<f64> {
        self.strike(triangle).map(|(t, _)| t)
    }

    /// Where the triangle is hit, and whether on an edge, where its neighbour is hit as well.
    pub(super) fn strike(&self, triangle: &Triangle) -> Option<(f64, bool)> {
        let [x, y, z] = self.axes;
        let [a, b, c] = triangle.corners.map(|corner| {
            let p = (corner - self.origin).to_array();
            [p[x] - self.shear[0] * p[z], p[y] - self.shear[1] * p[z], self.shear[2] * p[z]]
        });
        let edge = |p: [f64; 3], q: [f64; 3]| p[0] * q[1] - p[1] * q[0];
        let weights = [edge(c, b), edge(a, c), edge(b, a)];
        if weights.iter().any(|w| *w < 0.0) && weights.iter().any(|w| *w > 0.0) {
            return None;
        }
        let sum = weights[0] + weights[1] + weights[2];
        if sum == 0.0 {
            return None;
        }
        let t = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / sum;
        Some((t, weights.contains(&0.0)))
    }
}
