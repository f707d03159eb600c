//! Checking a mesh, and mending what can be mended without guessing.
//!
//! Mended and said: vertices at one place are merged, faces that this collapses and repeated faces
//! are dropped, flipped faces are turned. Refused with the face's name: slivers of no area, holes, edges of three
//! and more faces, surfaces that have no two sides.

use super::measure::{bounds, winding_number};
use super::overlap::{crossing_itself, overlapping};
use super::read::NO_NORMAL;
use super::wedges::{self, Face};
use super::{MeshError, RawMesh, TriangleMesh};
use crate::geometry::Vec3;
use std::collections::HashMap;

/// What the mesh has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// The boundary of a solid: watertight, with an inside.
    Closed,
    /// A surface that is only reflected from: it may have borders.
    Open,
}

/// What was mended on a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Mended {
    /// Vertices that stood where another one stands.
    pub merged_vertices: usize,
    /// Vertices that no face uses.
    pub unused_vertices: usize,
    /// Faces with corners at one place, dropped; in the file's numbering.
    pub collapsed_faces: Vec<String>,
    /// Faces with the corners of an earlier one, dropped; in the file's numbering.
    pub repeated_faces: Vec<String>,
    /// Triangles whose winding was turned, in the file's numbering.
    pub flipped_faces: Vec<String>,
    /// Whether that was all of them: the mesh was inside out.
    pub inside_out: bool,
    /// Closed pieces within others, which are taken as hollows.
    pub hollows: usize,
    /// Pairs of closed pieces that overlap or touch, each named by one of its faces.
    pub overlaps: Vec<String>,
    /// A face at which a closed piece's surface crosses itself.
    pub crossing: Option<String>,
}

impl Mended {
    /// One sentence for each thing that was mended; none for a mesh that was fine.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.merged_vertices > 0 {
            notes.push(format!("merged {} duplicate vertices", self.merged_vertices));
        }
        if self.unused_vertices > 0 {
            notes.push(format!("left out {} vertices that no face uses", self.unused_vertices));
        }
        if !self.collapsed_faces.is_empty() {
            notes.push(format!(
                "dropped faces with corners at one place: {}",
                listed(&self.collapsed_faces)
            ));
        }
        if !self.repeated_faces.is_empty() {
            notes.push(format!("dropped repeated faces: {}", listed(&self.repeated_faces)));
        }
        if self.inside_out {
            notes.push("turned every face: the mesh was inside out".to_owned());
        } else if !self.flipped_faces.is_empty() {
            notes
                .push(format!("turned faces wound the wrong way: {}", listed(&self.flipped_faces)));
        }
        if self.hollows > 0 {
            notes.push(format!("took {} closed pieces within others as hollows", self.hollows));
        }
        if !self.overlaps.is_empty() {
            notes.push(format!(
                "took closed pieces that overlap or touch as one solid, their union: {}",
                listed(&self.overlaps)
            ));
        }
        if let Some(face) = &self.crossing {
            notes.push(format!(
                "its surface crosses itself, first at {face}: what it winds around, once or more often, is taken as one solid"
            ));
        }
        notes
    }
}

