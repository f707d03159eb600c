//! A triangle mesh as rays meet it.

mod triangle;

use super::mesh::TriangleMesh;
use super::mesh::adjacency::{NONE, Sets, neighbours};
use super::mesh::overlap::TOUCHING;
use super::{Crossing, Fold, Hit, Ray, Real, Search, Vec3};
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh};
use obvhs::ploc::PlocBuilder;
use obvhs::{Boundable, BvhBuildParams};
use triangle::{Sheared, Triangle};

/// A triangle mesh with what tracing needs: planes, barycentric gradients, neighbours, and a BVH.
#[derive(Clone)]
pub struct MeshSurface {
    triangles: Vec<Triangle>,
    /// Unit normals of each triangle's corners; empty for flat ones.
    normals: Vec<[Vec3; 3]>,
    /// The triangle across the edge opposite each corner; `NONE` where there is none.
    neighbours: Vec<[u32; 3]>,
    /// The part that each triangle belongs to: triangles over whose common edges the normal does not jump.
    parts: Vec<Part>,
    /// The body that each triangle bounds; empty where no bodies overlap and none crosses itself.
    bodies: Vec<u32>,
    bvh: CwBvh,
    low: Vec3,
    high: Vec3,
    closed: bool,
    volume: f64,
    /// Surfaces of two bodies that a ray meets within this distance, mm, are met at once: they touch.
    at_once: f64,
}

impl std::fmt::Debug for MeshSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "MeshSurface({} triangles)", self.triangles.len())
    }
}

/// A part of the surface with no sharp edge within.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Its number: that of one of its triangles.
    pub number: u32,
    /// Whether it is bent; a flat one is crossed alike by all of its triangles.
    pub is_bent: bool,
}

/// Normals that differ by less, radians, are one: files have them to six digits, and flat faces in single precision are not flatter.
const ONE_NORMAL: f64 = 1e-5;

/// Boxes of the BVH are widened by this share of the mesh's size: many times the rounding of the `f32`
/// arithmetic that they are tested with, so that no triangle is missed for it; triangles themselves are tested in `f64`.
const WIDENED: f64 = 1e-5;

/// The BVH's traversal leaves out boxes that end nearer than 1e-4 to its start, mm: it starts this much earlier.
const SET_BACK: f64 = 1e-3;

/// A walk from one triangle to the next that is longer than this is given up for a search.
const LONGEST_WALK: usize = 24;

struct Bounds(Aabb);

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// The BVH over boxes, built of obvhs' parts: its own `build_cwbvh` reads a clock, which traps where a target has none.
fn build_bvh(bounds: &[Bounds]) -> CwBvh {
    let how = BvhBuildParams::medium_build();
    let mut bvh = PlocBuilder::with_capacity(bounds.len()).build(
        how.ploc_search_distance,
        bounds,
        (0..bounds.len() as u32).collect(),
        how.sort_precision,
        how.search_depth_threshold,
    );
    ReinsertionOptimizer::default().run(&mut bvh, how.reinsertion_batch_ratio, None);
    // A node of the compressed form has room for three.
    let leaf = how.max_prims_per_leaf.clamp(1, 3);
    bvh2_to_cwbvh(&bvh, leaf, true, false)
}

