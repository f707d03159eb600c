//! One path from the eye to the display, with everything that happens to light on it.

use crate::geometry::{Frame, Ray, Vec3};
use crate::optics::interface::{Fresnel, attenuate, beer_lambert, fresnel, reflect, refract_with};
use crate::optics::plate::Class;
use crate::optics::polarisation::Analysed;
use crate::picture::Picture;
use crate::transport::{Action, Matter, Setup, Step, Walk};

/// All that light meets.
#[derive(Clone, Copy)]
pub(super) struct Stage<'a> {
    pub(super) setup: &'a Setup,
}

/// Where a path ends in the display's plane: which light it brings is told by what the display shows there. One path serves for all
/// pictures that a display may show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arrival {
    /// How it passed the plate.
    pub(super) class: Class,
    /// The place in the display's plane, on the display or beside it.
    pub(super) st: [f64; 2],
    /// The share of the light from there that arrives: linear R, G, B.
    pub(super) share: [f64; 3],
}

impl Arrival {
    /// The light of a display that shows this; `None` beside the display.
    #[inline]
    pub(super) fn light(&self, display: &Picture) -> Option<[f64; 3]> {
        let [r, g, b, _] = display.emitted(self.st)?;
        let mut light = self.share;
        attenuate(&mut light, [r, g, b].map(f64::from));
        Some(light)
    }
}

/// A number in \[0, 1) that decides one question after the other: what an answer leaves of it is as evenly
/// spread as it was. (Of its 24 bits a reflection at 4 % uses up 4.6, a refraction 0.06: paths that
/// use up all carry less than 1e-6 of the light.)
pub(super) struct Chance(pub(super) f64);

impl Chance {
    /// Yes with this probability.
    #[inline]
    fn decide(&mut self, probability: f64) -> bool {
        let (yes, rest) = Self(self.0).decided(probability);
        self.0 = rest;
        yes
    }

    /// The answer, and the number that is left.
    #[inline(always)]
    pub(super) fn decided(self, probability: f64) -> (bool, f64) {
        let yes = self.0 < probability;
        let below = if yes { self.0 } else { self.0 - probability };
        let width = if yes { probability } else { 1.0 - probability };
        (yes, below / width)
    }
}

