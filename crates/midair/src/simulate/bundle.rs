//! Many paths at once, where neighbours take the same course.
//!
//! Almost all light of a view goes one way: into the element by one face, out of it by another, through the plate, to the display.
//! A bundle follows that course for all of its paths with loops over plain arrays, which the compiler turns into vector
//! instructions: no search, no branches, and the very same functions of [`geometry`](crate::geometry) and [`optics`](crate::optics)
//! over the same numbers. Each path is checked: on a convex solid a point of the right face, met in the right sense, is the
//! first one that light meets. What leaves the course (an inner reflection, another face) is left to [`Stage::follow`]; what
//! stays on it comes out to the last bit as that would have it.

mod lanes;

use super::light::{Arrival, Chance, Stage};
use super::sequence::Points;
use crate::geometry::{Convex, Ray, Vec3};
use crate::optics::emission::Emission;
use crate::optics::interface::{attenuate, beer_lambert, fresnel, reflect, refract_with};
use crate::optics::plate::{Class, Model, SlitMirrorPlate, pass_ideal};
use crate::simulate::lens::Lens;
use crate::transport::packet::{Course, LANES, LoneSolid, Together, meeting, widest};
pub(super) use lanes::Bundle;

/// What a bundle can be followed through.
pub(super) struct Straight<'a> {
    solid: Option<LoneSolid<'a>>,
    plate: Option<&'a SlitMirrorPlate>,
}

impl<'a> Straight<'a> {
    /// What bundles can be followed through; `None` where only path by path will do: a display that does not emit alike in all directions or is
    /// polarised, a measured plate, elements that are more than a [`LoneSolid`] before an eye's pupil (radius in mm) and the plate.
    pub(super) fn of(stage: &Stage<'a>, eye: Vec3, pupil: f64) -> Option<Self> {
        let setup = stage.setup;
        if setup.emission != Emission::Lambert || setup.polarisation.is_some() {
            return None;
        }
        let plate = match setup.plate.model() {
            Model::Ideal => None,
            Model::SlitMirror(plate) => Some(&**plate),
            Model::Measured(_) => return None,
        };
        let behind_by = plate.map_or(0.0, |plate| 0.5 * plate.parameters().thickness());
        Some(Self { solid: LoneSolid::before_plate(setup, eye, pupil, behind_by)?, plate })
    }

    /// The course of the first path; `None` if it meets no element where there is one.
    pub(super) fn course(&self, bundle: &Bundle) -> Course {
        self.solid.as_ref().map_or(Some([0; 2]), |solid| solid.course(&bundle.ray(0)))
    }

    /// Sets out: rays through pixels (columns and rows of the view, numbers for randomness) of the lens.
    #[inline(always)]
    fn set_out(bundle: &mut Bundle, lens: &Lens, at: &Places, points: &Points) {
        // A copy of its own, that no store into the bundle can change.
        let lens = *lens;
        let mut numbers = [[0.0; LANES]; 5];
        points.numbers(&at.pixel, &at.index, &mut numbers);
        for i in 0..LANES {
            let place = [at.column[i] + numbers[0][i], at.row + numbers[1][i]];
            let ray = lens.ray(place[0], place[1], [numbers[2][i], numbers[3][i]]);
            bundle.set(i, &ray);
        }
        bundle.chance = numbers[4];
        bundle.start = (bundle.rays, bundle.chance);
    }

    #[inline(always)]
    fn through_plate(&self, bundle: &mut Bundle, stage: &Stage) {
        let plate = stage.setup.plate.rectangle;
        for i in 0..LANES {
            let ray = bundle.ray(i);
            let distance = plate.plane_distance(&ray);
            let crossing = ray.at(distance);
            let [u, v] = plate.coordinates(crossing);
            let meets = (distance > 0.0) & (ray.direction.dot(plate.frame.normal()) < 0.0);
            let within = (0.0..=1.0).contains(&u) & (0.0..=1.0).contains(&v);
            bundle.dark[i] = !(meets & within);
            bundle.set(i, &Ray { origin: crossing, direction: ray.direction });
        }
        let Some(model) = self.plate else {
            for i in 0..LANES {
                let ray = bundle.ray(i);
                let direction = pass_ideal(ray.direction, plate.frame.normal());
                bundle.set(i, &Ray { origin: ray.origin, direction });
            }
            return;
        };
        for i in 0..LANES {
            let ray = bundle.ray(i);
            let frame = &plate.frame;
            let point = frame.to_local(ray.origin);
            // Light that comes from behind is dark: what is computed for it does not count.
            let passed = model.unfold(point, frame.to_local_direction(ray.direction), false);
            bundle.dark[i] |= !passed.open;
            bundle.mirrors[0][i] = passed.mirrors[0];
            bundle.mirrors[1][i] = passed.mirrors[1];
            bundle.faces[i] = passed.faces;
            bundle.cos_t[i] = passed.cos_t;
            let next = Ray {
                origin: frame.to_world(passed.exit_point),
                direction: frame.to_world_direction(passed.direction),
            };
            bundle.set(i, &next);
        }
    }

