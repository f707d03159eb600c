//! Normals of bodies that are known in closed form, from their triangles alone.

use super::super::normals::Shading;
use super::*;
use crate::geometry::{MeshSurface, Ray, Search};
use std::f64::consts::TAU;

const CREASE: f64 = 30.0;

/// A body of revolution about y: its profile (radius, height) from the lower end of the axis to the upper, turned in so many steps.
fn lathe(profile: &[[f64; 2]], segments: usize) -> RawMesh {
    let mut raw = RawMesh::default();
    for &[r, y] in profile {
        for j in 0..segments {
            let (sin, cos) = (TAU * j as f64 / segments as f64).sin_cos();
            raw.positions.push(Vec3::new(r * sin, y, r * cos));
        }
    }
    let at = |i: usize, j: usize| (i * segments + j % segments) as u32;
    for i in 0..profile.len() - 1 {
        for j in 0..segments {
            let quad = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            let face = raw.faces.len() as u32;
            // On the axis two corners are one.
            match (profile[i][0], profile[i + 1][0]) {
                (0.0, _) => raw.push_polygon(&[quad[0], quad[2], quad[3]], face, None),
                (_, 0.0) => raw.push_polygon(&[quad[0], quad[1], quad[2]], face, None),
                _ => raw.push_polygon(&quad, face, None),
            }
        }
    }
    raw
}

fn shaded(raw: RawMesh, crease: f64) -> (TriangleMesh, Shading) {
    closed(raw).unwrap().0.with_creased_normals(crease)
}

/// The largest angle between a mesh's normals and the true ones, over rays that meet it; where `truth` has none they do not count. And their number.
fn error(mesh: &TriangleMesh, truth: impl Fn(Vec3) -> Option<Vec3>) -> (f64, usize) {
    let surface = MeshSurface::new(mesh);
    let [low, high] = mesh.bounds();
    let search = Search { crossing: None, after: 0.0, standing_on: None };
    let (mut worst, mut met) = (0.0f64, 0);
    for k in 1..6000 {
        let f = |a: f64| (f64::from(k) * a).fract();
        let target = (0..3).map(|i| {
            let (low, high) = (low.to_array()[i], high.to_array()[i]);
            low + (high - low) * f([0.754_877_666, 0.569_840_291, 0.819_172_513][i])
        });
        let target: Vec<f64> = target.collect();
        let target = Vec3::new(target[0], target[1], target[2]);
        let (sin, cos) = (TAU * f(0.618_033_989)).sin_cos();
        let y = 2.0 * f(0.414_213_562) - 1.0;
        let direction = Vec3::new(sin * (1.0 - y * y).sqrt(), y, cos * (1.0 - y * y).sqrt());
        let ray = Ray { origin: target - direction * 500.0, direction };
        let Some(hit) = surface.nearest(&ray, search) else { continue };
        let Some(truth) = truth(ray.at(hit.t)) else { continue };
        // Where a ray grazes, the triangle's own normal stands in for one that it would meet from behind.
        if direction.dot(truth).abs() < 0.1 {
            continue;
        }
        let (_, normal) = surface.cross(&ray, hit.face);
        worst = worst.max(normal.cross(truth).length().atan2(normal.dot(truth)));
        met += 1;
    }
    (worst, met)
}

/// Away from the axis.
fn radial(p: Vec3) -> Vec3 {
    Vec3::new(p.x, 0.0, p.z).normalized()
}

fn up(sign: f64) -> Vec3 {
    Vec3::new(0.0, sign, 0.0)
}

#[test]
fn a_cube_and_a_cylinder_are_sharp_where_they_are() {
    let (mesh, shading) = shaded(cube(), CREASE);
    assert_eq!(shading.sharp_edges, 12);
    let (worst, met) = error(&mesh, |p| {
        let p = p.to_array();
        let axis = (0..3).max_by(|&a, &b| p[a].abs().total_cmp(&p[b].abs()))?;
        Some(Vec3::from_array(std::array::from_fn(|k| if k == axis { p[k].signum() } else { 0.0 })))
    });
    assert!(worst < 1e-12 && met > 1000, "{worst} of {met}");
    // The cube's six faces are six parts, and each of them is flat.
    let surface = MeshSurface::new(&mesh);
    let parts: std::collections::BTreeSet<u32> = (0..12).map(|t| surface.part(t).number).collect();
    assert_eq!((parts.len(), surface.is_bent()), (6, false));

    let (mesh, shading) =
        shaded(lathe(&[[0.0, -15.0], [20.0, -15.0], [20.0, 15.0], [0.0, 15.0]], 48), CREASE);
    assert_eq!(shading.sharp_edges, 96);
    // Between two normals as between two points of a chord: the directions are the same. Only rounding is left.
    let lid = |p: Vec3| p.y.abs() > 15.0 - 1e-9;
    let truth = |p: Vec3| Some(if lid(p) { up(p.y.signum()) } else { radial(p) });
    let (worst, met) = error(&mesh, truth);
    assert!(worst < 1e-9 && met > 1000, "{worst} of {met}");
    let parts = |mesh: &TriangleMesh| {
        let surface = MeshSurface::new(mesh);
        (0..mesh.triangles.len() as u32)
            .map(|t| surface.part(t).number)
            .collect::<std::collections::BTreeSet<_>>()
            .len()
    };
    assert_eq!(parts(&mesh), 3);
}

