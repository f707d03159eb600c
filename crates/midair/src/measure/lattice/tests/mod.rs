//! The detector on lattices whose intersections are known by construction.

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use rayon::prelude::*;

use super::*;
use crate::measure::Plane;

mod cut;
mod paper;
mod refusals;
mod views;

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
