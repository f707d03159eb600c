//! Convex solids bounded by planes and one quadric: sphere, ellipsoid, box, cylinder, cone.

use super::{Crossing, Hit, Ray, Real, Search, Vec3};

/// A convex solid in its own frame.
///
/// A line meets it in at most one interval. Faces are numbered: the curved one 0 (where there
/// is one), planes `2 * axis + (1 if on the positive side)` counted from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Convex {
    /// Ball of a radius.
    Sphere {
        /// Radius, mm.
        radius: f64,
    },
    /// Ball stretched along the axes.
    Ellipsoid {
        /// Semi-axes, mm.
        radii: Vec3,
    },
    /// Block.
    Box {
        /// Half edge lengths, mm.
        half: Vec3,
    },
    /// Frustum about y, from `-half_height` to `half_height`; a cylinder where `slope` is 0.
    Frustum {
        /// Radius at y = 0, mm.
        middle_radius: f64,
        /// Change of radius per mm of y.
        slope: f64,
        /// Half the length along y, mm.
        half_height: f64,
    },
}

const CURVED: u32 = 0;

fn plane_face(axis: usize, positive: bool) -> u32 {
    1 + 2 * axis as u32 + u32::from(positive)
}

/// The part of a line that is inside, with the faces where it starts and ends.
#[derive(Clone, Copy)]
struct Interval {
    enter: (f64, u32),
    leave: (f64, u32),
}

impl Interval {
    const ALL: Self = Self { enter: (f64::NEG_INFINITY, CURVED), leave: (f64::INFINITY, CURVED) };

    fn clip_to_slab(&mut self, origin: f64, direction: f64, half: f64, axis: usize) {
        let inverse = 1.0 / direction;
        let (low, high) = ((-half - origin) * inverse, (half - origin) * inverse);
        if direction == 0.0 {
            if origin.abs() > half {
                self.enter.0 = f64::INFINITY;
            }
            return;
        }
        let positive = direction > 0.0;
        let (near, far) = if positive { (low, high) } else { (high, low) };
        if near > self.enter.0 {
            self.enter = (near, plane_face(axis, !positive));
        }
        if far < self.leave.0 {
            self.leave = (far, plane_face(axis, positive));
        }
    }

    fn clip_to_roots(&mut self, near: f64, far: f64) {
        // Written so that NaN (no meeting) empties the interval.
        if !(near <= far) {
            self.enter.0 = f64::INFINITY;
            return;
        }
        if near > self.enter.0 {
            self.enter = (near, CURVED);
        }
        if far < self.leave.0 {
            self.leave = (far, CURVED);
        }
    }
}

impl Convex {
    /// The hit that `search` asks for, if the ray meets it.
    pub fn nearest(&self, ray: &Ray, search: Search) -> Option<Hit> {
        let interval = self.interval(ray);
        if interval.enter.0 >= interval.leave.0 {
            return None;
        }
        let crossing = search.crossing.unwrap_or(Crossing::Enter);
        let (t, face) = match crossing {
            Crossing::Enter => interval.enter,
            Crossing::Leave => interval.leave,
        };
        (t > search.after).then_some(Hit { t, face, crossing })
    }

    fn interval(&self, ray: &Ray) -> Interval {
        let (o, d) = (ray.origin, ray.direction);
        let mut inside = Interval::ALL;
        match *self {
            Self::Sphere { .. } | Self::Ellipsoid { .. } => {
                let [near, far] = self.curved_roots(ray);
                inside.clip_to_roots(near, far);
            }
            Self::Box { half } => {
                inside.clip_to_slab(o.x, d.x, half.x, 0);
                inside.clip_to_slab(o.y, d.y, half.y, 1);
                inside.clip_to_slab(o.z, d.z, half.z, 2);
            }
            Self::Frustum { middle_radius, slope, half_height } => {
                inside.clip_to_slab(o.y, d.y, half_height, 1);
                if slope == 0.0 && d.x == 0.0 && d.z == 0.0 {
                    if o.x.hypot(o.z) > middle_radius {
                        inside.enter.0 = f64::INFINITY;
                    }
                    return inside;
                }
                let [near, far] = self.curved_roots(ray);
                self.clip_to_nappe(&mut inside, ray, near, far, slope, middle_radius);
            }
        }
        inside
    }

    /// A cone's line may be inside between its roots, or (steeper than the cone) beyond one of them.
    fn clip_to_nappe(
        &self,
        inside: &mut Interval,
        ray: &Ray,
        near: f64,
        far: f64,
        slope: f64,
        middle_radius: f64,
    ) {
        let d = ray.direction;
        let a = d.x * d.x + d.z * d.z - slope * slope * d.y * d.y;
        if slope == 0.0 || a > 0.0 {
            inside.clip_to_roots(near, far);
            return;
        }
        if near.is_nan() && far.is_nan() {
            inside.enter.0 = f64::INFINITY;
            return;
        }
        // Steeper than the cone: the line goes in at one point of the nappe and stays in, towards
        // the side where the nappe widens. The other root lies on the mirror nappe.
        let on_nappe = |t: f64| middle_radius + slope * (ray.origin.y + t * d.y) >= 0.0;
        let widens = slope * d.y > 0.0;
        let t = if near.is_finite() && on_nappe(near) { near } else { far };
        if widens {
            if t > inside.enter.0 {
                inside.enter = (t, CURVED);
            }
        } else if t < inside.leave.0 {
            inside.leave = (t, CURVED);
        }
    }