    #[inline(always)]
    fn to_display(bundle: &mut Bundle, stage: &Stage) {
        let display = stage.setup.display;
        for i in 0..LANES {
            let ray = bundle.ray(i);
            let distance = display.plane_distance(&ray);
            let meets = (distance > 0.0)
                & (distance < f64::INFINITY)
                & (ray.direction.dot(display.frame.normal()) < 0.0);
            bundle.dark[i] |= !meets;
            let [s, t] = display.coordinates(ray.at(distance));
            bundle.st[0][i] = s;
            bundle.st[1][i] = t;
        }
    }

    #[inline(always)]
    fn follow_lanes(&self, bundle: &mut Bundle, stage: &Stage, faces: [u32; 2]) {
        match &self.solid {
            Some(solid) => {
                solid.through::<false>(bundle, faces[0]);
                solid.through::<true>(bundle, faces[1]);
            }
            None => bundle.kept = [true; LANES],
        }
        self.through_plate(bundle, stage);
        Self::to_display(bundle, stage);
    }

    widest! {
        /// Rays for all paths of the bundle, with the widest instructions that this machine has.
        pub(super) fn start(bundle: &mut Bundle, lens: &Lens, at: &Places, points: &Points)
            => Straight::set_out
    }

    widest! {
        /// Follows the course for all paths of the bundle, with the widest instructions that this machine has.
        pub(super) fn follow(
            straight: &Straight<'_>,
            bundle: &mut Bundle,
            stage: &Stage<'_>,
            faces: [u32; 2],
        ) => Straight::follow_lanes
    }

    /// What a path brings, after [`Self::follow`]: as [`Stage::follow`] has it, which takes over where the path left
    /// the course.
    #[inline]
    pub(super) fn outcome(&self, bundle: &Bundle, stage: &Stage, i: usize) -> Option<Arrival> {
        if !bundle.kept[i] {
            let (ray, chance) = bundle.first(i);
            return stage.follow(ray, chance);
        }
        if bundle.dark[i] {
            return None;
        }
        let mut light = [1.0; 3];
        if let Some(LoneSolid { absorption: Some(absorption), .. }) = &self.solid
            && bundle.inside[i]
        {
            attenuate(&mut light, beer_lambert(*absorption, bundle.length[i]));
        }
        let mut class = Class::Real;
        if let Some(plate) = self.plate {
            let mirrors = bundle.mirrors.map(|lanes| lanes[i] as u32);
            class = Class::of(mirrors);
            attenuate(&mut light, plate.weight(mirrors, bundle.faces[i], bundle.cos_t[i]));
        }
        Some(Arrival { class, st: bundle.st.map(|lanes| lanes[i]), share: light })
    }
}

/// Which paths a bundle holds.
pub(super) struct Places {
    /// Of each path: the pixel's column, and what chooses the shifts of its numbers.
    pub(super) column: [f64; LANES],
    pub(super) pixel: [u32; LANES],
    /// The pixels' row.
    pub(super) row: f64,
    /// Which of the sequence's points, from the pass's first.
    pub(super) index: [u32; LANES],
}

impl Together for Bundle {
    #[inline(always)]
    fn through_face<const LEAVING: bool>(&mut self, solid: &LoneSolid, convex: Convex, face: u32) {
        // A copy of its own, that no store into the bundle can change.
        let (frame, eta) = (*solid.frame, solid.eta::<LEAVING>());
        for i in 0..LANES {
            let ray = self.ray(i);
            let met = meeting::<LEAVING>(&ray, &frame, &convex, face);
            let (t, d, n) = (met.t, met.direction, met.normal);
            let cos_i = (-d.dot(n)).min(1.0);
            let f = fresnel(cos_i, eta);
            let (reflected, rest) = Chance(self.chance[i]).decided(f.reflectance());
            let refracted = refract_with(d, n, eta, cos_i, f.cos_t);
            let mirrored = reflect(d, n);
            let pick = |a: f64, b: f64| if reflected { a } else { b };
            let out = Vec3::new(
                pick(mirrored.x, refracted.x),
                pick(mirrored.y, refracted.y),
                pick(mirrored.z, refracted.z),
            );
            let next = Ray { origin: ray.at(t), direction: frame.to_world_direction(out) };
            if LEAVING {
                // What was reflected at the first face is outside already, and stays as it is.
                let inside = self.inside[i];
                self.kept[i] &= !inside | (met.is_first & !reflected);
                self.length[i] = t;
                let keep = |new: f64, old: f64| if inside { new } else { old };
                let (o, d) = (next.origin, next.direction);
                let next = Ray {
                    origin: Vec3::new(
                        keep(o.x, ray.origin.x),
                        keep(o.y, ray.origin.y),
                        keep(o.z, ray.origin.z),
                    ),
                    direction: Vec3::new(
                        keep(d.x, ray.direction.x),
                        keep(d.y, ray.direction.y),
                        keep(d.z, ray.direction.z),
                    ),
                };
                self.set(i, &next);
            } else {
                self.kept[i] = met.is_first;
                self.inside[i] = !reflected;
                self.chance[i] = rest;
                self.set(i, &next);
            }
        }
    }
}

#[cfg(test)]
mod tests;
