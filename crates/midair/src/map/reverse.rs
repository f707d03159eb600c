//! The inverse of a map that is known by its samples alone.

use super::{Map, Status, bleed, pixel_at};

/// Turns a map about: of one that leads from display pixels into the image, the one that leads from image pixels (`width` x
/// `height` of them) onto the display; and the reverse.
///
/// The map is taken as bilinear between its samples, each sample answering for its own pixel, and as broken where it jumps
/// (see below). A pixel that is reached from one place is `Ok`; from several, or from a folded pixel, `Folded`, and the
/// place nearest to the source's middle is taken; from none, `Outside`. Places are as exact as bilinear interpolation of
/// the map is; where the set-up is at hand [`forward`](super::forward()) knows them exactly. The error bound is infinite.
///
/// Neighbouring samples are taken as lying on different branches where they are more than three times as far apart as
/// those before and behind them on the same line are from each other, and more than two pixels of the result.
pub fn reversed(map: &Map, [width, height]: [usize; 2]) -> Map {
    let mut result = Map::unanswered(width, height);
    result.error_bound = f64::INFINITY;
    if map.width == 0 || map.height == 0 || width == 0 || height == 0 {
        return result;
    }
    let grid = Grid::new(map, [width, height]);
    for row in 0..grid.height - 1 {
        for column in 0..grid.width - 1 {
            let Some(corners) = grid.cell(column, row) else { continue };
            let bound = |axis: usize, pick: fn(f64, f64) -> f64| {
                corners.iter().map(|corner| corner[axis]).reduce(pick).unwrap_or(f64::NAN)
            };
            // Pixel centres lie at half numbers.
            let range = |axis: usize, size: usize| {
                let first = (bound(axis, f64::min) - 0.5 - SLACK).ceil().max(0.0) as usize;
                let last = (bound(axis, f64::max) - 0.5 + SLACK).floor();
                first..if last < 0.0 { 0 } else { (last as usize + 1).min(size) }
            };
            for y in range(1, height) {
                for x in range(0, width) {
                    for place in places(corners, [x as f64 + 0.5, y as f64 + 0.5]) {
                        // The grid has a ring of one pixel around the map, and its points are pixel centres.
                        let st = [
                            (column as f64 + place[0] - 0.5) / map.width as f64,
                            1.0 - (row as f64 + place[1] - 0.5) / map.height as f64,
                        ];
                        answer(map, st, &mut result, y * width + x);
                    }
                }
            }
        }
    }
    result
}

/// Rounding that is forgiven at a cell's edges, in cells and pixels.
const SLACK: f64 = 1e-9;

/// Notes that a pixel of the result is reached from `st`.
fn answer(map: &Map, st: [f64; 2], result: &mut Map, pixel: usize) {
    if !st.iter().all(|c| (0.0..=1.0).contains(c)) {
        return;
    }
    let (x, y) = pixel_at(st, map.width, map.height);
    let status = match map.status[y * map.width + x] {
        status @ (Status::Ok | Status::Folded) => status,
        Status::Outside | Status::Blocked => return,
    };
    let known = result.uv[pixel];
    if known[0].is_nan() {
        (result.uv[pixel], result.status[pixel]) = (st, status);
        return;
    }
    let apart =
        (known[0] - st[0]).abs() * map.width as f64 + (known[1] - st[1]).abs() * map.height as f64;
    // The same place found from both sides of a cell's edge is one place.
    if apart > 1e-6 {
        result.status[pixel] = Status::Folded;
    }
    let from_middle = |st: [f64; 2]| (st[0] - 0.5).hypot(st[1] - 0.5);
    if from_middle(st) < from_middle(known) {
        result.uv[pixel] = st;
    }
}

/// The map's samples in pixels of the result from its top left, with a ring around them that is extrapolated.
struct Grid {
    width: usize,
    height: usize,
    points: Vec<[f64; 2]>,
}

impl Grid {
    fn new(map: &Map, target: [usize; 2]) -> Self {
        let mut ringed = Map::unanswered(map.width + 2, map.height + 2);
        for y in 0..map.height {
            for x in 0..map.width {
                let [from, to] = [y * map.width + x, (y + 1) * ringed.width + x + 1];
                if map.status[from].is_answered() {
                    ringed.uv[to] = map.uv[from];
                }
            }
        }
        let Map { width, height, uv, .. } = bleed(&ringed, 1);
        let points =
            uv.into_iter().map(|[u, v]| [u * target[0] as f64, (1.0 - v) * target[1] as f64]);
        Self { width, height, points: points.collect() }
    }