impl MeshSurface {
    /// From a mesh in mm, checked and mended, with normals at its vertices for smooth shading. It has no degenerate
    /// triangle and every index is in range.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let [low, high] = mesh.bounds();
        let triangles = &mesh.triangles;
        let widen = WIDENED * (high - low).length();
        let at = |index: u32| mesh.positions[index as usize];
        let bounds: Vec<Bounds> = triangles
            .iter()
            .map(|t| {
                let mut aabb = Aabb::empty();
                for p in t.map(at) {
                    for sign in [-1.0, 1.0] {
                        let [x, y, z] = [p.x, p.y, p.z].map(|c| (c + sign * widen) as f32);
                        aabb.extend([x, y, z].into());
                    }
                }
                Bounds(aabb)
            })
            .collect();
        let bvh = build_bvh(&bounds);
        let neighbours = neighbours(triangles);
        let closed = neighbours.iter().flatten().all(|&other| other != NONE);
        let triangles: Vec<Triangle> = triangles.iter().map(|t| Triangle::new(t.map(at))).collect();
        let normals = mesh.normals.clone().unwrap_or_default();
        Self {
            parts: parts(&mesh.triangles, &triangles, &normals, &neighbours),
            bodies: mesh.bodies.clone().unwrap_or_default(),
            triangles,
            normals,
            neighbours,
            bvh,
            low,
            high,
            closed,
            volume: mesh.signed_volume().abs(),
            at_once: TOUCHING * (high - low).length(),
        }
    }

    /// Least and largest x, y and z, mm.
    pub fn bounds(&self) -> [Vec3; 2] {
        [self.low, self.high]
    }

    /// Its edges, each once: between two faces, or at a rim.
    pub fn folds(&self) -> Vec<Fold> {
        let mut folds = Vec::new();
        for (index, (triangle, neighbours)) in
            self.triangles.iter().zip(&self.neighbours).enumerate()
        {
            for (opposite, &other) in neighbours.iter().enumerate() {
                let ends = [1, 2].map(|k| triangle.corners[(opposite + k) % 3]);
                if other == NONE {
                    folds.push(Fold { ends, normals: [triangle.normal, -triangle.normal] });
                } else if other as usize > index {
                    let normals = [triangle.normal, self.triangles[other as usize].normal];
                    folds.push(Fold { ends, normals });
                }
            }
        }
        folds
    }

    /// Whether it encloses a volume.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Whether it has a bent part: normals are interpolated there, so that light crosses from face to face without a jump.
    pub fn is_bent(&self) -> bool {
        self.parts.iter().any(|part| part.is_bent)
    }

    /// The part that a face belongs to.
    pub fn part(&self, face: u32) -> Part {
        self.parts[face as usize]
    }

    /// Volume, mm^3.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// The first triangle along a ray that fits the search.
    pub fn nearest(&self, ray: &Ray, search: Search) -> Option<Hit> {
        if let (false, Some(wanted)) = (self.bodies.is_empty(), search.crossing) {
            return self.nearest_of_union(ray, search, wanted);
        }
        let start = self.entry(ray)?.max(search.after) - SET_BACK;
        // f32 traversal starts where the mesh does: far-away origins would lose the digits that boxes need.
        let near = ray.at(start);
        let sheared = Sheared::new(ray);
        let mut best: Option<Hit> = None;
        let traversed = obvhs::ray::Ray::new(
            narrow(near).into(),
            narrow(ray.direction).into(),
            0.0,
            f32::INFINITY,
        );
        self.bvh.ray_traverse(traversed, &mut obvhs::ray::RayHit::none(), |_, index| {
            let face = self.bvh.primitive_indices[index];
            if search.standing_on == Some(face) {
                return f32::INFINITY;
            }
            let triangle = &self.triangles[face as usize];
            let crossing = triangle.crossing(ray.direction);
            if search.crossing.is_some_and(|wanted| wanted != crossing) {
                return f32::INFINITY;
            }
            let Some(t) = sheared.hit(triangle) else { return f32::INFINITY };
            if t > search.after && best.is_none_or(|b| t < b.t) {
                best = Some(Hit { t, face, crossing });
            }
            // Rounded up, so that a hit nearer by less than f32 tells is still looked at.
            best.map_or(f32::INFINITY, |b| ((b.t - start) as f32).next_up())
        });
        best
    }

    /// The first crossing of the surface of all bodies' union: where, going on, the number of bodies around changes from or to none. A body whose
    /// surface crosses itself is around as often as the surface winds.
    ///
    /// That number is counted from the far end, where it is 0: it does not depend on where the ray begins.
    fn nearest_of_union(&self, ray: &Ray, search: Search, wanted: Crossing) -> Option<Hit> {
        let mut hits = self.all(ray, search);
        // Of an edge both triangles are hit; their body is crossed once. Two faces of a body may also lie upon one another, and then both count.
        let body = |hit: &Hit| self.bodies[hit.face as usize];
        hits.sort_by(|(a, _), (b, _)| a.t.total_cmp(&b.t).then(body(a).cmp(&body(b))));
        hits.dedup_by(|(next, on_edge), (kept, at_edge)| {
            let same = body(next) == body(kept) && next.crossing == kept.crossing;
            same && *on_edge && *at_edge && next.t - kept.t <= 1e-9
        });
        let mut first = None;
        let mut around = 0i32;
        let mut later: Option<f64> = None;
        for end in (1..=hits.len()).rev() {
            let (hit, _) = hits[end - 1];
            let beyond = around;
            around += if hit.crossing == Crossing::Leave { 1 } else { -1 };
            let outside = if wanted == Crossing::Leave { beyond } else { around };
            if hit.crossing == wanted && outside == 0 {
                // Where one body is left and another entered at once, the union goes on.
                let touches =
                    wanted == Crossing::Leave && later.is_some_and(|t| t - hit.t <= self.at_once);
                if !touches {
                    first = Some(hit);
                }
            }
            later = (hit.crossing == Crossing::Enter).then_some(hit.t);
        }
        first
    }

    /// Whether the line from `from` to `to` goes through a face that `counts`, from one side of it to the other: both ends are further than `margin` from
    /// its plane.
    pub(in crate::geometry) fn is_pierced(
        &self,
        [from, to]: [Vec3; 2],
        margin: f64,
        counts: impl Fn(u32) -> bool,
    ) -> bool {
        let length = (to - from).length();
        let ray = Ray { origin: from, direction: (to - from) * (1.0 / length) };
        let sheared = Sheared::new(&ray);
        let traversed = obvhs::ray::Ray::new(
            narrow(ray.at(-SET_BACK)).into(),
            narrow(ray.direction).into(),
            0.0,
            ((length + 2.0 * SET_BACK) as f32).next_up(),
        );
        let mut pierced = false;
        self.bvh.ray_traverse(traversed, &mut obvhs::ray::RayHit::none(), |_, index| {
            let face = self.bvh.primitive_indices[index];
            let triangle = &self.triangles[face as usize];
            let [a, b] = [from, to].map(|p| (p - triangle.corners[0]).dot(triangle.normal));
            let parted = a.min(b) < -margin && a.max(b) > margin;
            pierced |= parted && counts(face) && sheared.hit(triangle).is_some();
            // Nothing beyond counts once it is.
            if pierced { 0.0 } else { f32::INFINITY }
        });
        pierced
    }

    /// All hits that lie ahead, and whether each is on an edge.
    fn all(&self, ray: &Ray, search: Search) -> Vec<(Hit, bool)> {
        let mut hits = Vec::new();
        let Some(entry) = self.entry(ray) else { return hits };
        let near = ray.at(entry.max(search.after) - SET_BACK);
        let sheared = Sheared::new(ray);
        let traversed = obvhs::ray::Ray::new(
            narrow(near).into(),
            narrow(ray.direction).into(),
            0.0,
            f32::INFINITY,
        );
        self.bvh.ray_traverse_anyhit(traversed, |_, index| {
            let face = self.bvh.primitive_indices[index];
            let triangle = &self.triangles[face as usize];
            if search.standing_on != Some(face)
                && let Some((t, on_edge)) =
                    sheared.strike(triangle).filter(|&(t, _)| t > search.after)
            {
                hits.push((Hit { t, face, crossing: triangle.crossing(ray.direction) }, on_edge));
            }
        });
        hits
    }

    /// Where the ray enters the mesh's bounds (not before its own start by more than the coincidence margin).
    fn entry(&self, ray: &Ray) -> Option<f64> {
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        let widen = WIDENED * (self.high - self.low).length();
        let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
        let (low, high) = (self.low.to_array(), self.high.to_array());
        for axis in 0..3 {
            let a = (low[axis] - widen - o[axis]) / d[axis];
            let b = (high[axis] + widen - o[axis]) / d[axis];
            // NaN (a ray within a boundary plane) leaves the bound as it is.
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        (near <= far && far >= -1e-9).then_some(near)
    }

    /// The triangle around which a path that was known to cross `face` crosses now: a walk over the edges of its part. At a sharp edge
    /// it stays on the last triangle, which is continued smoothly. `None` where it walks off the sheet (a silhouette, a hole).
    pub fn settle(&self, ray: &Ray, face: u32, crossing: Crossing) -> Option<u32> {
        let mut face = face;
        for _ in 0..LONGEST_WALK {
            let triangle = &self.triangles[face as usize];
            if triangle.crossing(ray.direction) != crossing {
                return None;
            }
            let weights = triangle.weights(ray.at(triangle.plane_distance(ray)));
            let lowest = (0..3).min_by(|&a, &b| weights[a].total_cmp(&weights[b])).unwrap_or(0);
            // Rounding of barycentric coordinates: on an edge either side is right.
            if weights[lowest] >= -1e-12 {
                return Some(face);
            }
            let next = self.neighbours[face as usize][lowest];
            if next == NONE {
                return None;
            }
            if self.parts[next as usize] != self.parts[face as usize] {
                return Some(face);
            }
            face = next;
        }
        None
    }

    /// Distance to a triangle's plane along a ray and the (interpolated) normal there.
    pub fn cross<T: Real>(&self, ray: &Ray<T>, face: u32) -> (T, Vec3<T>) {
        let triangle = &self.triangles[face as usize];
        let t = triangle.plane_distance(ray);
        let flat = Vec3::constant(triangle.normal);
        let Some([n0, n1, n2]) = self.normals.get(face as usize) else { return (t, flat) };
        let [_, b, c] = triangle.weights(ray.at(t));
        let blend = |n0: f64, n1: f64, n2: f64| b * (n1 - n0) + c * (n2 - n0) + n0;
        let smooth =
            Vec3::new(blend(n0.x, n1.x, n2.x), blend(n0.y, n1.y, n2.y), blend(n0.z, n1.z, n2.z))
                .normalized();
        // At a silhouette the interpolated normal may face the other way than the triangle: light would come from
        // inside. The triangle's own normal is right there.
        let d = ray.direction.value();
        let agree = d.dot(smooth.value()) * d.dot(triangle.normal) > 0.0;
        (t, if agree { smooth } else { flat })
    }
}

