//! Along a cone's straight lines normals are one: their lengths go with the distance from the tip.

use super::{COPLANAR, ONE, face_normal};
use crate::geometry::Vec3;
use crate::geometry::mesh::TriangleMesh;
use crate::geometry::mesh::adjacency::neighbours;

impl TriangleMesh {
    /// Gives normals along straight lines that meet in a point, as a cone's do, lengths that go with the distance from it.
    pub(super) fn follow_rulings(&mut self) {
        let Some(normals) = &self.normals else { return };
        let across = neighbours(&self.triangles);
        let [low, high] = self.bounds();
        let level = COPLANAR * (high - low).length();
        let lengths: Vec<[f64; 3]> = (0..self.triangles.len())
            .map(|t| self.distances_from_tip(t, normals, &across, level).unwrap_or([1.0; 3]))
            .collect();
        if let Some(normals) = &mut self.normals {
            for (n, lengths) in normals.iter_mut().zip(lengths) {
                *n = [0, 1, 2].map(|k| n[k] * lengths[k]);
            }
        }
    }

    /// The distances of a triangle's corners from where its straight lines meet, as shares of the largest: one line is its side with one normal at both
    /// ends, the other such a side of a triangle in its plane.
    fn distances_from_tip(
        &self,
        t: usize,
        normals: &[[Vec3; 3]],
        across: &[[u32; 3]],
        level: f64,
    ) -> Option<[f64; 3]> {
        let one = |a: Vec3, b: Vec3| (a - b).length() < ONE;
        let (p, n) = (self.corners(t), normals[t]);
        let k = (0..3).find(|&k| {
            let [i, j] = [(k + 1) % 3, (k + 2) % 3];
            one(n[i], n[j]) && !one(n[i], n[k]) && n[k].length() > 0.5
        })?;
        let [i, j] = [(k + 1) % 3, (k + 2) % 3];
        let face = face_normal(p);
        // Over the side opposite i lies a triangle with the corners k and j, and so on.
        let tip = [i, j].into_iter().find_map(|opposite| {
            let other = across[t][opposite] as usize;
            let third = *self.triangles.get(other)?;
            let far = (0..3).find(|&m| !self.triangles[t].contains(&third[m]))?;
            let m = self.positions[third[far] as usize];
            let flat = (m - p[k]).dot(face).abs() <= level;
            (flat && one(normals[other][far], n[k])).then_some(())?;
            // Where the lines from i to j and from k to m come nearest, in their plane.
            let (d, e) = (p[j] - p[i], m - p[k]);
            let turn = d.cross(e);
            // Parallel ones never meet: their normals are equally long.
            let sine = turn.length() / (d.length() * e.length());
            (sine > 1e-9)
                .then(|| p[i] + d * ((p[k] - p[i]).cross(e).dot(turn) / turn.squared_length()))
        })?;
        let distances = p.map(|p| (p - tip).length());
        let largest = distances.iter().fold(0.0, |a: f64, &b| a.max(b));
        // A point on the side itself would turn the normals about.
        let beyond = (p[i] - tip).dot(p[j] - tip) > 0.0;
        (beyond && largest > 0.0).then(|| distances.map(|d| d / largest))
    }
}
