//! Solids of revolution and prisms: a profile turned about an axis, or moved along one.

mod outline;
mod roots;
#[cfg(test)]
mod tests;

use super::profile::{Piece, Point, Profile};
use super::{Crossing, Hit, Ray, Real, Search, Vec3};
pub(super) use outline::of_swept;

/// How a profile becomes a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sweep {
    /// Turned about y; the profile's points are [distance from the axis, y].
    AboutY,
    /// Turned about z; the profile's points are [distance from the axis, z].
    AboutZ,
    /// Moved along z by this much to both sides, mm; the profile's points are [x, y].
    AlongZ(f64),
}

/// A solid that a profile sweeps, in its own frame.
///
/// Each piece of the profile is a face: a plane, cone, cylinder, ball, torus or asphere, each continued beyond its edges. The flat ends of a prism
/// are the last two.
#[derive(Clone, Debug, PartialEq)]
pub struct Swept {
    sweep: Sweep,
    profile: Profile,
    faces: Vec<Face>,
    bounds: [Vec3; 2],
    volume: f64,
}

#[derive(Clone, Debug, PartialEq)]
struct Face {
    piece: Piece,
    /// Bounds of the piece.
    bounds: [Point; 2],
}

/// What lies beyond a face's edge by less still lies on it, mm: neighbours then leave no gap between them.
const EDGE: f64 = 1e-9;
/// A surface that coincides with where a ray stands is met there, at a distance that rounding makes a little negative.
const BEHIND: f64 = -1e-9;
/// A line that rises by less counts as level: it sweeps a plane.
const FLAT: f64 = 1e-9;

impl Swept {
    /// The solid that a profile sweeps.
    pub fn new(profile: Profile, sweep: Sweep) -> Self {
        let turned = !matches!(sweep, Sweep::AlongZ(_));
        let faces = profile
            .pieces()
            .iter()
            .filter(|piece| !(turned && piece.is_on_axis()))
            .map(|piece| Face { piece: piece.clone(), bounds: piece.bounds() })
            .collect();
        let [low, high] = profile.bounds();
        let reach = low[0].abs().max(high[0].abs());
        let bounds = match sweep {
            Sweep::AboutY => [Vec3::new(-reach, low[1], -reach), Vec3::new(reach, high[1], reach)],
            Sweep::AboutZ => [Vec3::new(-reach, -reach, low[1]), Vec3::new(reach, reach, high[1])],
            Sweep::AlongZ(half) => {
                [Vec3::new(low[0], low[1], -half), Vec3::new(high[0], high[1], half)]
            }
        };
        let volume = match sweep {
            Sweep::AlongZ(half) => 2.0 * half * profile.area(),
            _ => profile.turned_volume(),
        };
        Self { sweep, profile, faces, bounds, volume }
    }

    /// What it is the section of.
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// How the profile becomes a solid.
    pub fn sweep(&self) -> Sweep {
        self.sweep
    }

    /// Least and largest x, y and z, mm.
    pub fn bounds(&self) -> [Vec3; 2] {
        self.bounds
    }

    /// Volume, mm^3.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// The first hit along a ray that fits the search.
    pub fn nearest(&self, ray: &Ray, search: Search) -> Option<Hit> {
        let crossing = search.crossing.unwrap_or(Crossing::Enter);
        let within = self.within_bounds(ray, search.after)?;
        let ray = self.inner(ray);
        let mut best: Option<Hit> = None;
        for face in 0..self.face_count() {
            let Some(part) = self.part_near(&ray, face, within) else { continue };
            for t in self.roots(&ray, face, part) {
                let sooner = best.is_none_or(|hit| t < hit.t);
                if t > search.after
                    && sooner
                    && self.crossing(&ray, face, t) == crossing
                    && self.excess(face, ray.at(t)) <= EDGE
                {
                    best = Some(Hit { t, face: face as u32, crossing });
                }
            }
        }
        best
    }

