//! What somebody wants of the show: keys, nudges and their way back, the scene as it is to be saved.

use super::Show;
use crate::arrangement::Arrangement;
use crate::command::{Command, Wish};
use crate::tracker::Calibration;
use midair::geometry::Vec3;
use midair::scene::model::{Pose, Tracker};
use midair::scene::{SceneEdit, SceneError, validate, validate_viewpoint};
use std::sync::Arc;
use std::time::Duration;

/// So many steps can be taken back.
const STEPS: usize = 1000;

impl Show {
    /// What somebody wants.
    pub fn command(&mut self, command: Command, now: Duration) -> Option<Wish> {
        self.stale = true;
        match command {
            Command::End => return Some(Wish::End),
            Command::FillScreen => return Some(Wish::FillScreen),
            Command::Save => match self.scene_text() {
                Ok(text) => return Some(Wish::Save(text)),
                Err(error) => self.say(error.to_string(), now),
            },
            Command::Pause => self.paused = !self.paused,
            Command::Figures => self.figures = !self.figures,
            Command::Help => self.help = !self.help,
            Command::Lattice => {
                self.show_lattice = !self.show_lattice;
                self.ask(None, now);
            }
            Command::Uncompensated => {
                self.uncompensated = !self.uncompensated;
                self.ask(None, now);
            }
            Command::NextTarget => {
                self.target = self.target.next(self.loaded.scene.elements.len());
                self.nudged = Some(now);
            }
            Command::Nudge(nudge) => {
                let before = Arrangement::of(&self.loaded.scene);
                let mut after = before.clone();
                if after.nudge(nudge, self.target) && self.arrange(&after, now) {
                    self.history.push(before);
                    if self.history.len() > STEPS {
                        self.history.remove(0);
                    }
                }
            }
            Command::Undo => match self.history.pop() {
                Some(before) => drop(self.arrange(&before, now)),
                None => self.say("there is no step to take back".to_owned(), now),
            },
            Command::Reset => {
                let before = Arrangement::of(&self.loaded.scene);
                let original = self.original.clone();
                if before != original && self.arrange(&original, now) {
                    self.history.push(before);
                }
            }
            Command::Calibrate => {
                let viewpoint = Vec3::from_array(self.loaded.scene.viewpoint);
                if self.viewer.calibrate(viewpoint) {
                    self.ask(None, now);
                    self.say(
                        "the tracker's present reading is the scene's viewpoint".to_owned(),
                        now,
                    );
                } else {
                    self.say("there is no reading of a tracker".to_owned(), now);
                }
            }
        }
        None
    }

    /// Puts everything there if a scene file may say so. Whether it was done.
    fn arrange(&mut self, arrangement: &Arrangement, now: Duration) -> bool {
        let mut moved = (*self.loaded).clone();
        arrangement.put(&mut moved.scene);
        let eye = self.viewer.eye();
        let allowed = validate(&moved)
            .and_then(|()| eye.map_or(Ok(()), |eye| validate_viewpoint(&moved, eye)));
        self.nudged = Some(now);
        match allowed {
            Ok(()) => {
                self.loaded = Arc::new(moved);
                self.ask(None, now);
                true
            }
            Err(error) => {
                self.say(format!("not moved: {}", error.message), now);
                false
            }
        }
    }

    /// The scene as it is now, in the form of the file that it came from: comments and all.
    ///
    /// # Errors
    /// [`SceneError`] where the file's form does not allow it.
    pub fn scene_text(&self) -> Result<String, SceneError> {
        let mut scene = self.loaded.scene.clone();
        let file = &mut SceneEdit::of(&self.loaded.text)?;
        // The display's pixels are the window's; the file keeps its own.
        scene.display.resolution = file.scene().display.resolution;
        if self.settings.tracker.is_some() {
            let Calibration { position, rotation, offset } = self.viewer.calibration;
            let round = |v: f64| (v * 1000.0).round() / 1000.0;
            let offset = offset.to_array().map(round);
            scene.tracker = Some(Tracker { pose: Pose { position, rotation }, offset });
        }
        file.set_scene(&scene)?;
        Ok(file.text().to_owned())
    }

    /// What came of a [`Wish::Save`]: the file's name, or why it could not be written.
    pub fn saved(&mut self, outcome: Result<String, String>, now: Duration) {
        self.say(outcome.map_or_else(|why| why, |file| format!("saved {file}")), now);
    }
}