    /// The corners of a cell: top left, top right, bottom left, bottom right; `None` where one has no answer or
    /// the map jumps between them.
    fn cell(&self, column: usize, row: usize) -> Option<[[f64; 2]; 4]> {
        let first = row * self.width + column;
        let corners = [first, first + 1, first + self.width, first + self.width + 1]
            .map(|index| self.points[index]);
        let whole = corners.iter().flatten().all(|value| value.is_finite())
            && !self.jumps(column, row, 0)
            && !self.jumps(column, row + 1, 0)
            && !self.jumps(column, row, 1)
            && !self.jumps(column + 1, row, 1);
        whole.then_some(corners)
    }

    /// Whether the map jumps between a point and the next one along an axis.
    fn jumps(&self, column: usize, row: usize, axis: usize) -> bool {
        let (at, size) = ([column, row][axis], [self.width, self.height][axis]);
        let stride = [1, self.width][axis];
        let index = row * self.width + column;
        let step = |from: usize| {
            let (a, b) = (self.points[from], self.points[from + stride]);
            (b[0] - a[0]).hypot(b[1] - a[1])
        };
        let before = (at > 0).then(|| step(index - stride)).filter(|step| step.is_finite());
        let behind = (at + 2 < size).then(|| step(index + stride)).filter(|step| step.is_finite());
        let Some(usual) = [before, behind].into_iter().flatten().reduce(f64::max) else {
            return false;
        };
        step(index) > (3.0 * usual).max(2.0)
    }
}

