//! One map for several viewpoints at once: the compromise, and what it leaves.

use crate::error::Error;
use crate::geometry::Vec3;
use crate::map::{Accuracy, Counts, Map, Status, invert};
use crate::monitor::Monitor;
use crate::transport::Setup;
use serde::{Serialize, Serializer};

/// One map for several viewpoints, and what it leaves at each; serialised, its figures.
#[derive(Clone, Debug)]
pub struct Eyebox {
    /// The compromise.
    pub map: Map,
    /// The viewpoints, in their order.
    pub eyes: Vec<Eye>,
}

/// A viewpoint of an [`Eyebox`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Eye {
    /// Where it is, mm.
    pub position: [f64; 3],
    /// What the compromise leaves here.
    #[serde(rename = "compromise_mm")]
    pub compromise: Remaining,
    /// What the map of the scene's viewpoint alone leaves here.
    #[serde(rename = "single_mm")]
    pub single: Remaining,
}

/// Maps that may be held at once: pixels of them all.
const MOST_PIXELS: usize = 1 << 27;

/// Whether the maps of so many viewpoints can be held at once.
///
/// # Errors
/// [`Error`] of kind `Request` where they are too much.
pub fn check_count(setup: &Setup, viewpoints: usize) -> Result<(), Error> {
    let [width, height] = setup.resolution;
    match viewpoints.saturating_add(1).saturating_mul(width * height) > MOST_PIXELS {
        true => Err(Error::request(
            format!("{viewpoints} maps of {width} x {height} pixels are too much to hold"),
            "ask for fewer viewpoints, or a smaller display resolution",
        )),
        false => Ok(()),
    }
}

/// The compromise for several viewpoints.
///
/// # Errors
/// [`Error`] of kind `Request` where there is no viewpoint, or so many that [`check_count`] refuses them.
pub fn eyebox(setup: &Setup, eyes: &[Vec3], monitor: &dyn Monitor) -> Result<Eyebox, Error> {
    check_count(setup, eyes.len())?;
    monitor.stage("maps", eyes.len() + 1);
    let map_from = |viewpoint: Vec3| -> Map {
        let (map, _) = invert(&setup.with_viewpoint(viewpoint), Accuracy::default());
        monitor.advance(1);
        map
    };
    let alone = map_from(setup.viewpoint);
    let maps: Vec<Map> = eyes.iter().map(|&eye| map_from(eye)).collect();
    let Some(map) = compromise(&maps) else {
        return Err(Error::request("there is no viewpoint", "give two or more"));
    };
    let size = setup.image.size;
    let eyes = eyes.iter().zip(&maps).map(|(eye, own)| Eye {
        position: eye.to_array(),
        compromise: remaining(&map, own, size),
        single: remaining(&alone, own, size),
    });
    let eyes = eyes.collect();
    Ok(Eyebox { map, eyes })
}

impl Eyebox {
    /// Root mean square over all viewpoints and pixels, mm: of the compromise, and of the map of the scene's viewpoint alone; NaN without pixels.
    pub fn rms(&self) -> [f64; 2] {
        let over = |of: fn(&Eye) -> &Remaining| {
            let known = || self.eyes.iter().map(of).filter(|left| left.pixels > 0);
            let squares: f64 = known().map(|left| left.rms.powi(2) * left.pixels as f64).sum();
            (squares / known().map(|left| left.pixels as f64).sum::<f64>()).sqrt()
        };
        [over(|eye| &eye.compromise), over(|eye| &eye.single)]
    }
}

impl Serialize for Eyebox {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct All {
            compromise_rms_mm: f64,
            single_rms_mm: f64,
        }
        #[derive(Serialize)]
        struct Told<'a> {
            size: [usize; 2],
            status: Counts,
            viewpoints: &'a [Eye],
            all: All,
        }
        let [compromise_rms_mm, single_rms_mm] = self.rms();
        let told = Told {
            size: [self.map.width, self.map.height],
            status: self.map.counts(),
            viewpoints: &self.eyes,
            all: All { compromise_rms_mm, single_rms_mm },
        };
        told.serialize(serializer)
    }
}

