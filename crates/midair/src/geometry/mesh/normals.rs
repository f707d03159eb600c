//! Normals at the corners of triangles: what a mesh says of the surface that it samples.
//!
//! Two faces whose normals differ by less than the crease angle sample one smooth surface, others meet in a sharp edge. Around a vertex, the faces
//! between two sharp edges are a *fan*; they share one normal there. How it is found follows from what triangles sample:
//! - the mean of the faces' normals, weighted by their angles (Thürmer and Wüthrich 1998), is right where faces lie all around;
//! - flat or ruled parts run into roundings: beside a region many times larger, small ones do not count;
//! - at a rim the faces lie on one side, and their mean leans inward. The normals at the two ends of an arc are mirror images of each other in the
//!   plane that halves its chord: so the rim's normal is the image of its inner neighbour's. This is exact on spheres, cylinders and cones;
//! - the tip of a cone has no normal: it gets one of length 0, which has no say between the others;
//! - on a cone the normal is the same along each straight line to the tip. Between corners of a triangle it is so if the normals there are as long as the
//!   lines from the tip, for the sum of such normals turns as the sum of the corners does.

mod rulings;
mod shading;

use super::TriangleMesh;
use super::adjacency::{NONE, Sets, neighbours};
use super::read::NO_NORMAL;
use crate::geometry::Vec3;
pub use shading::Shading;

/// A vertex further than this share of the mesh's extent from the plane of the triangle beyond an edge is out of that plane: single precision resolves 6e-8.
const COPLANAR: f64 = 3e-7;
/// Regions smaller than this share of the largest around a vertex do not count there.
const SMALL: f64 = 1.0 / 16.0;
/// The file's normals are those of flat faces if none is further from its face's than this, degrees: files have them to four digits.
const FLAT: f64 = 0.5;
/// Unit normals nearer to each other than this are one.
const ONE: f64 = 1e-5;
/// A fan that turns by less than this is flat, radians.
const LEVEL: f64 = 1e-4;

/// A triangle's unit normal; NaN for one of no area.
fn face_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a).normalized()
}

/// The angle between two unit vectors, radians.
fn between(a: Vec3, b: Vec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// The angle of a triangle at its corner `k`, radians.
fn corner_angle(p: &[Vec3; 3], k: usize) -> f64 {
    let [a, b] = [p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]];
    a.cross(b).length().atan2(a.dot(b))
}

impl TriangleMesh {
    /// The mesh with unit normals at its vertices, smooth over every edge: the mean of the adjacent faces' normals weighted
    /// by the angle that each face has at the vertex (Thürmer and Wüthrich 1998). Takes effect after
    /// duplicate vertices are merged; a vertex whose faces cancel gets one face's own normal.
    pub fn with_smooth_normals(mut self) -> Self {
        let at_vertices = self.smooth_normals();
        self.normals =
            Some(self.triangles.iter().map(|t| t.map(|v| at_vertices[v as usize])).collect());
        self
    }

    /// The normals of [`Self::with_smooth_normals`], one per vertex.
    pub fn smooth_normals(&self) -> Vec<Vec3> {
        let mut sums = vec![Vec3::ZERO; self.positions.len()];
        let mut fallback = sums.clone();
        for t in 0..self.triangles.len() {
            let p = self.corners(t);
            let normal = face_normal(p);
            if !normal.is_finite() {
                continue;
            }
            for (k, &v) in self.triangles[t].iter().enumerate() {
                sums[v as usize] = sums[v as usize] + normal * corner_angle(&p, k);
                fallback[v as usize] = normal;
            }
        }
        sums.iter()
            .zip(&fallback)
            .map(|(&sum, &face)| {
                // Angles add up to order 1: what is left below this is rounding.
                if sum.length() > 1e-9 {
                    sum.normalized()
                } else if face.length() > 0.5 {
                    face
                } else {
                    Vec3::new(0.0, 0.0, 1.0)
                }
            })
            .collect()
    }

    /// The mesh with the normals that its file gives, where they fit its faces, and elsewhere with smooth ones over edges of less than
    /// `crease_angle` degrees and sharp edges above.
    ///
    /// A normal fits a face if it is not further from the face's own than half the crease angle: between two faces of one smooth surface it cannot be.
    pub fn with_creased_normals(mut self, crease_angle: f64) -> (Self, Shading) {
        let crease = crease_angle.to_radians();
        let (normals, mut shading) = {
            let mut creased = Creased::new(&self, crease);
            let given = creased.given();
            (creased.normals(&given), creased.shading)
        };
        shading.corners = 3 * self.triangles.len();
        self.normals = Some(normals);
        self.follow_rulings();
        (self, shading)
    }
}

/// A fan's faces, gathered.
#[derive(Clone, Copy)]
struct Fan {
    /// Weighted by angles, of the regions that are not small.
    sum: Vec3,
    /// Area of the largest region.
    largest: f64,
    /// Whether it has an edge beyond which there is another fan or nothing.
    ends: bool,
    /// Whether all of its corners have a normal of the file that fits.
    given: bool,
    /// The largest angle between a face and the fan's normal.
    turn: f64,
    /// The largest angle across an edge opposite the vertex that is not sharp.
    beyond: f64,
    /// The least and the largest angle across an edge from the vertex.
    around: [f64; 2],
}

