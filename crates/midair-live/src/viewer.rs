//! Where the viewer is: readings made steady, held to what a scene allows, and given up when the tracker has lost them.

use crate::steady::{OneEuro, Steady};
use crate::tracker::{Calibration, Reading};
use midair::geometry::Vec3;
use midair::scene::{Loaded, validate_viewpoint};
use std::time::Duration;

/// Without a reading for so long, the viewer is lost.
pub(crate) const LOST: Duration = Duration::from_secs(2);

/// The viewer as a tracker tells.
#[derive(Clone, Debug)]
pub(crate) struct Viewer {
    pub calibration: Calibration,
    smoothing: Option<OneEuro>,
    steady: Steady,
    /// The last reading that counted, and the eye that was made of it.
    last: Option<(Reading, Vec3)>,
    /// When there was a reading last, be it one that was refused.
    heard: Option<Duration>,
    /// Why the last reading was refused.
    refusal: Option<String>,
}

impl Viewer {
    pub fn new(calibration: Calibration, smoothing: Option<OneEuro>) -> Self {
        let steady = Steady::new(smoothing);
        Self { calibration, smoothing, steady, last: None, heard: None, refusal: None }
    }

    /// The eye, while the tracker tells of one.
    pub fn eye(&self) -> Option<Vec3> {
        self.last.map(|(_, eye)| eye)
    }

    /// Why the last reading was refused; the eye is that of an earlier one.
    pub fn refusal(&self) -> Option<&str> {
        self.refusal.as_deref()
    }

    /// Takes a reading, and looks so many seconds ahead. Whether it counts.
    pub fn hear(&mut self, scene: &Loaded, reading: Reading, now: Duration, ahead: f64) -> bool {
        // What trackers send while they see nobody: their own place.
        if reading.position == Vec3::ZERO {
            let nobody = "the tracker tells its own place: it sees nobody";
            self.refusal = Some(nobody.to_owned());
            return false;
        }
        self.heard = Some(now);
        let measured = self.calibration.viewpoint(&reading);
        if let Err(error) = validate_viewpoint(scene, measured) {
            // No minus before a nought.
            let [x, y, z] = measured.to_array().map(|c| c.round() + 0.0);
            self.refusal = Some(format!("the eye at {x} {y} {z} mm is refused: {}", error.message));
            return false;
        }
        self.refusal = None;
        let steady = self.steady.follow(now, measured, ahead);
        // A place that is only expected may be one where no eye can be.
        let eye = if validate_viewpoint(scene, steady).is_ok() { steady } else { measured };
        self.last = Some((reading, eye));
        true
    }

    /// Gives the viewer up if the tracker has been silent for too long. Whether it has just been so.
    pub fn lose(&mut self, now: Duration) -> bool {
        let lost = self.lost_at().is_some_and(|then| now >= then);
        if lost {
            *self = Self::new(self.calibration, self.smoothing);
        }
        lost
    }

    /// When the viewer will be given up.
    pub fn lost_at(&self) -> Option<Duration> {
        self.last.and(self.heard).map(|heard| heard + LOST)
    }

    /// Takes the last reading to be this viewpoint. False without a reading.
    pub fn calibrate(&mut self, viewpoint: Vec3) -> bool {
        let Some((reading, _)) = self.last else { return false };
        self.calibration = self.calibration.taking(&reading, viewpoint);
        self.steady = Steady::new(self.smoothing);
        self.last = Some((reading, viewpoint));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use midair::scene::load;

    fn cube() -> Loaded {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        load(&root.join("../../scenes/paper/cube.toml")).unwrap()
    }

    fn reading(x: f64, y: f64, z: f64) -> Reading {
        Reading { position: Vec3::new(x, y, z), angles: [0.0; 3] }
    }

    fn viewer() -> Viewer {
        Viewer::new(Calibration::new([0.0; 3], [0.0; 3]), None)
    }

    const S: fn(f64) -> Duration = Duration::from_secs_f64;

    #[test]
    fn readings_that_no_scene_allows_keep_the_last_eye() {
        let (scene, mut viewer) = (cube(), viewer());
        assert!(viewer.hear(&scene, reading(30.0, 0.0, 900.0), S(0.0), 0.0));
        let eye = viewer.eye();
        assert_eq!(eye, Some(Vec3::new(30.0, 0.0, 900.0)));
        let refused = [
            (reading(5.0, 3.0, 2.0), "inside the element"),
            (reading(0.0, 0.0, -60.0), "faces away"),
            (reading(0.0, 0.0, 0.0), "sees nobody"),
        ];
        for (i, (reading, why)) in refused.into_iter().enumerate() {
            assert!(!viewer.hear(&scene, reading, S(0.1 + 0.1 * i as f64), 0.0));
            assert!(viewer.refusal().unwrap().contains(why), "{:?}", viewer.refusal());
            assert_eq!(viewer.eye(), eye);
        }
        assert!(viewer.hear(&scene, reading(31.0, 0.0, 900.0), S(0.5), 0.0));
        assert_eq!(viewer.refusal(), None);
    }

    #[test]
    fn a_tracker_that_falls_silent_loses_the_viewer() {
        let (scene, mut viewer) = (cube(), viewer());
        assert!(!viewer.lose(S(100.0)));
        viewer.hear(&scene, reading(30.0, 0.0, 900.0), S(100.0), 0.0);
        // A refused eye is one; the tracker's own place is none.
        viewer.hear(&scene, reading(5.0, 3.0, 2.0), S(101.0), 0.0);
        viewer.hear(&scene, reading(0.0, 0.0, 0.0), S(102.0), 0.0);
        assert!(!viewer.lose(S(102.9)) && viewer.eye().is_some());
        assert!(viewer.lose(S(103.0)) && viewer.eye().is_none());
        assert!(!viewer.lose(S(104.0)));
    }

    #[test]
    fn what_is_expected_of_a_quick_viewer_is_no_place_within_the_cube() {
        let (scene, mut viewer) = (cube(), viewer());
        // Towards the cube, a metre a second: 0.3 s ahead it would be in it.
        for i in 0..40 {
            let z = 700.0 - 10.0 * f64::from(i);
            viewer.hear(&scene, reading(0.0, 0.0, z), S(0.01 * f64::from(i)), 0.3);
            let eye = viewer.eye().unwrap();
            assert!(validate_viewpoint(&scene, eye).is_ok(), "{eye:?}");
        }
        assert_eq!(viewer.eye(), Some(Vec3::new(0.0, 0.0, 310.0)));
    }
}