/// The axes across the line of sight from the viewpoint to the image's centre: to the viewer's right, and up. Where the viewer
/// looks along the vertical the image's own right takes its place.
pub fn across(setup: &Setup) -> [Vec3; 2] {
    let sight = (setup.image.frame.origin - setup.viewpoint).normalized();
    let vertical = Vec3::new(0.0, 1.0, 0.0);
    let right = sight.cross(vertical);
    let right =
        if right.dot(right) > 1e-12 { right.normalized() } else { setup.image.frame.axes[0] };
    [right, right.cross(sight)]
}

/// The two eyes of a viewer whose middle is the viewpoint, `ipd` mm apart: the left one first.
pub fn two_eyes(setup: &Setup, ipd: f64) -> Vec<Vec3> {
    let [right, _] = across(setup);
    [-0.5, 0.5].map(|half| setup.viewpoint + right * (half * ipd)).to_vec()
}

/// Viewpoints over a rectangle of `size` mm around the viewpoint, square to the line of sight: `columns` x `rows` of them, its
/// corners included, from the upper left.
pub fn region(setup: &Setup, size: [f64; 2], [columns, rows]: [usize; 2]) -> Vec<Vec3> {
    let [right, up] = across(setup);
    let at = |i: usize, n: usize| if n < 2 { 0.0 } else { i as f64 / (n - 1) as f64 - 0.5 };
    let row = |j: usize| {
        (0..columns).map(move |i| right * (at(i, columns) * size[0]) - up * (at(j, rows) * size[1]))
    };
    (0..rows).flat_map(row).map(|offset| setup.viewpoint + offset).collect()
}

/// The map of least squared displacement over several viewpoints, given the maps of each, all of one size.
///
/// Seen from viewpoint k a display pixel stands at G_k; showing the image point u there displaces it by G_k - u on
/// the image's plane. The sum of squares is least at the mean of the G_k that exist. A pixel is `Folded` if any of them is; without any it is
/// `Blocked` if one of them is. The bound is infinite: no viewpoint is served exactly.
///
/// `None` if there is no map, or their sizes differ.
pub fn compromise(maps: &[Map]) -> Option<Map> {
    let first = maps.first()?;
    if maps.iter().any(|map| (map.width, map.height) != (first.width, first.height)) {
        return None;
    }
    let mut result = Map::unanswered(first.width, first.height);
    result.error_bound = f64::INFINITY;
    for i in 0..result.uv.len() {
        let (mut sum, mut count) = ([0.0; 2], 0);
        let mut status = Status::Outside;
        for map in maps {
            match map.status[i] {
                Status::Ok | Status::Folded => {
                    (0..2).for_each(|axis| sum[axis] += map.uv[i][axis]);
                    count += 1;
                }
                Status::Blocked => status = Status::Blocked,
                Status::Outside => {}
            }
        }
        if count > 0 {
            result.uv[i] = sum.map(|value| value / f64::from(count));
            let folded = maps.iter().any(|map| map.status[i] == Status::Folded);
            status = if folded { Status::Folded } else { Status::Ok };
        }
        result.status[i] = status;
    }
    Some(result)
}

/// What displacement a map leaves for a viewpoint, over the display's pixels, in mm on the image's plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Remaining {
    /// Pixels that both have an answer.
    pub pixels: usize,
    /// Root of the mean square; NaN without pixels, as the others.
    pub rms: f64,
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
}

