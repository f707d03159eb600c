//! A surface z(x, y) over a rectangle: a water surface, an asphere.

use super::roots::bracketed_root;
use super::{Crossing, Hit, Ray, Real, Search, Vec3};

/// Heights over a rectangle in its own frame, between samples by a uniform cubic B-spline through them: its slopes and
/// curvatures are continuous, so light leaves it without creases.
///
/// As a solid it reaches down to a flat bottom, with upright sides.
#[derive(Clone, Debug)]
pub struct HeightField {
    columns: usize,
    rows: usize,
    half: [f64; 2],
    depth: f64,
    /// B-spline coefficients with a ring of one around them, row-major, row 0 at the -y edge.
    coefficients: Vec<f64>,
    /// Bounds of the heights.
    range: [f64; 2],
    solid: bool,
}

const TOP: u32 = 0;
const BOTTOM: u32 = 5;

/// A ray that stands on the surface has left it from this distance on, mm: well above rounding, well below anything
/// that the samples resolve.
const STANDING: f64 = 1e-7;

impl HeightField {
    /// From rows of heights (mm), the first at the +y edge, at least 2 x 2, of equal lengths; samples lie at the
    /// rectangle's edges and evenly between. `depth`: for a solid, how far it reaches below z = 0; `None`: a sheet.
    pub fn new(heights: &[Vec<f64>], size: [f64; 2], depth: Option<f64>) -> Self {
        let (rows, columns) = (heights.len(), heights.first().map_or(0, Vec::len));
        assert!(rows >= 2 && columns >= 2, "a height field has at least 2 x 2 samples");
        let padded = columns + 2;
        let mut coefficients = vec![0.0; padded * (rows + 2)];
        for (row, line) in heights.iter().rev().enumerate() {
            let spline = interpolating_spline(line);
            coefficients[(row + 1) * padded..(row + 2) * padded].copy_from_slice(&spline);
        }
        for column in 0..padded {
            let line: Vec<f64> =
                (1..=rows).map(|row| coefficients[row * padded + column]).collect();
            for (row, c) in interpolating_spline(&line).into_iter().enumerate() {
                coefficients[row * padded + column] = c;
            }
        }
        // A B-spline stays within its coefficients' bounds.
        let range = coefficients
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &c| [low.min(c), high.max(c)]);
        Self {
            columns,
            rows,
            half: size.map(|s| 0.5 * s),
            depth: depth.unwrap_or(0.0),
            coefficients,
            range,
            solid: depth.is_some(),
        }
    }

    /// Least and largest x, y and z that it can reach, mm.
    pub fn bounds(&self) -> [Vec3; 2] {
        let ([x, y], [low, high]) = (self.half, self.range);
        let bottom = if self.solid { -self.depth } else { low };
        [Vec3::new(-x, -y, bottom.min(low)), Vec3::new(x, y, high)]
    }

    /// Whether it encloses a volume.
    pub fn is_solid(&self) -> bool {
        self.solid
    }

    /// Volume of the solid, mm^3, its top taken at the samples' mean.
    pub fn volume(&self) -> f64 {
        if !self.solid {
            return 0.0;
        }
        let samples = self.columns * self.rows;
        let sum: f64 = (0..samples)
            .map(|index| {
                let share = |k: usize, n: usize| k as f64 / (n - 1) as f64 * 2.0 - 1.0;
                let x = share(index % self.columns, self.columns) * self.half[0];
                let y = share(index / self.columns, self.rows) * self.half[1];
                self.height(x, y).0
            })
            .sum();
        4.0 * self.half[0] * self.half[1] * (sum / samples as f64 + self.depth)
    }

    fn over(&self, p: Vec3) -> bool {
        p.x.abs() <= self.half[0] && p.y.abs() <= self.half[1]
    }

    /// Height at a point of the rectangle, mm.
    pub fn height_at(&self, [x, y]: [f64; 2]) -> f64 {
        self.height(x, y).0
    }

    /// Height and slopes at a point of the rectangle.
    fn height<T: Real>(&self, x: T, y: T) -> (T, T, T) {
        let locate = |c: T, half: f64, n: usize| {
            let scale = (n - 1) as f64 / (2.0 * half);
            let position = (c + half) * scale;
            let cell = (position.value().floor().max(0.0) as usize).min(n - 2);
            (cell, position - cell as f64, scale)
        };
        let (column, fx, scale_x) = locate(x, self.half[0], self.columns);
        let (row, fy, scale_y) = locate(y, self.half[1], self.rows);
        let (wx, dx) = b_spline(fx);
        let (wy, dy) = b_spline(fy);
        let mut sums = [T::constant(0.0); 3];
        for j in 0..4 {
            let start = (row + j) * (self.columns + 2) + column;
            let mut along = T::constant(0.0);
            let mut slope = T::constant(0.0);
            for i in 0..4 {
                along = along + wx[i] * self.coefficients[start + i];
                slope = slope + dx[i] * self.coefficients[start + i];
            }
            sums = [sums[0] + along * wy[j], sums[1] + slope * wy[j], sums[2] + along * dy[j]];
        }
        (sums[0], sums[1] * scale_x, sums[2] * scale_y)
    }

    /// The first hit along a ray that fits the search.
    pub fn nearest(&self, ray: &Ray, search: Search) -> Option<Hit> {
        let on_top = search.standing_on == Some(TOP);
        let after = if on_top { search.after.max(STANDING) } else { search.after };
        let top = self.nearest_top(ray, search.crossing, after);
        let walls = if self.solid { self.nearest_wall(ray, search) } else { None };
        match (top, walls) {
            (Some(a), Some(b)) => Some(if a.t < b.t { a } else { b }),
            (a, b) => a.or(b),
        }
    }

    fn nearest_wall(&self, ray: &Ray, search: Search) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for face in 1..=BOTTOM {
            let (t, normal) = self.cross_wall(ray, face);
            let p = ray.at(t);
            let slack = 1e-9;
            let within = match face {
                BOTTOM => self.over(p),
                1 | 2 => p.y.abs() <= self.half[1],
                _ => p.x.abs() <= self.half[0],
            } && p.z >= -self.depth - slack
                && p.z <= self.height(p.x, p.y).0 + slack;
            let crossing = crossing_of(ray.direction.dot(normal));
            let wanted = search.crossing.is_none_or(|c| c == crossing);
            if within
                && wanted
                && t > search.after
                && search.standing_on != Some(face)
                && best.is_none_or(|b| t < b.t)
            {
                best = Some(Hit { t, face, crossing });
            }
        }
        best
    }

    /// Marches over the rectangle in steps of half a sample, and closes in where the ray changes sides.
    fn nearest_top(&self, ray: &Ray, wanted: Option<Crossing>, after: f64) -> Option<Hit> {
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        let (mut near, mut far) = (after, f64::INFINITY);
        let bounds = [
            [-self.half[0], self.half[0]],
            [-self.half[1], self.half[1]],
            [self.range[0] - STANDING, self.range[1] + STANDING],
        ];
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if o[axis] < bounds[axis][0] || o[axis] > bounds[axis][1] {
                    return None;
                }
                continue;
            }
            let [a, b] = bounds[axis].map(|x| (x - o[axis]) / d[axis]);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        if !(near < far) {
            return None;
        }
        let above = |t: f64| {
            let p = ray.at(t);
            p.z - self.height(p.x, p.y).0
        };
        let cells = |axis: usize, n: usize| {
            (far - near) * d[axis].abs() * (n - 1) as f64 / (2.0 * self.half[axis])
        };
        let steps = (2.0 * cells(0, self.columns).max(cells(1, self.rows))).ceil().max(4.0);
        let mut t0 = near;
        let mut f0 = above(t0);
        for k in 1..=steps as usize {
            let t1 = near + (far - near) * k as f64 / steps;
            let f1 = above(t1);
            let crossing = if f0 > 0.0 { Crossing::Enter } else { Crossing::Leave };
            if (f0 > 0.0) != (f1 > 0.0) && wanted.is_none_or(|c| c == crossing) {
                let t = bracketed_root(above, [t0, t1], [f0, f1]);
                return Some(Hit { t, face: TOP, crossing });
            }
            (t0, f0) = (t1, f1);
        }
        None
    }

    /// Distance to a known face along a ray and the outward normal there.
    pub fn cross<T: Real>(&self, ray: &Ray<T>, face: u32, crossing: Crossing) -> (T, Vec3<T>) {
        if face != TOP {
            let (t, normal) = self.cross_wall(ray, face);
            return (t, Vec3::constant(normal));
        }
        let plain = ray.value();
        let start = match self.nearest_top(&plain, Some(crossing), STANDING) {
            Some(hit) => hit.t,
            None => f64::NAN,
        };
        // The implicit function theorem: one Newton step from the root carries the derivatives over.
        let p = ray.at(T::constant(start));
        let (h, hx, hy) = self.height(p.x, p.y);
        let d = plain.direction;
        let slope = d.z - hx.value() * d.x - hy.value() * d.y;
        let t = (h - p.z) * slope.recip() + start;
        let p = ray.at(t);
        let (_, hx, hy) = self.height(p.x, p.y);
        (t, Vec3::new(-hx, -hy, T::constant(1.0)).normalized())
    }

    fn cross_wall<T: Real>(&self, ray: &Ray<T>, face: u32) -> (T, Vec3) {
        let (o, d) = (ray.origin, ray.direction);
        let wall = |o: T, d: T, at: f64| (T::constant(at) - o) / d;
        match face {
            1 => (wall(o.x, d.x, -self.half[0]), Vec3::new(-1.0, 0.0, 0.0)),
            2 => (wall(o.x, d.x, self.half[0]), Vec3::new(1.0, 0.0, 0.0)),
            3 => (wall(o.y, d.y, -self.half[1]), Vec3::new(0.0, -1.0, 0.0)),
            4 => (wall(o.y, d.y, self.half[1]), Vec3::new(0.0, 1.0, 0.0)),
            _ => (wall(o.z, d.z, -self.depth), Vec3::new(0.0, 0.0, -1.0)),
        }
    }
}

