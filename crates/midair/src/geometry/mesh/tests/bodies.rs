//! Bodies within one file that overlap, touch, or lie in one another: rays against intervals on the line.

use super::*;
use crate::geometry::{Crossing, Hit, MeshSurface, Ray, Search};

/// Where a ray is within a box: from and to.
fn within(ray: &Ray, [low, high]: [Vec3; 2]) -> Option<[f64; 2]> {
    let [o, d, l, h] = [ray.origin, ray.direction, low, high].map(Vec3::to_array);
    let mut range = [f64::NEG_INFINITY, f64::INFINITY];
    for k in 0..3 {
        let (a, b) = ((l[k] - o[k]) / d[k], (h[k] - o[k]) / d[k]);
        range = [range[0].max(a.min(b)), range[1].min(a.max(b))];
    }
    (range[0] < range[1]).then_some(range)
}

/// The union of intervals, those that touch made one.
fn union(mut parts: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut joined: Vec<[f64; 2]> = Vec::new();
    for part in parts {
        match joined.last_mut() {
            Some(last) if part[0] <= last[1] + 1e-6 => last[1] = last[1].max(part[1]),
            _ => joined.push(part),
        }
    }
    joined
}

/// All crossings of a surface along a ray from outside, each found from the one before, as a path finds them.
fn crossings(surface: &MeshSurface, ray: &Ray) -> Vec<Hit> {
    let mut found: Vec<Hit> = Vec::new();
    loop {
        let wanted = if found.len().is_multiple_of(2) { Crossing::Enter } else { Crossing::Leave };
        let at = found.last().map_or(0.0, |hit| hit.t);
        let on = Ray { origin: ray.at(at), direction: ray.direction };
        let search = Search {
            crossing: Some(wanted),
            after: 0.0,
            standing_on: found.last().map(|hit| hit.face),
        };
        match surface.nearest(&on, search) {
            Some(hit) => found.push(Hit { t: at + hit.t, ..hit }),
            None => return found,
        }
        assert!(found.len() < 50);
    }
}

fn rays() -> impl Iterator<Item = Ray> {
    (0..3000).map(|k| {
        let f = |a: f64| (f64::from(k) * a).fract() - 0.5;
        let origin = Vec3::new(9.0 * f(0.754_877_666), 9.0 * f(0.569_840_291), 20.0);
        let target = Vec3::new(4.0 * f(0.618_033_989), 4.0 * f(0.414_213_562), f(0.236_067_977));
        Ray { origin, direction: (target - origin).normalized() }
    })
}

/// Cubes of these sizes at these places, in one file, with so many overlaps.
fn check(cubes: &[(f64, Vec3)], overlaps: usize) {
    let mended = compare(cubes);
    assert_eq!(mended.overlaps.len(), overlaps, "{:?}", mended.notes());
}

/// Cubes in one file have the crossings that the union of them has.
fn compare(cubes: &[(f64, Vec3)]) -> Mended {
    let mut raw = RawMesh::default();
    for &(size, place) in cubes {
        append(&mut raw, &cube(), size, place, false);
    }
    let (mesh, mended) = closed(raw).unwrap_or_else(|e| panic!("{e}"));
    let surface = MeshSurface::new(&mesh);
    let mut met = 0;
    for ray in rays() {
        let parts = cubes.iter().filter_map(|&(size, place)| {
            let half = Vec3::new(0.5 * size, 0.5 * size, 0.5 * size);
            within(&ray, [place - half, place + half])
        });
        let expected: Vec<f64> = union(parts.collect()).into_flattened();
        let found: Vec<f64> = crossings(&surface, &ray).iter().map(|hit| hit.t).collect();
        assert_eq!(found.len(), expected.len(), "{ray:?}: {found:?} {expected:?}");
        for (a, b) in found.iter().zip(&expected) {
            // Rounding over 20 units of length, twice.
            assert!((a - b).abs() < 1e-12 * 100.0, "{found:?} {expected:?}");
        }
        met += found.len() / 2;
    }
    assert!(met > 200, "{met}");
    mended
}