/// The displacement that remains for the viewpoint whose own map is `own` if the display shows what `shown` says; the image is
/// `size` mm large. Both maps are of one size.
pub fn remaining(shown: &Map, own: &Map, size: [f64; 2]) -> Remaining {
    let (mut pixels, mut sum, mut squares, mut max) = (0_u32, 0.0, 0.0, 0.0f64);
    for pixel in 0..shown.uv.len().min(own.uv.len()) {
        let (Some(a), Some(b)) = (shown.answer(pixel), own.answer(pixel)) else { continue };
        let off = ((a[0] - b[0]) * size[0]).hypot((a[1] - b[1]) * size[1]);
        pixels += 1;
        sum += off;
        squares += off * off;
        max = max.max(off);
    }
    let count = f64::from(pixels);
    let max = if pixels > 0 { max } else { f64::NAN };
    Remaining { pixels: pixels as usize, rms: (squares / count).sqrt(), mean: sum / count, max }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::bench_setup::{ACRYLIC, element, setup, sphere};

    fn maps(setup: &Setup, eyes: &[Vec3]) -> Vec<Map> {
        let map = |&viewpoint| invert(&setup.with_viewpoint(viewpoint), Accuracy::default()).0;
        eyes.iter().map(map).collect()
    }

    fn ball() -> Setup {
        let mut setup = setup(20.0, vec![element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 0)]);
        setup.resolution = [60, 60];
        setup
    }

    #[test]
    fn viewpoints_stand_where_they_should() {
        let setup = ball();
        let eyes = two_eyes(&setup, 64.0);
        assert_eq!([eyes[0].x, eyes[1].x], [-32.0, 32.0]);
        let grid = region(&setup, [100.0, 40.0], [3, 2]);
        let at: Vec<_> = grid.iter().map(|eye| [eye.x, eye.y, eye.z]).collect();
        assert_eq!(at[0], [-50.0, 20.0, 800.0]);
        assert_eq!(at[5], [50.0, -20.0, 800.0]);
        assert_eq!(region(&setup, [9.0, 9.0], [1, 1]), [setup.viewpoint]);
    }

    #[test]
    fn without_an_object_every_viewpoint_is_served() {
        let mut setup = setup(20.0, vec![]);
        setup.resolution = [40, 40];
        let maps = maps(&setup, &two_eyes(&setup, 64.0));
        let map = compromise(&maps).unwrap();
        for own in &maps {
            let left = remaining(&map, own, [20.0; 2]);
            // Twice the maps' tolerance of 1e-6, times 20 mm.
            assert!(left.pixels == 1600 && left.max < 4e-5, "{left:?}");
        }
    }

    #[test]
    fn no_other_map_leaves_less() {
        let setup = ball();
        let eyes = region(&setup, [80.0, 40.0], [3, 3]);
        let maps = maps(&setup, &eyes);
        let map = compromise(&maps).unwrap();
        let total = |shown: &Map| -> f64 {
            maps.iter()
                .map(|own| {
                    let left = remaining(shown, own, [20.0; 2]);
                    left.rms.powi(2) * left.pixels as f64
                })
                .sum()
        };
        // Only pixels that every map answers are compared.
        let mut common = map.clone();
        for i in 0..common.uv.len() {
            if maps.iter().any(|own| own.status[i] != Status::Ok) {
                common.uv[i] = [f64::NAN; 2];
            }
        }
        let masked = |map: &Map| {
            let mut map = map.clone();
            for (uv, keep) in map.uv.iter_mut().zip(&common.uv) {
                if keep[0].is_nan() {
                    *uv = [f64::NAN; 2];
                }
            }
            map
        };
        let best = total(&common);
        assert!(best > 0.1, "{best}");
        for own in &maps {
            assert!(total(&masked(own)) > best);
        }
        // And moved a little in any direction it is worse.
        for (du, dv) in [(1e-4, 0.0), (-1e-4, 0.0), (0.0, 1e-4), (0.0, -1e-4)] {
            let mut moved = common.clone();
            moved.uv.iter_mut().for_each(|uv| *uv = [uv[0] + du, uv[1] + dv]);
            assert!(total(&moved) > best);
        }
    }

    #[test]
    fn without_an_object_one_map_serves_as_well_as_many() {
        let mut setup = setup(20.0, vec![]);
        setup.resolution = [40, 40];
        let both = eyebox(&setup, &two_eyes(&setup, 64.0), &()).unwrap();
        let told = serde_json::to_value(&both).unwrap();
        assert_eq!(told["viewpoints"][0]["position"][0], -32.0);
        assert_eq!(told["status"]["ok"], 1600);
        for key in ["compromise_rms_mm", "single_rms_mm"] {
            // Twice the maps' tolerance of 1e-6, times 20 mm.
            assert!(told["all"][key].as_f64().unwrap() < 4e-5, "{told}");
        }
        assert!(eyebox(&setup, &[], &()).is_err());
        let crowd = vec![setup.viewpoint; MOST_PIXELS / 1600];
        assert!(eyebox(&setup, &crowd, &()).is_err());
    }

    #[test]
    fn maps_of_different_sizes_have_no_compromise() {
        assert!(compromise(&[]).is_none());
        assert!(compromise(&[Map::identity(2, 2), Map::identity(2, 3)]).is_none());
    }
}
