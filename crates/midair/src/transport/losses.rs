//! What is left of light at the end of a known path.

use super::path::{Action, Step};
use super::setup::{Matter, Setup};
use super::walk::Walk;
use crate::geometry::{Ray, Vec3};
use crate::optics::interface::{attenuate, beer_lambert, fresnel};

/// What the elements leave of light that goes along a path (either way: both ends are in air), and how it
/// meets the plate.
#[derive(Clone, Copy, Debug)]
pub struct Remainder {
    /// Share of the light that survives, by linear R, G, B: Fresnel's transmittance (unpolarised) at each surface, the mirrors'
    /// reflectance, and absorption within solids.
    pub share: [f64; 3],
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
        let mut at_plate = None;
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
                walk.leave_plate(ahead);
                continue;
            }
            match (step.action, self.elements[usize::from(step.element)].matter) {
                (Action::Refract { eta }, _) => {
                    let (_, d, n) = self.facet(&ray, step);
                    // Rounding must not take a grazing cosine out of its range.
                    let passed = fresnel((-d.dot(n)).min(1.0), eta).transmittance();
                    attenuate(&mut share, [passed; 3]);
                }
                (Action::Reflect, Matter::Mirror { reflectance }) => {
                    attenuate(&mut share, reflectance);
                }
                // Total reflection takes nothing.
                _ => {}
            }
            self.take(&mut walk, *step, ahead);
        }
        if let Some(absorption) = self.absorption(&walk) {
            let distance = self.display.plane_distance(&walk.ray);
            attenuate(&mut share, beer_lambert(absorption, distance));
        }
        Some(Remainder { share, at_plate: at_plate?, at_display: walk.ray.direction })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Shape, Sheet};
    use crate::transport::bench_setup::{block, element, setup, sphere};
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
