//! A path under way: what it meets next, and which solids are around it.

use super::path::{Action, Step};
use super::setup::{Element, Matter, Setup};
use crate::geometry::{Crossing, Hit, Ray, Search, Shape};

/// A path under way.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    /// Where the path is, and which way it goes.
    pub ray: Ray,
    /// The solids around it, a bit for each rank.
    inside: u64,
    /// The surface that it stands on.
    standing: Option<Step>,
}

/// Surfaces nearer to each other than this along a ray coincide (water in its glass). Which of them comes first is told by
/// [`Setup::order`], not by rounding, and a hit this little behind the start still counts, if the path is on the side that it
/// asks for. 1e-9 mm is a thousand times the rounding of coordinates of a metre, and far below anything optical.
const COINCIDENT: f64 = 1e-9;

impl Walk {
    /// Sets out in the open air.
    pub fn new(ray: Ray) -> Self {
        Self { ray, inside: 0, standing: None }
    }

    /// Goes on behind the plate.
    pub fn leave_plate(&mut self, ray: Ray) {
        self.ray = ray;
        self.standing = None;
    }
}

impl Setup {
    /// What the path meets first at an element nearer than `limit` mm, and what happens there: a mirror
    /// reflects; the surface of a solid refracts, unless it has the same medium on both sides.
    ///
    /// Solids that overlap are resolved by rank: the medium at a point is that of the highest-ranked solid around
    /// it. A solid's surface counts only where it fits the side that the path is on, so neither
    /// coinciding surfaces nor rounding can make a path enter twice.
    pub fn meet(&self, walk: &Walk, limit: f64) -> Option<Step> {
        let (index, hit) = self.nearest(walk, limit)?;
        let element = &self.elements[index];
        let action = match element.matter {
            Matter::Mirror { .. } => Action::Reflect,
            Matter::Opaque => Action::Stop,
            Matter::Refractive { .. } => {
                let before = self.medium_index(walk.inside);
                let behind = self.medium_index(walk.inside ^ 1 << element.rank);
                if before == behind {
                    Action::Pass
                } else {
                    Action::Refract { eta: before / behind }
                }
            }
        };
        let part = element.shape.part(hit.face);
        Some(Step {
            element: index as u16,
            crossing: hit.crossing,
            face: hit.face,
            part: part.number,
            seamless: part.is_bent,
            action,
        })
    }

    /// Goes on from a meeting along `ray`. Whether the path now is on the surface's other side is told by the
    /// step's action: reflected light stays where it was.
    pub fn take(&self, walk: &mut Walk, step: Step, ray: Ray) {
        let element = &self.elements[usize::from(step.element)];
        if let (Matter::Refractive { .. }, Action::Refract { .. } | Action::Pass) =
            (element.matter, step.action)
        {
            walk.inside ^= 1 << element.rank;
        }
        walk.ray = ray;
        walk.standing = Some(step);
    }

    /// Index before over index behind the surface of a solid that the path meets; `None` at a mirror.
    pub fn eta(&self, walk: &Walk, step: &Step) -> Option<f64> {
        let element = &self.elements[usize::from(step.element)];
        matches!(element.matter, Matter::Refractive { .. }).then(|| {
            self.medium_index(walk.inside) / self.medium_index(walk.inside ^ 1 << element.rank)
        })
    }

    /// Absorption per mm by linear R, G, B where the path is; `None` where nothing is absorbed.
    pub fn absorption(&self, walk: &Walk) -> Option<[f64; 3]> {
        match self.medium(walk.inside)?.matter {
            Matter::Refractive { absorption, .. } if absorption != [0.0; 3] => Some(absorption),
            _ => None,
        }
    }

    /// The element that the path meets first, nearer than `limit`.
    fn nearest(&self, walk: &Walk, limit: f64) -> Option<(usize, Hit)> {
        let mut best: Option<(usize, Hit)> = None;
        for (index, element) in self.elements.iter().enumerate() {
            let stands_here = walk.standing.filter(|s| usize::from(s.element) == index);
            let crossing = match element.matter {
                Matter::Refractive { .. } if walk.inside >> element.rank & 1 == 1 => {
                    Some(Crossing::Leave)
                }
                Matter::Refractive { .. } => Some(Crossing::Enter),
                Matter::Mirror { .. } | Matter::Opaque if element.shape.is_solid() => {
                    Some(Crossing::Enter)
                }
                Matter::Mirror { .. } | Matter::Opaque => None,
            };
            // Light that goes away from a convex solid never comes back to it by itself.
            if stands_here.is_some()
                && crossing == Some(Crossing::Enter)
                && matches!(element.shape, Shape::Convex(_))
            {
                continue;
            }
            let search = Search {
                crossing,
                after: if stands_here.is_some() { 0.0 } else { -COINCIDENT },
                standing_on: stands_here.map(|s| s.face),
            };
            if let Some(hit) = element.shape.nearest(&walk.ray.to_local(&element.frame), search)
                && hit.t < limit
                && best.is_none_or(|(other, first)| {
                    let behind = hit.t - first.t;
                    behind < -COINCIDENT
                        || behind <= COINCIDENT && self.order(index, hit) < self.order(other, first)
                })
            {
                best = Some((index, hit));
            }
        }
        best
    }

    /// In which order surfaces that coincide are met, the least first: so that all rays through them take the same path, and
    /// light goes from medium to medium at once, without a film of nothing between. A mirror on a solid's face is the solid's
    /// silvering. A solid is entered before another one is left (water, and the air on it, touch: no glass comes between);
    /// the higher-ranked one is entered first and left last.
    fn order(&self, index: usize, hit: Hit) -> (u8, u8) {
        let Element { matter, rank, .. } = self.elements[index];
        match (matter, hit.crossing) {
            (Matter::Mirror { .. } | Matter::Opaque, _) => (0, 0),
            (Matter::Refractive { .. }, Crossing::Enter) => (1, u8::MAX - rank),
            (Matter::Refractive { .. }, Crossing::Leave) => (2, rank),
        }
    }

    /// The solid that fills the place inside these solids (a bit for each rank); `None` in the open.
    pub(super) fn medium(&self, inside: u64) -> Option<&Element> {
        if inside == 0 {
            return None;
        }
        let rank = 63 - inside.leading_zeros() as u8;
        let solid = |e: &&Element| e.rank == rank && matches!(e.matter, Matter::Refractive { .. });
        self.elements.iter().find(solid)
    }

    /// Refractive index inside these solids; 1 in the open.
    fn medium_index(&self, inside: u64) -> f64 {
        match self.medium(inside).map(|e| e.matter) {
            Some(Matter::Refractive { index, .. }) => index,
            _ => 1.0,
        }
    }
}
