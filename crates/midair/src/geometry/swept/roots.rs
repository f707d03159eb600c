//! Where a line meets the faces of a swept solid.

use super::{EDGE, FLAT, Face, Sweep, Swept};
use crate::geometry::convex::quadratic_roots;
use crate::geometry::profile::{Piece, Sag};
use crate::geometry::roots::{Roots, bracketed_root, polynomial_roots};
use crate::geometry::{Ray, Vec3};

impl Swept {
    /// The part of a ray within which it can meet a face of the profile: where its height is the piece's, and its distance from the axis is not more
    /// than the piece's. `None` where there is none, or all of it is nearer to the axis than the piece.
    pub(super) fn part_near(
        &self,
        ray: &Ray,
        face: usize,
        [low, high]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let Some(Face { bounds: [least, most], .. }) = self.faces.get(face) else {
            return Some([low, high]);
        };
        let (o, d) = (ray.origin, ray.direction);
        // Coordinates are known to 16 digits, seen from wherever the ray comes.
        let slack = 1e-6 + 1e-12 * o.squared_length();
        let mut part = [low, high];
        let mut clip = |o: f64, d: f64, axis: usize| {
            let [a, b] = [least[axis] - slack - o, most[axis] + slack - o];
            if d == 0.0 {
                return a <= 0.0 && b >= 0.0;
            }
            let [a, b] = [a / d, b / d];
            part = [part[0].max(a.min(b)), part[1].min(a.max(b))];
            part[0] <= part[1]
        };
        if !clip(o.y, d.y, 1) {
            return None;
        }
        if let Sweep::AlongZ(_) = self.sweep {
            return clip(o.x, d.x, 0).then_some(part);
        }
        let (a, b, c) = (d.x * d.x + d.z * d.z, o.x * d.x + o.z * d.z, o.x * o.x + o.z * o.z);
        let far = (most[0] + slack).powi(2);
        if a > 0.0 {
            let half = (b * b - a * (c - far)).sqrt();
            // NaN where the whole line is too far off.
            if half.is_nan() {
                return None;
            }
            part = [part[0].max((-b - half) / a), part[1].min((half - b) / a)];
        } else if c > far {
            return None;
        }
        // The distance from the axis is largest at an end.
        let squared =
            |t: f64| if t.is_finite() { (a * t + 2.0 * b) * t + c } else { f64::INFINITY };
        let near = (least[0] - slack).max(0.0).powi(2);
        let reaches = squared(part[0]).max(squared(part[1])) >= near;
        (part[0] <= part[1] && reaches).then_some(part)
    }

    /// Where a line (in the frame of the profile) meets a face's unbounded surface, within a part of it.
    pub(super) fn roots(&self, ray: &Ray, face: usize, [low, high]: [f64; 2]) -> Roots {
        // By way of the closest approach to the middle: from far away digits would cancel.
        let (o, d) = (ray.origin, ray.direction);
        let centre = match self.faces.get(face).map(|face| &face.piece) {
            Some(Piece::Arc { centre: [x, y], .. }) if matches!(self.sweep, Sweep::AlongZ(_)) => {
                Vec3::new(*x, *y, 0.0)
            }
            Some(Piece::Arc { centre: [_, y], .. }) => Vec3::new(0.0, *y, 0.0),
            Some(Piece::Line { from: [_, y], .. }) => Vec3::new(0.0, *y, 0.0),
            Some(Piece::Sag(sag)) => Vec3::new(0.0, sag.vertex, 0.0),
            None => Vec3::ZERO,
        };
        let middle = (centre - o).dot(d);
        let near = Ray { origin: ray.at(middle) - centre, direction: d };
        let part = [low - middle, high - middle];
        let mut roots = self.unpolished(ray, &near, face, part);
        for t in &mut roots {
            *t += middle;
        }
        let tolerance = 1e-9 * (1.0 + self.bounds[1].length() + self.bounds[0].length());
        roots.retain(|t| {
            for _ in 0..2 {
                let (level, gradient) = self.level(face, ray.at(*t));
                let step = level / gradient.dot(d);
                // A ray that touches has no step that means anything.
                if step.abs() < 1.0 {
                    *t -= step;
                }
            }
            // What solves only the squared equation lies elsewhere.
            self.level(face, ray.at(*t)).0.abs() < tolerance && *t >= low && *t <= high
        });
        roots
    }

