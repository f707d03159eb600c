//! The detector on lattices whose intersections are known by construction.

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use rayon::prelude::*;

use super::*;
use crate::evaluate::{Plane, gaussian_blur};

/// A picture of a lattice seen through a homography and a radial bend.
///
/// The picture shows, at the place p (pixels), the lattice at `uv(p)`: an exact closed form, so
/// that the true intersections are its inverse, found by Newton's method to 1e-12.
#[derive(Clone, Debug)]
struct Warp {
    size: usize,
    /// Rows of the homography from bent, centred places (in units of the picture) to uv.
    homography: [[f64; 3]; 3],
    /// Radial bend: places are multiplied by 1 + bend r^2 before the homography.
    bend: f64,
}

impl Warp {
    fn uv(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let size = self.size as f64;
        let (x, y) = (x / size - 0.5, y / size - 0.5);
        let radial = 1.0 + self.bend * (x * x + y * y);
        let bent = [radial * x, radial * y, 1.0];
        let [a, b, w] =
            self.homography.map(|row| row.iter().zip(bent).map(|(h, p)| h * p).sum::<f64>());
        [a / w + 0.5, 0.5 - b / w]
    }

    fn place(&self, uv: [f64; 2]) -> [f64; 2] {
        let mut p = [0.5 * self.size as f64; 2];
        for _ in 0..50 {
            let error = |p: [f64; 2]| {
                let found = self.uv(p);
                [found[0] - uv[0], found[1] - uv[1]]
            };
            let [e, f] = error(p);
            let h = 1e-4;
            let right = error([p[0] + h, p[1]]);
            let down = error([p[0], p[1] + h]);
            let (a, c) = ((right[0] - e) / h, (right[1] - f) / h);
            let (b, d) = ((down[0] - e) / h, (down[1] - f) / h);
            let det = a * d - b * c;
            let (dx, dy) = ((d * e - b * f) / det, (a * f - c * e) / det);
            p = [p[0] - dx, p[1] - dy];
            if dx.hypot(dy) < 1e-11 {
                break;
            }
        }
        p
    }

    fn truth(&self, style: &LatticeStyle) -> Vec<[f64; 2]> {
        style.intersections_uv().into_iter().map(|uv| self.place(uv)).collect()
    }

    /// Each pixel is the mean over 256 places in it (a Hammersley set: edges along the axes are not
    /// quantised to the rows of a regular grid).
    fn picture(&self, style: &LatticeStyle) -> Plane {
        const SUB: usize = 256;
        let places = style.lines_at();
        let past = style.overhang.max(0.5 * style.line_width);
        let ends = [style.margin - past, 1.0 - style.margin + past];
        let extent = ends[0]..=ends[1];
        let to_line = |t: f64| {
            places.iter().map(|at| (t - at).abs()).fold(f64::INFINITY, f64::min)
                - 0.5 * style.line_width
        };
        let lit = |p: [f64; 2]| {
            let [u, v] = self.uv(p);
            extent.contains(&u) && extent.contains(&v) && (to_line(u) <= 0.0 || to_line(v) <= 0.0)
        };
        let to_edge = |t: f64| {
            let to_end = ends.iter().map(|end| (t - end).abs()).fold(f64::INFINITY, f64::min);
            to_line(t).abs().min(to_end)
        };
        let value = |at: usize| {
            let (column, row) = ((at % self.size) as f64, (at / self.size) as f64);
            let middle = [column + 0.5, row + 0.5];
            let ([u, v], [ur, vr]) = (self.uv(middle), self.uv([column + 1.5, row + 0.5]));
            let [ud, vd] = self.uv([column + 0.5, row + 1.5]);
            // A pixel's corners are 0.7 pixels from its middle: an edge further than one leaves it whole.
            let (du, dv) = ((ur - u).hypot(ud - u), (vr - v).hypot(vd - v));
            if to_edge(u) > du && to_edge(v) > dv {
                return if lit(middle) { 1.0 } else { 0.0 };
            }
            let place = |i: usize| [(i as f64 + 0.5) / SUB as f64, radical_inverse(i)];
            let hits = (0..SUB).map(place).filter(|[x, y]| lit([column + x, row + y])).count();
            hits as f32 / SUB as f32
        };
        let values = (0..self.size * self.size).into_par_iter().map(value).collect();
        Plane { width: self.size, height: self.size, values }
    }
}

