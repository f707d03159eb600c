//! What polishing does to a scan: its roughness goes, its form stays.

use super::TriangleMesh;
use crate::geometry::Vec3;

/// Shares of the way to the neighbours' middle: towards it, and back. The two let waves longer than about ten edges pass as they are (Taubin, SIGGRAPH 1995,
/// 351-358: pass band 1 / INWARD + 1 / OUTWARD = 0.1).
const INWARD: f64 = 0.5;
const OUTWARD: f64 = 1.0 / (0.1 - 1.0 / INWARD);

/// How far smoothing moved a surface's vertices, in its unit of length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// Root mean square.
    pub rms: f64,
    /// The largest way.
    pub most: f64,
}

impl TriangleMesh {
    /// The mesh smoothed by so many steps, and how far that moved it. Each step moves all vertices towards the middle of their neighbours and a little
    /// farther back, so that bodies do not shrink. Vertices on the rim of an open surface stay. Normals that the file gave are left out: they were of
    /// the surface before.
    pub fn smoothed(mut self, steps: usize) -> (Self, Moved) {
        if steps == 0 {
            return (self, Moved::default());
        }
        let before = self.positions.clone();
        let (neighbours, at_rim) = self.rings();
        for _ in 0..steps {
            for share in [INWARD, OUTWARD] {
                let at = &self.positions;
                let moved = (0..at.len()).map(|v| {
                    let ring = &neighbours[v];
                    if at_rim[v] || ring.is_empty() {
                        return at[v];
                    }
                    let sum = ring.iter().fold(Vec3::ZERO, |sum, &n| sum + at[n as usize]);
                    at[v] + (sum * (1.0 / ring.len() as f64) - at[v]) * share
                });
                self.positions = moved.collect();
            }
        }
        self.given_normals = Vec::new();
        self.normals = None;
        let ways = before.iter().zip(&self.positions).map(|(&a, &b)| (b - a).length());
        let (mut sum, mut most) = (0.0, 0.0_f64);
        for way in ways {
            (sum, most) = (sum + way * way, most.max(way));
        }
        let rms = (sum / before.len().max(1) as f64).sqrt();
        (self, Moved { rms, most })
    }

    /// The vertices that each vertex shares an edge with, and whether one of its edges has a face on one side alone.
    fn rings(&self) -> (Vec<Vec<u32>>, Vec<bool>) {
        let mut rings = vec![Vec::new(); self.positions.len()];
        let mut at_rim = vec![false; self.positions.len()];
        let beyond = super::adjacency::neighbours(&self.triangles);
        for (triangle, beyond) in self.triangles.iter().zip(beyond) {
            for opposite in 0..3 {
                let (a, b) = (triangle[(opposite + 1) % 3], triangle[(opposite + 2) % 3]);
                rings[a as usize].push(b);
                if beyond[opposite] == super::adjacency::NONE {
                    rings[b as usize].push(a);
                    at_rim[a as usize] = true;
                    at_rim[b as usize] = true;
                }
            }
        }
        for ring in &mut rings {
            ring.sort_unstable();
            ring.dedup();
        }
        (rings, at_rim)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere of 20 mm as a grid over its angles, each vertex off by up to `rough` along its radius.
    fn ball(rough: f64) -> TriangleMesh {
        let (columns, rows) = (96, 48);
        let mut random = fastrand::Rng::with_seed(11);
        let mut positions = vec![Vec3::new(0.0, 20.0, 0.0)];
        for row in 1..rows {
            for column in 0..columns {
                let (a, b) = (
                    std::f64::consts::PI * f64::from(row) / f64::from(rows),
                    std::f64::consts::TAU * f64::from(column) / f64::from(columns),
                );
                let r = 20.0 + rough * (2.0 * random.f64() - 1.0);
                positions.push(Vec3::new(
                    r * a.sin() * b.sin(),
                    r * a.cos(),
                    r * a.sin() * b.cos(),
                ));
            }
        }
        positions.push(Vec3::new(0.0, -20.0, 0.0));
        let last = (positions.len() - 1) as u32;
        let (columns, rows) = (columns as u32, rows as u32);
        let at = |row: u32, column: u32| 1 + (row - 1) * columns + column % columns;
        let mut triangles = Vec::new();
        for column in 0..columns {
            triangles.push([0, at(1, column), at(1, column + 1)]);
            triangles.push([last, at(rows - 1, column + 1), at(rows - 1, column)]);
            for row in 1..rows - 1 {
                let [a, b] = [at(row, column), at(row, column + 1)];
                let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
                triangles.extend([[a, c, d], [a, d, b]]);
            }
        }
        TriangleMesh { positions, triangles, ..TriangleMesh::default() }
    }

    /// Root mean square of the radius' deviation from its mean, away from the poles, where edges are short.
    fn roughness(mesh: &TriangleMesh) -> f64 {
        let radii: Vec<f64> =
            mesh.positions.iter().filter(|p| p.y.abs() < 14.0).map(|p| p.length()).collect();
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        (radii.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / radii.len() as f64).sqrt()
    }

    #[test]
    fn roughness_goes_and_the_form_stays() {
        let rough = ball(0.1);
        let (before, volume) = (roughness(&rough), rough.signed_volume());
        let (smooth, moved) = rough.clone().smoothed(20);
        // Uniform within 0.1: 0.1 / sqrt(3).
        assert!((before - 0.0577).abs() < 0.005, "{before}");
        // Of white noise on a mesh of six neighbours a ninth of the power lies in waves that twenty steps let pass: those whose mean neighbour is off by
        // less than 0.4 of them. Its root is a third.
        assert!(roughness(&smooth) < 0.4 * before, "{}", roughness(&smooth));
        // A ball of 20 mm has waves of its own far longer than ten edges.
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 20f64.powi(3);
        assert!((volume / exact - 1.0).abs() < 0.01, "{volume} {exact}");
        // At the poles of the grid 96 edges meet, and no wave there is long: a hundredth for them.
        assert!((smooth.signed_volume() / volume - 1.0).abs() < 0.01);
        // What went of the roughness is what the vertices moved by, and at the poles some of the grid's own unevenness.
        assert!((0.6 * before..2.0 * before).contains(&moved.rms), "{moved:?}");
        assert!(moved.most >= moved.rms && moved.most < 0.5, "{moved:?}");
        let (same, still) = rough.clone().smoothed(0);
        assert_eq!((same, still), (rough, Moved::default()));
    }

    #[test]
    fn a_plane_stays_and_its_rim_with_it() {
        let side = 9u32;
        let positions: Vec<Vec3> = (0..side * side)
            .map(|i| Vec3::new(f64::from(i % side), f64::from(i / side), 0.5 * f64::from(i % side)))
            .collect();
        let mut triangles = Vec::new();
        for y in 0..side - 1 {
            for x in 0..side - 1 {
                let a = y * side + x;
                triangles.extend([[a, a + 1, a + side + 1], [a, a + side + 1, a + side]]);
            }
        }
        let mesh = TriangleMesh { positions, triangles, ..TriangleMesh::default() };
        let (smooth, moved) = mesh.clone().smoothed(50);
        // Neighbours lie symmetrically about every vertex within.
        assert!(moved.most < 1e-12, "{moved:?}");
        assert_eq!(smooth.triangles, mesh.triangles);
    }
}
