//! Cutting a polygon into triangles: ears are cut by a library, in the plane of two coordinates.
//!
//! What is added here is what a surface needs and a filled shape does not: every corner stays a corner. A corner that lies on the line of its
//! neighbours has no ear, so the library leaves it out, or makes an ear without area of it; either would tear the surface from the face beyond.

use crate::geometry::Vec3;
use std::collections::HashMap;

/// A polygon whose border crosses itself, or that is so bent that it does so when seen along its own normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tangled;

/// Triangles lower than this share of the polygon's extent have no area: single precision resolves 6e-8 of a coordinate.
const FLAT: f64 = 1e-6;
/// Sums of areas that differ by more than this share are not rounding.
const AREA: f64 = 1e-6;

/// Cuts a polygon with these corners in space into triangles with its sense, as places in `corners`. Corners may stand at one place, as where a
/// bridge leads to a hole and back.
pub(super) fn cut(corners: &[Vec3]) -> Result<Vec<[usize; 3]>, Tangled> {
    let n = corners.len();
    let fan = || (2..n).map(|k| [0, k - 1, k]).collect();
    if n <= 3 {
        return Ok(fan());
    }
    let Some(points) = flattened(corners) else {
        // All on one line: there is nothing to cut, and the mesh is refused for it later.
        return Ok(fan());
    };
    let convex = (0..n).all(|k| cross(points[k], points[(k + 1) % n], points[(k + 2) % n]) > 0.0);
    if n == 4 && convex {
        return Ok(fan());
    }
    let mut ears: Vec<u32> = Vec::new();
    earcut::Earcut::new().earcut(points.iter().copied(), &[], &mut ears);
    let found: Vec<[usize; 3]> = ears
        .as_chunks::<3>()
        .0
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|k| k as usize);
            if cross(points[a], points[b], points[c]) < 0.0 { [a, c, b] } else { [a, b, c] }
        })
        .collect();
    let extent = extent(&points);
    let low = |t: &[usize; 3]| height(t.map(|k| points[k])) <= FLAT * extent;
    let upright: Vec<[usize; 3]> = found.iter().copied().filter(|t| !low(t)).collect();
    let mut first = HashMap::new();
    let vertex: Vec<usize> = corners
        .iter()
        // Adding 0 makes the two zeros one.
        .map(|p| {
            let next = first.len();
            *first.entry(p.to_array().map(|x| (x + 0.0).to_bits())).or_insert(next)
        })
        .collect();
    let polygon = Polygon { points: &points, vertex, extent };
    // A polygon that is thin all over has nothing but such triangles, and they are its own.
    [upright, found].into_iter().find_map(|triangles| polygon.joined(triangles)).ok_or(Tangled)
}

/// The corners in two of their coordinates, counter-clockwise: those that the polygon's normal (Newell's sum) is least along. Lines stay lines.
fn flattened(corners: &[Vec3]) -> Option<Vec<[f64; 2]>> {
    let origin = corners[0];
    let normal = corners
        .iter()
        .zip(corners.iter().cycle().skip(1))
        .fold(Vec3::ZERO, |sum, (&a, &b)| sum + (a - origin).cross(b - origin))
        .to_array();
    let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()))?;
    let (mut x, mut y) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        (x, y) = (y, x);
    }
    let points = corners.iter().map(|&p| {
        let p = (p - origin).to_array();
        [p[x], p[y]]
    });
    (normal[axis] != 0.0 && normal[axis].is_finite()).then(|| points.collect())
}

/// Twice the area of a triangle, positive counter-clockwise.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// A triangle's height over its longest side.
fn height([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let longest = distance(a, b).max(distance(b, c)).max(distance(c, a));
    if longest > 0.0 { cross(a, b, c).abs() / longest } else { 0.0 }
}

fn extent(points: &[[f64; 2]]) -> f64 {
    points.iter().fold(0.0, |largest, &p| f64::max(largest, distance(points[0], p)))
}

struct Polygon<'a> {
    points: &'a [[f64; 2]],
    /// Which place each corner stands at.
    vertex: Vec<usize>,
    extent: f64,
}