fn crossing_of(along_normal: f64) -> Crossing {
    if along_normal < 0.0 { Crossing::Enter } else { Crossing::Leave }
}

/// Weights of a uniform cubic B-spline's four coefficients at a fraction of a cell, and their slopes (de Boor, A Practical
/// Guide to Splines, 1978).
fn b_spline<T: Real>(f: T) -> ([T; 4], [T; 4]) {
    let g = -f + 1.0;
    let (f2, g2) = (f * f, g * g);
    let sixth = 1.0 / 6.0;
    (
        [
            g2 * g * sixth,
            (f2 * f * 3.0 - f2 * 6.0 + 4.0) * sixth,
            (g2 * g * 3.0 - g2 * 6.0 + 4.0) * sixth,
            f2 * f * sixth,
        ],
        [g2 * -0.5, (f2 * 3.0 - f * 4.0) * 0.5, (g2 * -3.0 + g * 4.0) * 0.5, f2 * 0.5],
    )
}

/// Coefficients of the cubic B-spline through samples, one more at each end; without curvature at the ends (a natural
/// spline). Thomas's algorithm for the tridiagonal system (c[k-1] + 4 c[k] + c[k+1]) / 6 = sample.
fn interpolating_spline(samples: &[f64]) -> Vec<f64> {
    let n = samples.len();
    let mut c = vec![0.0; n + 2];
    // No curvature at an end makes the coefficient there equal the sample.
    c[1] = samples[0];
    c[n] = samples[n - 1];
    let inner = n.saturating_sub(2);
    let mut factor = vec![0.0; inner];
    let mut right = vec![0.0; inner];
    for k in 0..inner {
        let mut r = 6.0 * samples[k + 1];
        if k == 0 {
            r -= c[1];
        }
        if k == inner - 1 {
            r -= c[n];
        }
        let (previous_factor, previous) =
            if k == 0 { (0.0, 0.0) } else { (factor[k - 1], right[k - 1]) };
        let pivot = 4.0 - previous_factor;
        factor[k] = 1.0 / pivot;
        right[k] = (r - previous) / pivot;
    }
    for k in (0..inner).rev() {
        let next = if k + 1 < inner { c[k + 3] } else { 0.0 };
        c[k + 2] = right[k] - factor[k] * next;
    }
    c[0] = 2.0 * c[1] - c[2];
    c[n + 1] = 2.0 * c[n] - c[n - 1];
    c
}
