//! Lattices that an edge cuts.

use super::*;
use crate::measure::gaussian_blur;

/// The picture beyond a cut is another one: both of the same lattice, displaced by `shift` and, within `gap` of the
/// cut, black. The cut runs at `x + slope * y = at`.
fn cut(
    picture: &Plane,
    [at, slope, gap]: [f64; 3],
    [dx, dy]: [isize; 2],
) -> (Plane, impl Fn([f64; 2]) -> f64) {
    let side = move |[x, y]: [f64; 2]| (x + slope * y - at) / 1_f64.hypot(slope);
    let (width, height) = (picture.width, picture.height);
    let broken = Plane::from_fn(width, height, |x, y| {
        let across = side([x as f64 + 0.5, y as f64 + 0.5]);
        if across.abs() < gap {
            return 0.0;
        }
        let [dx, dy] = if across < 0.0 { [0, 0] } else { [dx, dy] };
        let (x, y) = (x as isize - dx, y as isize - dy);
        if (0..width as isize).contains(&x) && (0..height as isize).contains(&y) {
            picture.at(x as usize, y as usize)
        } else {
            0.0
        }
    });
    (broken, side)
}

/// Columns that an edge cuts off are never named by guess, be they displaced by less than half a period or by whole ones: what is found without
/// expectations has no name but its own; with them both sides are named and measured.
#[test]
fn what_a_cut_displaces_is_left_out_or_named_by_where_it_is_expected() {
    let style = LatticeStyle { line_width: 0.008, ..Default::default() };
    let mut uniform = noise(11);
    let (mut told, mut all) = (0, Vec::new());
    for (seed, warp) in sample(6, warps(900)).iter().enumerate() {
        let (picture, truth) = (warp.picture(&style), warp.truth(&style));
        for turn in 0..4 {
            let mut between = |from: f64, to: f64| from + (to - from) * uniform();
            // A period is some 80 to 120 pixels: by less than half of one, and by one and two.
            let most = if turn < 2 { 38.0 } else { 230.0 };
            let shift = [between(-most, most) as isize, between(-38.0, 38.0) as isize];
            let [at, slope] = [between(300.0, 600.0), between(-0.25, 0.25)];
            let place = [at + 450.0 * slope, slope, between(0.0, 6.0)];
            let (broken, side) = cut(&picture, place, shift);
            let photograph = photographed(&gaussian_blur(&broken, 1.0), 0.3, 0.02, seed as u64);
            // Seen on its own side of the cut, or on neither, or on both.
            let moved = |[x, y]: [f64; 2]| [x + shift[0] as f64, y + shift[1] as f64];
            let sights = |p: [f64; 2]| {
                let here = (side(p) < 0.0).then_some(p);
                let there = Some(moved(p)).filter(|p| side(*p) >= 0.0);
                [here, there]
            };
            match detect(&photograph, 7) {
                // Two of the lines cross the cut and are whole all the same, so that a lattice is one: none is misnamed.
                Ok(found) => {
                    for (point, truth) in found.points().iter().zip(&truth) {
                        let Some(point) = point else { continue };
                        let off = |p: [f64; 2]| (point[0] - p[0]).hypot(point[1] - p[1]);
                        let nearest = sights(*truth).into_iter().flatten().map(off);
                        let nearest = nearest.fold(f64::INFINITY, f64::min);
                        assert!(nearest < 0.3, "{nearest} {place:?} {shift:?} {warp:?}");
                    }
                }
                Err(LatticeError::Partial { seen, .. }) => {
                    assert!(seen.columns < 7 || seen.rows < 7);
                    told += 1;
                }
                Err(LatticeError::TooMany { .. }) => told += 1,
                Err(error) => panic!("{error} {warp:?}"),
            }
            // Expected a few pixels off, where one sight of it is.
            let expected: Vec<Option<[f64; 2]>> = truth
                .iter()
                .map(|&p| match sights(p) {
                    [Some(p), None] | [None, Some(p)] if side(p).abs() > 6.0 => {
                        Some([p[0] + 3.0, p[1] - 2.0])
                    }
                    _ => None,
                })
                .collect();
            let found = detect_at(&photograph, 7, &expected).unwrap();
            let mut squares = Vec::new();
            for (point, expected) in found.points().iter().zip(&expected) {
                let (Some([x, y]), Some([ex, ey])) = (point, expected) else { continue };
                let off = (x + 3.0 - ex).hypot(y - 2.0 - ey);
                // From one side of a cut, errors of up to four times a line's standard error of 0.045 pixels are left.
                assert!(off < 0.2, "{off} at {x} {y}: {place:?} {shift:?} {warp:?}");
                squares.push(off * off);
            }
            assert!(squares.len() >= 20, "{} {place:?} {shift:?} {warp:?}", squares.len());
            all.extend(squares);
        }
    }
    let error = (all.iter().sum::<f64>() / all.len() as f64).sqrt();
    println!("{told} of 24 told to be cut, {} named, {error} px off (root mean square)", all.len());
    // What is promised of a whole lattice.
    assert!(error <= 0.05, "{error}");
    // Of twelve cuts that displace by up to 230 pixels, three in four displace by more than half a period: no blur joins their lines. Of the others lines may be
    // joined, and then none was misnamed.
    assert!(told >= 6 && all.len() >= 24 * 25, "{told} {}", all.len());
}

/// Each of these has 49 crossings for anyone who looks.
#[test]
fn bent_sheared_and_unevenly_lit_lattices_are_found_whole() {
    let warp = |homography, bend| Warp { size: 800, homography, bend };
    let scaled = |zoom: f64| [[zoom, 0.0, 0.0], [0.0, zoom, 0.0], [0.0, 0.0, 1.0]];
    let tan = 27_f64.to_radians().tan();
    // All of the 25 inner crossings have lines on all sides; of the outer ones, whose lines end soon after them, those that can be measured well.
    let cases = [
        ("barrel", warp(scaled(0.95), 0.35), 0.01, 0.2, 49),
        ("pincushion", warp(scaled(1.25), -0.3), 0.01, 0.2, 49),
        (
            "perspective",
            warp([[1.3, 0.0, 0.0], [0.0, 1.3, 0.0], [0.0, 0.7, 1.0]], 0.0),
            0.01,
            0.2,
            45,
        ),
        (
            "shear",
            warp([[1.7, 1.7 * tan, 0.0], [0.0, 1.3, 0.0], [0.0, 0.0, 1.0]], 0.0),
            0.01,
            0.2,
            25,
        ),
        ("light that falls to a tenth", warp(scaled(1.1), 0.0), 0.01, 0.9, 25),
        ("thick lines", warp(scaled(1.1), 0.0), 0.03, 0.2, 25),
    ];
    for (name, warp, line_width, fall_off, least) in cases {
        let style = LatticeStyle { line_width, ..Default::default() };
        let photograph =
            photographed(&gaussian_blur(&warp.picture(&style), 1.0), fall_off, 0.004, 5);
        let found = detect(&photograph, 7).unwrap_or_else(|error| panic!("{name}: {error}"));
        let truth = warp.truth(&style);
        let error = root_mean_square(&found, &truth);
        println!("{name}: {} found, {error:.4} px off", found.found());
        assert!(found.found() >= least, "{name}: {:?}", found.intersections);
        // A twentieth of a pixel, or half a hundredth of a thick line's width.
        assert!(error <= 0.05_f64.max(0.005 * found.line_width), "{name}: {error}");
    }
}