/// Where in a bilinear cell a point lies: the solutions (a, b) in [0, 1]^2 of
/// p = p00 + a (p10 - p00) + b (p01 - p00) + a b (p11 - p10 - p01 + p00).
fn places([p00, p10, p01, p11]: [[f64; 2]; 4], p: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
    let minus = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let (e, f, h) = (minus(p10, p00), minus(p01, p00), minus(p, p00));
    let g = minus(minus(p11, p10), f);
    // (h - b f) is parallel to (e + b g): a quadratic in b.
    let (k2, k1, k0) = (cross(g, f), cross(e, f) + cross(h, g), cross(h, e));
    let scale = k2.abs() + k1.abs() + k0.abs();
    let mut roots = [f64::NAN; 2];
    if k2.abs() < 1e-12 * scale {
        roots[0] = -k0 / k1;
    } else {
        let discriminant = k1 * k1 - 4.0 * k2 * k0;
        if discriminant >= 0.0 {
            // Numerically stable: no difference of nearly equal numbers.
            let q = -0.5 * (k1 + discriminant.sqrt().copysign(k1));
            roots = [q / k2, k0 / q];
        }
    }
    let within = |x: f64| (-SLACK..=1.0 + SLACK).contains(&x);
    roots.into_iter().filter_map(move |b| {
        let along = [e[0] + b * g[0], e[1] + b * g[1]];
        let axis = usize::from(along[1].abs() > along[0].abs());
        let a = (h[axis] - b * f[axis]) / along[axis];
        (within(a) && within(b)).then(|| [a.clamp(0.0, 1.0), b.clamp(0.0, 1.0)])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::pixel_centre;
    use proptest::prelude::*;

    fn centre(pixel: usize, width: usize, height: usize) -> [f64; 2] {
        pixel_centre(pixel % width, pixel / width, width, height)
    }

    fn map_of(width: usize, height: usize, f: impl Fn([f64; 2]) -> [f64; 2]) -> Map {
        let mut map = Map::identity(width, height);
        map.uv.iter_mut().for_each(|uv| *uv = f(*uv));
        map
    }

    #[test]
    fn the_identity_is_its_own_reverse_at_any_size() {
        for (size, target) in [([16, 12], [16, 12]), ([16, 12], [64, 7]), ([5, 9], [3, 40])] {
            let back = reversed(&Map::identity(size[0], size[1]), target);
            let expected = Map::identity(target[0], target[1]);
            assert!(back.status.iter().all(|&status| status == Status::Ok));
            for (a, b) in back.uv.iter().zip(&expected.uv) {
                // Rounding of a few operations on numbers up to 64.
                assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_bent_map_is_reversed_to_second_order_and_its_hole_stays_a_hole() {
        let bend = |[s, t]: [f64; 2]| [s * (0.5 + 0.5 * s), t * t * 0.9 + 0.1 * t];
        let mut map = map_of(200, 150, bend);
        for i in 0..map.uv.len() {
            let [s, t] = centre(i, 200, 150);
            if (s - 0.6).hypot(t - 0.5) < 0.2 {
                (map.uv[i], map.status[i]) = ([f64::NAN; 2], Status::Blocked);
            }
        }
        let back = reversed(&map, [80, 90]);
        let mut found = 0;
        for (i, st) in back.uv.iter().enumerate() {
            let [u, v] = centre(i, 80, 90);
            // The closed forms of both quadratics.
            let exact = [-0.5 + (0.25 + 2.0 * u).sqrt(), (-0.1 + (0.01 + 3.6 * v).sqrt()) / 1.8];
            let from_hole = (exact[0] - 0.6).hypot(exact[1] - 0.5) - 0.2;
            if st[0].is_finite() {
                found += 1;
                // h^2 / 8 times second derivatives up to 1.8, over slopes of at least 0.1; and within the
                // extrapolated half pixel at the edges four times that.
                assert!((st[0] - exact[0]).abs() < 4.0 * 1.8 / 8.0 / 0.5 / 150f64.powi(2), "{i}");
                assert!((st[1] - exact[1]).abs() < 4.0 * 1.8 / 8.0 / 0.1 / 150f64.powi(2), "{i}");
                assert!(from_hole > -1.0 / 100.0);
            } else {
                assert!(from_hole < 1.0 / 100.0, "{i}: {from_hole}");
            }
        }
        assert!(found > 5000 && found < 80 * 90);
    }

    #[test]
    fn what_is_reached_twice_is_folded() {
        // Down the middle and back: each u below 1 is reached from two s.
        let map = map_of(100, 20, |[s, t]| [4.0 * s * (1.0 - s), t]);
        let back = reversed(&map, [50, 20]);
        for (i, status) in back.status.iter().enumerate() {
            let u = centre(i, 50, 20)[0];
            if (0.05..0.98).contains(&u) {
                assert_eq!(*status, Status::Folded);
                let s = 0.5 - 0.5 * (1.0 - u).sqrt();
                // Either is as near to the middle; h^2 / 8 * 8 over the slope, 8 * |0.5 - s| > 0.5.
                let off = (back.uv[i][0] - s).abs().min((back.uv[i][0] - (1.0 - s)).abs());
                assert!(off < 1e-4 / 0.5, "{off}");
            }
        }
    }

    #[test]
    fn a_jump_is_not_bridged() {
        let map = map_of(40, 10, |[s, t]| [if s < 0.5 { 0.4 * s } else { 0.4 * s + 0.5 }, t]);
        let back = reversed(&map, [100, 10]);
        for (i, st) in back.uv.iter().enumerate() {
            let u = centre(i, 100, 10)[0];
            // The left half fills u < 0.2, the right one u > 0.7.
            assert_eq!(st[0].is_finite(), u < 0.2 || (0.7..0.9).contains(&u), "{u}");
        }
    }

    proptest! {
        #[test]
        fn there_and_back_is_where_it_was(
            a in -0.3f64..0.3, b in -0.3f64..0.3, c in -0.2f64..0.2,
        ) {
            // A linear map with a shift, onto part of the source: bilinear cells are exact.
            let map = map_of(30, 30, |[s, t]| [
                0.5 + (s - 0.5) + a * (t - 0.5) + c,
                0.5 + b * (s - 0.5) + (t - 0.5),
            ]);
            let back = reversed(&map, [41, 37]);
            for (i, st) in back.uv.iter().enumerate() {
                let [u, v] = centre(i, 41, 37);
                if st[0].is_finite() {
                    let there = [0.5 + (st[0] - 0.5) + a * (st[1] - 0.5) + c, 0.5 + b * (st[0] - 0.5) + st[1] - 0.5];
                    prop_assert!((there[0] - u).abs() < 1e-10 && (there[1] - v).abs() < 1e-10);
                } else {
                    let d = 1.0 - a * b;
                    let (x, y) = (u - 0.5 - c, v - 0.5);
                    let (s, t) = (0.5 + (x - a * y) / d, 0.5 + (y - b * x) / d);
                    prop_assert!(!((1e-9..1.0 - 1e-9).contains(&s) && (1e-9..1.0 - 1e-9).contains(&t)));
                }
            }
        }

        #[test]
        fn wild_maps_are_reversed_without_a_fault(uv in prop::collection::vec((-2.0f64..3.0, -2.0f64..3.0, 0u8..4), 30)) {
            let mut map = Map::identity(6, 5);
            for (i, (u, v, hole)) in uv.into_iter().enumerate() {
                map.uv[i] = [u, v];
                if hole == 0 {
                    (map.uv[i], map.status[i]) = ([f64::NAN; 2], Status::Outside);
                }
            }
            let back = reversed(&map, [9, 8]);
            for (st, status) in back.uv.iter().zip(&back.status) {
                prop_assert_eq!(st[0].is_finite(), matches!(status, Status::Ok | Status::Folded));
                prop_assert!(st[0].is_nan() || st.iter().all(|c| (0.0..=1.0).contains(c)));
            }
        }
    }
}
