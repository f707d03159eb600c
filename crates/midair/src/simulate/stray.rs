//! Where the plate's stray images fall for the viewer, and how bright they are.

use crate::geometry::{Ray, Vec3};
use crate::map::{Accuracy, Map, invert, pixel_at, pixel_centre};
use crate::optics::plate::{SlitMirror, SlitMirrorPlate, luminance};
use crate::transport::{Path, Remainder, Setup};
use rayon::prelude::*;

/// The three kinds of light that pass the plate without forming the image: turned across one layer's mirrors or the other's only
/// (stray images), or across neither (what is seen through the plate).
pub const STRAY: [[bool; 2]; 3] = [[true, false], [false, true], [false, false]];

/// What a viewer sees besides the mid-air image, while the display is white where the map has an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct StrayView {
    /// Width and height of the view in pixels.
    pub size: [usize; 2],
    /// How much of the image's plane is shown: 1 is the image exactly.
    pub window: f64,
    /// Luminance of the image itself, over the display's; row 0 at the top.
    pub image: Vec<f64>,
    /// Luminance of each kind of [`STRAY`] light.
    pub stray: [Vec<f64>; 3],
}

/// The lines of sight of a viewer who looks at the image's plane, as they meet the plate: what the plate and the display
/// then make of them takes no more tracing.
#[derive(Clone, Debug)]
pub struct Sights {
    size: [usize; 2],
    window: f64,
    /// `None` where a line does not meet the plate.
    lines: Vec<Option<Remainder>>,
}

impl Sights {
    /// The viewpoint's lines through `size` places of the image's plane, of which `window` times the image's width and height is shown.
    pub fn new(setup: &Setup, size: [usize; 2], window: f64) -> Self {
        let line = |path: &mut Path, index: usize| {
            let [s, t] = pixel_centre(index % size[0], index / size[0], size[0], size[1]);
            let ray = setup.ray([s, t].map(|c| (c - 0.5) * window + 0.5));
            setup.trace(ray, path);
            let left = setup.remainder(ray, path)?;
            let at = setup.plate.rectangle.coordinates(left.at_plate.origin);
            at.iter().all(|c| (0.0..=1.0).contains(c)).then_some(left)
        };
        let lines = (0..size[0] * size[1]).into_par_iter().map_init(Path::new, line).collect();
        Self { size, window, lines }
    }

    /// Looks through a plate of no thickness whose lattice is averaged over: where lines of sight lead on behind the plate, turned by each
    /// kind of passage, and whether that is a lit part of the display. Elements before the plate bend stray light as they bend the
    /// image's; behind the plate nothing stands. `setup` says where plate and display stand, `map` which of its pixels are lit.
    pub fn through(&self, plate: &SlitMirrorPlate, setup: &Setup, map: &Map) -> StrayView {
        let frame = &setup.plate.rectangle.frame;
        let lit = |ray: &Ray| -> bool {
            let distance = setup.display.plane_distance(ray);
            if !(distance > 0.0) || ray.direction.dot(setup.display.frame.normal()) >= 0.0 {
                return false;
            }
            let st = setup.display.coordinates(ray.at(distance));
            st.iter().all(|c| (0.0..=1.0).contains(c)) && {
                let (column, row) = pixel_at(st, map.width, map.height);
                map.status[row * map.width + column].is_answered()
            }
        };
        let of_line = |line: &Option<Remainder>| -> [f64; 4] {
            let Some(left) = line else { return [0.0; 4] };
            let d = frame.to_local_direction(left.at_plate.direction);
            let seen = |odd: [bool; 2]| -> f64 {
                let along = plate.across([d.x, d.y]);
                let [x, y] =
                    plate.across_inverse([0, 1].map(|k| if odd[k] { -along[k] } else { along[k] }));
                let direction = frame.to_world_direction(Vec3::new(x, y, d.z));
                if !lit(&Ray { origin: left.at_plate.origin, direction }) {
                    return 0.0;
                }
                let share = plate.share(d, odd);
                let emitted = setup.emitted_against(direction);
                luminance([0, 1, 2].map(|c| share[c] * left.share[c] * emitted[c]))
            };
            [seen([true, true]), seen(STRAY[0]), seen(STRAY[1]), seen(STRAY[2])]
        };
        let pixels: Vec<[f64; 4]> = self.lines.par_iter().map(of_line).collect();
        let layer = |k: usize| pixels.iter().map(|pixel| pixel[k]).collect();
        StrayView {
            size: self.size,
            window: self.window,
            image: layer(0),
            stray: [layer(1), layer(2), layer(3)],
        }
    }
}

impl StrayView {
    /// Share of the image that this kind of stray light lies over.
    pub fn covered(&self, kind: usize) -> f64 {
        let (mut formed, mut over) = (0usize, 0usize);
        for (image, stray) in self.image.iter().zip(&self.stray[kind]) {
            formed += usize::from(*image > 0.0);
            over += usize::from(*image > 0.0 && *stray > 0.0);
        }
        over as f64 / formed.max(1) as f64
    }