/// A few names, and how many more.
fn listed(names: &[String]) -> String {
    const SHOWN: usize = 5;
    let shown = names.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// Vertices nearer than this fraction of the mesh's diagonal are one vertex, and triangles thinner
/// than it have no area: far below the 6e-8 that single-precision files resolve, far above the
/// rounding of double-precision ones.
const TOLERANCE: f64 = 1e-9;
/// More closed pieces than this are not held against each other for hollows.
const MOST_PIECES: usize = 2000;

/// Checks and mends a mesh; `file` names it in messages.
///
/// Each connected piece is wound consistently, and outward by its volume. A closed piece within
/// an odd number of others is a hollow: wound inward. Pieces that overlap stay outward and are one solid, their union, and so is one whose surface
/// crosses itself: see [`TriangleMesh::bodies`].
///
/// # Errors
/// Slivers of no area; for a closed surface also holes, edges that more than two faces share, and
/// pieces with one side only or without volume. The message names the face.
pub fn mend(
    raw: RawMesh,
    file: &str,
    surface: Surface,
) -> Result<(TriangleMesh, Mended), MeshError> {
    let mut mended = Mended::default();
    let [low, high] = bounds(raw.positions.iter().copied().filter(|p| p.is_finite()));
    let tolerance = (high - low).length() * TOLERANCE;
    let representative = merge(&raw.positions, tolerance);

    let Kept { mut triangles, mut origin, collapsed, mut repeated, opposite } =
        Kept::of(&raw, &representative, false);
    if triangles.is_empty() {
        return Err(MeshError::new(
            file,
            format!("all faces have no area, the first is {}", raw.face_name(0)),
            "check the file's coordinates",
        ));
    }
    slivers(&raw.positions, &triangles, tolerance, file, &|t| raw.face_name(origin[t]))?;
    let joined = |triangles: &[[u32; 3]], origin: &[usize]| {
        neighbours(&raw.positions, triangles, file, surface, &|t| raw.face_name(origin[t]))
    };
    let joined_as_kept = joined(&triangles, &origin);
    let (neighbours, parted) = match joined_as_kept {
        // Two faces upon one another and wound against each other may be the wall between two solids that touch.
        Err(error) if opposite => {
            let walls = Kept::of(&raw, &representative, true);
            let opened = joined(&walls.triangles, &walls.origin).map_err(|_| error)?;
            (triangles, origin, repeated) = (walls.triangles, walls.origin, walls.repeated);
            opened
        }
        found => found?,
    };
    mended.collapsed_faces = collapsed.iter().map(|&i| raw.face_name(i)).collect();
    mended.repeated_faces = repeated.iter().map(|&i| raw.face_name(i)).collect();
    let name = |t: usize| raw.face_name(origin[t]);
    let pieces = pieces(&triangles, &neighbours, file, surface, &name)?;
    let turned = orient(&raw.positions, &triangles, &neighbours, &pieces, file, &name)?;
    mended.hollows = turned.hollows;
    for (t, triangle) in triangles.iter_mut().enumerate() {
        if turned.flip[t] {
            triangle.swap(1, 2);
            mended.flipped_faces.push(name(t));
        }
    }
    mended.inside_out = mended.flipped_faces.len() == triangles.len();
    let mut positions = std::borrow::Cow::Borrowed(&raw.positions);
    let added = match parted {
        true => wedges::part(positions.to_mut(), &mut triangles, |t, k| {
            // Turned triangles have their last two corners exchanged.
            let k = if turned.flip[t] { 2 - k } else { k };
            neighbours[t][k].map(|(other, _)| other as usize)
        }),
        false => 0,
    };
    let (mut mesh, used) = compacted(&positions, triangles);
    if !raw.normals.is_empty() {
        let given = |t: usize| {
            let [a, b, c] = raw.normals.get(origin[t]).copied().unwrap_or([NO_NORMAL; 3]);
            if turned.flip[t] { [a, c, b] } else { [a, b, c] }
        };
        mesh.given_normals = (0..mesh.triangles.len()).map(given).collect();
    }
    if surface == Surface::Closed {
        let mut bodies = vec![0; mesh.triangles.len()];
        for (body, range) in (0u32..).zip(pieces.starts.windows(2)) {
            pieces.order[range[0]..range[1]].iter().for_each(|&t| bodies[t as usize] = body);
        }
        let first = |body: u32| name(pieces.order[pieces.starts[body as usize]] as usize);
        let overlaps = overlapping(&mesh, &bodies);
        let told = |&[a, b]: &[u32; 2]| format!("that of {} and that of {}", first(a), first(b));
        mended.overlaps = overlaps.iter().map(told).collect();
        mended.crossing = crossing_itself(&mesh, &bodies).map(name);
        let several = !overlaps.is_empty() || mended.crossing.is_some();
        mesh.bodies = several.then_some(bodies);
    }
    let merged = representative.iter().enumerate().filter(|&(v, &r)| v != r as usize).count();
    mended.merged_vertices = merged;
    mended.unused_vertices = raw.positions.len() + added - merged - used;
    Ok((mesh, mended))
}

/// The triangles that make up the surface.
struct Kept {
    triangles: Vec<[u32; 3]>,
    /// For each its place in the file's own list.
    origin: Vec<usize>,
    /// Places of triangles with corners at one place.
    collapsed: Vec<usize>,
    /// Places of triangles with the corners of an earlier one.
    repeated: Vec<usize>,
    /// Whether one of these is wound against the earlier one.
    opposite: bool,
}

impl Kept {
    /// `walls`: two triangles upon one another that are wound against each other both go.
    fn of(raw: &RawMesh, representative: &[u32], walls: bool) -> Self {
        let count = raw.triangles.len();
        let (mut triangles, mut origin) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let (mut collapsed, mut repeated, mut opposite) = (Vec::new(), Vec::new(), false);
        // The sense and the place of the triangle that is kept, by its corners.
        let mut seen: HashMap<[u32; 3], (bool, usize)> = HashMap::with_capacity(count);
        let mut gone = std::collections::HashSet::new();
        for (i, triangle) in raw.triangles.iter().enumerate() {
            let t = triangle.map(|v| representative[v as usize]);
            if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
                collapsed.push(i);
                continue;
            }
            let mut sorted = t;
            sorted.sort_unstable();
            let least = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
            let sense = t[(least + 1) % 3] < t[(least + 2) % 3];
            if let Some(&(earlier, place)) = seen.get(&sorted) {
                repeated.push(i);
                opposite |= earlier != sense;
                if walls && earlier != sense {
                    seen.remove(&sorted);
                    gone.insert(place);
                }
                continue;
            }
            seen.insert(sorted, (sense, triangles.len()));
            triangles.push(t);
            origin.push(i);
        }
        let stays = |k: &usize| !gone.contains(k);
        repeated.extend(gone.iter().map(|&k| origin[k]));
        repeated.sort_unstable();
        let kept: Vec<usize> = (0..triangles.len()).filter(stays).collect();
        Self {
            triangles: kept.iter().map(|&k| triangles[k]).collect(),
            origin: kept.iter().map(|&k| origin[k]).collect(),
            collapsed,
            repeated,
            opposite,
        }
    }
}

