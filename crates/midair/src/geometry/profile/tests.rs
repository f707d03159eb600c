//! Held to school geometry: areas, volumes, distances.

use super::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn line(from: Point, to: Point) -> Piece {
    Piece::Line { from, to }
}

fn polygon(points: &[Point]) -> Vec<Piece> {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(&a, &b)| line(a, b)).collect()
}

fn arc(centre: Point, radius: f64, from: f64, to: f64) -> Piece {
    Piece::Arc { centre, radius, from, to }
}

#[test]
fn areas_and_volumes_are_the_textbook_s() {
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    let clockwise =
        Profile::new(polygon(&[[0.0, 0.0], [0.0, 3.0], [5.0, 3.0], [5.0, 0.0]])).unwrap();
    near(clockwise.area(), 15.0);
    let ball = Profile::turned(vec![arc([0.0; 2], 5.0, -FRAC_PI_2, FRAC_PI_2)]).unwrap();
    near(ball.turned_volume(), 4.0 / 3.0 * PI * 125.0);
    near(ball.area(), 0.5 * PI * 25.0);
    let frustum = Profile::turned(vec![line([4.0, -3.0], [2.0, 3.0])]).unwrap();
    near(frustum.turned_volume(), PI * 6.0 / 3.0 * (16.0 + 8.0 + 4.0));
    // Pappus.
    let torus = Profile::turned(vec![arc([9.0, 1.0], 2.0, 0.0, TAU)]).unwrap();
    near(torus.turned_volume(), 2.0 * PI * PI * 9.0 * 4.0);
    // A paraboloid z = r^2 / (2 R) up to r = a: pi a^4 / (4 R).
    let bowl =
        Sag { vertex: 0.0, side: -1.0, curvature: 0.1, conic: -1.0, terms: vec![], reach: 4.0 };
    let top = bowl.height(4.0);
    let bowl = Profile::new(vec![
        Piece::Sag(bowl),
        line([4.0, top], [0.0, top]),
        line([0.0, top], [0.0, 0.0]),
    ]);
    // Its sum stops a billionth short of the rim.
    let volume = bowl.unwrap().turned_volume();
    assert!((volume / (PI * 256.0 / 40.0) - 1.0).abs() < 1e-9, "{volume}");
}

#[test]
fn what_surrounds_nothing_or_crosses_is_refused() {
    let bow = polygon(&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 3.0]]);
    assert!(matches!(Profile::new(bow), Err(ProfileError::CrossesItself(_))));
    assert_eq!(Profile::new(polygon(&[[0.0, 0.0], [4.0, 4.0]])), Err(ProfileError::Empty));
    let beyond = vec![arc([1.0, 0.0], 2.0, 0.0, TAU)];
    assert!(matches!(Profile::turned(beyond), Err(ProfileError::CrossesAxis(_))));
}

#[test]
fn an_inside_keeps_its_distance_from_the_outside() {
    // A tumbler with a rounded foot, a waist, and a bulge: convex and hollow arcs, sharp corners of both kinds.
    let outer = Profile::turned(vec![
        line([0.0, 0.0], [20.0, 0.0]),
        arc([20.0, 5.0], 5.0, -FRAC_PI_2, 0.0),
        line([25.0, 5.0], [25.0, 30.0]),
        arc([31.0, 30.0], 6.0, PI, FRAC_PI_2),
        line([31.0, 36.0], [40.0, 36.0]),
        line([40.0, 36.0], [40.0, 60.0]),
    ])
    .unwrap();
    let distance_to = |profile: &Profile, p: Point| {
        let near = |piece: &Piece| {
            (0..=4000)
                .map(|k| piece.at(f64::from(k) / 4000.0))
                .map(|q| distance(p, q))
                .fold(f64::INFINITY, f64::min)
        };
        let surface = profile.pieces().iter().filter(|piece| !piece.is_on_axis());
        surface.map(near).fold(f64::INFINITY, f64::min)
    };
    for wall in [0.5, 3.0] {
        let inner = outer.inside(wall, true, false).unwrap();
        let mut compared = 0;
        for piece in inner.pieces().iter().filter(|piece| !piece.is_on_axis()) {
            for k in 1..8 {
                let p = piece.at(f64::from(k) / 8.0);
                assert!(outer.contains(p), "{p:?}");
                // 4000 steps along 40 mm are 0.01 mm apart: the nearest is off by less than 0.005^2 / (2 wall).
                let off = distance_to(&outer, p) - wall;
                assert!(off.abs() < 2.6e-5, "{p:?} {off}");
                compared += 1;
            }
        }
        assert!(compared >= 49, "{compared}");
    }
    // Open at the top: the inside ends where the outside does.
    let open = outer.inside(3.0, true, true).unwrap();
    assert!((open.bounds()[1][1] - 60.0).abs() < 1e-12);
    assert!((open.bounds()[0][1] - 3.0).abs() < 1e-12);
    assert!(matches!(outer.inside(20.0, true, false), Err(ProfileError::WallTooThick { .. })));
    let ball = Profile::turned(vec![arc([0.0; 2], 5.0, -FRAC_PI_2, FRAC_PI_2)]).unwrap();
    assert_eq!(ball.inside(1.0, true, true), Err(ProfileError::NoTop));
    let hollow = ball.inside(1.0, true, false).unwrap();
    assert!((hollow.turned_volume() / (4.0 / 3.0 * PI * 64.0) - 1.0).abs() < 1e-12);
}

