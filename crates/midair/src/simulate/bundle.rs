//! Many paths at once, where neighbours take the same course.
//!
//! Almost all light of a view goes one way: into the element by one face, out of it by another, through the plate, to the display.
//! A bundle follows that course for all of its paths with loops over plain arrays, which the compiler turns into vector
//! instructions: no search, no branches, and the very same functions of [`geometry`](crate::geometry) and [`optics`](crate::optics)
//! over the same numbers. Each path is checked: on a convex solid a point of the right face, met in the right sense, is the
//! first one that light meets. What leaves the course (an inner reflection, another face) is left to [`Stage::follow`]; what
//! stays on it comes out to the last bit as that would have it.

use super::light::{Arrival, Chance, Stage};
use super::sequence::Points;
use crate::geometry::{Convex, Crossing, Frame, Ray, Search, Shape, Vec3};
use crate::optics::emission::Emission;
use crate::optics::interface::{attenuate, beer_lambert, fresnel, reflect, refract_with};
use crate::optics::plate::{Class, Model, SlitMirrorPlate, pass_ideal};
use crate::simulate::lens::Lens;
use crate::transport::Matter;

/// Paths of a bundle: some rounds of the widest instructions, while all arrays stay in the first cache.
pub(super) const LANES: usize = 32;

/// What a bundle can be followed through.
pub(super) struct Straight<'a> {
    solid: Option<Solid<'a>>,
    plate: Option<&'a SlitMirrorPlate>,
}

/// The one element.
struct Solid<'a> {
    convex: &'a Convex,
    frame: &'a Frame,
    index: f64,
    absorption: Option<[f64; 3]>,
}

/// The faces by which light enters the solid and leaves it.
pub(super) type Course = Option<[u32; 2]>;

/// A bundle of paths under way.
pub(super) struct Bundle {
    origin: [[f64; LANES]; 3],
    direction: [[f64; LANES]; 3],
    chance: [f64; LANES],
    /// The state at the start, for those who leave the course.
    start: ([[f64; LANES]; 3], [[f64; LANES]; 3], [f64; LANES]),
    /// Whether the path kept to the course.
    kept: [bool; LANES],
    inside: [bool; LANES],
    /// Whether it ends dark, if it kept to the course.
    dark: [bool; LANES],
    /// Way through the solid, mm.
    length: [f64; LANES],
    mirrors: [[f64; LANES]; 2],
    faces: [f64; LANES],
    cos_t: [f64; LANES],
    st: [[f64; LANES]; 2],
}

impl Bundle {
    pub(super) fn new() -> Self {
        let none = [0.0; LANES];
        Self {
            origin: [none; 3],
            direction: [none; 3],
            chance: none,
            start: ([none; 3], [none; 3], none),
            kept: [true; LANES],
            inside: [false; LANES],
            dark: [false; LANES],
            length: none,
            mirrors: [none; 2],
            faces: none,
            cos_t: none,
            st: [none; 2],
        }
    }

    #[inline(always)]
    fn ray(&self, i: usize) -> Ray {
        let vector = |v: &[[f64; LANES]; 3]| Vec3::new(v[0][i], v[1][i], v[2][i]);
        Ray { origin: vector(&self.origin), direction: vector(&self.direction) }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, ray: &Ray) {
        let (o, d) = (ray.origin, ray.direction);
        (self.origin[0][i], self.origin[1][i], self.origin[2][i]) = (o.x, o.y, o.z);
        (self.direction[0][i], self.direction[1][i], self.direction[2][i]) = (d.x, d.y, d.z);
    }

    /// Whether so many paths left the course that another one is worth looking for.
    pub(super) fn is_lost(&self) -> bool {
        2 * self.kept.iter().filter(|&&kept| kept).count() < LANES
    }

