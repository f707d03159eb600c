//! F for many rays at once, where neighbours take the same course.
//!
//! Almost all rays of a view go one way: into the element by one face, out of it by another, through the plate, to the display. A packet follows that
//! course for all of its rays with loops over plain arrays, which the compiler turns into vector instructions: no search, no branches, and the very same
//! functions of [`geometry`](crate::geometry) and [`optics`](crate::optics) over the same numbers. Each ray is checked: on a convex solid a point of the
//! right face, met in the right sense, is the first one that light meets. What leaves the course (total reflection, another face, past the solid) is
//! left to [`Setup::trace`]; what stays on it comes out to the last bit as that would have it.

mod lanes;
mod lone;
mod widest;

pub(crate) use lanes::{LANES, Lanes};
pub(crate) use lone::{Course, LoneSolid};
pub(crate) use widest::widest;

use super::path::{End, Path};
use super::setup::{Setup, ray_through};
use crate::geometry::{Convex, Crossing, Ray, Vec3};
use crate::optics::interface::refract;

/// Follows rays through a set-up, packet by packet where it can, and one by one where only that will do.
pub struct Packets<'a> {
    setup: &'a Setup,
    eye: Vec3,
    /// The one element, if there is one; `None` where packets cannot be followed.
    lone: Option<Option<LoneSolid<'a>>>,
    /// The course of the packet before.
    course: Course,
    packet: Packet,
    path: Path,
}

/// Rays under way.
struct Packet {
    lanes: Lanes,
    /// Whether the ray kept to the course.
    kept: [bool; LANES],
    through_plate: [bool; LANES],
    st: [[f64; LANES]; 2],
}

impl<'a> Packets<'a> {
    /// Of rays from an eye.
    pub fn new(setup: &'a Setup, eye: Vec3) -> Self {
        let lone = LoneSolid::before_plate(setup, eye, 0.0, 0.0);
        let none = [0.0; LANES];
        let packet = Packet {
            lanes: Lanes::new(),
            kept: [false; LANES],
            through_plate: [false; LANES],
            st: [none; 2],
        };
        Self { setup, eye, lone, course: None, packet, path: Path::new() }
    }

    /// Where the rays through image points uv end, each with its number: as [`Setup::trace`] has it of [`Setup::ray_from`].
    pub fn ends(&mut self, uv: &[[f64; 2]], mut each: impl FnMut(usize, End)) {
        let Self { setup, eye, lone, course, packet, path } = self;
        let Some(lone) = lone else {
            for (i, &uv) in uv.iter().enumerate() {
                each(i, setup.trace(setup.ray_from(*eye, uv), path));
            }
            return;
        };
        for (number, uv) in uv.chunks(LANES).enumerate() {
            let mut points = [[0.0; LANES]; 2];
            for i in 0..LANES {
                let [u, v] = uv[i.min(uv.len() - 1)];
                (points[0][i], points[1][i]) = (u, v);
            }
            set_out(&mut packet.lanes, setup, *eye, &points);
            let mut keeps = false;
            // The neighbour's course first; where most left that, the course of the first ray here.
            for attempt in 0..2 {
                if attempt == 1 || course.is_none() {
                    *course = lone
                        .as_ref()
                        .map_or(Some([0; 2]), |lone| lone.course(&packet.lanes.ray(0)));
                }
                let Some(faces) = *course else { break };
                if attempt == 1 {
                    set_out(&mut packet.lanes, setup, *eye, &points);
                }
                follow(packet, setup, lone, faces);
                keeps = true;
                if 2 * packet.kept.iter().filter(|&&kept| kept).count() >= LANES {
                    break;
                }
            }
            for (i, &uv) in uv.iter().enumerate() {
                let end = if keeps && packet.kept[i] {
                    let st = packet.st.map(|lanes| lanes[i]);
                    End::Display { st, through_plate: packet.through_plate[i] }
                } else {
                    setup.trace(setup.ray_from(*eye, uv), path)
                };
                each(number * LANES + i, end);
            }
        }
    }
}

