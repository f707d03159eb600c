//! Where the plate's stray images fall for the viewer, and how bright they are.

use crate::geometry::{Ray, Vec3};
use crate::map::{Map, pixel_at, pixel_centre};
use crate::optics::plate::{SlitMirror, SlitMirrorPlate, luminance};
use crate::transport::{Path, Setup};
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

/// Looks at the set-up through a plate of no thickness whose lattice is averaged over: where lines of sight lead on behind the plate, turned
/// by each kind of passage, and whether that is a lit part of the display. Elements before the plate bend stray light as they bend the
/// image's; behind the plate nothing stands.
pub fn stray_view(
    setup: &Setup,
    plate: &SlitMirrorPlate,
    map: &Map,
    size: [usize; 2],
    window: f64,
) -> StrayView {
    let frame = &setup.plate.frame;
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
    let of_pixel = |path: &mut Path, index: usize| -> [f64; 4] {
        let [s, t] = pixel_centre(index % size[0], index / size[0], size[0], size[1]);
        let ray = setup.ray([s, t].map(|c| (c - 0.5) * window + 0.5));
        setup.trace(ray, path);
        let Some(left) = setup.remainder(ray, path) else { return [0.0; 4] };
        let at = setup.plate.coordinates(left.at_plate.origin);
        if !at.iter().all(|c| (0.0..=1.0).contains(c)) {
            return [0.0; 4];
        }
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
            luminance([0, 1, 2].map(|c| share[c] * left.share[c]))
        };
        [seen([true, true]), seen(STRAY[0]), seen(STRAY[1]), seen(STRAY[2])]
    };
    let pixels: Vec<[f64; 4]> =
        (0..size[0] * size[1]).into_par_iter().map_init(Path::new, of_pixel).collect();
    let layer = |k: usize| pixels.iter().map(|pixel| pixel[k]).collect();
    StrayView { size, window, image: layer(0), stray: [layer(1), layer(2), layer(3)] }
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

/// The turn of the plate in its own plane that leaves the least stray light over the image: its mirrors' azimuth in degrees, and the view
/// then, like the one `seen_now`. Azimuths within `limits`, in steps of `step`; of equal ones the nearest to the present one.
///
/// The display's own place does not matter: only lit pixels throw stray light, and where those are is settled by the image.
pub fn best_azimuth(
    setup: &Setup,
    plate: &SlitMirrorPlate,
    map: &Map,
    seen_now: &StrayView,
    limits: [f64; 2],
    step: f64,
) -> (f64, StrayView) {
    let present = plate.parameters().azimuth;
    let steps = ((limits[1] - limits[0]) / step).floor().max(0.0) as usize;
    let mut azimuths: Vec<f64> = (0..=steps).map(|k| limits[0] + step * k as f64).collect();
    azimuths.sort_by(|a, b| (a - present).abs().total_cmp(&(b - present).abs()));
    let view = |azimuth: f64| {
        let turned = SlitMirror { azimuth, ..*plate.parameters() };
        let plate = SlitMirrorPlate::new(turned).unwrap_or_else(|_| plate.clone());
        stray_view(setup, &plate, map, seen_now.size, seen_now.window)
    };
    let mut best = (present, seen_now.clone());
    for azimuth in azimuths.into_iter().filter(|&azimuth| azimuth != present) {
        let seen = view(azimuth);
        // Differences of less than a hundredth are the grid's.
        let dimmer = seen.image.iter().sum::<f64>() < 0.5 * best.1.image.iter().sum::<f64>();
        if !dimmer && seen.burden() < best.1.burden() - 0.01 {
            best = (azimuth, seen);
        }
    }
    best
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
        let view = stray_view(&setup, &plate, &map(), [240, 240], window);
        let frame = &setup.plate.frame;
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

    #[test]
    fn a_turned_plate_is_never_worse() {
        let setup = setup(40.0, Vec::new());
        for azimuth in [0.0, 20.0, 45.0] {
            let plate =
                SlitMirrorPlate::new(SlitMirror { azimuth, ..SlitMirror::default() }).unwrap();
            let before = stray_view(&setup, &plate, &map(), [48, 48], 1.0);
            let (found, after) = best_azimuth(&setup, &plate, &map(), &before, [0.0, 90.0], 7.5);
            assert!(after.burden() <= before.burden(), "{azimuth} {found}");
            assert!((0.0..=90.0).contains(&found));
        }
    }
}
