//! The one convex solid that rays go through, if there is no more in the way.

use crate::geometry::{Convex, Crossing, Frame, Ray, Search, Shape, Vec3};
use crate::optics::interface::refract;
use crate::transport::{Matter, Setup};

/// A convex solid alone before the plate.
pub(crate) struct LoneSolid<'a> {
    pub(crate) convex: &'a Convex,
    pub(crate) frame: &'a Frame,
    pub(crate) index: f64,
    /// Per mm, by linear R, G, B; `None` where nothing is absorbed.
    pub(crate) absorption: Option<[f64; 3]>,
}

/// Rays that go through a lone solid's faces together.
pub(crate) trait Together {
    /// Takes all of them through one face; `LEAVING` tells which way. `convex` is the solid's surface.
    fn through_face<const LEAVING: bool>(&mut self, solid: &LoneSolid, convex: Convex, face: u32);
}

/// A ray at one of the solid's faces.
pub(crate) struct Meeting {
    /// The distance, mm.
    pub(crate) t: f64,
    /// The ray's direction in the solid's frame.
    pub(crate) direction: Vec3,
    /// The unit normal there, on the side that the ray comes from.
    pub(crate) normal: Vec3,
    /// Whether it is the first surface that light meets: on a convex solid that is the one point of its faces where light goes in (out).
    pub(crate) is_first: bool,
}

/// Where a ray meets a face of a solid that stands in `frame`.
#[inline(always)]
pub(crate) fn meeting<const LEAVING: bool>(
    ray: &Ray,
    frame: &Frame,
    convex: &Convex,
    face: u32,
) -> Meeting {
    let crossing = if LEAVING { Crossing::Leave } else { Crossing::Enter };
    let local = ray.to_local(frame);
    let (t, outward) = convex.cross(&local, face, crossing);
    let normal = if LEAVING { -outward } else { outward };
    let direction = local.direction;
    let is_first =
        (t > 0.0) & (direction.dot(normal) < 0.0) & convex.within_face(local.at(t), face);
    Meeting { t, direction, normal, is_first }
}

/// The faces by which light enters the solid and leaves it.
pub(crate) type Course = Option<[u32; 2]>;

impl<'a> LoneSolid<'a> {
    /// The one element, if there is one; `None` where the set-up is more than that: elements that are not one convex solid, which stands like the pupil
    /// (an eye and its radius, mm) wholly before the plate, and the display further behind it than half its thickness.
    pub(crate) fn before_plate(
        setup: &'a Setup,
        eye: Vec3,
        pupil: f64,
        half_thickness: f64,
    ) -> Option<Option<Self>> {
        let before = |point: Vec3| setup.plate.rectangle.frame.to_local(point).z;
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let behind = |st| before(setup.display.point(st)) < -half_thickness;
        if before(eye) <= pupil || !corners.into_iter().all(behind) || setup.max_interactions < 4 {
            return None;
        }
        let [element] = setup.elements.as_slice() else {
            return setup.elements.is_empty().then_some(None);
        };
        let Shape::Convex(convex) = &element.shape else { return None };
        let Matter::Refractive { index, absorption } = element.matter else { return None };
        if before(element.frame.origin) <= convex.reach() || index == 1.0 {
            return None;
        }
        let absorption = (absorption != [0.0; 3]).then_some(absorption);
        Some(Some(Self { convex, frame: &element.frame, index, absorption }))
    }

    /// Takes rays through one of the faces, by a loop of its own for each kind of surface.
    #[inline(always)]
    pub(crate) fn through<const LEAVING: bool>(&self, rays: &mut impl Together, face: u32) {
        match *self.convex {
            Convex::Sphere { radius } => {
                rays.through_face::<LEAVING>(self, Convex::Sphere { radius }, 0);
            }
            Convex::Frustum { middle_radius, slope: 0.0, half_height } if face == 0 => {
                let convex = Convex::Frustum { middle_radius, slope: 0.0, half_height };
                rays.through_face::<LEAVING>(self, convex, 0);
            }
            convex => rays.through_face::<LEAVING>(self, convex, face),
        }
    }

    /// Index before a face over the one behind.
    #[inline(always)]
    pub(crate) fn eta<const LEAVING: bool>(&self) -> f64 {
        if LEAVING { self.index } else { 1.0 / self.index }
    }

    /// The course of a ray; `None` if it misses the solid.
    pub(crate) fn course(&self, ray: &Ray) -> Course {
        let local = ray.to_local(self.frame);
        let search = |crossing| Search { crossing: Some(crossing), after: 0.0, standing_on: None };
        let enter = self.convex.nearest(&local, search(Crossing::Enter))?;
        let (t, n) = self.convex.cross(&local, enter.face, Crossing::Enter);
        let direction = refract(local.direction, n, 1.0 / self.index);
        let within = Ray { origin: local.at(t), direction };
        let leave = self.convex.nearest(&within, search(Crossing::Leave))?;
        Some([enter.face, leave.face])
    }
}