impl Fan {
    /// Whether the vertex is a cone's tip: its faces turn about an axis and go straight on away from it. A round summit turns on; a ridge
    /// turns at two of its edges only.
    fn is_tip(&self, crease: f64) -> bool {
        let cone = self.beyond < 0.1 * self.turn && self.around[0] > 0.1 * self.around[1];
        !self.given && !self.ends && self.turn > LEVEL && (self.turn > crease || cone)
    }
}

struct Creased<'a> {
    mesh: &'a TriangleMesh,
    crease: f64,
    faces: Vec<Vec3>,
    neighbours: Vec<[u32; 3]>,
    /// Whether the edge opposite a corner is smooth.
    smooth: Vec<[bool; 3]>,
    /// The fan of each corner: triangle times three and the corner.
    fans: Sets,
    /// Area of the flat region that each triangle is a part of.
    areas: Vec<f64>,
    shading: Shading,
}

impl<'a> Creased<'a> {
    fn new(mesh: &'a TriangleMesh, crease: f64) -> Self {
        let count = mesh.triangles.len();
        let faces: Vec<Vec3> = (0..count).map(|t| face_normal(mesh.corners(t))).collect();
        let neighbours = neighbours(&mesh.triangles);
        let [low, high] = mesh.bounds();
        let level = COPLANAR * (high - low).length();
        let mut fans = Sets::new(3 * count);
        let mut regions = Sets::new(count);
        let mut shading = Shading::default();
        let mut smooth = vec![[false; 3]; count];
        for t in 0..count {
            for k in 0..3 {
                let other = neighbours[t][k] as usize;
                if other == NONE as usize {
                    continue;
                }
                let sharp = between(faces[t], faces[other]) > crease;
                smooth[t][k] = !sharp;
                if t > other {
                    continue;
                }
                shading.sharp_edges += usize::from(sharp);
                if sharp {
                    continue;
                }
                for end in [(k + 1) % 3, (k + 2) % 3] {
                    let v = mesh.triangles[t][end];
                    if let Some(there) = mesh.triangles[other].iter().position(|&w| w == v) {
                        fans.join((3 * t + end) as u32, (3 * other + there) as u32);
                    }
                }
                let off = |from: usize, of: usize| {
                    let origin = mesh.corners(from)[0];
                    let far = mesh.corners(of).map(|p| (p - origin).dot(faces[from]).abs());
                    far.into_iter().fold(0.0, f64::max)
                };
                if off(t, other).max(off(other, t)) <= level {
                    regions.join(t as u32, other as u32);
                }
            }
        }
        let mut areas = vec![0.0; count];
        for t in 0..count {
            let [a, b, c] = mesh.corners(t);
            areas[regions.of(t as u32) as usize] += (b - a).cross(c - a).length();
        }
        let areas = (0..count).map(|t| areas[regions.of(t as u32) as usize]).collect();
        Self { mesh, crease, faces, neighbours, smooth, fans, areas, shading }
    }

    /// The file's normals at each corner as unit vectors on the face's side; NaN where it has none, or none that fits.
    fn given(&mut self) -> Vec<[Vec3; 3]> {
        let given = &self.mesh.given_normals;
        if given.len() != self.faces.len() {
            return Vec::new();
        }
        let outward = |n: Vec3, face: Vec3| {
            let n = n.normalized();
            if n.dot(face) < 0.0 { -n } else { n }
        };
        let turned: Vec<[Vec3; 3]> = given
            .iter()
            .zip(&self.faces)
            .map(|(corners, &face)| corners.map(|n| outward(n, face)))
            .collect();
        let corners = || turned.iter().zip(&self.faces).flat_map(|(n, f)| n.map(|n| (n, *f)));
        let known = || corners().filter(|(n, _)| n.is_finite());
        self.shading.flat =
            known().next().is_some() && known().all(|(n, f)| between(n, f) < FLAT.to_radians());
        if self.shading.flat {
            return Vec::new();
        }
        let fits = |n: Vec3, f: Vec3| n.is_finite() && between(n, f) <= 0.5 * self.crease;
        self.shading.unfit = known().filter(|(n, f)| !fits(*n, *f)).count();
        turned
            .into_iter()
            .zip(&self.faces)
            .map(|(n, &f)| n.map(|n| if fits(n, f) { n } else { NO_NORMAL }))
            .collect()
    }

    /// The corner's fan.
    fn fan(&mut self, t: usize, k: usize) -> usize {
        self.fans.of((3 * t + k) as u32) as usize
    }