    /// Distance to a known face along a ray and the outward normal there, the face continued beyond its edges. Where the ray meets the face several
    /// times in the same sense, the first meeting within its edges is meant, else that least beyond them. NaN where there is none.
    pub fn cross<T: Real>(&self, ray: &Ray<T>, face: u32, crossing: Crossing) -> (T, Vec3<T>) {
        let face = face as usize;
        let inner =
            Ray { origin: self.to_inner(ray.origin), direction: self.to_inner(ray.direction) };
        let plain = inner.value();
        let rank = |t: f64| {
            let excess = self.excess(face, plain.at(t));
            if t > BEHIND { (excess <= EDGE, excess) } else { (false, excess.max(1.0)) }
        };
        let start = self
            .roots(&plain, face, [f64::NEG_INFINITY, f64::INFINITY])
            .into_iter()
            .filter(|&t| self.crossing(&plain, face, t) == crossing)
            .min_by(|&a, &b| {
                let ((on_a, beyond_a), (on_b, beyond_b)) = (rank(a), rank(b));
                on_b.cmp(&on_a).then_with(|| {
                    if on_a { a.total_cmp(&b) } else { beyond_a.total_cmp(&beyond_b) }
                })
            })
            .unwrap_or(f64::NAN);
        // The implicit function theorem: one Newton step from the root carries the derivatives over.
        let (level, gradient) = self.level(face, inner.at(T::constant(start)));
        let slope = gradient.value().dot(plain.direction);
        let t = -(level * slope.recip()) + start;
        let (_, gradient) = self.level(face, inner.at(t));
        (t, self.to_outer(gradient.normalized()))
    }

    /// A ray in the frame of the profile: the axis of what is turned is y.
    fn inner(&self, ray: &Ray) -> Ray {
        Ray { origin: self.to_inner(ray.origin), direction: self.to_inner(ray.direction) }
    }

    fn to_inner<T: Real>(&self, v: Vec3<T>) -> Vec3<T> {
        match self.sweep {
            Sweep::AboutZ => Vec3::new(v.x, v.z, -v.y),
            Sweep::AboutY | Sweep::AlongZ(_) => v,
        }
    }

    fn to_outer<T: Real>(&self, v: Vec3<T>) -> Vec3<T> {
        match self.sweep {
            Sweep::AboutZ => Vec3::new(v.x, -v.z, v.y),
            Sweep::AboutY | Sweep::AlongZ(_) => v,
        }
    }

    fn face_count(&self) -> usize {
        self.faces.len() + if matches!(self.sweep, Sweep::AlongZ(_)) { 2 } else { 0 }
    }

    /// The part of a ray from `after` on that lies within the bounds, a little wider; `None` if none does.
    fn within_bounds(&self, ray: &Ray, after: f64) -> Option<[f64; 2]> {
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        let [low, high] = self.bounds.map(Vec3::to_array);
        let slack = 1e-6 + 1e-9 * (self.bounds[1] - self.bounds[0]).length();
        let mut part = [after - slack, f64::INFINITY];
        for axis in 0..3 {
            let [a, b] = [low[axis] - slack - o[axis], high[axis] + slack - o[axis]];
            if d[axis] == 0.0 {
                if a > 0.0 || b < 0.0 {
                    return None;
                }
                continue;
            }
            let [a, b] = [a / d[axis], b / d[axis]];
            part = [part[0].max(a.min(b)), part[1].min(a.max(b))];
        }
        (part[0] <= part[1]).then_some(part)
    }

    /// Which way a ray goes through a face.
    fn crossing(&self, ray: &Ray, face: usize, t: f64) -> Crossing {
        let (_, gradient) = self.level(face, ray.at(t));
        if gradient.dot(ray.direction) < 0.0 { Crossing::Enter } else { Crossing::Leave }
    }