/// The bits of a number below 256 mirrored about the point.
fn radical_inverse(i: usize) -> f64 {
    f64::from((i as u8).reverse_bits()) / 256.0 + 1.0 / 512.0
}

/// Turned up to 25 degrees, filling 65 to 95 % of the picture, with perspective that makes one
/// side up to a third larger than the other, and a bend either way of up to 6 % of the half-size.
fn warps(size: usize) -> impl Strategy<Value = Warp> {
    let perspective = -0.2_f64..0.2;
    let shift = -0.02_f64..0.02;
    (
        (-25.0_f64..25.0, 1.05_f64..1.5, -0.1_f64..0.1),
        (perspective.clone(), perspective),
        (shift.clone(), shift),
        -0.25_f64..0.25,
    )
        .prop_map(move |((turn, zoom, shear), (p, q), (dx, dy), bend)| {
            let (sin, cos) = turn.to_radians().sin_cos();
            let zoom = zoom * (1.0 + 0.5 * sin.abs()) * (1.0 + 0.25 * (p.abs() + q.abs()));
            let homography = [
                [zoom * cos, zoom * (shear * cos - sin), dx],
                [zoom * sin, zoom * (shear * sin + cos), dy],
                [p, q, 1.0],
            ];
            Warp { size, homography, bend }
        })
}

/// Uniform pseudo-random numbers (SplitMix64, Steele, Lea and Flood 2014).
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }
}

/// The picture under a light that falls off to one corner, with normal noise added.
fn photographed(picture: &Plane, fall_off: f64, deviation: f64, seed: u64) -> Plane {
    let mut uniform = noise(seed);
    let mut out = picture.clone();
    for (at, value) in out.values.iter_mut().enumerate() {
        let (x, y) = ((at % picture.width) as f64, (at / picture.width) as f64);
        let across = 0.5 * (x / picture.width as f64 + y / picture.height as f64);
        // Box and Muller 1958.
        let normal =
            (-2.0 * uniform().max(1e-300).ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
        let lit = (0.05 + 0.9 * f64::from(*value)) * (1.0 - fall_off * across);
        *value = (lit + deviation * normal) as f32;
    }
    out
}

/// The greatest distance from the truth; None when an intersection is missing.
fn worst(found: &Lattice, truth: &[[f64; 2]]) -> Option<f64> {
    let points: Option<Vec<[f64; 2]>> = found.points().into_iter().collect();
    let distances = points?
        .iter()
        .zip(truth)
        .map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]))
        .collect::<Vec<_>>();
    Some(distances.into_iter().fold(0.0, f64::max))
}

/// The same warps in every run, so that bounds on noise are bounds and not odds.
fn sample(count: usize, warps: impl Strategy<Value = Warp>) -> Vec<Warp> {
    let mut runner = TestRunner::deterministic();
    (0..count).map(|_| warps.new_tree(&mut runner).unwrap().current()).collect()
}