/// For each vertex the first one that stands within `tolerance` of it.
///
/// Vertices are sorted into cells of four tolerances, so a vertex's neighbourhood touches at most
/// eight, and a cell holds few distinct ones however they are crowded.
fn merge(positions: &[Vec3], tolerance: f64) -> Vec<u32> {
    let cell = if tolerance > 0.0 { 4.0 * tolerance } else { 1.0 };
    let origin = bounds(positions.iter().copied().filter(|p| p.is_finite()))[0];
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::with_capacity(positions.len());
    let mut result = Vec::with_capacity(positions.len());
    for (v, &p) in positions.iter().enumerate() {
        let at = (p - origin).to_array();
        let low = at.map(|x| ((x - tolerance) / cell).floor() as i64);
        let high = at.map(|x| ((x + tolerance) / cell).floor() as i64);
        let mut found = None;
        'search: for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let near = cells.get(&[x, y, z]).and_then(|list| {
                        list.iter().find(|&&r| (positions[r as usize] - p).length() <= tolerance)
                    });
                    if let Some(&r) = near {
                        found = Some(r);
                        break 'search;
                    }
                }
            }
        }
        result.push(found.unwrap_or_else(|| {
            let own = at.map(|x| (x / cell).floor() as i64);
            cells.entry(own).or_default().push(v as u32);
            v as u32
        }));
    }
    result
}

/// Refuses triangles with distinct corners and no area: dropping them would tear the surface.
fn slivers(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    tolerance: f64,
    file: &str,
    name: &dyn Fn(usize) -> String,
) -> Result<(), MeshError> {
    let thin: Vec<usize> = (0..triangles.len())
        .filter(|&t| {
            let [a, b, c] = triangles[t].map(|v| positions[v as usize]);
            let (ab, bc, ca) = (b - a, c - b, a - c);
            let longest = ab.length().max(bc.length()).max(ca.length());
            // Height over the longest edge.
            ab.cross(ca).length() <= tolerance * longest
        })
        .collect();
    let Some(&first) = thin.first() else { return Ok(()) };
    let more = match thin.len() - 1 {
        0 => String::new(),
        more => format!(" ({more} more faces likewise)"),
    };
    Err(MeshError::new(
        file,
        format!("{} is degenerate: its corners lie on one line{more}", name(first)),
        "remove the face by merging its corners (in Blender: Mesh > Clean Up > Degenerate \
         Dissolve) and export again",
    ))
}

/// The triangle across each edge (corner k to k + 1), and whether the two are wound alike.
type Neighbours = Vec<[Option<(u32, bool)>; 3]>;

