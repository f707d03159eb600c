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

pub(crate) use lanes::{LANES, Lanes, is_lost};
pub(crate) use lone::{Course, LoneSolid, Together, meeting};
pub(crate) use widest::widest;

use super::path::{End, Path};
use super::setup::{Setup, ray_through};
use crate::geometry::{Convex, Ray, Vec3};
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
            let first = packet.lanes.ray(0);
            packet.kept = [false; LANES];
            // The neighbours' course first; where most leave that, the first ray's own.
            if let Some(faces) = *course {
                follow(packet, setup, lone, faces);
            }
            if is_lost(&packet.kept) {
                let own = lone.as_ref().map_or(Some([0; 2]), |lone| lone.course(&first));
                if let Some(faces) = own.filter(|_| own != *course) {
                    set_out(&mut packet.lanes, setup, *eye, &points);
                    follow(packet, setup, lone, faces);
                }
                *course = own;
            }
            for (i, &uv) in uv.iter().enumerate() {
                let end = if packet.kept[i] {
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
        solid.through::<false>(packet, faces[0]);
        solid.through::<true>(packet, faces[1]);
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

impl Together for Packet {
    #[inline(always)]
    fn through_face<const LEAVING: bool>(&mut self, solid: &LoneSolid, convex: Convex, face: u32) {
        // A copy of its own, that no store into the lanes can change.
        let (frame, eta) = (*solid.frame, solid.eta::<LEAVING>());
        for i in 0..LANES {
            let ray = self.lanes.ray(i);
            let met = meeting::<LEAVING>(&ray, &frame, &convex, face);
            let refracted = refract(met.direction, met.normal, eta);
            self.kept[i] &= met.is_first & !refracted.x.is_nan();
            let direction = frame.to_world_direction(refracted);
            self.lanes.set(i, &Ray { origin: ray.at(met.t), direction });
        }
    }
}

#[cfg(test)]
mod tests;