fn root_mean_square(found: &Lattice, truth: &[[f64; 2]]) -> f64 {
    let distances = found.points().into_iter().zip(truth).filter_map(|(a, b)| {
        let a = a?;
        Some((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2))
    });
    let squares: Vec<f64> = distances.collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn clean_views_are_measured_to_a_hundredth_of_a_pixel() {
    let style = LatticeStyle { line_width: 0.008, ..LatticeStyle::default() };
    for warp in sample(8, warps(1024)) {
        let (picture, truth) = (warp.picture(&style), warp.truth(&style));
        let found = detect(&picture, 7).unwrap();
        let error = root_mean_square(&found, &truth);
        assert!(error <= 0.01, "{error} {warp:?}");
        // In perspective the middle of a line's two edges is not its middle: for lines of 8 px and
        // magnification that changes by 0.4 across 1024 px, by 8^2 / 8 * 0.4 / 1024 = 0.003 px; the
        // picture's 256 samples a pixel leave about as much.
        let worst = worst(&found, &truth);
        assert!(worst.is_some_and(|worst| worst <= 0.02), "{worst:?} {warp:?}");
    }
}

#[test]
fn blurred_noisy_unevenly_lit_views_are_measured_to_a_twentieth_of_a_pixel() {
    for (seed, warp) in sample(6, warps(1024)).into_iter().enumerate() {
        let style = LatticeStyle { line_width: 0.008 + 0.001 * seed as f64, ..Default::default() };
        let (picture, truth) = (warp.picture(&style), warp.truth(&style));
        for sigma in [1.0, 2.0, 3.0] {
            let photograph = photographed(&gaussian_blur(&picture, sigma), 0.4, 0.02, seed as u64);
            let found = detect(&photograph, 7).unwrap();
            let error = root_mean_square(&found, &truth);
            assert!(error <= 0.05, "{error} at blur {sigma} of {warp:?}");
            assert!(found.found() >= 47, "{:?} at blur {sigma} of {warp:?}", found.intersections);
        }
    }
}

#[test]
fn a_closed_frame_without_overhang_is_found_whole() {
    let style = LatticeStyle { overhang: 0.0, ..LatticeStyle::default() };
    for warp in sample(4, warps(700)) {
        let (picture, truth) = (warp.picture(&style), warp.truth(&style));
        let found = detect(&picture, 7).unwrap();
        // At the frame a crossing is extrapolated from one side.
        let worst = worst(&found, &truth);
        assert!(worst.is_some_and(|worst| worst <= 0.05), "{worst:?} {warp:?}");
    }
}

#[test]
fn other_counts_of_lines_and_small_pictures_are_found() {
    for (lines, size) in [(2, 200), (3, 160), (5, 256), (11, 400)] {
        let style = LatticeStyle { lines, line_width: 0.012, ..LatticeStyle::default() };
        let drawn = draw_lattice(size, size, &style).unwrap();
        // Lines are 2 to 5 pixels wide: where in a pixel an edge lies is half lost, and the sRGB
        // encoding brightens the partly covered ones.
        for (picture, tolerance) in [(Plane::luminance(&drawn), 0.06), (Plane::luma(&drawn), 0.1)] {
            let found = detect(&picture, lines).unwrap();
            for (point, [u, v]) in found.points().iter().zip(style.intersections_uv()) {
                let [x, y] = point.unwrap();
                let (dx, dy) = (x - u * size as f64, y - (1.0 - v) * size as f64);
                assert!(dx.hypot(dy) < tolerance, "{lines} lines, {size} pixels: {dx} {dy}");
            }
        }
    }
}

#[test]
fn a_covered_crossing_is_missing_and_its_neighbours_are_not() {
    let style = LatticeStyle::default();
    let mut picture = Plane::luma(&draw_lattice(700, 700, &style).unwrap());
    let [u, v] = style.intersections_uv()[24];
    let (x, y) = (u * 700.0, (1.0 - v) * 700.0);
    for (at, value) in picture.values.iter_mut().enumerate() {
        let (dx, dy) = ((at % 700) as f64 + 0.5 - x, (at / 700) as f64 + 0.5 - y);
        if dx.hypot(dy) < 25.0 {
            *value = 0.0;
        }
    }
    let found = detect(&picture, 7).unwrap();
    assert_eq!(found.intersections[24], Err(Missing::NotSeen));
    assert_eq!(found.found(), 48);
}

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

/// An edge of a glass cube cuts the lattice in two and displaces one part by less than half a period.
///
/// What is wrong with the case cut at x = 602 and displaced by (-10, 27): a crossing 5 pixels from the cut is 2.03 pixels off, as its row
/// is seen from one side only and its column runs along the cut, so that windows across it reach beyond; and one is misnamed,
/// 231 pixels from where it belongs, as a small piece is joined in a wrong place. To leave out all that is seen from one side
/// with a standard error above 0.05 mends the first, and loses half of the crossings; the second is open. A crossing at the border,
/// 250 pixels from a cut, is 0.44 pixels off, seen from one side as well.
#[test]
#[ignore = "fails: a crossing 5 px from a cut is 2.03 px off, and one is misnamed"]
fn a_lattice_cut_by_an_edge_is_put_together() {
    let style = LatticeStyle { line_width: 0.008, ..Default::default() };
    let mut uniform = noise(11);
    let mut whole = 0;
    let mut all = Vec::new();
    let cases = sample(6, warps(900));
    for (seed, warp) in cases.iter().enumerate() {
        let (picture, truth) = (warp.picture(&style), warp.truth(&style));
        for _ in 0..4 {
            let mut between = |from: f64, to: f64| from + (to - from) * uniform();
            // A period is some 80 to 120 pixels.
            let shift = [between(-38.0, 38.0) as isize, between(-38.0, 38.0) as isize];
            let [at, slope] = [between(300.0, 600.0), between(-0.25, 0.25)];
            let place = [at + 450.0 * slope, slope, between(0.0, 6.0)];
            let (broken, side) = cut(&picture, place, shift);
            let photograph = photographed(&gaussian_blur(&broken, 1.0), 0.3, 0.02, seed as u64);
            let found = match detect(&photograph, 7) {
                Ok(found) => found,
                // The cut may run along a line and hide it: which lines are there cannot be told then.
                Err(LatticeError::Partial { .. } | LatticeError::TooMany { .. }) => continue,
                Err(error) => panic!("{error} {warp:?}"),
            };
            whole += 1;
            let mut squares = [const { Vec::new() }; 2];
            for (point, &[x, y]) in found.points().iter().zip(&truth) {
                let Some(point) = point else { continue };
                let there = [x + shift[0] as f64, y + shift[1] as f64];
                let off = |p: [f64; 2]| (point[0] - p[0]).hypot(point[1] - p[1]);
                // One that is displaced across the cut can be seen on both sides or on neither: either is right.
                let (here, there) = (off([x, y]), off(there));
                let nearest = if side([x, y]) < -20.0 {
                    here
                } else if side([x, y]) > 60.0 {
                    there
                } else {
                    here.min(there)
                };
                // None is named after its neighbour, a period away, nor measured across the cut.
                assert!(nearest < 0.5, "{point:?}: {nearest} {place:?} {shift:?} {warp:?}");
                let beside = side(*point).abs() < 40.0;
                squares[usize::from(beside)].push(nearest * nearest);
            }
            let [clear, beside] = squares;
            let error = |squares: &[f64]| {
                (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
            };
            println!(
                "{} and {} beside the cut, off by {:.4} and {:.4}",
                clear.len(),
                beside.len(),
                error(&clear),
                error(&beside)
            );
            // Lines of a piece two columns wide are short: what cannot be measured well is left out.
            assert!(clear.len() + beside.len() >= 20, "{place:?} {shift:?} {warp:?}");
            // Such pieces are off by up to twice what a whole lattice is.
            assert!(error(&clear) <= 0.1, "{} {place:?} {shift:?} {warp:?}", error(&clear));
            all.extend(clear);
            // Beside the cut a line is measured from one side, and extrapolated to the crossing.
            assert!(error(&beside) <= 0.15, "{} {place:?} {shift:?} {warp:?}", error(&beside));
        }
    }
    let error = (all.iter().sum::<f64>() / all.len() as f64).sqrt();
    println!("{whole} of 24 put together, {error} px off (root mean square)");
    assert!(error <= 0.05, "{error}");
    assert!(whole >= 16, "{whole} of 24");
}

/// What a JPEG file loses costs no more than noise.
#[test]
fn a_jpeg_photograph_is_measured_to_a_twentieth_of_a_pixel() {
    use crate::media::{decode_still, srgb};
    let style = LatticeStyle { line_width: 0.01, ..Default::default() };
    for (seed, warp) in sample(4, warps(800)).into_iter().enumerate() {
        let (picture, truth) = (warp.picture(&style), warp.truth(&style));
        let photograph = photographed(&gaussian_blur(&picture, 1.5), 0.4, 0.01, seed as u64);
        let yellow = |light: &f32| {
            let code = srgb::encode_8(light.clamp(0.0, 1.0));
            [code, code, srgb::encode_8(0.02)]
        };
        let codes: Vec<[u8; 3]> = photograph.values.iter().map(yellow).collect();
        let mut bytes = Vec::new();
        image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 85)
            .encode(codes.as_flattened(), 800, 800, image::ExtendedColorType::Rgb8)
            .unwrap();
        let read = decode_still("photo.jpg".as_ref(), &bytes).unwrap();
        let found = detect(&Plane::luminance(&read.picture), 7).unwrap();
        let error = root_mean_square(&found, &truth);
        assert!(error <= 0.05, "{error} {warp:?}");
        assert!(found.found() >= 45, "{} {warp:?}", found.found());
    }
}

#[test]
fn what_is_no_whole_lattice_is_an_error_that_says_why() {
    let seen = Plane::luma(&draw_lattice(500, 500, &LatticeStyle::default()).unwrap());
    let half = Plane::from_fn(300, 500, |x, y| seen.at(x, y));
    let error = detect(&half, 7).unwrap_err();
    assert!(matches!(error, LatticeError::Partial { rows: 7, lines: 7, .. }), "{error}");
    let error = detect(&seen, 5).unwrap_err();
    assert_eq!(error, LatticeError::TooMany { columns: 7, rows: 7, lines: 5 });
    assert_eq!(detect(&Plane::filled(200, 200, 0.4), 7), Err(LatticeError::NoLattice));
    let mut uniform = noise(7);
    let grain = Plane {
        values: (0..90_000).map(|_| uniform() as f32).collect(),
        ..Plane::filled(300, 300, 0.0)
    };
    assert!(detect(&grain, 7).is_err());
    assert!(matches!(detect(&seen, 1), Err(LatticeError::TooFewLines { .. })));
    assert!(matches!(detect(&Plane::filled(30, 900, 0.0), 7), Err(LatticeError::TooSmall { .. })));
    let mut holed = seen.clone();
    holed.values[3] = f32::INFINITY;
    assert_eq!(detect(&holed, 7), Err(LatticeError::NotFinite { column: 3, row: 0 }));
    // Dark lines on white are found once inverted.
    let dark = seen.inverted();
    assert!(detect(&dark, 7).is_err());
    assert_eq!(detect(&dark.inverted(), 7).unwrap().found(), 49);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Whatever the picture, the answer is an answer.
    #[test]
    fn no_picture_makes_it_fail_otherwise(
        width in 0_usize..90,
        height in 0_usize..90,
        lines in 0_usize..9,
        stripes in 1_usize..12,
        seed in any::<u64>(),
    ) {
        let mut uniform = noise(seed);
        let mut picture = Plane::from_fn(width, height, |x, y| {
            f32::from(x % stripes == 0 || y % (stripes + 1) == 0)
        });
        picture.values.iter_mut().for_each(|value| *value += uniform() as f32);
        if let Ok(found) = detect(&picture, lines) {
            prop_assert_eq!(found.intersections.len(), lines * lines);
            prop_assert!(found.points().iter().flatten().flatten().all(|x| x.is_finite()));
        }
    }
}
