//! The gain that frames have divided out, kept near the viewer's.

use crate::solver::{COLOURS, LIVE_TOLERANCE};
use midair::geometry::Vec3;
use midair::map::{Accuracy, ImageGain, invert};
use midair::picture::{Evening, FrameEvening, Overflow};
use midair::simulate::{ImageGainWork, gain};
use midair::transport::Setup;
use std::sync::Arc;

/// What is divided out of frames. The gain is smooth where the map is, and changes less from eye to eye: while the viewer moves,
/// maps are shown with the gain of a moment ago, and the viewer's own is worked out in the time between them.
pub(crate) struct Brightness {
    /// How bright white is, over the display's: what the scene's own viewpoint allows. It stays while the viewer moves, for a picture whose
    /// brightness goes with the viewer's head is worse than one that clips at its most demanding pixels from aside.
    level: f64,
    /// The last gain, and the eye that it is for.
    last: Option<(Vec3, Arc<FrameEvening>)>,
    /// One that is being worked out, and its eye.
    work: Option<(Vec3, ImageGainWork)>,
}

/// The last gain is not shown to an eye that is further than this from its own, mm: then the map waits for a new one. A head of 300 mm/s
/// goes so far from one packet to the next of a tracker that sends 60 a second. On the paper's set-ups with a slit-mirror plate, whose light
/// goes with the direction, a gain from so far aside is within 4 % of the eye's own, which is four codes of 255 at white and
/// changes slowly over the image; with an ideal plate it is the same (a test holds it to both).
const FAR: f64 = 5.0;

/// A gain from as near as this, mm, is as good as the eye's own: on the same set-ups it is within 0.4 % of it, less than half a code, and
/// most of that is the grid's own error along the kinks of the plate's efficiency.
const SAME: f64 = 0.2;

/// Rows of the gain's grid that are worked out before somebody looks whether there is something more urgent: well below a millisecond.
const ROWS: usize = 4;

/// Columns of the display that the level is found with: it is the gain of the most demanding pixel or tenth of the pixels, and
/// gains change little between pixels.
const LEVEL_COLUMNS: usize = 320;

impl Brightness {
    pub fn new(setup: &Setup, [width, height]: [usize; 2], overflow: Overflow) -> Self {
        let columns = width.min(LEVEL_COLUMNS);
        let rows = (height * columns / width.max(1)).max(1);
        let small = setup.with_resolution([columns, rows]);
        let (map, _) = invert(&small, Accuracy { tolerance: LIVE_TOLERANCE });
        let level = Evening::for_white(&gain(&small, &map), overflow).level();
        Self { level, last: None, work: None }
    }

    /// The gain to show a map with at once: the last one, unless it is for an eye far away.
    pub fn at_hand(&mut self, setup: &Setup) -> Arc<FrameEvening> {
        loop {
            if let Some(evening) = self.near(FAR, setup.viewpoint) {
                return evening;
            }
            self.work.take_if(|(eye, _)| *eye != setup.viewpoint);
            self.work_out(setup, usize::MAX);
        }
    }

    /// Goes on a little with the gain of where the viewer is. It, once it is known.
    pub fn go_on(&mut self, setup: &Setup) -> Option<Arc<FrameEvening>> {
        let known = self.near(SAME, setup.viewpoint);
        if known.is_none() {
            self.work_out(setup, ROWS);
        }
        known
    }

    fn near(&self, distance: f64, eye: Vec3) -> Option<Arc<FrameEvening>> {
        let (of, evening) = self.last.as_ref()?;
        ((*of - eye).length() <= distance).then(|| Arc::clone(evening))
    }

    /// Works on. What was begun for an earlier eye is brought to its end, else a viewer who never rests would never get a newer gain.
    fn work_out(&mut self, setup: &Setup, rows: usize) {
        let begin = || (setup.viewpoint, ImageGainWork::new(setup.clone()));
        let (eye, work) = self.work.get_or_insert_with(begin);
        if let Some(gain) = work.go_on(rows) {
            self.last = Some((*eye, Arc::new(evening(&gain, self.level))));
            self.work = None;
        }
    }
}