/// And whether solids that touch along an edge were told apart there.
fn neighbours(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    file: &str,
    surface: Surface,
    name: &dyn Fn(usize) -> String,
) -> Result<(Neighbours, bool), MeshError> {
    struct Side {
        edge: [u32; 2],
        triangle: u32,
        k: u8,
        forward: bool,
    }
    let mut sides = Vec::with_capacity(triangles.len() * 3);
    for (t, triangle) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            sides.push(Side {
                edge: [a.min(b), a.max(b)],
                triangle: t as u32,
                k: k as u8,
                forward: a < b,
            });
        }
    }
    sides.sort_unstable_by_key(|s| (s.edge, s.triangle, s.k));
    let mut neighbours: Neighbours = vec![[None; 3]; triangles.len()];
    let mut parted = false;
    let mut holes: Option<(u32, [u32; 2])> = None;
    let mut open_edges = 0usize;
    for group in sides.chunk_by(|a, b| a.edge == b.edge) {
        match group {
            [a, b] => {
                let alike = a.forward != b.forward;
                neighbours[a.triangle as usize][a.k as usize] = Some((b.triangle, alike));
                neighbours[b.triangle as usize][b.k as usize] = Some((a.triangle, alike));
            }
            [only] => {
                open_edges += 1;
                // The first face in the file's order, whatever the edges' order.
                if holes.is_none_or(|(t, _)| only.triangle < t) {
                    holes = Some((only.triangle, only.edge));
                }
            }
            _ if surface == Surface::Open => {}
            [first, rest @ ..] => {
                let [from, to] = first.edge.map(|v| positions[v as usize]);
                let face = |side: &Side| {
                    let third = triangles[side.triangle as usize][(side.k as usize + 2) % 3];
                    Face { outward: positions[third as usize] - from, forward: side.forward }
                };
                let faces: Vec<Face> = group.iter().map(face).collect();
                if let Some(pairs) = wedges::pairs(to - from, &faces) {
                    parted = true;
                    for [a, b] in pairs.iter().map(|pair| pair.map(|k| &group[k])) {
                        neighbours[a.triangle as usize][a.k as usize] = Some((b.triangle, true));
                        neighbours[b.triangle as usize][b.k as usize] = Some((a.triangle, true));
                    }
                    continue;
                }
                let others: Vec<String> = rest.iter().map(|s| name(s.triangle as usize)).collect();
                return Err(MeshError::new(
                    file,
                    format!(
                        "{} shares its edge {} with more than one other: {}",
                        name(first.triangle as usize),
                        edge_name(positions, first.edge),
                        listed(&others)
                    ),
                    "the surface must part inside from outside: remove inner walls, or part \
                     solids that touch along an edge",
                ));
            }
            [] => {}
        }
    }
    match holes {
        Some((t, edge)) if surface == Surface::Closed => Err(MeshError::new(
            file,
            format!(
                "is not watertight: {} has nothing beyond its edge {} ({open_edges} open edges in \
                 all)",
                name(t as usize),
                edge_name(positions, edge)
            ),
            "close the holes (in Blender: Mesh > Clean Up > Fill Holes) and export again; a \
             mirror may have borders",
        )),
        _ => Ok((neighbours, parted)),
    }
}

fn edge_name(positions: &[Vec3], edge: [u32; 2]) -> String {
    let [a, b] = edge.map(|v| {
        let p = positions[v as usize];
        format!("[{}, {}, {}]", p.x, p.y, p.z)
    });
    format!("from {a} to {b}")
}

/// The connected pieces.
struct Pieces {
    /// The triangles, piece by piece.
    order: Vec<u32>,
    /// Where each piece starts in `order`, and the end.
    starts: Vec<usize>,
    /// Whether a triangle is wound against its piece's first one.
    against: Vec<bool>,
}

fn pieces(
    triangles: &[[u32; 3]],
    neighbours: &Neighbours,
    file: &str,
    surface: Surface,
    name: &dyn Fn(usize) -> String,
) -> Result<Pieces, MeshError> {
    let mut against: Vec<Option<bool>> = vec![None; triangles.len()];
    let mut order = Vec::with_capacity(triangles.len());
    let mut starts = vec![0];
    for seed in 0..triangles.len() {
        if against[seed].is_some() {
            continue;
        }
        against[seed] = Some(false);
        order.push(seed as u32);
        let mut next = order.len() - 1;
        while next < order.len() {
            let t = order[next] as usize;
            next += 1;
            for (other, alike) in neighbours[t].iter().flatten() {
                let wanted = against[t].map(|turned| turned == *alike);
                match against[*other as usize] {
                    None => {
                        against[*other as usize] = wanted;
                        order.push(*other);
                    }
                    found if found != wanted && surface == Surface::Closed => {
                        return Err(MeshError::new(
                            file,
                            format!(
                                "has only one side: {} and {} cannot be wound alike",
                                name(t),
                                name(*other as usize)
                            ),
                            "the surface must part inside from outside: remove the twist",
                        ));
                    }
                    Some(_) => {}
                }
            }
        }
        starts.push(order.len());
    }
    Ok(Pieces {
        order,
        starts,
        against: against.into_iter().map(Option::unwrap_or_default).collect(),
    })
}

