//! Edges that more than two faces share, because solids touch along them: which faces bound one solid, and how such solids come apart.

use super::adjacency::Sets;
use crate::geometry::Vec3;

/// A face at an edge: the direction from the edge to its third corner, and whether it runs along the edge from its lower end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    pub outward: Vec3,
    pub forward: bool,
}

/// Angles are told apart in so many steps around: faces upon one another differ by less, computed from corners in single precision.
const STEPS: i64 = 1 << 22;

/// Pairs of places in `faces`, each the two sides of one wedge of solid about an edge in the direction `along`; `None` where faces that open a wedge and
/// such that close one do not alternate as they must: they are not wound alike.
///
/// Going around the edge, the solid lies before a face that runs along it forward and behind one that runs back. Where wedges overlap, the pairs are nested;
/// which of them is whose makes no difference to what is wound around.
pub(super) fn pairs(along: Vec3, faces: &[Face]) -> Option<Vec<[usize; 2]>> {
    let axis = along.normalized();
    let flat = |face: &Face| face.outward - axis * face.outward.dot(axis);
    let x = flat(faces.first()?).normalized();
    let y = axis.cross(x);
    let turn = |face: &Face| {
        let u = flat(face);
        let share = u.dot(y).atan2(u.dot(x)) / std::f64::consts::TAU;
        ((share * STEPS as f64).round() as i64).rem_euclid(STEPS)
    };
    let mut order: Vec<(i64, bool, usize)> =
        faces.iter().enumerate().map(|(k, face)| (turn(face), !face.forward, k)).collect();
    // Where a solid ends and another begins upon the same face, the first ends first.
    order.sort_unstable();
    let depths = order.iter().scan(0i32, |depth, &(_, opens, _)| {
        *depth += if opens { 1 } else { -1 };
        Some(*depth)
    });
    let depths: Vec<i32> = depths.collect();
    if depths.last() != Some(&0) {
        return None;
    }
    // Begun behind the lowest place, no wedge is closed that was not opened.
    let lowest = (0..depths.len()).min_by_key(|&k| depths[k])?;
    order.rotate_left((lowest + 1) % depths.len());
    let mut open = Vec::new();
    let mut pairs = Vec::new();
    for (_, opens, k) in order {
        match opens {
            true => open.push(k),
            false => pairs.push([open.pop()?, k]),
        }
    }
    Some(pairs)
}

/// Gives the triangles that are not connected around a vertex vertices of their own, at the same place. `across` is the triangle over each edge (corner k
/// to k + 1). Returns how many were added.
pub(super) fn part(
    positions: &mut Vec<Vec3>,
    triangles: &mut [[u32; 3]],
    across: impl Fn(usize, usize) -> Option<usize>,
) -> usize {
    let mut fans = Sets::new(3 * triangles.len());
    for t in 0..triangles.len() {
        for k in 0..3 {
            let Some(other) = across(t, k) else { continue };
            for end in [k, (k + 1) % 3] {
                let vertex = triangles[t][end];
                if let Some(there) = triangles[other].iter().position(|&v| v == vertex) {
                    fans.join((3 * t + end) as u32, (3 * other + there) as u32);
                }
            }
        }
    }
    let before = positions.len();
    // The fan that keeps the vertex, and the new vertices of others.
    let mut keeps: Vec<Option<u32>> = vec![None; before];
    let mut new = std::collections::HashMap::new();
    for t in 0..triangles.len() {
        for k in 0..3 {
            let (fan, vertex) = (fans.of((3 * t + k) as u32), triangles[t][k]);
            if *keeps[vertex as usize].get_or_insert(fan) != fan {
                triangles[t][k] = *new.entry(fan).or_insert_with(|| {
                    positions.push(positions[vertex as usize]);
                    positions.len() as u32 - 1
                });
            }
        }
    }
    positions.len() - before
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces about +z at these angles in degrees, that open a wedge or close one.
    fn about(faces: &[(f64, bool)]) -> Option<Vec<[usize; 2]>> {
        let face = |&(angle, opens): &(f64, bool)| {
            let (sine, cosine) = angle.to_radians().sin_cos();
            Face { outward: Vec3::new(cosine, sine, 0.7), forward: !opens }
        };
        let faces: Vec<Face> = faces.iter().map(face).collect();
        let mut pairs = pairs(Vec3::new(0.0, 0.0, 2.0), &faces)?;
        pairs.sort_unstable();
        Some(pairs)
    }

    #[test]
    fn wedges_about_an_edge_are_told_apart() {
        // Two that touch along the edge only, in any order and begun anywhere.
        let apart = [(0.0, true), (90.0, false), (180.0, true), (270.0, false)];
        assert_eq!(about(&apart), Some(vec![[0, 1], [2, 3]]));
        assert_eq!(about(&[apart[3], apart[0], apart[2], apart[1]]), Some(vec![[1, 3], [2, 0]]));
        // Two that share a face: one ends there and the other begins.
        let shared = [(0.0, true), (90.0, true), (90.0, false), (180.0, false)];
        assert_eq!(about(&shared), Some(vec![[0, 2], [1, 3]]));
        // The same where angles begin anew.
        let shared = [(180.0, true), (0.0, true), (360.0, false), (90.0, false)];
        assert_eq!(about(&shared), Some(vec![[0, 2], [1, 3]]));
        // One within another.
        let within = [(0.0, true), (30.0, true), (60.0, false), (90.0, false)];
        assert_eq!(about(&within), Some(vec![[0, 3], [1, 2]]));
        // Not wound alike.
        assert_eq!(about(&[(0.0, true), (90.0, true), (180.0, true), (270.0, false)]), None);
    }
}