    /// Luminance of this kind of stray light, where it is seen at all, over the image's mean: how bright its brightest place is.
    pub fn brightness(&self, kind: usize) -> f64 {
        let lit = || self.image.iter().filter(|l| **l > 0.0);
        let mean = lit().sum::<f64>() / lit().count().max(1) as f64;
        let most = self.stray[kind].iter().copied().fold(0.0, f64::max);
        if mean > 0.0 { most / mean } else { 0.0 }
    }

    /// Places at which the image is seen.
    fn formed(&self) -> usize {
        self.image.iter().filter(|light| **light > 0.0).count()
    }

    /// How much stray light lies over the image, over the image's own light: what turning the plate is to make small.
    pub fn burden(&self) -> f64 {
        let image: f64 = self.image.iter().sum();
        let over = |kind: &Vec<f64>| -> f64 {
            kind.iter().zip(&self.image).filter(|(_, image)| **image > 0.0).map(|(s, _)| s).sum()
        };
        let stray: f64 = self.stray.iter().map(over).sum();
        if image > 0.0 { stray / image } else { 0.0 }
    }
}

/// Which poses [`best_pose`] tries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseLimits {
    /// Least and largest azimuth of the plate's mirrors, degrees.
    pub azimuth: [f64; 2],
    /// Between azimuths, degrees.
    pub azimuth_step: f64,
    /// Least and largest shift of the display along its normal, mm; positive: towards the plate.
    pub shift: [f64; 2],
    /// Between shifts, mm.
    pub shift_step: f64,
}

/// A pose that leaves less stray light over the image.
#[derive(Clone, Debug, PartialEq)]
pub struct BestPose {
    /// Azimuth of the plate's mirrors, degrees.
    pub azimuth: f64,
    /// How far the display stands along its normal from where it is now, mm; positive: towards the plate.
    pub shift: f64,
    /// What is then seen.
    pub view: StrayView,
}

/// The coarsest map that tells lit from dark well enough: a line of sight in 256 may be wrong at each edge.
const LIT: usize = 256;

/// Poses whose burdens differ by less are equal: the grid's own uncertainty.
const WORTH: f64 = 0.01;

/// The turn of the plate in its own plane, and the shift of the display along its normal, that leave the least stray light over the image. Of poses that are
/// equal but for a hundredth, the nearest to the present one: the plate is turned rather than the display shifted.
///
/// A shift of the display within its own plane is not tried: the lit part stays where it is in space, so nothing changes as long as the display
/// holds it. Poses that form less of the image, or make it half as bright, are passed over.
///
/// `map` and `now` are the set-up's map and what is seen now through `plate`.
pub fn best_pose(
    setup: &Setup,
    plate: &SlitMirrorPlate,
    map: &Map,
    sights: &Sights,
    limits: &PoseLimits,
) -> BestPose {
    let present = plate.parameters().azimuth;
    let now = sights.through(plate, setup, map);
    // A lit edge is uncertain by half a pixel of the map at four sides: 1.6 % at most of a display that is lit all over.
    let formed = 0.97 * now.formed() as f64;
    let bright = 0.5 * now.image.iter().sum::<f64>();
    let mut best = BestPose { azimuth: present, shift: 0.0, view: now };
    let azimuths = nearest_first(limits.azimuth, limits.azimuth_step, present);
    for shift in nearest_first(limits.shift, limits.shift_step, 0.0) {
        if best.view.burden() <= WORTH {
            break;
        }
        let shifted = shifted(setup, shift);
        let solved;
        let map = if shift == 0.0 {
            map
        } else {
            solved = invert(&shifted, Accuracy::default()).0;
            &solved
        };
        for &azimuth in &azimuths {
            let Ok(turned) = SlitMirrorPlate::new(SlitMirror { azimuth, ..*plate.parameters() })
            else {
                continue;
            };
            let view = sights.through(&turned, &shifted, map);
            let sound = view.formed() as f64 >= formed && view.image.iter().sum::<f64>() >= bright;
            if sound && view.burden() < best.view.burden() - WORTH {
                best = BestPose { azimuth, shift, view };
            }
        }
    }
    best
}

/// The set-up with its display moved along its normal (towards the plate: positive), with no more pixels than are needed to
/// tell lit from dark.
fn shifted(setup: &Setup, shift: f64) -> Setup {
    let mut there = setup.clone();
    let frame = &mut there.display.frame;
    frame.origin = frame.origin + frame.normal() * shift;
    there.resolution = there.resolution.map(|side| side.min(LIT));
    there
}

