//! What is looked at in a set-up.

use crate::geometry::Vec3;
use crate::map::{Accuracy, ImagePoint, formation, invert, pixel_centre};
use crate::optics::plate::SlitMirrorPlate;
use crate::scene::model::PlateModel;
use crate::simulate::{Sights, share_along};
use crate::transport::{End, Path, Setup};
use serde::{Deserialize, Serialize};

/// The numbers said once: the struct, their names, and both ways between it and a list of them.
macro_rules! measured {
    ($($(#[$about:meta])* $name:ident),* $(,)?) => {
        /// What becomes of a set-up's image.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[non_exhaustive]
        pub struct Measured {
            $($(#[$about])* #[serde(with = "no_number")] pub $name: f64,)*
        }

        /// The names of a [`Measured`]'s numbers, in their order.
        pub const NAMES: [&str; [$(stringify!($name)),*].len()] = [$(stringify!($name)),*];

        impl Measured {
            /// The numbers, in the order of [`NAMES`].
            pub fn numbers(&self) -> [f64; NAMES.len()] {
                [$(self.$name),*]
            }

            pub(super) fn of_numbers([$($name),*]: [f64; NAMES.len()]) -> Self {
                Self { $($name),* }
            }
        }
    };
}

measured! {
    /// The share of the image that is formed.
    formed,
    /// The share whose display pixels are seen at other image points as well.
    folded,
    /// The share that ends by total internal reflection.
    total_reflection,
    /// The share that opaque parts stop.
    stopped,
    /// The share whose paths go past the plate or meet it from behind.
    missed_plate,
    /// The share whose paths go past the display.
    missed_display,
    /// Width times height of the image times the share that is formed, mm².
    formed_area,
    /// The least length on the image of a millimetre on the display, over the formed points and all directions; NaN without any.
    least_magnification,
    /// The largest.
    largest_magnification,
    /// The mean share of the display's light that arrives through the formed points; NaN without any.
    mean_gain,
    /// The least share over the largest.
    evenness,
    /// Light of stray images over the image, as a share of the image's own, through the scene's slit-mirror plate or the usual one.
    stray,
    /// How far the viewer may move to either side until a twentieth of the formed points is lost, while the display follows, mm.
    sideways,
    /// The same up and down.
    up_and_down,
}

/// So many of the numbers, from the first, are shares of the image: together they are all of it.
pub const SHARES: usize = 6;

/// JSON has no NaN: null.
mod no_number {
    use serde::{Deserialize as _, Deserializer, Serialize as _, Serializer};

    pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        value.is_finite().then_some(*value).serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
    }
}

impl Measured {
    /// How good it is, mm²: the area that is formed, times the share that it is of the image, so that half of a large image is no better than all of
    /// one with half the area; a tenth less where the dimmest point has a third of the brightest one's light, and less by the stray light.
    pub fn score(&self) -> f64 {
        let known = |value: f64, otherwise: f64| if value.is_finite() { value } else { otherwise };
        // 3 to the power of -0.1 is 0.9.
        let even = known(self.evenness, 1.0).max(1e-3).powf(0.1);
        self.formed_area * self.formed * even / (1.0 + known(self.stray, 0.0))
    }
}

/// Image points along a side where more than one ray is traced for each.
const COARSE: usize = 24;
/// Image points along a side whose visibility from elsewhere is asked for.
const SEEN: usize = 12;
/// The share of the formed points that may be lost.
const LOST: f64 = 0.05;
/// Halvings of the interval in which the image breaks.
const HALVINGS: usize = 8;

/// Looks at a set-up with a map and image points of `side` by `side`; `plate` is the scene's.
pub(super) fn measure(setup: &Setup, plate: &PlateModel, side: usize) -> Measured {
    let (map, _) = invert(setup, Accuracy::default());
    let image = formation(setup, &map, [side; 2]);
    let mut counts = [0usize; SHARES];
    for point in &image.points {
        let fate = match point {
            ImagePoint::Formed => 0,
            ImagePoint::Folded => 1,
            ImagePoint::TotalReflection(_) | ImagePoint::TooManyInteractions => 2,
            ImagePoint::Stopped(_) => 3,
            ImagePoint::MissedPlate | ImagePoint::PlateBehind => 4,
            ImagePoint::MissedDisplay => 5,
        };
        counts[fate] += 1;
    }
    let shares = counts.map(|count| count as f64 / image.points.len().max(1) as f64);
    let [formed, folded, total_reflection, stopped, missed_plate, missed_display] = shares;
    let [width, height] = setup.image.size;
    let [least_magnification, largest_magnification] = magnification(setup);
    let [mean_gain, evenness] = light(setup);
    let stray = SlitMirrorPlate::new(plate.slit_mirror_or_usual().0).map_or(f64::NAN, |plate| {
        Sights::new(setup, [COARSE; 2], 1.0).through(&plate, setup, &map).burden()
    });
    let [sideways, up_and_down] = reach(setup);
    Measured {
        formed,
        folded,
        total_reflection,
        stopped,
        missed_plate,
        missed_display,
        formed_area: width * height * formed,
        least_magnification,
        largest_magnification,
        mean_gain,
        evenness,
        stray,
        sideways,
        up_and_down,
    }
}

fn points(side: usize) -> Vec<[f64; 2]> {
    (0..side * side).map(|i| pixel_centre(i % side, i / side, side, side)).collect()
}

/// The least and the largest length on the image of a millimetre on the display: the reciprocals of the singular values of F in millimetres.
fn magnification(setup: &Setup) -> [f64; 2] {
    let ([w, h], [a, b]) = (setup.image.size, setup.display.size);
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for jacobian in setup.jacobians(&points(COARSE), End::formed) {
        let [[su, sv], [tu, tv]] = jacobian;
        let [su, sv, tu, tv] = [su * a / w, sv * a / h, tu * b / w, tv * b / h];
        // Of a matrix of two rows: the sum and the difference of its singular values are these two lengths.
        let (sum, difference) = ((su + tv).hypot(tu - sv), (su - tv).hypot(tu + sv));
        let (largest, least) = (0.5 * (sum + difference), 0.5 * (sum - difference).abs());
        if largest.is_finite() {
            range = [range[0].min(1.0 / largest), range[1].max(1.0 / least)];
        }
    }
    if range[0].is_finite() { range } else { [f64::NAN; 2] }
}

/// The mean share of light that arrives through formed points, and the least over the largest; of the three colours' mean.
fn light(setup: &Setup) -> [f64; 2] {
    let mut path = Path::new();
    let (mut sum, mut count, mut range) = (0.0, 0usize, [f64::INFINITY, 0.0_f64]);
    for uv in points(COARSE) {
        let formed = setup.transport(uv, &mut path).formed();
        let Some(share) = formed.and_then(|_| share_along(setup, uv, &path)) else { continue };
        let mean = share.iter().sum::<f64>() / 3.0;
        (sum, count) = (sum + mean, count + 1);
        range = [range[0].min(mean), range[1].max(mean)];
    }
    if count == 0 { [f64::NAN; 2] } else { [sum / count as f64, range[0] / range[1]] }
}

/// How far the viewer may move sideways and up or down, the nearer of both ways.
fn reach(setup: &Setup) -> [f64; 2] {
    let seen_from = |eye: Vec3, points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let there = setup.with_viewpoint(eye);
        let mut path = Path::new();
        let formed = |uv: &&[f64; 2]| there.transport(**uv, &mut path).formed().is_some();
        points.iter().filter(formed).copied().collect()
    };
    let formed = seen_from(setup.viewpoint, &points(SEEN));
    if formed.is_empty() {
        return [f64::NAN; 2];
    }
    let frame = &setup.image.frame;
    let distance = (setup.viewpoint - frame.origin).dot(frame.normal()).abs();
    let most = distance;
    let breaks = |by: Vec3| {
        seen_from(setup.viewpoint + by, &formed).len() as f64 <= (1.0 - LOST) * formed.len() as f64
    };
    let until = |direction: Vec3| -> f64 {
        // The image may come back farther off: the first break that steps of a sixteenth find counts.
        let steps = 16;
        let broken =
            (1..=steps).map(|k| most * k as f64 / steps as f64).find(|&at| breaks(direction * at));
        let Some(mut far) = broken else { return most };
        let mut near = far - most / steps as f64;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            if breaks(direction * middle) { far = middle } else { near = middle }
        }
        near
    };
    let [x, y, _] = frame.axes;
    [x, y].map(|axis| until(axis).min(until(-axis)))
}