    fn normals(&mut self, given: &[[Vec3; 3]]) -> Vec<[Vec3; 3]> {
        let fans = self.gathered(given);
        let count = self.faces.len();
        let mean = |fan: &Fan, face: Vec3| {
            if fan.sum.length() > 1e-9 { fan.sum.normalized() } else { face }
        };
        let rims = self.rims(&fans);
        let mut tips: Vec<bool> = fans.iter().map(|fan| fan.is_tip(self.crease)).collect();
        for t in 0..count {
            let own = [0, 1, 2].map(|k| self.fan(t, k));
            // Between two tips nothing goes straight on.
            if own.iter().filter(|&&fan| tips[fan]).count() > 1 {
                own.iter().for_each(|&fan| tips[fan] = false);
            }
        }
        let mut normals = Vec::with_capacity(count);
        for t in 0..count {
            let own = [0, 1, 2].map(|k| self.fan(t, k));
            let face = self.faces[t];
            normals.push([0, 1, 2].map(|k| {
                let fan = &fans[own[k]];
                if fan.given {
                    self.shading.given += 1;
                    given[t][k]
                } else if tips[own[k]] {
                    Vec3::ZERO
                } else {
                    rims.get(&own[k]).copied().unwrap_or_else(|| mean(fan, face))
                }
            }));
        }
        normals
    }

    fn gathered(&mut self, given: &[[Vec3; 3]]) -> Vec<Fan> {
        let count = self.faces.len();
        let empty = Fan {
            sum: Vec3::ZERO,
            largest: 0.0,
            ends: false,
            given: !given.is_empty(),
            turn: 0.0,
            beyond: 0.0,
            around: [f64::INFINITY, 0.0],
        };
        let mut fans = vec![empty; 3 * count];
        for t in 0..count {
            for k in 0..3 {
                let of = self.fan(t, k);
                let fan = &mut fans[of];
                fan.largest = fan.largest.max(self.areas[t]);
                fan.ends |= !self.smooth[t][(k + 1) % 3] || !self.smooth[t][(k + 2) % 3];
                fan.given &= given.get(t).is_some_and(|n| n[k].is_finite());
                let across = |k: usize| {
                    let beyond = self.faces.get(self.neighbours[t][k] as usize);
                    beyond.map_or(0.0, |&beyond| between(self.faces[t], beyond))
                };
                if self.smooth[t][k] {
                    fan.beyond = fan.beyond.max(across(k));
                }
                for side in [across((k + 1) % 3), across((k + 2) % 3)] {
                    fan.around = [fan.around[0].min(side), fan.around[1].max(side)];
                }
            }
        }
        for t in 0..count {
            let p = self.mesh.corners(t);
            for k in 0..3 {
                let of = self.fan(t, k);
                if self.areas[t] >= SMALL * fans[of].largest && self.faces[t].is_finite() {
                    fans[of].sum = fans[of].sum + self.faces[t] * corner_angle(&p, k);
                }
            }
        }
        for t in 0..count {
            for k in 0..3 {
                let of = self.fan(t, k);
                let turn = between(self.faces[t], fans[of].sum.normalized());
                // NaN, where faces cancel, counts as no tip: `max` leaves it out.
                fans[of].turn = fans[of].turn.max(turn);
            }
        }
        fans
    }

    /// The normals of fans that end, from inner neighbours: of these the one whose edge stands most upright on the rim.
    fn rims(&mut self, fans: &[Fan]) -> std::collections::HashMap<usize, Vec3> {
        let count = self.faces.len();
        // The two ends of each fan's rim.
        let mut rims: std::collections::HashMap<usize, Vec3> = std::collections::HashMap::new();
        for t in 0..count {
            let smooth = self.smooth[t];
            for k in (0..3).filter(|&k| !smooth[k]) {
                let [from, to] = [(k + 1) % 3, (k + 2) % 3];
                let p = self.mesh.corners(t);
                for end in [from, to] {
                    let along = rims.entry(self.fan(t, end)).or_insert(Vec3::ZERO);
                    *along = *along + (p[to] - p[from]).normalized();
                }
            }
        }
        let mut best: std::collections::HashMap<usize, (f64, Vec3)> =
            std::collections::HashMap::new();
        for t in 0..count {
            let p = self.mesh.corners(t);
            for (k, inner) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
                let (of, from) = (self.fan(t, k), self.fan(t, inner));
                let (Some(along), false) = (rims.get(&of), fans[from].ends) else { continue };
                let (rim, inside) = (&fans[of], &fans[from]);
                if rim.given || inside.given || inside.is_tip(self.crease) {
                    continue;
                }
                let chord = p[k] - p[inner];
                let slant = chord.normalized().dot(along.normalized()).abs();
                let normal = inside.sum.normalized();
                let image = normal - chord * (2.0 * normal.dot(chord) / chord.squared_length());
                // Beyond this the surface is no arc between the two.
                let near = between(image, rim.sum.normalized()) <= 0.5 * self.crease;
                if near && best.get(&of).is_none_or(|(least, _)| slant < *least) {
                    best.insert(of, (slant, image));
                }
            }
        }
        best.into_iter().map(|(fan, (_, normal))| (fan, normal)).collect()
    }
}