#[test]
fn overlapping_bodies_are_their_union() {
    let at = Vec3::new;
    check(&[(2.0, Vec3::ZERO), (2.0, at(0.7, 0.4, 0.3))], 1);
    check(&[(2.0, Vec3::ZERO), (1.5, at(0.7, 0.4, 0.9)), (1.0, at(-1.1, 0.1, 0.2))], 2);
    check(&[(2.0, Vec3::ZERO), (2.0, at(1.0, 1.0, 1.0)), (2.0, at(0.5, -0.5, 0.25))], 3);
    // Three that share a place, and one that stands apart.
    check(
        &[
            (2.0, Vec3::ZERO),
            (2.0, at(0.3, 0.0, 0.1)),
            (2.0, at(0.0, 0.3, 0.2)),
            (1.0, at(4.0, 0.0, 0.0)),
        ],
        3,
    );
}

#[test]
fn bodies_that_touch_are_one() {
    // Face to face, on a part of it, without a common corner.
    check(&[(2.0, Vec3::ZERO), (1.0, Vec3::new(0.3, 0.2, 1.5))], 1);
    check(&[(2.0, Vec3::ZERO), (1.0, Vec3::new(1.5, 0.2, 0.1))], 1);
    // A whole face in common, its two triangles cut one way here and another there, and alike: then the wall between them is two of each.
    let at = Vec3::new;
    check(&[(1.0, Vec3::ZERO), (1.0, at(1.0, 0.0, 0.0))], 1);
    check(&[(1.0, Vec3::ZERO), (1.0, at(0.0, -1.0, 0.0))], 1);
    check(&[(1.0, Vec3::ZERO), (1.0, at(0.0, 0.0, 1.0))], 0);
    // A row and a block of them.
    compare(&[(1.0, Vec3::ZERO), (1.0, at(0.0, 0.0, 1.0)), (1.0, at(0.0, 0.0, -1.0))]);
    let block = [0.0, 1.0].into_iter().flat_map(|x| [0.0, 1.0].map(|y| (1.0, at(x, y, 0.0))));
    compare(&block.collect::<Vec<_>>());
    // An edge in common, and a corner.
    compare(&[(1.0, Vec3::ZERO), (1.0, at(1.0, 1.0, 0.0))]);
    compare(&[(1.0, Vec3::ZERO), (1.0, at(0.0, 1.0, -1.0))]);
    compare(&[(1.0, Vec3::ZERO), (1.0, at(1.0, 1.0, 1.0))]);
    // Faces in one plane, overlapping.
    check(&[(2.0, Vec3::ZERO), (2.0, Vec3::new(0.5, 0.5, 0.0))], 1);
}

#[test]
fn bodies_apart_and_in_one_another_are_left_as_they_are() {
    check(&[(2.0, Vec3::ZERO), (1.0, Vec3::new(2.5, 0.0, 0.0))], 0);
    // A hollow: light crosses four walls.
    let mut raw = cube();
    append(&mut raw, &cube(), 0.5, Vec3::ZERO, true);
    let (mesh, mended) = closed(raw).unwrap();
    assert!(mended.overlaps.is_empty() && mesh.bodies.is_none());
    let surface = MeshSurface::new(&mesh);
    let ray = Ray { origin: Vec3::new(0.01, 0.02, 5.0), direction: Vec3::new(0.0, 0.0, -1.0) };
    let found: Vec<f64> = crossings(&surface, &ray).iter().map(|hit| hit.t).collect();
    assert_eq!(found, [4.5, 4.75, 5.25, 5.5]);
}

