//! The mean course of a slit-mirror plate's image-forming light: two planes of symmetry instead of one.

use super::SlitMirror;
use super::slit_mirror::{across, across_inverse};
use crate::geometry::{Real, Vec3};

/// What a slit-mirror plate does on average to the light that forms the mid-air image.
///
/// In its layer, light that meets an odd number of mirrors leaves, averaged over where it enters between two of them, as if
/// it had been turned back once, at the layer's mid-plane: of the offsets 0 to p at which a ray of slope m meets k mirrors, the mean of
/// exit less entry is 0 for every odd k (integrate the unfolding of [`SlitMirrorPlate`](super::SlitMirrorPlate) over the entry). The two layers lie one behind the other, so that the plate is symmetric in one plane for the
/// one direction and in another for the other: a point's image is two lines, a layer's depth over the index apart. To a viewer
/// the whole image is out of place by half a millimetre or so, by different amounts where directions differ.
///
/// Glass before and behind drops out, as both directions pass the same of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerPlanes {
    /// From one layer's mid-plane to the other's, mm.
    depth: f64,
    /// One over the glass' index.
    eta: f64,
    /// Sine and cosine of the azimuth.
    turn: (f64, f64),
}

impl LayerPlanes {
    /// Of a plate.
    pub fn new(plate: &SlitMirror) -> Self {
        Self {
            depth: plate.layer_depth,
            eta: 1.0 / plate.ior,
            turn: plate.azimuth.to_radians().sin_cos(),
        }
    }

    /// How far from the ideal plate's the light's line lies behind the plate: local x and y, mm, in the plate's mid-plane, for light that
    /// arrives along the unit vector `d` in the plate's frame.
    #[inline]
    pub fn shift<T: Real>(&self, d: Vec3<T>) -> [T; 2] {
        let [a, b] = across(self.turn, [d.x, d.y]);
        // Snell in the glass; what is met first lies before the mid-plane, so the sign follows the side that light comes from.
        let cos_t = (-(-d.z.squared() + 1.0) * (self.eta * self.eta) + 1.0).sqrt();
        let cos_t = if d.z.value() < 0.0 { -cos_t } else { cos_t };
        let each = T::constant(self.depth * self.eta) / cos_t;
        across_inverse(self.turn, [a * each, -(b * each)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Dual;
    use crate::optics::plate::{Class, SlitMirrorPlate, pass_ideal};
    use proptest::prelude::*;

    fn plate() -> impl Strategy<Value = SlitMirror> {
        let sizes = (0.1..1.0f64, 0.2..3.0f64, 0.0..1.0f64);
        (sizes, -90.0..90.0f64, 1.0..1.9f64).prop_map(
            |((pitch, layer_depth, cover_glass), azimuth, ior)| SlitMirror {
                pitch,
                layer_depth,
                cover_glass,
                azimuth,
                ior,
                ..SlitMirror::default()
            },
        )
    }

    fn direction() -> impl Strategy<Value = Vec3> {
        (-1.5..1.5f64, -1.5..1.5f64, prop::bool::ANY)
            .prop_map(|(x, y, up)| Vec3::new(x, y, if up { 1.0 } else { -1.0 }).normalized())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Against the light itself, mirror by mirror: the mean over a whole cell of the lattice.
        #[test]
        fn the_mean_of_the_light_by_light_model_is_this(
            parameters in plate(),
            direction in direction(),
            start in (-5.0..5.0f64, -5.0..5.0f64),
        ) {
            let plate = SlitMirrorPlate::new(parameters).unwrap();
            const EACH: usize = 200;
            let (mut sum, mut real) = ([0.0; 2], 0);
            for index in 0..EACH * EACH {
                let of_cell = [index % EACH, index / EACH].map(|i| (i as f64 + 0.5) / EACH as f64);
                let [x, y] = plate.across_inverse(of_cell.map(|c| c * parameters.pitch));
                let point = Vec3::new(start.0 + x, start.1 + y, 0.0);
                let Some(passage) = plate.pass(point, direction) else { continue };
                if passage.class != Class::Real {
                    continue;
                }
                real += 1;
                // Back along the line to the mid-plane.
                let back = passage.exit_point.z / passage.direction.z;
                let there = passage.exit_point - passage.direction * back;
                sum[0] += there.x - point.x;
                sum[1] += there.y - point.y;
            }
            prop_assume!(real > EACH * EACH / 20);
            let shift = LayerPlanes::new(&parameters).shift(direction);
            for axis in 0..2 {
                let mean = sum[axis] / f64::from(real as u32);
                // 200 offsets each way: the ends of the open range are known to half a step, which moves a mean over a
                // twentieth of the cell or more by about a step.
                let step = parameters.pitch / EACH as f64;
                prop_assert!((mean - shift[axis]).abs() < 2.0 * step, "{mean} {shift:?}");
            }
        }

        /// The way back is the same line: light behind the plate, sent back, leaves where it came from.
        #[test]
        fn light_goes_the_same_way_back(parameters in plate(), d in direction()) {
            let planes = LayerPlanes::new(&parameters);
            let n = Vec3::new(0.0, 0.0, 1.0);
            let there = planes.shift(d);
            let back = planes.shift(-pass_ideal(d, n));
            for axis in 0..2 {
                // A few roundings of numbers below 10.
                prop_assert!((there[axis] + back[axis]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn derivatives_are_differences() {
        let planes = LayerPlanes::new(&SlitMirror { azimuth: 30.0, ..SlitMirror::default() });
        let at = |u: f64, v: f64| Vec3::new(0.3 + u, -0.4 + v, -0.9).normalized();
        let dual = |value: f64, which| Dual::<2>::variable(value, which);
        let d = Vec3 { x: dual(0.0, 0) + 0.3, y: dual(0.0, 1) + -0.4, z: Dual::constant(-0.9) }
            .normalized();
        let shift = planes.shift(d);
        let h = 1e-6;
        for axis in 0..2 {
            let by_u =
                (planes.shift(at(h, 0.0))[axis] - planes.shift(at(-h, 0.0))[axis]) / (2.0 * h);
            let by_v =
                (planes.shift(at(0.0, h))[axis] - planes.shift(at(0.0, -h))[axis]) / (2.0 * h);
            // Central differences err by h^2 and by rounding over h: 1e-10.
            assert!((shift[axis].d[0] - by_u).abs() < 1e-9, "{shift:?}");
            assert!((shift[axis].d[1] - by_v).abs() < 1e-9, "{shift:?}");
        }
    }
}