struct Turned {
    flip: Vec<bool>,
    hollows: usize,
}

/// Which triangles to turn: closed pieces outward, hollows inward, open ones as most are.
fn orient(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    neighbours: &Neighbours,
    pieces: &Pieces,
    file: &str,
    name: &dyn Fn(usize) -> String,
) -> Result<Turned, MeshError> {
    let mut flip = pieces.against.clone();
    let corners = |t: u32, flip: &[bool]| {
        let [a, b, c] = triangles[t as usize].map(|v| positions[v as usize]);
        if flip[t as usize] { [a, c, b] } else { [a, b, c] }
    };
    let mut closed: Vec<&[u32]> = Vec::new();
    for range in pieces.starts.windows(2) {
        let piece = &pieces.order[range[0]..range[1]];
        let is_closed = piece.iter().all(|&t| neighbours[t as usize].iter().all(Option::is_some));
        let turn = if is_closed {
            let first = piece[0];
            let origin = corners(first, &flip)[0];
            let (mut volume, mut magnitude) = (0.0, 0.0);
            for &t in piece {
                let [a, b, c] = corners(t, &flip).map(|p| p - origin);
                let part = a.dot(b.cross(c));
                volume += part;
                magnitude += a.length() * b.cross(c).length();
            }
            // Below this the sum is the rounding of its terms.
            if f64::abs(volume) <= 1e-13 * magnitude {
                return Err(MeshError::new(
                    file,
                    format!("the piece with {} encloses no volume", name(first as usize)),
                    "remove the piece, or give it thickness",
                ));
            }
            closed.push(piece);
            volume < 0.0
        } else {
            let against = piece.iter().filter(|&&t| flip[t as usize]).count();
            against * 2 > piece.len()
        };
        if turn {
            piece.iter().for_each(|&t| flip[t as usize] ^= true);
        }
    }
    let hollow = hollows(&closed, |t| corners(t, &flip), file)?;
    let hollows = hollow.iter().filter(|h| **h).count();
    for (piece, _) in closed.iter().zip(hollow).filter(|(_, hollow)| *hollow) {
        piece.iter().for_each(|&t| flip[t as usize] ^= true);
    }
    Ok(Turned { flip, hollows })
}

/// Which of the closed pieces lie within an odd number of others.
fn hollows(
    closed: &[&[u32]],
    corners: impl Fn(u32) -> [Vec3; 3],
    file: &str,
) -> Result<Vec<bool>, MeshError> {
    if closed.len() > MOST_PIECES {
        return Err(MeshError::new(
            file,
            format!("has {} separate closed pieces, more than {MOST_PIECES}", closed.len()),
            "split the model into several elements",
        ));
    }
    let boxes: Vec<[Vec3; 2]> =
        closed.iter().map(|piece| bounds(piece.iter().flat_map(|&t| corners(t)))).collect();
    let within = |a: &[Vec3; 2], b: &[Vec3; 2]| {
        let [al, ah, bl, bh] = [a[0], a[1], b[0], b[1]].map(Vec3::to_array);
        (0..3).all(|k| bl[k] < al[k] && ah[k] < bh[k])
    };
    Ok(closed
        .iter()
        .enumerate()
        .map(|(i, piece)| {
            // A few corners spread over the piece tell a piece within from one that overlaps.
            let step = piece.len().div_ceil(8);
            let samples: Vec<Vec3> = piece.iter().step_by(step).map(|&t| corners(t)[0]).collect();
            let depth = (0..closed.len())
                .filter(|&j| j != i && within(&boxes[i], &boxes[j]))
                .filter(|&j| {
                    samples.iter().all(|&p| {
                        let triangles = closed[j].iter().map(|&t| corners(t));
                        winding_number(triangles, p).round() != 0.0
                    })
                })
                .count();
            depth % 2 == 1
        })
        .collect())
}

/// The mesh with only the vertices that its triangles use, and their number.
fn compacted(positions: &[Vec3], mut triangles: Vec<[u32; 3]>) -> (TriangleMesh, usize) {
    let mut new_index = vec![u32::MAX; positions.len()];
    let mut kept = Vec::new();
    for v in triangles.iter_mut().flatten() {
        let new = &mut new_index[*v as usize];
        if *new == u32::MAX {
            *new = kept.len() as u32;
            kept.push(positions[*v as usize]);
        }
        *v = *new;
    }
    let used = kept.len();
    (TriangleMesh { positions: kept, triangles, ..TriangleMesh::default() }, used)
}
