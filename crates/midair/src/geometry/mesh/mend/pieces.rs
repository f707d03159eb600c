//! Which triangles are neighbours, the connected pieces that they make, and which way each is wound.

use super::{Surface, listed};
use crate::geometry::Vec3;
use crate::geometry::mesh::MeshError;
use crate::geometry::mesh::measure::{bounds, winding_number};
use crate::geometry::mesh::wedges::{self, Face};

/// More closed pieces than this are not held against each other for hollows.
const MOST_PIECES: usize = 2000;

/// The triangle across each edge (corner k to k + 1), and whether the two are wound alike.
pub(super) type Neighbours = Vec<[Option<(u32, bool)>; 3]>;

/// And whether solids that touch along an edge were told apart there.
pub(super) fn neighbours(
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
pub(super) struct Pieces {
    /// The triangles, piece by piece.
    pub(super) order: Vec<u32>,
    /// Where each piece starts in `order`, and the end.
    pub(super) starts: Vec<usize>,
    /// Whether a triangle is wound against its piece's first one.
    pub(super) against: Vec<bool>,
}

pub(super) fn pieces(
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

pub(super) struct Turned {
    pub(super) flip: Vec<bool>,
    pub(super) hollows: usize,
}

/// Which triangles to turn: closed pieces outward, hollows inward, open ones as most are.
pub(super) fn orient(
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
