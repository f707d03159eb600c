//! Solids that a profile sweeps, held to the closed forms that they must be, and to marching.

use crate::geometry::profile::{Piece, Point, Profile, Sag, smooth};
use crate::geometry::{Convex, Crossing, Dual, Ray, Real, Search, Shape, Sweep, Swept, Vec3};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

fn line(from: Point, to: Point) -> Piece {
    Piece::Line { from, to }
}

fn arc(centre: Point, radius: f64, from: f64, to: f64) -> Piece {
    Piece::Arc { centre, radius, from, to }
}

fn turned(pieces: Vec<Piece>) -> Shape {
    Shape::Swept(Arc::new(Swept::new(Profile::turned(pieces).unwrap(), Sweep::AboutY)))
}

/// Lines through a ball about the origin, from all sides, each by a rule of its own.
fn lines(reach: f64, count: usize) -> impl Iterator<Item = Ray> {
    // Two points on the ball by golden ratios: evenly spread, and along no axis.
    let on_ball = move |k: usize, ratio: f64| {
        let z = 2.0 * ((k as f64 + 0.5) * ratio).fract() - 1.0;
        let (s, c) = (k as f64 * ratio * 7.3 * TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * c, r * s, z) * reach
    };
    (0..count).map(move |k| {
        let from = on_ball(k, 0.618_033_988_749_895) * 3.0;
        let to = on_ball(k, 0.754_877_666_246_693);
        Ray { origin: from, direction: (to - from).normalized() }
    })
}

/// Both shapes have the same chords along all lines, and as steep sides; how many chords were compared.
fn same(a: &Shape, b: &Shape, reach: f64) -> usize {
    let mut compared = 0;
    for ray in lines(reach, 4000) {
        let (in_a, in_b) = (a.chords(&ray), b.chords(&ray));
        // A line that touches may count or not.
        let long = |chords: &[[f64; 2]]| chords.iter().any(|c| c[1] - c[0] > 1e-5);
        if !long(&in_a) && !long(&in_b) {
            continue;
        }
        assert_eq!(in_a.len(), in_b.len(), "{ray:?} {in_a:?} {in_b:?}");
        for (c, d) in in_a.iter().zip(&in_b) {
            // Rounding grows with the slant against the surface.
            let tolerance = 1e-10 / (c[1] - c[0]).min(1.0);
            assert!(
                (c[0] - d[0]).abs() < tolerance && (c[1] - d[1]).abs() < tolerance,
                "{c:?} {d:?}"
            );
            let search = Search { crossing: Some(Crossing::Enter), after: 0.0, standing_on: None };
            let normal = |shape: &Shape| {
                let hit = shape.nearest(&ray, search).unwrap();
                shape.cross(&ray, hit.face, hit.crossing).1
            };
            assert!((normal(a) - normal(b)).length() < 1e-8, "{ray:?}");
            compared += 1;
        }
    }
    compared
}