    /// The ray that a path set out with, and its chance.
    pub(super) fn first(&self, i: usize) -> (Ray, Chance) {
        let (origin, direction, chance) = &self.start;
        let vector = |v: &[[f64; LANES]; 3]| Vec3::new(v[0][i], v[1][i], v[2][i]);
        (Ray { origin: vector(origin), direction: vector(direction) }, Chance(chance[i]))
    }
}

impl<'a> Straight<'a> {
    /// What bundles can be followed through; `None` where only path by path will do: a display that does not emit alike in all directions or is polarised, elements that are not
    /// one convex solid which stands, like the pupil (an eye and its radius, mm), wholly before the plate.
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
        let before = |point: Vec3| setup.plate.rectangle.frame.to_local(point).z;
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let display_behind = corners.iter().all(|&st| before(setup.display.point(st)) < -behind_by);
        if before(eye) <= pupil || !display_behind || setup.max_interactions < 3 {
            return None;
        }
        let solid = match setup.elements.as_slice() {
            [] => None,
            [element] => {
                let Shape::Convex(convex) = &element.shape else { return None };
                let Matter::Refractive { index, absorption } = element.matter else { return None };
                if before(element.frame.origin) <= convex.reach() || index == 1.0 {
                    return None;
                }
                let absorption = (absorption != [0.0; 3]).then_some(absorption);
                Some(Solid { convex, frame: &element.frame, index, absorption })
            }
            _ => return None,
        };
        Some(Self { solid, plate })
    }

    /// The course of the first path; `None` if it meets no element where there is one.
    pub(super) fn course(&self, bundle: &Bundle) -> Course {
        let Some(solid) = &self.solid else { return Some([0; 2]) };
        let local = bundle.ray(0).to_local(solid.frame);
        let search = |crossing| Search { crossing: Some(crossing), after: 0.0, standing_on: None };
        let enter = solid.convex.nearest(&local, search(Crossing::Enter))?;
        let (t, n) = solid.convex.cross(&local, enter.face, Crossing::Enter);
        let direction = crate::optics::interface::refract(local.direction, n, 1.0 / solid.index);
        let within = Ray { origin: local.at(t), direction };
        let leave = solid.convex.nearest(&within, search(Crossing::Leave))?;
        Some([enter.face, leave.face])
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
        bundle.start = (bundle.origin, bundle.direction, bundle.chance);
    }

    /// The solid's surface by one face; `LEAVING` tells which of the two it is.
    #[inline(always)]
    fn through_face<const LEAVING: bool>(
        bundle: &mut Bundle,
        solid: &Solid,
        convex: Convex,
        face: u32,
    ) {
        let crossing = if LEAVING { Crossing::Leave } else { Crossing::Enter };
        let eta = if LEAVING { solid.index } else { 1.0 / solid.index };
        // A copy of its own, that no store into the bundle can change.
        let frame = *solid.frame;
        for i in 0..LANES {
            let ray = bundle.ray(i);
            let local = ray.to_local(&frame);
            let (t, outward) = convex.cross(&local, face, crossing);
            let n = if LEAVING { -outward } else { outward };
            let d = local.direction;
            // The first meeting with a convex solid is the one point of its faces where light goes in (out).
            let met = (t > 0.0) & (d.dot(n) < 0.0) & convex.within_face(local.at(t), face);
            let cos_i = (-d.dot(n)).min(1.0);
            let f = fresnel(cos_i, eta);
            let (reflected, rest) = Chance(bundle.chance[i]).decided(f.reflectance());
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
                let inside = bundle.inside[i];
                bundle.kept[i] &= !inside | (met & !reflected);
                bundle.length[i] = t;
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
                bundle.set(i, &next);
            } else {
                bundle.kept[i] = met;
                bundle.inside[i] = !reflected;
                bundle.chance[i] = rest;
                bundle.set(i, &next);
            }
        }
    }

    /// One of the solid's faces, each kind of surface in a loop of its own.
    #[inline(always)]
    fn through_surface<const LEAVING: bool>(bundle: &mut Bundle, solid: &Solid, face: u32) {
        match *solid.convex {
            Convex::Sphere { radius } => {
                Self::through_face::<LEAVING>(bundle, solid, Convex::Sphere { radius }, 0);
            }
            Convex::Frustum { middle_radius, slope: 0.0, half_height } if face == 0 => {
                let convex = Convex::Frustum { middle_radius, slope: 0.0, half_height };
                Self::through_face::<LEAVING>(bundle, solid, convex, 0);
            }
            convex => Self::through_face::<LEAVING>(bundle, solid, convex, face),
        }
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
                Self::through_surface::<false>(bundle, solid, faces[0]);
                Self::through_surface::<true>(bundle, solid, faces[1]);
            }
            None => bundle.kept = [true; LANES],
        }
        self.through_plate(bundle, stage);
        Self::to_display(bundle, stage);
    }

    /// Rays for all paths of the bundle, with the widest instructions that this machine has.
    pub(super) fn start(bundle: &mut Bundle, lens: &Lens, at: &Places, points: &Points) {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
            fn avx512(bundle: &mut Bundle, lens: &Lens, at: &Places, points: &Points) {
                Straight::set_out(bundle, lens, at, points);
            }
            #[target_feature(enable = "avx2,fma")]
            fn avx2(bundle: &mut Bundle, lens: &Lens, at: &Places, points: &Points) {
                Straight::set_out(bundle, lens, at, points);
            }
            if has_avx512() {
                // SAFETY: the instructions were just found to exist.
                return unsafe { avx512(bundle, lens, at, points) };
            }
            if has_avx2() {
                // SAFETY: the instructions were just found to exist.
                return unsafe { avx2(bundle, lens, at, points) };
            }
        }
        Self::set_out(bundle, lens, at, points);
    }

    /// Follows the course for all paths of the bundle, with the widest instructions that this machine has.
    pub(super) fn follow(&self, bundle: &mut Bundle, stage: &Stage, faces: [u32; 2]) {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
            fn avx512(straight: &Straight, bundle: &mut Bundle, stage: &Stage, faces: [u32; 2]) {
                straight.follow_lanes(bundle, stage, faces);
            }
            #[target_feature(enable = "avx2,fma")]
            fn avx2(straight: &Straight, bundle: &mut Bundle, stage: &Stage, faces: [u32; 2]) {
                straight.follow_lanes(bundle, stage, faces);
            }
            if has_avx512() {
                // SAFETY: the instructions were just found to exist.
                return unsafe { avx512(self, bundle, stage, faces) };
            }
            if has_avx2() {
                // SAFETY: the instructions were just found to exist.
                return unsafe { avx2(self, bundle, stage, faces) };
            }
        }
        self.follow_lanes(bundle, stage, faces);
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
        if let Some(Solid { absorption: Some(absorption), .. }) = &self.solid
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

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::plate::SlitMirror;
    use crate::simulate::sequence::mix;
    use crate::simulate::{Camera, Viewer};
    use crate::transport::Setup;
    use crate::transport::bench_setup::{block, cone, cylinder, element, setup, sphere};

    /// Every path of a view by bundles and one by one; the share of paths that kept to their bundle's course.
    fn compare(setup: &Setup) -> f64 {
        let stage = Stage { setup };
        let camera = Camera { window: 1.5, ..Camera::at_viewpoint(setup, [64, 64]) };
        let viewer = Viewer { camera, aperture: 8.0, focus: Some(700.0) };
        let lens = Lens::new(&viewer, setup);
        let straight = Straight::of(&stage, setup.viewpoint, 4.0).expect("one convex solid");
        let points = Points::new(3, 0, 4);
        let mut bundle = Bundle::new();
        let (mut kept, mut all, mut lit) = (0, 0, 0);
        for row in 0..64 {
            for column in 0..64 {
                let at = Places {
                    column: [f64::from(column); LANES],
                    pixel: std::array::from_fn(|i| {
                        mix(64 * row + column as u32 + ((i as u32) << 20))
                    }),
                    row: f64::from(row),
                    index: std::array::from_fn(|i| i as u32 % 4),
                };
                Straight::start(&mut bundle, &lens, &at, &points);
                let Some(faces) = straight.course(&bundle) else { continue };
                straight.follow(&mut bundle, &stage, faces);
                for i in 0..LANES {
                    let (ray, chance) = bundle.first(i);
                    let alone = stage.follow(ray, chance);
                    // To the last bit: the same functions over the same numbers.
                    assert_eq!(straight.outcome(&bundle, &stage, i), alone, "{column} {row} {i}");
                    kept += usize::from(bundle.kept[i]);
                    let on_display = |c: &f64| (0.0..=1.0).contains(c);
                    lit += usize::from(alone.is_some_and(|end| end.st.iter().all(on_display)));
                    all += 1;
                }
            }
        }
        assert!(all > 10_000 && 20 * lit > all, "{lit} of {all}");
        kept as f64 / all as f64
    }

    #[test]
    fn a_bundle_brings_what_its_paths_bring_one_by_one() {
        let thick = SlitMirror {
            mirror_thickness: 0.05,
            absorption: [0.0, 0.02, 0.1],
            ..SlitMirror::default()
        };
        let plates = [
            Model::Ideal,
            Model::from(SlitMirrorPlate::new(SlitMirror::default()).unwrap()),
            Model::from(SlitMirrorPlate::new(thick).unwrap()),
        ];
        let clear = Matter::Refractive { index: 1.49, absorption: [0.0; 3] };
        let tinted = Matter::Refractive { index: 1.7, absorption: [0.001, 0.01, 0.0] };
        let turned =
            |shape, matter| vec![element(shape, matter, [1.0, -2.0, 3.0], [10.0, 20.0, 5.0], 0)];
        for plate in &plates {
            assert_eq!(compare(&setup(30.0, vec![]).with_plate(plate.clone())), 1.0);
            for elements in [
                turned(Shape::Convex(Convex::Sphere { radius: 30.0 }), clear),
                turned(cylinder(30.0, 80.0), tinted),
                turned(cylinder(60.0, 20.0), clear),
                turned(block(50.0, 60.0, 40.0), tinted),
                turned(cone(40.0, 25.0, 60.0), clear),
                turned(
                    Shape::Convex(Convex::Ellipsoid { radii: Vec3::new(30.0, 40.0, 20.0) }),
                    tinted,
                ),
                turned(sphere(8.0), clear),
            ] {
                let kept = compare(&setup(30.0, elements).with_plate(plate.clone()));
                // About 8 % are reflected inside at these indices, and edges and rims take some more.
                assert!(kept > 0.3, "{kept}");
            }
        }
    }

    #[test]
    fn what_is_no_lone_convex_solid_before_the_plate_goes_path_by_path() {
        let clear = Matter::Refractive { index: 1.49, absorption: [0.0; 3] };
        let mirror = Matter::Mirror { reflectance: [0.9; 3] };
        let ball = |matter, z: f64| element(sphere(25.0), matter, [0.0, 0.0, z], [0.0; 3], 0);
        let of = |elements: Vec<_>, pupil: f64| {
            let setup = setup(20.0, elements);
            let stage = Stage { setup: &setup };
            Straight::of(&stage, setup.viewpoint, pupil).is_some()
        };
        assert!(of(vec![], 4.0) && of(vec![ball(clear, 0.0)], 4.0));
        assert!(!of(vec![ball(mirror, 0.0)], 4.0));
        assert!(!of(vec![ball(clear, 0.0), ball(clear, 100.0)], 4.0));
        // Through the plate, which stands at z = -150 and leans by 45 degrees.
        assert!(!of(vec![ball(clear, -130.0)], 4.0));
        assert!(!of(vec![], 5000.0));
    }
}