    /// The same from the line's closest approach to the face's centre on, `near` having that centre as its origin; roots of the squared equations too.
    fn unpolished(&self, ray: &Ray, near: &Ray, face: usize, part: [f64; 2]) -> Roots {
        let (o, d) = (near.origin, near.direction);
        let Some(Face { piece, bounds }) = self.faces.get(face) else {
            let (level, gradient) = self.level(face, ray.origin);
            let middle = -(ray.origin.dot(d));
            return one(-level / gradient.dot(d) - middle);
        };
        let along = matches!(self.sweep, Sweep::AlongZ(_));
        let two = |a: f64, b: f64, c: f64| {
            let mut roots: Roots = quadratic_roots(a, b, c).into_iter().collect();
            roots.retain(|t| t.is_finite());
            roots
        };
        let (a, b, c) = (d.x * d.x + d.z * d.z, o.x * d.x + o.z * d.z, o.x * o.x + o.z * o.z);
        match piece {
            Piece::Line { from, .. } => {
                let [[u, w], _] = piece.directions();
                if along {
                    return one(((from[0] - o.x) * w + o.y * u) / (d.x * w - d.y * u));
                }
                if w.abs() < FLAT {
                    return one(-o.y / d.y);
                }
                let (r, change) = (w * from[0] + u * o.y, u * d.y);
                two(w * w * a - change * change, w * w * b - r * change, w * w * c - r * r)
            }
            Piece::Arc { radius, .. } if along => {
                let (a, b) = (d.x * d.x + d.y * d.y, o.x * d.x + o.y * d.y);
                two(a, b, o.x * o.x + o.y * o.y - radius * radius)
            }
            Piece::Arc { centre, radius, .. } if centre[0] == 0.0 => {
                two(1.0, 0.0, o.squared_length() - radius * radius)
            }
            Piece::Arc { centre, radius, .. } => {
                let reach = centre[0].abs() + radius;
                let low = (-reach).max(part[0]);
                let high = reach.min(part[1]);
                let whole = part[0] == f64::NEG_INFINITY;
                let nearest = c - if a > 0.0 { b * b / a } else { 0.0 };
                if !(low <= high) || !whole && nearest > (bounds[1][0] + EDGE).powi(2) {
                    return Roots::new();
                }
                // In units of the reach; ((t^2 + k)^2 = 4 R^2 (a t^2 + 2 b t + c)).
                let scale = reach.recip();
                let (b, c) = (b * scale, c * scale * scale);
                let (ring, tube) = (centre[0] * scale, radius * scale);
                let k = o.squared_length() * scale * scale + ring * ring - tube * tube;
                let f = 4.0 * ring * ring;
                let quartic = [k * k - f * c, -2.0 * f * b, 2.0 * k - f * a, 0.0, 1.0];
                let slack = 1e-9;
                let mut roots =
                    polynomial_roots(&quartic, [low * scale - slack, high * scale + slack]);
                roots.iter_mut().for_each(|t| *t *= reach);
                roots
            }
            Piece::Sag(sag) => sag_roots(sag, o.y, d.y, [a, b, c], part),
        }
    }
}

fn one(t: f64) -> Roots {
    let mut roots = Roots::new();
    if t.is_finite() {
        roots.push(t);
    }
    roots
}

/// Where a line meets an asphere: heights over the vertex are o + t d, squares of the distance from the axis a t^2 + 2 b t + c.
///
/// On either side of the closest approach to the axis every term is monotone, which bounds the function and its slope over an interval: an interval
/// that may hold a root is halved until the slope has one sign.
fn sag_roots(sag: &Sag, o: f64, d: f64, [a, b, c]: [f64; 3], part: [f64; 2]) -> Roots {
    let mut roots = Roots::new();
    let q = |t: f64| (a * t * t + 2.0 * b * t + c).max(0.0);
    let reach = sag.farthest();
    let [first, last] = if a > 0.0 {
        quadratic_roots(a, b, c - reach)
    } else if c <= reach {
        [f64::NEG_INFINITY, f64::INFINITY]
    } else {
        return roots;
    };
    // A line along the axis: no farther than the surface falls.
    let [fall_low, fall_high] = sag.range([0.0, reach]);
    let heights = [fall_low, fall_high].map(|fall| (-sag.side * fall - o) / d);
    let [from, to] = [heights[0].min(heights[1]) - 1.0, heights[0].max(heights[1]) + 1.0];
    let clip = |low: f64, high: f64| {
        if d == 0.0 { [low, high] } else { [low.max(from), high.min(to)] }
    };
    let [first, last] = clip(first.max(part[0]), last.min(part[1]));
    if !(first <= last) {
        return roots;
    }
    let level = |t: f64| sag.side * (o + d * t) + sag.at(q(t));
    let turn = if a > 0.0 { (-b / a).clamp(first, last) } else { last };
    let mut open: Vec<([f64; 2], usize)> = vec![([turn, last], 0), ([first, turn], 0)];
    while let Some(([low, high], depth)) = open.pop() {
        let ends = [q(low).min(q(high)).min(reach), q(low).max(q(high)).min(reach)];
        let fall = sag.range(ends);
        let heights = [low, high].map(|t| sag.side * (o + d * t));
        let least = heights[0].min(heights[1]) + fall[0];
        let most = heights[0].max(heights[1]) + fall[1];
        if !(least <= 1e-12 && most >= -1e-12) {
            continue;
        }
        let [slope_low, slope_high] = sag.slope_range(ends);
        let speeds = [low, high].map(|t| 2.0 * (a * t + b));
        let products = speeds.iter().flat_map(|s| [s * slope_low, s * slope_high]);
        let (mut below, mut above) = (f64::INFINITY, f64::NEG_INFINITY);
        for product in products {
            below = below.min(product);
            above = above.max(product);
        }
        let rise = sag.side * d;
        let monotone = rise + below > 0.0 || rise + above < 0.0;
        if monotone || depth >= DEEPEST {
            let values = [level(low), level(high)];
            if (values[0] > 0.0) != (values[1] > 0.0) {
                roots.push(bracketed_root(level, [low, high], values));
            }
            continue;
        }
        let half = 0.5 * (low + high);
        open.push(([half, high], depth + 1));
        open.push(([low, half], depth + 1));
    }
    roots
}

/// An interval of a metre halved as often is a hundredth of a micrometre long.
const DEEPEST: usize = 27;