    /// Where the line meets the curved face; NaN where it does not.
    #[inline(always)]
    fn curved_root<T: Real>(&self, ray: &Ray<T>, crossing: Crossing) -> T {
        match (self.meetings(ray), crossing) {
            (Meetings::Chord { middle, half }, Crossing::Enter) => middle - half,
            (Meetings::Chord { middle, half }, Crossing::Leave) => middle + half,
            (Meetings::Quadratic { middle, terms: [a, b, c] }, crossing) => {
                middle + quadratic_root(a, b, c, crossing)
            }
            (Meetings::None, _) => T::constant(f64::NAN),
        }
    }

    /// Both meetings of the line with the curved face, the first one first; NaN where there are none.
    fn curved_roots(&self, ray: &Ray) -> [f64; 2] {
        match self.meetings(ray) {
            Meetings::Chord { middle, half } => [middle - half, middle + half],
            Meetings::Quadratic { middle, terms: [a, b, c] } => {
                quadratic_roots(a, b, c).map(|t| middle + t)
            }
            Meetings::None => [f64::NAN; 2],
        }
    }

    #[inline(always)]
    fn meetings<T: Real>(&self, ray: &Ray<T>) -> Meetings<T> {
        let d = ray.direction;
        if let Self::Box { .. } = self {
            return Meetings::None;
        }
        // By way of the closest approach to the middle: from far away the digits that tell a grazing ray's roots apart would cancel.
        let along = ray.origin.dot(d);
        let o = ray.origin - d.scaled(along);
        let middle = -along;
        match *self {
            Self::Sphere { radius } => {
                let half = (T::constant(radius * radius) - o.squared_length()).sqrt();
                Meetings::Chord { middle, half }
            }
            Self::Ellipsoid { radii } => {
                let shrink = |v: Vec3<T>| {
                    Vec3::new(v.x * radii.x.recip(), v.y * radii.y.recip(), v.z * radii.z.recip())
                };
                let (o, d) = (shrink(o), shrink(d));
                Meetings::Quadratic { middle, terms: [d.dot(d), o.dot(d), o.dot(o) - 1.0] }
            }
            Self::Frustum { middle_radius, slope, .. } => {
                let radius = o.y * slope + middle_radius;
                let change = d.y * slope;
                let terms = [
                    d.x * d.x + d.z * d.z - change * change,
                    o.x * d.x + o.z * d.z - radius * change,
                    o.x * o.x + o.z * o.z - radius * radius,
                ];
                Meetings::Quadratic { middle, terms }
            }
            Self::Box { .. } => Meetings::None,
        }
    }

    /// Distance to a known face along a ray and the outward normal there; the face counts as unbounded, so
    /// that the result is the smooth continuation of the path beyond the face's edges.
    #[inline(always)]
    pub fn cross<T: Real>(&self, ray: &Ray<T>, face: u32, crossing: Crossing) -> (T, Vec3<T>) {
        if face != CURVED {
            return self.cross_plane(ray, face);
        }
        let mut t = self.curved_root(ray, crossing);
        if let Self::Frustum { middle_radius, slope, .. } = *self
            && slope != 0.0
        {
            let radius_at =
                |t: T| ((ray.origin.y + ray.direction.y * t) * slope + middle_radius).value();
            if !(radius_at(t) >= 0.0) {
                let other = match crossing {
                    Crossing::Enter => Crossing::Leave,
                    Crossing::Leave => Crossing::Enter,
                };
                t = self.curved_root(ray, other);
            }
        }
        let p = ray.at(t);
        let normal = match *self {
            Self::Sphere { radius } => p * radius.recip(),
            Self::Ellipsoid { radii } => {
                Vec3::new(p.x * radii.x.powi(-2), p.y * radii.y.powi(-2), p.z * radii.z.powi(-2))
                    .normalized()
            }
            Self::Frustum { middle_radius, slope, .. } => {
                if slope == 0.0 {
                    Vec3::new(p.x, T::constant(0.0), p.z) * middle_radius.recip()
                } else {
                    Vec3::new(p.x, (p.y * slope + middle_radius) * -slope, p.z).normalized()
                }
            }
            Self::Box { .. } => unreachable!("a box has no curved face"),
        };
        (t, normal)
    }