#[test]
fn cones_keep_their_slope_up_to_the_tip() {
    let segments = 64;
    let step = TAU / segments as f64;
    // A pointed cone, an axicon so flat that its tip is no sharp point, and one that is cut off; each meets its rod in an edge that is sharper
    // than the crease angle (34, 81 and 37 degrees).
    for (radius, height, top) in [(20.0, 30.0, 0.0), (20.0, 3.0, 0.0), (20.0, 20.0, 5.0)] {
        for rings in [1, 5] {
            let mut profile = vec![[0.0, -10.0], [radius, -10.0]];
            profile.extend((0..=rings).map(|k| {
                let share = f64::from(k) / f64::from(rings);
                [radius + (top - radius) * share, height * share]
            }));
            if top > 0.0 {
                profile.push([0.0, height]);
            }
            let (mesh, _) = shaded(lathe(&profile, segments), CREASE);
            let slope = Vec3::new(height, radius - top, 0.0).normalized();
            // What lies below is the rod that the cone stands on.
            let cone = |p: Vec3| p.y > 1e-9 && p.y < height - if top > 0.0 { 1e-9 } else { 0.0 };
            let truth = |p: Vec3| cone(p).then(|| radial(p) * slope.x + up(slope.y));
            let (worst, met) = error(&mesh, truth);
            // Between two normals a step apart the radial part is short by up to step^2 / 8.
            assert!(
                worst < step * step / 8.0 && met > 300,
                "{height}, {top}, {rings}: {worst} of {met}"
            );
        }
    }
}

#[test]
fn a_lens_is_right_up_to_its_rim() {
    let (radius, rim, rings) = (60.0, 15.0, 12);
    let most = f64::asin(rim / radius);
    let edge = radius * most.cos();
    let step = most / f64::from(rings);
    let mut profile = vec![[0.0, edge - 4.0], [rim, edge - 4.0]];
    profile.extend((0..=rings).rev().map(|k| {
        let angle = most * f64::from(k) / f64::from(rings);
        [radius * angle.sin(), radius * angle.cos()]
    }));
    let (mesh, shading) = shaded(lathe(&profile, 64), CREASE);
    // Where the plane meets the edge, and where the edge meets the cap.
    assert_eq!(shading.sharp_edges, 128);
    let cap = |p: Vec3| (p.y > edge + 1e-9).then(|| p.normalized());
    let (worst, met) = error(&mesh, cap);
    // A mean over one side would lean by half a step at the rim, 0.6 degrees; what is left goes with its square.
    assert!(worst < step * step && met > 300, "{worst} over {}, of {met}", step * step);
}

#[test]
fn flat_and_straight_parts_run_into_roundings() {
    // A capsule, and a disc with a rounded edge.
    let arc = |centre: [f64; 2], r: f64, from: f64, to: f64| {
        (0..=12).map(move |k| {
            let angle = from + (to - from) * f64::from(k) / 12.0;
            [centre[0] + r * angle.cos(), centre[1] + r * angle.sin()]
        })
    };
    let quarter = TAU / 4.0;
    let mut capsule: Vec<[f64; 2]> = arc([0.0, -30.0], 5.0, -quarter, 0.0).collect();
    capsule.extend(arc([0.0, 30.0], 5.0, 0.0, quarter));
    let last = capsule.len() - 1;
    (capsule[0][0], capsule[last][0]) = (0.0, 0.0);
    let (mesh, _) = shaded(lathe(&capsule, 48), CREASE);
    let (worst, met) = error(&mesh, |p| (p.y.abs() < 30.0 - 1e-9).then(|| radial(p)));
    assert!(worst < 1e-9 && met > 1000, "{worst} of {met}");

    let mut disc = vec![[0.0, -5.0]];
    disc.extend(arc([20.0, 0.0], 5.0, -quarter, quarter));
    disc.push([0.0, 5.0]);
    let (mesh, _) = shaded(lathe(&disc, 48), CREASE);
    let lid = |p: Vec3| (p.x.hypot(p.z) < 19.9 && p.y.abs() > 4.99).then(|| up(p.y.signum()));
    let (worst, met) = error(&mesh, lid);
    assert!(worst < 1e-9 && met > 300, "{worst} of {met}");
}

