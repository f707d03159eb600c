//! What is left of light at the end of a known path.

use super::path::{Action, Step};
use super::setup::{Matter, Setup};
use super::walk::Walk;
use crate::geometry::{Ray, Vec3};
use crate::optics::interface::{attenuate, beer_lambert, fresnel};
use crate::optics::polarisation::Analysed;

/// What the elements leave of light that goes along a path (either way: both ends are in air), and how it
/// meets the plate.
#[derive(Clone, Copy, Debug)]
pub struct Remainder {
    /// Share of the light that survives, by linear R, G, B: Fresnel's transmittance at each surface, the mirrors'
    /// reflectance, and absorption within solids. Light of a polarised display is followed by its field, with the plate's faces; else
    /// each surface takes what it takes of unpolarised light.
    pub share: [f64; 3],
    /// What the plate's faces pass of unpolarised light, where `share` has them already: what the plate's own share is to be divided by. 1 for
    /// unpolarised light.
    pub faces: f64,
    /// The path as it meets the plate, towards the display: the point, and a unit vector, in the world.
    pub at_plate: Ray,
    /// The direction in which the path meets the display: a unit vector, in the world.
    pub at_display: Vec3,
}

impl Setup {
    /// What is left of light along the path with these steps that sets out as `ray`; `None` where the steps lead nowhere or
    /// not through the plate.
    pub fn remainder(&self, ray: Ray, path: &[Step]) -> Option<Remainder> {
        let mut walk = Walk::new(ray);
        let mut share = [1.0; 3];
        let (mut at_plate, mut faces) = (None, 1.0);
        let mut field = self.polarisation.map(|_| Analysed::at_eye(ray.direction));
        for step in path {
            let ray = walk.ray;
            let ahead = self.advance(&ray, step);
            if ahead.direction.x.is_nan() {
                return None;
            }
            if let Some(absorption) = self.absorption(&walk) {
                attenuate(
                    &mut share,
                    beer_lambert(absorption, (ahead.origin - ray.origin).length()),
                );
            }
            if step.action == Action::Plate {
                let origin = ray.at(self.plate.rectangle.plane_distance(&ray));
                at_plate = Some(Ray { origin, direction: ray.direction });
                if let Some(field) = &mut field {
                    let (frame, direction) = (&self.plate.rectangle.frame, ray.direction);
                    faces = self.plate.faces(direction);
                    self.plate.model().turn(field, frame, direction, ahead.direction);
                }
                walk.leave_plate(ahead);
                continue;
            }
            match (step.action, self.elements[usize::from(step.element)].matter) {
                (Action::Refract { eta }, _) => {
                    let (_, d, n) = self.facet(&ray, step);
                    match &mut field {
                        Some(field) => {
                            let n = self.normal_against(&ray, step);
                            field.refract(ray.direction, n, eta, ahead.direction);
                        }
                        None => {
                            // Rounding must not take a grazing cosine out of its range.
                            let passed = fresnel((-d.dot(n)).min(1.0), eta).transmittance();
                            attenuate(&mut share, [passed; 3]);
                        }
                    }
                }
                (Action::Reflect, Matter::Mirror { reflectance }) => {
                    if let Some(field) = &mut field {
                        field.mirror(self.normal_against(&ray, step));
                    }
                    attenuate(&mut share, reflectance);
                }
                // Total reflection takes nothing, and turns the field.
                (Action::Reflect, Matter::Refractive { .. }) => {
                    if let (Some(field), Some(eta)) = (&mut field, self.eta(&walk, step)) {
                        let n = self.normal_against(&ray, step);
                        field.reflect(ray.direction, n, eta, ahead.direction);
                    }
                }
                // No path that arrives has met what stops it.
                (Action::Reflect, Matter::Opaque)
                | (Action::Pass | Action::Stop | Action::Plate, _) => {}
            }
            self.take(&mut walk, *step, ahead);
        }
        if let Some(absorption) = self.absorption(&walk) {
            let distance = self.display.plane_distance(&walk.ray);
            attenuate(&mut share, beer_lambert(absorption, distance));
        }
        let at_display = walk.ray.direction;
        if let (Some(field), Some(e)) = (&field, self.polarised_against(at_display)) {
            attenuate(&mut share, [field.share(e); 3]);
        }
        Some(Remainder { share, faces, at_plate: at_plate?, at_display })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Shape, Sheet};
    use crate::transport::bench_setup::{ACRYLIC, block, element, setup, sphere};
    use crate::transport::{Element, Path};