fn evening(gain: &ImageGain, level: f64) -> FrameEvening {
    FrameEvening::new(gain, level, COLOURS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use midair::optics::plate::{Model, SlitMirror, SlitMirrorPlate};
    use midair::simulate::image_gain;

    fn set_up(name: &str) -> Setup {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let file = format!("../../scenes/paper/{name}.toml");
        let loaded = midair::scene::load(&root.join(file)).unwrap();
        Setup::new(&loaded).unwrap()
    }

    /// The largest difference that a gain for an eye so far aside, one way or another, makes over the image, as a share of the gain.
    fn off(name: &str, plate: &Model, aside: f64) -> f32 {
        let here = set_up(name).with_plate(plate.clone());
        let own = image_gain(&here);
        let places = (0..10_000).map(|i| [i % 100, i / 100].map(|i| (f64::from(i) + 0.5) / 100.0));
        let at =
            |gain: &ImageGain| -> Vec<f32> { places.clone().flat_map(|uv| gain.at(uv)).collect() };
        let (own, mut worst) = (at(&own), 0.0);
        for way in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let viewpoint = here.viewpoint + Vec3::from_array(way) * aside;
            let other = at(&image_gain(&here.with_viewpoint(viewpoint)));
            let off = own.iter().zip(&other).map(|(a, b)| (a - b).abs() / a);
            let known: Vec<f32> = off.filter(|off| off.is_finite()).collect();
            assert!(known.len() > 9_000, "{name}: {}", known.len());
            worst = known.into_iter().fold(worst, f32::max);
        }
        worst
    }

    #[test]
    fn a_gain_serves_eyes_nearby() {
        let real = SlitMirrorPlate::new(SlitMirror::default()).unwrap();
        // Without losses in the plate next to nothing depends on the eye.
        for (plate, far, same) in [(Model::Ideal, 1e-4, 1e-5), (Model::from(real), 0.04, 0.004)] {
            let worst = |aside: f64| {
                ["sphere", "cube", "cylinder", "bent-mirror-convex"]
                    .map(|name| off(name, &plate, aside))
            };
            let found = [FAR, SAME].map(worst);
            println!("{found:?}");
            let largest = found.map(|of| of.into_iter().fold(0.0, f32::max));
            assert!(largest[0] <= far && largest[1] <= same, "{largest:?}");
            // Eyes are told apart at all, and the bound is no wider than it need be.
            assert!(matches!(plate, Model::Ideal) || largest[0] > 0.5 * far, "{largest:?}");
        }
    }

    /// The evening of a gain that was worked out in one go.
    fn exact(brightness: &Brightness, setup: &Setup) -> FrameEvening {
        evening(&image_gain(setup), brightness.level)
    }

    #[test]
    fn a_moving_eye_is_served_from_nearby_and_a_resting_one_by_its_own() {
        let mut setup = set_up("sphere");
        let start = setup.viewpoint;
        let mut to = |x: f64| {
            setup.viewpoint = start + Vec3::new(x, 0.0, 0.0);
            setup.clone()
        };
        let mut kept = Brightness::new(&to(0.0), [64, 64], Overflow::Fit);
        let first = kept.at_hand(&to(0.0));
        assert_eq!(*first, exact(&kept, &to(0.0)));
        // Nearby, the last; there is something to work on.
        assert!(Arc::ptr_eq(&kept.at_hand(&to(0.9 * FAR)), &first));
        assert!(kept.go_on(&to(0.9 * FAR)).is_none());
        // The viewer moves on meanwhile: the gain that was begun is finished, and then the viewer's own.
        let mut steps = 0;
        let own = loop {
            steps += 1;
            if let Some(own) = kept.go_on(&to(0.9 * FAR + 0.6 * SAME)) {
                break own;
            }
        };
        assert_eq!(*own, exact(&kept, &to(0.9 * FAR)));
        // 65 rows, 4 at a time, after the first four.
        assert_eq!(steps, 17);
        let own = loop {
            if let Some(own) = kept.go_on(&to(0.9 * FAR + 1.1 * SAME)) {
                break own;
            }
        };
        assert_eq!(*own, exact(&kept, &to(0.9 * FAR + 1.1 * SAME)));
        assert!(Arc::ptr_eq(&kept.at_hand(&to(0.9 * FAR)), &own));
        // Far away, the eye's own at once, whatever was begun.
        assert!(kept.go_on(&to(0.0)).is_none());
        assert_eq!(*kept.at_hand(&to(-1.1 * FAR)), exact(&kept, &to(-1.1 * FAR)));
    }
}
