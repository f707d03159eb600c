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

/// An edge of a glass cube cuts the lattice in two and displaces one part by less than half a period.
#[test]
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
                // None is named after its neighbour, a period away, nor measured across the cut. A line's standard error is 0.03
                // pixels at most, as if centres were independent; from one side, errors of up to four times that are left.
                assert!(nearest < 0.12, "{point:?}: {nearest} {place:?} {shift:?} {warp:?}");
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
            // What is promised of a whole lattice.
            assert!(error(&clear) <= 0.05, "{} {place:?} {shift:?} {warp:?}", error(&clear));
            all.extend(clear);
            // Beside the cut a line is measured from one side, and extrapolated to the crossing: few pass, and those as well.
            assert!(error(&beside) <= 0.05, "{} {place:?} {shift:?} {warp:?}", error(&beside));
        }
    }
    let error = (all.iter().sum::<f64>() / all.len() as f64).sqrt();
    println!("{whole} of 24 put together, {error} px off (root mean square)");
    assert!(error <= 0.05, "{error}");
    assert!(whole >= 16, "{whole} of 24");
}