    fn remainder(elements: Vec<Element>, uv: [f64; 2]) -> Remainder {
        let setup = setup(20.0, elements);
        let mut path = Path::new();
        setup.transport(uv, &mut path).st().expect("it arrives");
        setup.remainder(setup.ray(uv), &path).expect("the path is a path")
    }

    #[test]
    fn head_on_a_slab_passes_what_the_textbook_says() {
        // T = 4 n / (n + 1)^2 at each face (Hecht, Optics, 4.6), exp(-a d) between them.
        let absorption = [0.0, 0.01, 0.05];
        let matter = Matter::Refractive { index: 1.5, absorption };
        let slab = element(block(90.0, 90.0, 40.0), matter, [0.0; 3], [0.0; 3], 0);
        let found = remainder(vec![slab], [0.5, 0.5]).share;
        for c in 0..3 {
            let expected = 0.96f64.powi(2) * (-absorption[c] * 40.0).exp();
            assert!((found[c] - expected).abs() < 1e-12, "{found:?}");
        }
    }

    /// At Brewster's angle a slab passes all of p and (1 - R_s)^2 of s, R_s = ((n^2 - 1) / (n^2 + 1))^2 (Hecht, Optics, 8.6); between them Malus' law. The
    /// plate, whose normal lies in the plane of the display's y axis, keeps both apart.
    #[test]
    fn polarised_light_is_followed_by_its_field() {
        let n = 1.49f64;
        let turn = n.atan().to_degrees();
        let slab = element(block(400.0, 90.0, 4.0), ACRYLIC, [0.0; 3], [0.0, turn, 0.0], 0);
        let mut setup = setup(20.0, vec![slab]);
        // From far away, so that the ray through the image's centre is one of parallel ones; it meets the slab at its middle.
        setup.viewpoint = Vec3::new(0.0, 0.0, 1e6);
        setup.display.size = [200.0; 2];
        let mut found = |polarisation: Option<f64>| {
            setup.polarisation = polarisation;
            let mut path = Path::new();
            setup.transport([0.5, 0.5], &mut path).st().expect("it arrives");
            setup.remainder(setup.ray([0.5, 0.5]), &path).expect("it is a path").share[1]
        };
        let s = (1.0 - ((n * n - 1.0) / (n * n + 1.0)).powi(2)).powi(2);
        for (angle, expected) in
            [(0.0, 1.0), (90.0, s), (30.0, 0.75 + 0.25 * s), (-60.0, 0.25 + 0.75 * s)]
        {
            assert!(
                (found(Some(angle)) - expected).abs() < 1e-9,
                "{angle}: {}",
                found(Some(angle))
            );
        }
        // Surface by surface the unpolarised mean: a little less than the mean of both.
        let unpolarised = (0.5 * (1.0 + s.sqrt())).powi(2);
        assert!((found(None) - unpolarised).abs() < 1e-9);
    }

    #[test]
    fn mirrors_leave_their_reflectance_and_nothing_in_the_way_leaves_all() {
        assert_eq!(remainder(Vec::new(), [0.3, 0.8]).share, [1.0; 3]);
        let reflectance = [0.9, 0.8, 0.7];
        let mirror = |y: f64| {
            let sheet = Shape::Sheet(Sheet::Plane { half: [20.0; 2] });
            let matter = Matter::Mirror { reflectance };
            element(sheet, matter, [0.0, y, 0.0], [-45.0, 0.0, 0.0], 0)
        };
        // A periscope: up at the first mirror, and on at the second.
        let setup = setup(20.0, vec![mirror(0.0), mirror(60.0)]);
        let mut path = Path::new();
        setup.transport([0.5, 0.5], &mut path);
        let left = setup.remainder(setup.ray([0.5, 0.5]), &path).expect("it meets the plate");
        for c in 0..3 {
            assert!((left.share[c] - reflectance[c].powi(2)).abs() < 1e-15, "{left:?}");
        }
    }

    #[test]
    fn inner_and_outer_solids_absorb_over_their_own_lengths() {
        // Along the axis: 60 - 20 mm of the outer ball, 20 of the inner one, all of one index: no Fresnel losses within.
        let tinted = |a: f64| Matter::Refractive { index: 1.0 + 1e-12, absorption: [a; 3] };
        let outer = element(sphere(30.0), tinted(0.01), [0.0; 3], [0.0; 3], 0);
        let inner = element(sphere(10.0), tinted(0.1), [0.0; 3], [0.0; 3], 1);
        let found = remainder(vec![outer, inner], [0.5, 0.5]).share;
        let expected = (-(40.0 * 0.01 + 20.0 * 0.1f64)).exp();
        assert!((found[0] / expected - 1.0).abs() < 1e-9, "{found:?} {expected}");
    }
}
