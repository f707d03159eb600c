//! Which of a mesh's closed bodies overlap or touch, and which cross themselves.

use super::TriangleMesh;
use super::measure::bounds;
use crate::geometry::{MeshSurface, Ray, Search, Vec3};
use rayon::prelude::*;

/// Bodies nearer than this share of the mesh's extent touch: single precision resolves 6e-8.
pub(in crate::geometry) const TOUCHING: f64 = 1e-6;

/// The pairs of bodies (numbers from 0, one for each triangle) whose surfaces meet. A body within another is none.
///
/// Two closed surfaces meet where an edge of one crosses a face of the other.
pub(super) fn overlapping(mesh: &TriangleMesh, bodies: &[u32]) -> Vec<[u32; 2]> {
    let count = bodies.iter().max().map_or(0, |&most| most as usize + 1);
    if count < 2 {
        return Vec::new();
    }
    let [low, high] = mesh.bounds();
    let margin = TOUCHING * (high - low).length();
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (t, &body) in bodies.iter().enumerate() {
        members[body as usize].push(t);
    }
    let boxes: Vec<[Vec3; 2]> = members
        .iter()
        .map(|triangles| bounds(triangles.iter().flat_map(|&t| mesh.corners(t))))
        .collect();
    let near = |[al, ah]: [Vec3; 2], [bl, bh]: [Vec3; 2]| {
        let apart = |low: f64, high: f64| low > high + margin;
        let [al, ah, bl, bh] = [al, ah, bl, bh].map(Vec3::to_array);
        (0..3).all(|k| !apart(al[k], bh[k]) && !apart(bl[k], ah[k]))
    };
    let mut surfaces: Vec<Option<MeshSurface>> = vec![None; count];
    let mut found = Vec::new();
    for a in 0..count {
        for b in a + 1..count {
            if !near(boxes[a], boxes[b]) {
                continue;
            }
            let mut meet = |edges: usize, faces: usize| {
                let surface = surfaces[faces]
                    .get_or_insert_with(|| MeshSurface::new(&part(mesh, &members[faces])));
                members[edges].iter().any(|&t| {
                    let p = mesh.corners(t);
                    (0..3).any(|k| {
                        let (from, to) = (p[k], p[(k + 1) % 3]);
                        let touches = near(bounds([from, to].into_iter()), boxes[faces]);
                        // Each edge is one of two triangles, walked both ways: once is enough.
                        touches
                            && from.to_array() < to.to_array()
                            && crosses(surface, from, to, margin)
                    })
                })
            };
            if meet(a, b) || meet(b, a) {
                found.push([a as u32, b as u32]);
            }
        }
    }
    found
}

/// The first triangle of which an edge goes through another face of the same body: its surface crosses itself.
pub(super) fn crossing_itself(mesh: &TriangleMesh, bodies: &[u32]) -> Option<usize> {
    let [low, high] = mesh.bounds();
    let margin = TOUCHING * (high - low).length();
    let surface = MeshSurface::new(mesh);
    (0..mesh.triangles.len()).into_par_iter().find_first(|&t| {
        let triangle = mesh.triangles[t];
        (0..3).any(|k| {
            let edge = [triangle[k], triangle[(k + 1) % 3]];
            let counts = |face: u32| {
                let other = &mesh.triangles[face as usize];
                bodies[face as usize] == bodies[t] && !edge.iter().any(|v| other.contains(v))
            };
            // Each edge is one of two triangles, walked both ways: once is enough.
            edge[0] < edge[1]
                && surface.is_pierced(edge.map(|v| mesh.positions[v as usize]), margin, counts)
        })
    })
}

/// Whether the line between two points, a little longer at both ends, crosses a surface.
fn crosses(surface: &MeshSurface, from: Vec3, to: Vec3, margin: f64) -> bool {
    let length = (to - from).length();
    let direction = (to - from) * (1.0 / length);
    let ray = Ray { origin: from - direction * margin, direction };
    let search = Search { crossing: None, after: 0.0, standing_on: None };
    surface.nearest(&ray, search).is_some_and(|hit| hit.t <= length + 2.0 * margin)
}

/// Some of a mesh's triangles as a mesh, each with corners of its own.
fn part(mesh: &TriangleMesh, triangles: &[usize]) -> TriangleMesh {
    TriangleMesh {
        positions: triangles.iter().flat_map(|&t| mesh.corners(t)).collect(),
        triangles: (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        ..TriangleMesh::default()
    }
}