impl Stage<'_> {
    /// Follows light backwards from the eye, as reciprocity allows (both ends are in air, so that radiance
    /// needs no factor of the index), and returns where it ends on the display. `None` is darkness.
    ///
    /// At the surface of a solid the path is reflected with Fresnel's reflectance as its probability, and
    /// refracted otherwise: its weight stays, and on average both branches carry their share. Light at
    /// total internal reflection is reflected, whatever the scene asks of the transport.
    ///
    /// The plate stands in an opaque wall: what meets its plane outside its rectangle, or comes back to it from behind,
    /// is dark. So is the display's back.
    #[inline]
    pub(super) fn follow(&self, ray: Ray, mut chance: Chance) -> Option<Arrival> {
        let setup = self.setup;
        let mut walk = Walk::new(ray);
        let mut light = [1.0; 3];
        let mut field = setup.polarisation.map(|_| Analysed::at_eye(ray.direction));
        let mut class = None;
        for _ in 0..setup.max_interactions.saturating_add(1) {
            let goal = if class.is_none() { &setup.plate.rectangle } else { &setup.display };
            let distance = ahead(goal.plane_distance(&walk.ray));
            if class.is_some() && walk.ray.direction.dot(setup.plate.rectangle.frame.normal()) > 0.0
            {
                let back = ahead(setup.plate.rectangle.plane_distance(&walk.ray));
                if back < distance {
                    // Only an element in between can save it.
                    let step =
                        setup.meet(&walk, back).filter(|step| step.action != Action::Stop)?;
                    self.interact(&mut walk, step, &mut light, &mut field, &mut chance);
                    continue;
                }
            }
            if let Some(step) = setup.meet(&walk, distance) {
                if step.action == Action::Stop {
                    return None;
                }
                self.interact(&mut walk, step, &mut light, &mut field, &mut chance);
                continue;
            }
            if distance == f64::INFINITY || walk.ray.direction.dot(goal.frame.normal()) >= 0.0 {
                return None;
            }
            if let Some(absorption) = setup.absorption(&walk) {
                attenuate(&mut light, beer_lambert(absorption, distance));
            }
            let point = walk.ray.at(distance);
            let at = goal.coordinates(point);
            match class {
                None => {
                    if !at.iter().all(|c| (0.0..=1.0).contains(c)) {
                        return None;
                    }
                    let (how, behind, weight) = setup.plate.pass(&walk.ray, point)?;
                    attenuate(&mut light, weight);
                    if let Some(field) = &mut field {
                        let (before, frame) = (walk.ray.direction, &setup.plate.rectangle.frame);
                        attenuate(&mut light, [1.0 / setup.plate.faces(before); 3]);
                        setup.plate.model().turn(field, frame, before, behind.direction);
                    }
                    class = Some(how);
                    walk.leave_plate(behind);
                }
                Some(class) => {
                    let direction = walk.ray.direction;
                    attenuate(&mut light, setup.emitted_against(direction));
                    if let (Some(field), Some(e)) = (&field, setup.polarised_against(direction)) {
                        attenuate(&mut light, [field.share(e); 3]);
                    }
                    return Some(Arrival { class, st: at, share: light });
                }
            }
        }
        None
    }

    /// What happens at an element: the path goes on from there.
    #[inline]
    fn interact(
        &self,
        walk: &mut Walk,
        step: Step,
        light: &mut [f64; 3],
        field: &mut Option<Analysed>,
        chance: &mut Chance,
    ) {
        let setup = self.setup;
        let element = &setup.elements[usize::from(step.element)];
        let (distance, d, n) = setup.facet(&walk.ray, &step);
        if let Some(absorption) = setup.absorption(walk) {
            attenuate(light, beer_lambert(absorption, distance));
        }
        let mut step = step;
        let direction = match step.action {
            Action::Pass | Action::Stop | Action::Plate => d,
            Action::Reflect => {
                if let Matter::Mirror { reflectance } = element.matter {
                    attenuate(light, reflectance);
                }
                if let Some(field) = field {
                    field.mirror(element.frame.to_world_direction(n));
                }
                reflect(d, n)
            }
            Action::Refract { eta } => {
                // Rounding must not take a grazing cosine out of its range.
                let cos_i = (-d.dot(n)).min(1.0);
                let f = fresnel(cos_i, eta);
                if let Some(field) = field {
                    let out = self.divided(field, (d, n), (eta, cos_i, f), element.frame, chance);
                    if out.dot(n) > 0.0 {
                        step.action = Action::Reflect;
                    }
                    out
                } else if chance.decide(f.reflectance()) {
                    step.action = Action::Reflect;
                    reflect(d, n)
                } else {
                    refract_with(d, n, eta, cos_i, f.cos_t)
                }
            }
        };
        let ray = Ray {
            origin: walk.ray.at(distance),
            direction: element.frame.to_world_direction(direction),
        };
        setup.take(walk, step, ray);
    }
}

impl Stage<'_> {
    /// Polarised light at an interface: reflected with the share of the light that is, as its field stands, else refracted; the direction in
    /// the element's frame, like `d` and `n`.
    fn divided(
        &self,
        field: &mut Analysed,
        (d, n): (Vec3, Vec3),
        (eta, cos_i, f): (f64, f64, Fresnel),
        frame: Frame,
        chance: &mut Chance,
    ) -> Vec3 {
        let world = |v: Vec3| frame.to_world_direction(v);
        let back = reflect(d, n);
        let mut reflected = *field;
        reflected.reflect(world(d), world(n), eta, world(back));
        let came = field.mean();
        // A field that is lost carries nothing either way.
        let share = if came > 0.0 { (reflected.mean() / came).min(1.0) } else { 0.0 };
        if f.cos_t.is_nan() || chance.decide(share) {
            *field = reflected;
            if !f.cos_t.is_nan() {
                field.scale(1.0 / share);
            }
            return back;
        }
        let on = refract_with(d, n, eta, cos_i, f.cos_t);
        field.refract(world(d), world(n), eta, world(on));
        field.scale(1.0 / (1.0 - share));
        on
    }
}

/// A distance if it lies ahead, else infinity; a plane that the ray lies in is never met.
#[inline]
fn ahead(distance: f64) -> f64 {
    if distance > 0.0 { distance } else { f64::INFINITY }
}