#[test]
fn below_a_level_lies_a_cap_of_the_ball() {
    let ball = Profile::turned(vec![arc([0.0; 2], 5.0, -FRAC_PI_2, FRAC_PI_2)]).unwrap();
    for level in [-3.0, 0.0, 2.5] {
        let h = level + 5.0;
        let cap = PI * h * h * (3.0 * 5.0 - h) / 3.0;
        let below = ball.below(level).unwrap();
        assert!((below.turned_volume() / cap - 1.0).abs() < 1e-12, "{level}");
    }
    // Two legs of a W, filled to below its middle: two pools.
    let w = polygon(&[
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 2.0],
        [3.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
    ]);
    let pools = Profile::new(w).unwrap().below(1.0).unwrap();
    assert!((pools.area() - 2.0 * 1.25).abs() < 1e-12, "{}", pools.area());
    assert!(pools.contains([0.5, 0.5]) && !pools.contains([2.0, 0.5]));
    assert_eq!(ball.below(-5.0), Err(ProfileError::NoLiquid));
    assert_eq!(ball.below(5.0).unwrap(), ball);
}

#[test]
fn a_smooth_line_through_points_of_a_circle_is_the_circle() {
    let circle: Vec<Point> = (0..=12)
        .map(|k| (f64::from(k) * 0.21 - 1.3).sin_cos())
        .map(|(s, c)| [7.0 + 4.0 * c, 4.0 * s])
        .collect();
    let pieces = smooth(&circle, true);
    assert_eq!(pieces.len(), 12);
    for piece in &pieces {
        let Piece::Arc { centre, radius, .. } = piece else { panic!("{piece:?}") };
        // Points a few millimetres apart: rounding of 1e-16 grows by the square of radius over chord.
        assert!(distance(*centre, [7.0, 0.0]) < 1e-12 && (radius - 4.0).abs() < 1e-12);
    }
}

#[test]
fn a_smooth_line_meets_its_points_and_has_no_bends_but_at_corners() {
    let points = [
        [0.0, 0.0],
        [18.0, 2.0],
        [22.0, 20.0],
        [22.0, 20.0],
        [9.0, 33.0],
        [14.0, 50.0],
        [0.0, 61.0],
    ];
    let pieces = smooth(&points, true);
    for p in points {
        assert!(
            pieces
                .iter()
                .any(|piece| distance(piece.from(), p) < 1e-9 || distance(piece.to(), p) < 1e-9)
        );
    }
    let mut corners = 0;
    for pair in pieces.windows(2) {
        assert!(distance(pair[0].to(), pair[1].from()) < 1e-9);
        let ([_, a], [b, _]) = (pair[0].directions(), pair[1].directions());
        if a[0] * b[0] + a[1] * b[1] < 1.0 - 1e-9 {
            corners += 1;
            assert!(distance(pair[0].to(), [22.0, 20.0]) < 1e-9, "{pair:?}");
        }
    }
    assert_eq!(corners, 1);
    // At a right angle to the axis at both ends.
    let ends = [pieces[0].directions()[0], pieces.last().unwrap().directions()[1]];
    assert!(ends.iter().all(|d| d[1].abs() < 1e-9), "{ends:?}");
}

#[test]
fn an_asphere_without_terms_is_its_conic() {
    let sag = |conic: f64| Sag {
        vertex: 0.0,
        side: 1.0,
        curvature: 0.05,
        conic,
        terms: vec![],
        reach: 10.0,
    };
    for r in [0.0, 1.0, 7.5, 10.0f64] {
        let q = r * r;
        assert!((sag(0.0).at(q) - (20.0 - (400.0 - q).sqrt())).abs() < 1e-12);
        assert!((sag(-1.0).at(q) - q / 40.0).abs() < 1e-12);
        // A hyperboloid: (1 + k) z^2 - 2 R z + r^2 = 0.
        let z = sag(-3.0).at(q);
        assert!((-2.0 * z * z - 40.0 * z + q).abs() < 1e-11);
    }
    let with = Sag { terms: vec![1e-4, -2e-6], ..sag(0.0) };
    let (q, h) = (36.0, 1e-4);
    assert!((with.at(q) - sag(0.0).at(q) - (1e-4 * q * q - 2e-6 * q * q * q)).abs() < 1e-12);
    // Differences over 2 h err by h^2 times the third derivative.
    assert!((with.slope(q) - (with.at(q + h) - with.at(q - h)) / (2.0 * h)).abs() < 1e-9);
}