fn narrow(v: Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// The part of each triangle.
fn parts(
    indices: &[[u32; 3]],
    triangles: &[Triangle],
    normals: &[[Vec3; 3]],
    neighbours: &[[u32; 3]],
) -> Vec<Part> {
    let at = |t: usize, vertex: u32| {
        let corner = indices[t].iter().position(|&v| v == vertex).unwrap_or(0);
        let normal = normals.get(t).map_or(triangles[t].normal, |n| n[corner]);
        // A tip has none on either side of an edge.
        if normal == Vec3::ZERO { normal } else { normal.normalized() }
    };
    let one = |a: Vec3, b: Vec3| (a - b).length() <= ONE_NORMAL;
    let mut sets = Sets::new(triangles.len());
    for t in 0..triangles.len() {
        for k in 0..3 {
            let other = neighbours[t][k];
            let ends = [(k + 1) % 3, (k + 2) % 3].map(|k| indices[t][k]);
            if other != NONE && ends.iter().all(|&v| one(at(t, v), at(other as usize, v))) {
                sets.join(t as u32, other);
            }
        }
    }
    let numbers: Vec<u32> = (0..triangles.len() as u32).map(|t| sets.of(t)).collect();
    let mut bent = vec![false; triangles.len()];
    for (t, &number) in numbers.iter().enumerate() {
        let first = triangles[number as usize].normal;
        // Twice: the first triangle itself is only one of those that are one.
        let flat = |n: Vec3| (n - first).length() <= 2.0 * ONE_NORMAL;
        bent[number as usize] |= !indices[t].iter().all(|&v| flat(at(t, v)));
    }
    numbers.iter().map(|&number| Part { number, is_bent: bent[number as usize] }).collect()
}