impl Polygon<'_> {
    /// The triangles with their sides split where corners lie on them, so that the sides that no two triangles share are the polygon's own. `None`
    /// where that cannot be: the triangles do not fill the polygon.
    fn joined(&self, mut triangles: Vec<[usize; 3]>) -> Option<Vec<[usize; 3]>> {
        // Each side counts for the triangle's way along it, and against the polygon's own way: all cancel at last.
        let mut open: HashMap<(usize, usize), i32> = HashMap::new();
        let n = self.points.len();
        let count = |open: &mut HashMap<(usize, usize), i32>, a: usize, b: usize, by: i32| {
            let (a, b) = (self.vertex[a], self.vertex[b]);
            if a != b {
                *open.entry((a.min(b), a.max(b))).or_default() += if a < b { by } else { -by };
            }
        };
        (0..n).for_each(|k| count(&mut open, k, (k + 1) % n, -1));
        for t in &triangles {
            (0..3).for_each(|k| count(&mut open, t[k], t[(k + 1) % 3], 1));
        }
        let mut at = 0;
        while at < triangles.len() {
            let [a, b, c] = triangles[at];
            let split = [[a, b, c], [b, c, a], [c, a, b]].into_iter().find_map(|[a, b, c]| {
                let (va, vb) = (self.vertex[a], self.vertex[b]);
                let excess = *open.get(&(va.min(vb), va.max(vb)))?;
                let forward = if va < vb { excess } else { -excess };
                (forward > 0).then(|| self.corner_on(a, b)).flatten().map(|m| [a, m, b, c])
            });
            // Each split gives a corner to a side that lacked it; a polygon has no more than n of them on any of its 2 n sides.
            let Some([a, m, b, c]) = split.filter(|_| triangles.len() <= 2 * n * n) else {
                at += 1;
                continue;
            };
            count(&mut open, a, b, -1);
            for (from, to) in [(a, m), (m, b)] {
                count(&mut open, from, to, 1);
            }
            // The side from m to c is walked both ways.
            triangles[at] = [a, m, c];
            triangles.push([m, b, c]);
        }
        let area = |t: &[usize; 3]| cross(self.points[t[0]], self.points[t[1]], self.points[t[2]]);
        let filled: f64 = triangles.iter().map(area).sum();
        let own: f64 = (1..n - 1).map(|k| area(&[0, k, k + 1])).sum();
        let closed = open.values().all(|&count| count == 0);
        (closed && (filled - own).abs() <= AREA * own).then_some(triangles)
    }

    /// The corner nearest to `a` on the line from `a` to `b`.
    fn corner_on(&self, a: usize, b: usize) -> Option<usize> {
        let (p, q) = (self.points[a], self.points[b]);
        let length = distance(p, q);
        (0..self.points.len())
            .filter(|&k| ![self.vertex[a], self.vertex[b]].contains(&self.vertex[k]))
            .filter_map(|k| {
                let r = self.points[k];
                let along =
                    ((r[0] - p[0]) * (q[0] - p[0]) + (r[1] - p[1]) * (q[1] - p[1])) / length;
                let off = cross(p, q, r).abs() / length;
                // As wide as what was left out for being low.
                let on = off <= 2.0 * FLAT * self.extent && 0.0 < along && along < length;
                on.then_some((k, along))
            })
            .min_by(|x, y| x.1.total_cmp(&y.1))
            .map(|(k, _)| k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    /// Corners of the plane in space: turned about two axes and moved.
    fn placed(points: &[[f64; 2]], [a, b]: [f64; 2]) -> Vec<Vec3> {
        let place = |&[x, y]: &[f64; 2]| {
            let (y, z) = (y * a.cos(), y * a.sin());
            Vec3::new(x * b.cos() - z * b.sin() + 5.0, y - 3.0, x * b.sin() + z * b.cos() + 2.0)
        };
        points.iter().map(place).collect()
    }

    fn shoelace(points: &[[f64; 2]]) -> f64 {
        let next = points.iter().cycle().skip(1);
        0.5 * points.iter().zip(next).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>()
    }

    /// The triangles have the polygon's sense and its area, none lies outside, and every side of theirs that is not another's is the polygon's.
    fn check(points: &[[f64; 2]], turn: [f64; 2], area: f64) {
        let corners = placed(points, turn);
        let triangles = cut(&corners).unwrap();
        let normal = corners
            .iter()
            .zip(corners.iter().cycle().skip(1))
            .fold(Vec3::ZERO, |sum, (&a, &b)| sum + a.cross(b))
            .normalized();
        let mut sum = 0.0;
        let key = |k: usize| corners[k].to_array().map(|x| (x * 1e9).round() as i64);
        let mut sides = std::collections::BTreeMap::<_, i32>::new();
        for t in &triangles {
            let [a, b, c] = t.map(|k| corners[k]);
            let part = 0.5 * (b - a).cross(c - a).dot(normal);
            assert!(part > 0.0, "{t:?} of {points:?} has the area {part}");
            sum += part;
            for k in 0..3 {
                *sides.entry([key(t[k]), key(t[(k + 1) % 3])]).or_default() += 1;
            }
        }
        // The sum of up to a hundred terms of the size of the polygon's extent squared.
        assert!((sum - area).abs() < 1e-9 * area.max(1.0), "{sum} is not {area}");
        for k in 0..points.len() {
            *sides.entry([key(k), key((k + 1) % points.len())]).or_default() -= 1;
        }
        for ([from, to], count) in &sides {
            let back = sides.get(&[*to, *from]).copied().unwrap_or(0);
            assert_eq!(count - back, 0, "the side from {from:?} to {to:?} is open");
        }
    }

    #[test]
    fn concave_polygons_with_corners_on_their_edges_are_filled() {
        let l = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        let on_edges = [
            [0., 0.],
            [0.5, 0.],
            [1., 0.],
            [2., 0.],
            [2., 0.25],
            [2., 1.],
            [1.5, 1.],
            [1., 1.],
            [1., 1.75],
            [1., 2.],
            [0., 2.],
            [0., 1.],
            [0., 0.5],
        ];
        // A comb, whose teeth's ends stand in line.
        let mut comb: Vec<[f64; 2]> = Vec::new();
        for k in 0..6 {
            let x = f64::from(k);
            comb.extend([[x, 0.0], [x + 0.5, 0.0], [x + 0.5, 3.0], [x + 1.0, 3.0]]);
        }
        comb.extend([[6.0, 4.0], [3.0, 4.0], [0.0, 4.0]]);
        // A square with a square hole: a bridge leads there and back.
        let keyhole = [
            [0., 0.],
            [4., 0.],
            [4., 4.],
            [0., 4.],
            [0., 0.],
            [1., 1.],
            [1., 3.],
            [3., 3.],
            [3., 1.],
            [1., 1.],
        ];
        for turn in [[0.0, 0.0], [0.3, 0.7], [2.0, 1.1], [1.234, 4.0]] {
            check(&l, turn, 3.0);
            check(&on_edges, turn, 3.0);
            check(&comb, turn, shoelace(&comb));
            check(&keyhole, turn, 12.0);
            let mut backwards = l;
            backwards.reverse();
            check(&backwards, turn, 3.0);
        }
    }

    #[test]
    fn polygons_that_cross_themselves_are_told() {
        let bow = [[0., 0.], [2., 2.], [2., 0.], [0., 1.]];
        let star = |k: usize| {
            let angle = TAU * (2 * k) as f64 / 5.0;
            [angle.cos(), angle.sin()]
        };
        assert_eq!(cut(&placed(&bow, [0.4, 0.2])), Err(Tangled));
        assert_eq!(cut(&placed(&[0, 1, 2, 3, 4].map(star), [0.4, 0.2])), Err(Tangled));
    }

    proptest! {
        #[test]
        fn star_shaped_polygons_are_filled(
            radii in prop::collection::vec(0.2..1.0f64, 3..40), turn in prop::array::uniform2(0.0..6.0f64),
        ) {
            let n = radii.len() as f64;
            let points: Vec<[f64; 2]> = radii
                .iter()
                .enumerate()
                .map(|(k, r)| [r * (TAU * k as f64 / n).cos(), r * (TAU * k as f64 / n).sin()])
                .collect();
            check(&points, turn, shoelace(&points));
        }

        /// Steps up and down whose corners stand in rows and columns, with more of them on the edges.
        #[test]
        fn stairs_are_filled(
            heights in prop::collection::vec(1..5u8, 2..12), more in any::<u64>(), turn in prop::array::uniform2(0.0..6.0f64),
        ) {
            let mut outline = vec![[0.0, 0.0]];
            outline.extend((1..=heights.len()).map(|x| [x as f64, 0.0]));
            for (x, &h) in heights.iter().enumerate().rev() {
                outline.extend([[x as f64 + 1.0, f64::from(h)], [x as f64, f64::from(h)]]);
            }
            outline.dedup();
            let mut points = Vec::new();
            for (k, &p) in outline.iter().enumerate() {
                points.push(p);
                let q = outline[(k + 1) % outline.len()];
                if more >> (k % 64) & 1 == 1 && p != q {
                    points.push([0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]);
                }
            }
            let area: f64 = heights.iter().map(|&h| f64::from(h)).sum();
            check(&points, turn, area);
        }
    }
}