#[test]
fn a_straight_profile_is_a_frustum_a_cylinder_a_cone() {
    for [bottom, top] in [[20.0, 12.0], [15.0, 15.0], [18.0, 0.0]] {
        let lathe = turned(vec![line([bottom, -25.0], [top, 25.0])]);
        let frustum = Shape::Convex(Convex::Frustum {
            middle_radius: 0.5 * (bottom + top),
            slope: (top - bottom) / 50.0,
            half_height: 25.0,
        });
        assert!(same(&lathe, &frustum, 30.0) > 500);
        assert!((lathe.volume() / frustum.volume() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn an_arc_about_the_axis_is_a_ball() {
    let half_circle = turned(vec![arc([0.0; 2], 25.0, -FRAC_PI_2, FRAC_PI_2)]);
    let ball = Shape::Convex(Convex::Sphere { radius: 25.0 });
    assert!(same(&half_circle, &ball, 25.0) > 3000);
}

#[test]
fn a_rectangle_moved_along_z_is_a_box() {
    let corners = [[-10.0, -15.0], [10.0, -15.0], [10.0, 15.0], [-10.0, 15.0]];
    let next = corners.iter().cycle().skip(1);
    let pieces = corners.iter().zip(next).map(|(&a, &b)| line(a, b)).collect();
    let prism = Swept::new(Profile::new(pieces).unwrap(), Sweep::AlongZ(20.0));
    let block = Shape::Convex(Convex::Box { half: Vec3::new(10.0, 15.0, 20.0) });
    assert!(same(&Shape::Swept(Arc::new(prism)), &block, 25.0) > 500);
}

#[test]
fn a_circle_moved_along_z_is_a_cylinder() {
    let circle = Profile::new(vec![arc([0.0; 2], 15.0, 0.0, TAU)]).unwrap();
    let prism = Shape::Swept(Arc::new(Swept::new(circle, Sweep::AlongZ(20.0))));
    let upright =
        Shape::Convex(Convex::Frustum { middle_radius: 15.0, slope: 0.0, half_height: 20.0 });
    let mut compared = 0;
    for ray in lines(20.0, 2000) {
        // The frustum's axis is y.
        let turn = |v: Vec3| Vec3::new(v.x, v.z, -v.y);
        let lying = Ray { origin: turn(ray.origin), direction: turn(ray.direction) };
        let (a, b) = (prism.chords(&ray), upright.chords(&lying));
        if let ([a], [b]) = (&a[..], &b[..])
            && a[1] - a[0] > 1e-3
        {
            assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9, "{a:?} {b:?}");
            compared += 1;
        }
    }
    assert!(compared > 1000, "{compared}");
}

/// Chords of what a function calls inside, by marching in small steps; ends to half a step.
fn marched(inside: impl Fn(Vec3) -> bool, ray: &Ray, step: f64, length: f64) -> Vec<[f64; 2]> {
    let mut chords = Vec::new();
    let mut since = None;
    for k in 0..(length / step) as usize {
        let t = k as f64 * step;
        match (inside(ray.at(t)), since) {
            (true, None) => since = Some(t),
            (false, Some(from)) => {
                chords.push([from, t]);
                since = None;
            }
            _ => {}
        }
    }
    chords
}

fn is_as_marched(shape: &Shape, inside: impl Fn(Vec3) -> bool, reach: f64, count: usize) -> usize {
    const STEP: f64 = 0.02;
    let mut compared = 0;
    for ray in lines(reach, count) {
        let found = shape.chords(&ray);
        for c in marched(&inside, &ray, STEP, 6.0 * reach) {
            if c[1] - c[0] < 10.0 * STEP {
                continue;
            }
            let same = |d: &&[f64; 2]| {
                (c[0] - d[0] - 0.5 * STEP).abs() < STEP && (c[1] - d[1] - 0.5 * STEP).abs() < STEP
            };
            // Gaps that marching steps over join two chords to one.
            let gaps = found.windows(2).any(|pair| pair[1][0] - pair[0][1] < STEP);
            assert!(gaps || found.iter().any(|d| same(&d)), "{ray:?} {c:?} {found:?}");
            compared += 1;
        }
        for c in found.iter().filter(|c| c[1] - c[0] > 2.0 * STEP) {
            assert!(inside(ray.at(0.5 * (c[0] + c[1]))), "{ray:?} {c:?}");
        }
    }
    compared
}

#[test]
fn a_torus_is_as_marching_finds_it() {
    let torus = turned(vec![arc([20.0, 0.0], 7.0, 0.0, TAU)]);
    let inside = |p: Vec3| (p.x.hypot(p.z) - 20.0).hypot(p.y) < 7.0;
    assert!(is_as_marched(&torus, inside, 27.0, 400) > 100);
    // Along the axis through the hole, in its plane, and upright through the tube.
    let along = |o: [f64; 3], d: [f64; 3]| Ray {
        origin: Vec3::from_array(o),
        direction: Vec3::from_array(d),
    };
    assert!(torus.chords(&along([0.0, 50.0, 0.0], [0.0, -1.0, 0.0])).is_empty());
    let across = torus.chords(&along([50.0, 0.0, 0.0], [-1.0, 0.0, 0.0]));
    assert_eq!(across.len(), 2);
    for (found, known) in across.concat().iter().zip([23.0, 37.0, 63.0, 77.0]) {
        assert!((found - known).abs() < 1e-12, "{across:?}");
    }
    let upright = torus.chords(&along([20.0, 50.0, 0.0], [0.0, -1.0, 0.0]));
    assert!((upright[0][0] - 43.0).abs() < 1e-12 && (upright[0][1] - 57.0).abs() < 1e-12);
}

/// A wine glass: foot, stem, bowl, rim, and the bowl's inside.
fn wine_glass() -> Vec<Point> {
    vec![
        [0.0, 0.0],
        [0.0, 0.0],
        [30.0, 0.0],
        [30.0, 0.0],
        [31.0, 1.5],
        [22.0, 4.0],
        [6.0, 8.0],
        [4.0, 30.0],
        [7.0, 60.0],
        [24.0, 72.0],
        [34.0, 95.0],
        [30.0, 130.0],
        [29.0, 131.0],
        [28.0, 130.0],
        [32.0, 95.0],
        [22.0, 76.0],
        [0.0, 68.0],
    ]
}

#[test]
fn a_smooth_profile_is_as_marching_finds_it() {
    let profile = Profile::turned(smooth(&wine_glass(), true)).unwrap();
    // Points of the section by angles, for a test of its own: winding around a point.
    let points: Vec<Point> = profile.pieces().iter().flat_map(|piece| piece.samples(60)).collect();
    let inside = |p: Vec3| {
        let p = [p.x.hypot(p.z), p.y];
        let n = points.len();
        (0..n)
            .filter(|&i| {
                let (a, b) = (points[i], points[(i + 1) % n]);
                (a[1] > p[1]) != (b[1] > p[1])
                    && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
            })
            .count()
            % 2
            == 1
    };
    let glass = Shape::Swept(Arc::new(Swept::new(profile.clone(), Sweep::AboutY)));
    let mut checked = 0;
    for ray in lines(70.0, 200) {
        let ray = Ray { origin: ray.origin + Vec3::new(0.0, 65.0, 0.0), ..ray };
        let chords = glass.chords(&ray);
        for pair in chords.windows(2) {
            let gap = 0.5 * (pair[0][1] + pair[1][0]);
            if pair[1][0] - pair[0][1] > 0.05 {
                assert!(!inside(ray.at(gap)), "{ray:?} {pair:?}");
            }
        }
        for c in chords.iter().filter(|c| c[1] - c[0] > 0.05) {
            for share in [0.02, 0.3, 0.7, 0.98] {
                // Chords of 60 to a piece lie within a hundredth of a millimetre of the arcs.
                assert!(inside(ray.at(c[0] + share * (c[1] - c[0]))), "{ray:?} {c:?}");
            }
            checked += 1;
        }
        // None is missed: places all along the line.
        for k in 0..80 {
            let t = 5.3 * f64::from(k);
            let edge = chords.iter().flatten().any(|e| (e - t).abs() < 0.05);
            let within = chords.iter().any(|c| c[0] < t && t < c[1]);
            assert!(edge || within == inside(ray.at(t)), "{ray:?} at {t}: {chords:?}");
        }
    }
    assert!(checked > 50, "{checked}");
}

fn asphere() -> Sag {
    Sag {
        vertex: 4.0,
        side: 1.0,
        curvature: 0.03,
        conic: -2.0,
        terms: vec![2e-5, -4e-8],
        reach: 20.0,
    }
}

/// A flat back, an aspheric front.
fn aspheric_lens() -> Shape {
    let front = asphere();
    let rim = front.height(20.0);
    let profile = Profile::new(vec![
        line([0.0, -8.0], [20.0, -8.0]),
        line([20.0, -8.0], [20.0, rim]),
        Piece::Sag(front),
        line([0.0, 4.0], [0.0, -8.0]),
    ]);
    Shape::Swept(Arc::new(Swept::new(profile.unwrap(), Sweep::AboutZ)))
}

#[test]
fn an_asphere_is_as_marching_finds_it() {
    let sag = asphere();
    let inside = |p: Vec3| {
        let r = p.x.hypot(p.y);
        r < 20.0 && p.z > -8.0 && p.z < sag.height(r)
    };
    assert!(is_as_marched(&aspheric_lens(), inside, 22.0, 400) > 100);
}

/// Distances and normals along rays that change with u and v: derivatives held to differences, along the axis and elsewhere.
#[test]
fn derivatives_are_those_of_differences() {
    let shapes = [
        turned(vec![arc([20.0, 0.0], 7.0, 0.0, TAU)]),
        turned(smooth(&wine_glass(), true)),
        turned(vec![line([20.0, -25.0], [12.0, 25.0])]),
        turned(vec![arc([0.0; 2], 25.0, -FRAC_PI_2, FRAC_PI_2)]),
        aspheric_lens(),
    ];
    let mut compared = 0;
    for shape in &shapes {
        for (place, axis) in
            [([3.0, 5.0], 2), ([0.0, 0.0], 2), ([11.0, -3.0], 2), ([0.0, 0.0], 1), ([2.5, 1.0], 1)]
        {
            let ray = |[u, v]: [f64; 2]| {
                let (o, d) = (
                    Vec3::new(place[0] + u, place[1] + v, 200.0),
                    Vec3::new(0.02 * u, 0.03 * v, -1.0).normalized(),
                );
                let turn = |p: Vec3| if axis == 2 { p } else { Vec3::new(p.x, p.z, -p.y) };
                Ray { origin: turn(o), direction: turn(d) }
            };
            let search = Search { crossing: Some(Crossing::Enter), after: 0.0, standing_on: None };
            let Some(hit) = shape.nearest(&ray([0.0; 2]), search) else { continue };
            let h = 1e-5;
            let at = |uv: [f64; 2]| {
                let (t, n) = shape.cross(&ray(uv), hit.face, hit.crossing);
                [t, n.x, n.y, n.z]
            };
            let (here, steps) = (ray([0.0; 2]), [[h, 0.0], [0.0, h]]);
            assert!((at([0.0; 2])[0] - hit.t).abs() < 1e-9);
            let dual = |f: fn(&Ray) -> Vec3| {
                let value = f(&here);
                let d = steps.map(|step| {
                    let back = [-step[0], -step[1]];
                    (f(&ray(step)) - f(&ray(back))) * (0.5 / h)
                });
                let number = |re: f64, du: f64, dv: f64| Dual { re, d: [du, dv] };
                Vec3::new(
                    number(value.x, d[0].x, d[1].x),
                    number(value.y, d[0].y, d[1].y),
                    number(value.z, d[0].z, d[1].z),
                )
            };
            let lifted = Ray { origin: dual(|r| r.origin), direction: dual(|r| r.direction) };
            let (t, n) = shape.cross(&lifted, hit.face, hit.crossing);
            for (k, found) in [t, n.x, n.y, n.z].into_iter().enumerate() {
                for i in 0..2 {
                    let back = [-steps[i][0], -steps[i][1]];
                    let by_difference = (at(steps[i])[k] - at(back)[k]) / (2.0 * h);
                    // Differences over 2e-5 mm of numbers of 200 with 16 digits are good to about 1e-8; curvature adds h^2.
                    assert!(
                        (found.d[i] - by_difference).abs() < 1e-6 * (1.0 + by_difference.abs()),
                        "{place:?} {k} {i} {} {by_difference}",
                        found.d[i]
                    );
                    compared += 1;
                }
            }
            assert!(found_is_finite(t));
        }
    }
    assert!(compared >= 8 * 18, "{compared}");
}

fn found_is_finite(t: Dual) -> bool {
    t.value().is_finite()
}
