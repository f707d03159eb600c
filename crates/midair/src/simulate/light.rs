//! One path from the eye to the display, with everything that happens to light on it.

use crate::geometry::Ray;
use crate::optics::interface::{attenuate, beer_lambert, fresnel, reflect, refract_with};
use crate::optics::plate::Class;
use crate::picture::Picture;
use crate::transport::{Action, Matter, Setup, Step, Walk};

/// All that light meets.
#[derive(Clone, Copy)]
pub(super) struct Stage<'a> {
    pub(super) setup: &'a Setup,
    pub(super) display: &'a Picture,
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
    /// needs no factor of the index), and returns what it brings: linear R, G, B, and how it
    /// passed the plate. `None` is darkness.
    ///
    /// At the surface of a solid the path is reflected with Fresnel's reflectance as its probability, and
    /// refracted otherwise: its weight stays, and on average both branches carry their share. Light at
    /// total internal reflection is reflected, whatever the scene asks of the transport.
    ///
    /// The plate stands in an opaque wall: what meets its plane outside its rectangle, or comes back to it from behind,
    /// is dark. So is the display's back.
    #[inline]
    pub(super) fn follow(&self, ray: Ray, mut chance: Chance) -> Option<(Class, [f64; 3])> {
        let setup = self.setup;
        let mut walk = Walk::new(ray);
        let mut light = [1.0; 3];
        let mut class = None;
        for _ in 0..setup.max_interactions.saturating_add(1) {
            let goal = if class.is_none() { &setup.plate.rectangle } else { &setup.display };
            let distance = ahead(goal.plane_distance(&walk.ray));
            if class.is_some() && walk.ray.direction.dot(setup.plate.rectangle.frame.normal()) > 0.0
            {
                let back = ahead(setup.plate.rectangle.plane_distance(&walk.ray));
                if back < distance {
                    // Only an element in between can save it.
                    let step = setup.meet(&walk, back)?;
                    self.interact(&mut walk, step, &mut light, &mut chance);
                    continue;
                }
            }
            if let Some(step) = setup.meet(&walk, distance) {
                self.interact(&mut walk, step, &mut light, &mut chance);
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
                    class = Some(how);
                    walk.leave_plate(behind);
                }
                Some(class) => {
                    let [r, g, b, _] = self.display.emitted(at)?;
                    attenuate(&mut light, [r, g, b].map(f64::from));
                    attenuate(&mut light, setup.emitted_against(walk.ray.direction));
                    return Some((class, light));
                }
            }
        }
        None
    }

    /// What happens at an element: the path goes on from there.
    #[inline]
    fn interact(&self, walk: &mut Walk, step: Step, light: &mut [f64; 3], chance: &mut Chance) {
        let setup = self.setup;
        let element = &setup.elements[usize::from(step.element)];
        let (distance, d, n) = setup.facet(&walk.ray, &step);
        if let Some(absorption) = setup.absorption(walk) {
            attenuate(light, beer_lambert(absorption, distance));
        }
        let mut step = step;
        let direction = match step.action {
            Action::Pass | Action::Plate => d,
            Action::Reflect => {
                if let Matter::Mirror { reflectance } = element.matter {
                    attenuate(light, reflectance);
                }
                reflect(d, n)
            }
            Action::Refract { eta } => {
                // Rounding must not take a grazing cosine out of its range.
                let cos_i = (-d.dot(n)).min(1.0);
                let f = fresnel(cos_i, eta);
                if chance.decide(f.reflectance()) {
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

/// A distance if it lies ahead, else infinity; a plane that the ray lies in is never met.
#[inline]
fn ahead(distance: f64) -> f64 {
    if distance > 0.0 { distance } else { f64::INFINITY }
}