    #[inline(always)]
    fn cross_plane<T: Real>(&self, ray: &Ray<T>, face: u32) -> (T, Vec3<T>) {
        let axis = (face - 1) / 2;
        let sign = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
        let half = match *self {
            Self::Box { half } => half,
            Self::Frustum { half_height, .. } => Vec3::new(half_height, half_height, half_height),
            Self::Sphere { .. } | Self::Ellipsoid { .. } => {
                unreachable!("a ball has no plane face")
            }
        };
        let (o, d) = (ray.origin, ray.direction);
        let (along, speed, half, normal) = match axis {
            0 => (o.x, d.x, half.x, Vec3::new(sign, 0.0, 0.0)),
            1 => (o.y, d.y, half.y, Vec3::new(0.0, sign, 0.0)),
            _ => (o.z, d.z, half.z, Vec3::new(0.0, 0.0, sign)),
        };
        ((T::constant(sign * half) - along) / speed, Vec3::constant(normal))
    }

    /// Whether a point of a face's surface, continued without bounds, lies on the face itself and off its edges.
    #[inline(always)]
    pub fn within_face(&self, point: Vec3, face: u32) -> bool {
        // As far from an edge that no rounding matters: what is nearer counts as off the face.
        const SAFE: f64 = 1.0 - 1e-9;
        let p = point;
        match *self {
            Self::Sphere { .. } | Self::Ellipsoid { .. } => true,
            Self::Box { half } => {
                let axis = (face - 1) / 2;
                let inside = |x: f64, half: f64| x.abs() < SAFE * half;
                ((axis == 0) | inside(p.x, half.x))
                    & ((axis == 1) | inside(p.y, half.y))
                    & ((axis == 2) | inside(p.z, half.z))
            }
            Self::Frustum { middle_radius, slope, half_height } => {
                let radius = middle_radius + slope * p.y;
                if face == CURVED {
                    (p.y.abs() < SAFE * half_height) & ((slope == 0.0) | (radius > 0.0))
                } else {
                    p.x * p.x + p.z * p.z < SAFE * radius * radius
                }
            }
        }
    }

    /// No point is further from the origin, mm.
    pub fn reach(&self) -> f64 {
        match *self {
            Self::Sphere { radius } => radius,
            Self::Ellipsoid { radii } => radii.x.max(radii.y).max(radii.z),
            Self::Box { half } => half.length(),
            Self::Frustum { middle_radius, slope, half_height } => {
                (middle_radius + (slope * half_height).abs()).hypot(half_height)
            }
        }
    }

    /// Volume, mm^3.
    pub fn volume(&self) -> f64 {
        use std::f64::consts::PI;
        match *self {
            Self::Sphere { radius } => 4.0 / 3.0 * PI * radius.powi(3),
            Self::Ellipsoid { radii } => 4.0 / 3.0 * PI * radii.x * radii.y * radii.z,
            Self::Box { half } => 8.0 * half.x * half.y * half.z,
            Self::Frustum { middle_radius, slope, half_height } => {
                let (a, b) =
                    (middle_radius - slope * half_height, middle_radius + slope * half_height);
                PI * 2.0 * half_height * (a * a + a * b + b * b) / 3.0
            }
        }
    }
}

/// What tells where a line meets a curved face.
enum Meetings<T> {
    /// Half a chord before and behind its middle.
    Chord { middle: T, half: T },
    /// Roots of a t^2 + 2 b t + c = 0, t from the line's closest approach on.
    Quadratic { middle: T, terms: [T; 3] },
    /// Nowhere.
    None,
}

/// The root of a t^2 + 2 b t + c = 0 that comes first or second along the line, without cancellation
/// (Press et al., Numerical Recipes, 5.6); NaN where there is none.
#[inline(always)]
pub(super) fn quadratic_root<T: Real>(a: T, b: T, c: T, crossing: Crossing) -> T {
    let (q, q_over_a_is_later) = quadratic_parts(a, b, c);
    // What is chosen is what to divide: no branch, and one division.
    let by_a = q_over_a_is_later == (crossing == Crossing::Leave);
    let above = if by_a { q } else { c };
    let below = if by_a { a } else { q };
    above / below
}

/// Both roots of a t^2 + 2 b t + c = 0, the first along the line first: see [`quadratic_root`].
pub(super) fn quadratic_roots<T: Real>(a: T, b: T, c: T) -> [T; 2] {
    let (q, q_over_a_is_later) = quadratic_parts(a, b, c);
    if q_over_a_is_later { [c / q, q / a] } else { [q / a, c / q] }
}

/// The roots are q / a and c / q. For a > 0, q / a is the later one where b <= 0.
#[inline(always)]
fn quadratic_parts<T: Real>(a: T, b: T, c: T) -> (T, bool) {
    let root = (b * b - a * c).sqrt();
    let q = if b.value() > 0.0 { -(b + root) } else { root - b };
    (q, (b.value() <= 0.0) == (a.value() > 0.0))
}