widest! {
    fn set_out(lanes: &mut Lanes, setup: &Setup, eye: Vec3, uv: &[[f64; LANES]; 2]) => set_out_lanes
}

#[inline(always)]
fn set_out_lanes(lanes: &mut Lanes, setup: &Setup, eye: Vec3, uv: &[[f64; LANES]; 2]) {
    // A copy of its own, that no store into the lanes can change.
    let image = setup.image;
    for i in 0..LANES {
        lanes.set(i, &ray_through(&image, eye, [uv[0][i], uv[1][i]]));
    }
}

widest! {
    fn follow(packet: &mut Packet, setup: &Setup, lone: &Option<LoneSolid<'_>>, faces: [u32; 2]) => follow_lanes
}

#[inline(always)]
fn follow_lanes(packet: &mut Packet, setup: &Setup, lone: &Option<LoneSolid<'_>>, faces: [u32; 2]) {
    packet.kept = [true; LANES];
    if let Some(solid) = lone {
        through_surface::<false>(packet, solid, faces[0]);
        through_surface::<true>(packet, solid, faces[1]);
    }
    let plate = setup.plate.rectangle;
    for i in 0..LANES {
        let ray = packet.lanes.ray(i);
        let distance = plate.plane_distance(&ray);
        let [u, v] = plate.coordinates(ray.at(distance));
        packet.kept[i] &= (distance > 0.0) & (ray.direction.dot(plate.frame.normal()) < 0.0);
        packet.through_plate[i] = (0.0..=1.0).contains(&u) & (0.0..=1.0).contains(&v);
        packet.lanes.set(i, &setup.pass_plate(&ray));
    }
    let display = setup.display;
    for i in 0..LANES {
        let ray = packet.lanes.ray(i);
        let distance = display.plane_distance(&ray);
        packet.kept[i] &= (distance > 0.0)
            & (distance < f64::INFINITY)
            & (ray.direction.dot(display.frame.normal()) < 0.0);
        let [s, t] = display.coordinates(ray.at(distance));
        packet.st[0][i] = s;
        packet.st[1][i] = t;
    }
}

/// One of the solid's faces, each kind of surface in a loop of its own.
#[inline(always)]
fn through_surface<const LEAVING: bool>(packet: &mut Packet, solid: &LoneSolid, face: u32) {
    match *solid.convex {
        Convex::Sphere { radius } => {
            through_face::<LEAVING>(packet, solid, Convex::Sphere { radius }, 0);
        }
        Convex::Frustum { middle_radius, slope: 0.0, half_height } if face == 0 => {
            let convex = Convex::Frustum { middle_radius, slope: 0.0, half_height };
            through_face::<LEAVING>(packet, solid, convex, 0);
        }
        convex => through_face::<LEAVING>(packet, solid, convex, face),
    }
}

#[inline(always)]
fn through_face<const LEAVING: bool>(
    packet: &mut Packet,
    solid: &LoneSolid,
    convex: Convex,
    face: u32,
) {
    let crossing = if LEAVING { Crossing::Leave } else { Crossing::Enter };
    let eta = if LEAVING { solid.index } else { 1.0 / solid.index };
    // A copy of its own, that no store into the lanes can change.
    let frame = *solid.frame;
    for i in 0..LANES {
        let ray = packet.lanes.ray(i);
        let local = ray.to_local(&frame);
        let (t, outward) = convex.cross(&local, face, crossing);
        let n = if LEAVING { -outward } else { outward };
        let d = local.direction;
        let refracted = refract(d, n, eta);
        // The first meeting with a convex solid is the one point of its faces where light goes in (out).
        let met = (t > 0.0) & (d.dot(n) < 0.0) & convex.within_face(local.at(t), face);
        packet.kept[i] &= met & !refracted.x.is_nan();
        let direction = frame.to_world_direction(refracted);
        packet.lanes.set(i, &Ray { origin: ray.at(t), direction });
    }
}

#[cfg(test)]
mod tests;