#[test]
fn a_hollow_in_one_of_two_overlapping_bodies_stays_one() {
    let mut raw = RawMesh::default();
    append(&mut raw, &cube(), 2.0, Vec3::ZERO, false);
    append(&mut raw, &cube(), 0.5, Vec3::new(-0.5, 0.0, 0.0), true);
    append(&mut raw, &cube(), 2.0, Vec3::new(1.2, 0.1, 0.3), false);
    let (mesh, mended) = closed(raw).unwrap();
    assert_eq!((mended.hollows, mended.overlaps.len()), (1, 1));
    let surface = MeshSurface::new(&mesh);
    let ray = Ray { origin: Vec3::new(-8.0, 0.01, 0.02), direction: Vec3::new(1.0, 0.0, 0.0) };
    let found: Vec<f64> = crossings(&surface, &ray).iter().map(|hit| hit.t).collect();
    let expected = [-1.0, -0.75, -0.25, 2.2].map(|x| x + 8.0);
    assert!(
        found.len() == 4 && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12),
        "{found:?}"
    );
}

/// A prism over a star of five points that is drawn in one line: its walls cross each other, and it winds twice around its middle.
#[test]
fn a_body_that_crosses_itself_is_what_it_winds_around() {
    let corner = |k: usize, z: f64| {
        let angle = std::f64::consts::TAU * (2 * k) as f64 / 5.0 + 0.1;
        Vec3::new(2.0 * angle.cos(), 2.0 * angle.sin(), z)
    };
    let mut raw = RawMesh::default();
    for z in [-0.5, 0.5] {
        raw.positions.extend((0..5).map(|k| corner(k, z)));
        raw.positions.push(Vec3::new(0.0, 0.0, z));
    }
    for k in 0..5u32 {
        let next = (k + 1) % 5;
        let faces =
            [[11, 6 + k, 6 + next], [5, next, k], [k, next, 6 + next], [k, 6 + next, 6 + k]];
        faces.into_iter().for_each(|t| raw.push_polygon(&t, k, None));
    }
    let (mesh, mended) = closed(raw).unwrap();
    assert!(mended.overlaps.is_empty() && mended.crossing.is_some(), "{:?}", mended.notes());
    let surface = MeshSurface::new(&mesh);
    // Within the star is within one of the five prisms from its middle to a wall.
    let within = |ray: &Ray, k: usize| {
        let middle = corner(k, 0.0).cross(Vec3::new(0.0, 0.0, 1.0));
        let after = corner((k + 1) % 5, 0.0);
        let wall = (after - corner(k, 0.0)).cross(Vec3::new(0.0, 0.0, 1.0));
        let other = after.cross(Vec3::new(0.0, 0.0, -1.0));
        let planes = [
            (middle, 0.0),
            (other, 0.0),
            (wall, wall.dot(after)),
            (Vec3::new(0.0, 0.0, 1.0), 0.5),
            (Vec3::new(0.0, 0.0, -1.0), 0.5),
        ];
        let mut range = [f64::NEG_INFINITY, f64::INFINITY];
        for (normal, most) in planes {
            let (slope, left) = (ray.direction.dot(normal), most - ray.origin.dot(normal));
            match slope > 0.0 {
                true => range[1] = range[1].min(left / slope),
                false => range[0] = range[0].max(left / slope),
            }
        }
        (range[0] < range[1]).then_some(range)
    };
    let (mut met, mut twice) = (0, 0);
    for ray in rays() {
        let parts: Vec<_> = (0..5).filter_map(|k| within(&ray, k)).collect();
        twice += usize::from(parts.len() > 1);
        let expected = union(parts).into_flattened();
        let found: Vec<f64> = crossings(&surface, &ray).iter().map(|hit| hit.t).collect();
        assert_eq!(found.len(), expected.len(), "{ray:?}: {found:?} {expected:?}");
        for (a, b) in found.iter().zip(&expected) {
            // Rounding over 20 units of length, twice.
            assert!((a - b).abs() < 1e-12 * 100.0, "{found:?} {expected:?}");
        }
        met += found.len() / 2;
    }
    assert!(met > 300 && twice > 100, "{met} {twice}");
    // Neither a ball nor an overlap of two cubes crosses itself.
    assert!(closed(sphere(8)).unwrap().1.crossing.is_none());
}
