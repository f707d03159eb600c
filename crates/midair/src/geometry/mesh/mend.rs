//! Checking a mesh, and mending what can be mended without guessing.
//!
//! Mended and said: vertices at one place are merged, faces that this collapses and repeated faces
//! are dropped, flipped faces are turned. Refused with the face's name: slivers of no area, holes, edges of three
//! and more faces, surfaces that have no two sides.

mod pieces;

mod kept;

use super::measure::bounds;
use super::overlap::{crossing_itself, overlapping};
use super::read::NO_NORMAL;
use super::wedges;
use super::{MeshError, RawMesh, TriangleMesh};
use crate::geometry::Vec3;
use kept::{Kept, merge, slivers};
use pieces::{neighbours, orient, pieces};

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
            // A sheet with two sides is no wall, and nothing is left of it.
            if walls.triangles.is_empty() {
                return Err(error);
            }
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