    /// The point of the section that a place of the solid comes from.
    fn in_section(&self, p: Vec3) -> Point {
        match self.sweep {
            Sweep::AlongZ(_) => [p.x, p.y],
            Sweep::AboutY | Sweep::AboutZ => [p.x.hypot(p.z), p.y],
        }
    }

    /// How far a point of a face's surface lies beyond its edges, mm; 0 on it.
    fn excess(&self, face: usize, p: Vec3) -> f64 {
        match (self.faces.get(face), self.sweep) {
            (Some(Face { piece, .. }), Sweep::AlongZ(half)) => {
                piece.excess([p.x, p.y]).max(p.z.abs() - half).max(0.0)
            }
            (Some(Face { piece, .. }), _) => piece.excess(self.in_section(p)),
            (None, _) if self.profile.contains([p.x, p.y]) => 0.0,
            (None, _) => 1.0,
        }
    }

    /// A function that is 0 on a face's surface, continued without bounds, more outside of the solid and less inside; and its gradient. Where the
    /// surface is none of an asphere, the function is the distance from it.
    fn level<T: Real>(&self, face: usize, p: Vec3<T>) -> (T, Vec3<T>) {
        let zero = T::constant(0.0);
        let Some(Face { piece, .. }) = self.faces.get(face) else {
            let half = match self.sweep {
                Sweep::AlongZ(half) => half,
                Sweep::AboutY | Sweep::AboutZ => f64::NAN,
            };
            let sign = if face == self.faces.len() { -1.0 } else { 1.0 };
            return (p.z * sign - half, Vec3::constant(Vec3::new(0.0, 0.0, sign)));
        };
        let along = matches!(self.sweep, Sweep::AlongZ(_));
        match piece {
            Piece::Line { from, .. } => {
                let [[u, w], _] = piece.directions();
                let rise = (p.y - from[1]) * -u;
                if along {
                    return ((p.x - from[0]) * w + rise, Vec3::constant(Vec3::new(w, -u, 0.0)));
                }
                if w.abs() < FLAT {
                    return (rise, Vec3::constant(Vec3::new(0.0, -u, 0.0)));
                }
                let r = from_axis(p);
                let [x, z] = across(p, r).map(|c| c * w);
                ((r - from[0]) * w + rise, Vec3::new(x, T::constant(-u), z))
            }
            Piece::Arc { centre, radius, from, to } => {
                let way = if to > from { 1.0 } else { -1.0 };
                let up = p.y - centre[1];
                if along || centre[0] == 0.0 {
                    let v = Vec3::new(
                        if along { p.x - centre[0] } else { p.x },
                        up,
                        if along { zero } else { p.z },
                    );
                    let length = v.length();
                    return ((length - *radius) * way, v.scaled(length.recip() * way));
                }
                let r = from_axis(p);
                let off = r - centre[0];
                let length = (off * off + up * up).sqrt();
                let scale = length.recip() * way;
                let [x, z] = across(p, r).map(|c| c * off * scale);
                ((length - *radius) * way, Vec3::new(x, up * scale, z))
            }
            Piece::Sag(sag) => {
                let q = p.x * p.x + p.z * p.z;
                let slope = sag.slope(q) * 2.0;
                let level = (p.y - sag.vertex) * sag.side + sag.at(q);
                (level, Vec3::new(p.x * slope, T::constant(sag.side), p.z * slope))
            }
        }
    }
}

/// Distance from the axis; without derivatives on it, where it has none.
fn from_axis<T: Real>(p: Vec3<T>) -> T {
    let q = p.x * p.x + p.z * p.z;
    if q.value() == 0.0 { T::constant(0.0) } else { q.sqrt() }
}

/// The direction away from the axis, x and z; none on the axis.
fn across<T: Real>(p: Vec3<T>, r: T) -> [T; 2] {
    if r.value() == 0.0 { [T::constant(0.0); 2] } else { [p.x / r, p.z / r] }
}