#[test]
fn a_ball_and_a_bean_stay_smooth() {
    let n = 32;
    let (mesh, shading) = shaded(sphere(n), CREASE);
    assert_eq!(shading.sharp_edges, 0);
    let step = PI / n as f64;
    let (worst, met) = error(&mesh, |p| Some(p.normalized()));
    assert!(worst < step * step && met > 1000, "{worst} of {met}");
    // Nothing was taken for a tip.
    assert_eq!(mesh.triangles.len(), closed(sphere(n)).unwrap().0.triangles.len());
}

#[test]
fn the_crease_angle_is_the_user_s() {
    let (mesh, shading) = shaded(cube(), 91.0);
    assert_eq!(shading.sharp_edges, 0);
    let diagonal = |t: usize, k: usize| mesh.corners(t)[k].normalized();
    for (t, normals) in mesh.normals.as_ref().unwrap().iter().enumerate() {
        for (k, normal) in normals.iter().enumerate() {
            assert!((*normal - diagonal(t, k)).length() < 1e-12);
        }
    }
    // Of a coarse ball all rings are sharp, and the meridians but for those at the poles: sin(11.25 degrees) of 22.5 is less than 5.
    assert_eq!(shaded(sphere(8), 5.0).1.sharp_edges, 7 * 16 + 6 * 16);
}

/// The cube or another mesh with normals of the file.
fn with_normals(mut raw: RawMesh, normal: impl Fn(Vec3, Vec3) -> Vec3) -> RawMesh {
    raw.normals = raw
        .triangles
        .iter()
        .map(|t| {
            let p = t.map(|v| raw.positions[v as usize]);
            let face = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
            p.map(|p| normal(p, face))
        })
        .collect();
    raw
}

#[test]
fn the_file_s_normals_count_where_they_fit() {
    // True ones of a coarse ball, turned inward and of another length: they count.
    let (mesh, shading) = shaded(with_normals(sphere(12), |p, _| p * -3.0), CREASE);
    assert_eq!((shading.given, shading.unfit), (shading.corners, 0));
    for (t, normals) in mesh.normals.as_ref().unwrap().iter().enumerate() {
        for (p, n) in mesh.corners(t).iter().zip(normals) {
            assert!((*n - p.normalized()).length() < 1e-12);
        }
    }
    assert_eq!(shading.note(CREASE), "normals: the file's own");
    // A cube's smoothed over its edges: 54.7 degrees from its faces.
    let (mesh, shading) = shaded(with_normals(cube(), |p, _| p), CREASE);
    assert_eq!((shading.given, shading.unfit, shading.sharp_edges), (0, 36, 12));
    assert!(shading.note(CREASE).contains("do not fit"));
    assert!(!MeshSurface::new(&mesh).is_bent());
    // Those of flat faces say nothing of a ball.
    let (_, shading) = shaded(with_normals(sphere(12), |_, face| face), CREASE);
    assert_eq!((shading.given, shading.flat), (0, true));
    assert!(shading.note(CREASE).contains("\"flat\""));
    // The file's sharp edges may be less than the crease angle: a wedge of 20 degrees between two of its faces.
    let roof = lathe(&[[0.0, -1.0], [10.0, -1.0], [10.0, 0.0], [5.0, 1.2], [0.0, 1.3]], 64);
    let own = with_normals(roof.clone(), |p, face| {
        if face.y.abs() > 0.99 && face.y < 0.0 {
            return face;
        }
        let out = Vec3::new(p.x, 0.0, p.z);
        let out = if out.length() > 0.0 {
            out.normalized()
        } else {
            Vec3::new(face.x, 0.0, face.z).normalized()
        };
        let slope = Vec3::new(face.x, 0.0, face.z).length();
        out * slope + up(face.y)
    });
    let kept = shaded(own, CREASE);
    assert!(kept.1.given > kept.1.corners / 2, "{:?}", kept.1);
    let surface = MeshSurface::new(&kept.0);
    // Just beside the inner edge the two slopes keep their own normals.
    let normal_at = |x: f64| {
        let ray = Ray { origin: Vec3::new(0.0, 50.0, x), direction: up(-1.0) };
        let hit = surface
            .nearest(&ray, Search { crossing: None, after: 0.0, standing_on: None })
            .unwrap();
        surface.cross(&ray, hit.face).1
    };
    let [outer, inner] = [normal_at(5.01), normal_at(4.99)];
    let expected = f64::atan2(1.2, 5.0) - f64::atan2(0.1, 5.0);
    assert!((outer.dot(inner).acos() - expected).abs() < 1e-3);
}