/// Values from `low` to `high` in steps, and the present one, the nearest to it first.
fn nearest_first([low, high]: [f64; 2], step: f64, present: f64) -> Vec<f64> {
    let steps = ((high - low) / step).floor().max(0.0) as usize;
    let mut values: Vec<f64> = (0..=steps).map(|k| low + step * k as f64).collect();
    values.push(present);
    values.sort_by(|a, b| (a - present).abs().total_cmp(&(b - present).abs()));
    values.dedup();
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::bench_setup::setup;

    /// All of the display lit.
    fn map() -> Map {
        Map::identity(64, 64)
    }

    #[test]
    fn light_is_seen_where_the_thin_plate_says() {
        let setup = setup(40.0, Vec::new());
        let plate =
            SlitMirrorPlate::new(SlitMirror { azimuth: 30.0, ..SlitMirror::default() }).unwrap();
        let window = 12.0;
        let view = Sights::new(&setup, [240, 240], window).through(&plate, &setup, &map());
        let frame = &setup.plate.rectangle.frame;
        let eye = frame.to_local(setup.viewpoint);
        let source = frame.to_local(setup.display.frame.origin);
        let mut found = 0;
        for (kind, odd) in STRAY.into_iter().enumerate() {
            // The middle of the display, by the closed form for a thin plate, against the middle of what is lit.
            let Some([x, y]) = plate.thin_crossing(source, eye, odd) else { continue };
            let crossing = frame.to_world(Vec3::new(x, y, 0.0));
            let ray = Ray {
                origin: setup.viewpoint,
                direction: (crossing - setup.viewpoint).normalized(),
            };
            let uv = setup.image.coordinates(ray.at(setup.image.plane_distance(&ray)));
            let place = uv.map(|c| (c - 0.5) / window + 0.5);
            // A display seen in part only has its middle elsewhere.
            if !place.iter().all(|c| (0.15..0.85).contains(c)) {
                continue;
            }
            let (column, row) = pixel_at(place, 240, 240);
            assert!(view.stray[kind][row * 240 + column] > 0.0, "{odd:?} at {place:?}");
            found += 1;
        }
        assert!(found >= 2, "only {found} kinds in the window");
        // The image itself: all of its square and nothing else.
        let lit = view.image.iter().filter(|l| **l > 0.0).count() as f64;
        assert!((lit / (240.0f64 / window).powi(2) - 1.0).abs() < 0.05, "{lit}");
    }

    const LIMITS: PoseLimits = PoseLimits {
        azimuth: [0.0, 90.0],
        azimuth_step: 7.5,
        shift: [-40.0, 40.0],
        shift_step: 20.0,
    };

    #[test]
    fn another_pose_is_never_worse() {
        let setup = setup(40.0, Vec::new());
        let sights = Sights::new(&setup, [48, 48], 1.0);
        for azimuth in [0.0, 20.0, 45.0] {
            let plate =
                SlitMirrorPlate::new(SlitMirror { azimuth, ..SlitMirror::default() }).unwrap();
            let before = sights.through(&plate, &setup, &map());
            let found = best_pose(&setup, &plate, &map(), &sights, &LIMITS);
            assert!(found.view.burden() <= before.burden(), "{azimuth} {found:?}");
            assert!((0.0..=90.0).contains(&found.azimuth) && found.shift.abs() <= 40.0);
        }
    }

    /// A display of three times the image's size, moved within its plane and along its normal: both in mm.
    fn with_display(shift: [f64; 3]) -> Setup {
        let mut setup = setup(40.0, Vec::new());
        setup.display.size = [120.0; 2];
        let [x, y, z] = setup.display.frame.axes;
        let by = x * shift[0] + y * shift[1] + z * shift[2];
        setup.display.frame.origin = setup.display.frame.origin + by;
        setup
    }

    #[test]
    fn a_display_moved_in_its_plane_throws_the_same_stray_light_and_one_moved_along_its_normal_does_not()
     {
        let azimuth = 10.0;
        let plate = SlitMirrorPlate::new(SlitMirror { azimuth, ..SlitMirror::default() }).unwrap();
        let seen = |shift: [f64; 3]| {
            let setup = with_display(shift);
            let map = invert(&setup, Accuracy::default()).0;
            Sights::new(&setup, [64, 64], 4.0).through(&plate, &setup, &map)
        };
        let differ = |a: &StrayView, b: &StrayView| -> usize {
            let layers = a.stray.iter().zip(&b.stray).flat_map(|(a, b)| a.iter().zip(b));
            layers.filter(|(a, b)| a != b).count()
        };
        let here = seen([0.0; 3]);
        let lit: usize = here.stray.iter().flatten().filter(|light| **light > 0.0).count();
        assert!(lit > 100, "{lit}");
        // Whole pixels of the map, so that the lit ones lie at the same places in space: 120 mm / 256.
        let pixel = 120.0 / 256.0;
        let aside = differ(&here, &seen([20.0 * pixel, -31.0 * pixel, 0.0]));
        // Places that lie on a pixel's edge may round to either side.
        assert!(aside <= lit / 200, "{aside} of {lit}");
        let nearer = differ(&here, &seen([0.0, 0.0, 30.0]));
        assert!(nearer > lit / 20, "{nearer} of {lit}");
    }

    #[test]
    fn poses_are_tried_from_the_nearest_on() {
        assert_eq!(nearest_first([-2.0, 2.0], 2.0, 0.0), [0.0, -2.0, 2.0]);
        assert_eq!(nearest_first([0.0, 1.0], 0.5, 0.2), [0.2, 0.0, 0.5, 1.0]);
    }
}
