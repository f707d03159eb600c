//! Which of a file's triangles make up the surface: vertices at one place are one, what this collapses goes.

use crate::geometry::Vec3;
use crate::geometry::mesh::measure::bounds;
use crate::geometry::mesh::{MeshError, RawMesh};
use std::collections::HashMap;

/// The triangles that make up the surface.
pub(super) struct Kept {
    pub(super) triangles: Vec<[u32; 3]>,
    /// For each its place in the file's own list.
    pub(super) origin: Vec<usize>,
    /// Places of triangles with corners at one place.
    pub(super) collapsed: Vec<usize>,
    /// Places of triangles with the corners of an earlier one.
    pub(super) repeated: Vec<usize>,
    /// Whether one of these is wound against the earlier one.
    pub(super) opposite: bool,
}

impl Kept {
    /// `walls`: two triangles upon one another that are wound against each other both go.
    pub(super) fn of(raw: &RawMesh, representative: &[u32], walls: bool) -> Self {
        let count = raw.triangles.len();
        let (mut triangles, mut origin) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let (mut collapsed, mut repeated, mut opposite) = (Vec::new(), Vec::new(), false);
        // The sense and the place of the triangle that is kept, by its corners.
        let mut seen: HashMap<[u32; 3], (bool, usize)> = HashMap::with_capacity(count);
        let mut gone = std::collections::HashSet::new();
        for (i, triangle) in raw.triangles.iter().enumerate() {
            let t = triangle.map(|v| representative[v as usize]);
            if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
                collapsed.push(i);
                continue;
            }
            let mut sorted = t;
            sorted.sort_unstable();
            let least = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
            let sense = t[(least + 1) % 3] < t[(least + 2) % 3];
            if let Some(&(earlier, place)) = seen.get(&sorted) {
                repeated.push(i);
                opposite |= earlier != sense;
                if walls && earlier != sense {
                    seen.remove(&sorted);
                    gone.insert(place);
                }
                continue;
            }
            seen.insert(sorted, (sense, triangles.len()));
            triangles.push(t);
            origin.push(i);
        }
        let stays = |k: &usize| !gone.contains(k);
        repeated.extend(gone.iter().map(|&k| origin[k]));
        repeated.sort_unstable();
        let kept: Vec<usize> = (0..triangles.len()).filter(stays).collect();
        Self {
            triangles: kept.iter().map(|&k| triangles[k]).collect(),
            origin: kept.iter().map(|&k| origin[k]).collect(),
            collapsed,
            repeated,
            opposite,
        }
    }
}

/// For each vertex the first one that stands within `tolerance` of it.
///
/// Vertices are sorted into cells of four tolerances, so a vertex's neighbourhood touches at most
/// eight, and a cell holds few distinct ones however they are crowded.
pub(super) fn merge(positions: &[Vec3], tolerance: f64) -> Vec<u32> {
    let cell = if tolerance > 0.0 { 4.0 * tolerance } else { 1.0 };
    let origin = bounds(positions.iter().copied().filter(|p| p.is_finite()))[0];
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::with_capacity(positions.len());
    let mut result = Vec::with_capacity(positions.len());
    for (v, &p) in positions.iter().enumerate() {
        let at = (p - origin).to_array();
        let low = at.map(|x| ((x - tolerance) / cell).floor() as i64);
        let high = at.map(|x| ((x + tolerance) / cell).floor() as i64);
        let mut found = None;
        'search: for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let near = cells.get(&[x, y, z]).and_then(|list| {
                        list.iter().find(|&&r| (positions[r as usize] - p).length() <= tolerance)
                    });
                    if let Some(&r) = near {
                        found = Some(r);
                        break 'search;
                    }
                }
            }
        }
        result.push(found.unwrap_or_else(|| {
            let own = at.map(|x| (x / cell).floor() as i64);
            cells.entry(own).or_default().push(v as u32);
            v as u32
        }));
    }
    result
}

/// Refuses triangles with distinct corners and no area: dropping them would tear the surface.
pub(super) fn slivers(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    tolerance: f64,
    file: &str,
    name: &dyn Fn(usize) -> String,
) -> Result<(), MeshError> {
    let thin: Vec<usize> = (0..triangles.len())
        .filter(|&t| {
            let [a, b, c] = triangles[t].map(|v| positions[v as usize]);
            let (ab, bc, ca) = (b - a, c - b, a - c);
            let longest = ab.length().max(bc.length()).max(ca.length());
            // Height over the longest edge.
            ab.cross(ca).length() <= tolerance * longest
        })
        .collect();
    let Some(&first) = thin.first() else { return Ok(()) };
    let more = match thin.len() - 1 {
        0 => String::new(),
        more => format!(" ({more} more faces likewise)"),
    };
    Err(MeshError::new(
        file,
        format!("{} is degenerate: its corners lie on one line{more}", name(first)),
        "remove the face by merging its corners (in Blender: Mesh > Clean Up > Degenerate \
         Dissolve) and export again",
    ))
}
