//! What keys do.

use crate::show::Show;
use midair::geometry::Vec3;
use midair::map::format::write_bytes_atomically;
use midair::scene::to_toml;
use midair_live::{Nudge, Steady};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use winit::event_loop::ActiveEventLoop;
use winit::keyboard::{Key, NamedKey};
use winit::window::Fullscreen;

impl Show {
    pub fn key(&mut self, key: &Key, events: &ActiveEventLoop) {
        let step = if self.modifiers.shift_key() { 1.0 } else { 0.1 };
        let turn = self.modifiers.control_key();
        // Along x and y the arrows move what they point to; a turn by an arrow moves the front that way.
        let nudge = |axis: usize, sign: f64| Some(Nudge { axis, by: sign * step, turn });
        let nudge = match (key, turn) {
            (Key::Named(NamedKey::ArrowRight), false) => nudge(0, 1.0),
            (Key::Named(NamedKey::ArrowLeft), false) => nudge(0, -1.0),
            (Key::Named(NamedKey::ArrowUp), false) => nudge(1, 1.0),
            (Key::Named(NamedKey::ArrowDown), false) => nudge(1, -1.0),
            (Key::Named(NamedKey::ArrowRight), true) => nudge(1, 1.0),
            (Key::Named(NamedKey::ArrowLeft), true) => nudge(1, -1.0),
            (Key::Named(NamedKey::ArrowUp), true) => nudge(0, -1.0),
            (Key::Named(NamedKey::ArrowDown), true) => nudge(0, 1.0),
            (Key::Named(NamedKey::PageUp), _) => nudge(2, 1.0),
            (Key::Named(NamedKey::PageDown), _) => nudge(2, -1.0),
            _ => None,
        };
        if let Some(nudge) = nudge {
            let mut moved = (*self.loaded).clone();
            nudge.apply(&mut moved, self.target);
            self.loaded = Arc::new(moved);
            return self.ask(None);
        }
        match key {
            Key::Named(NamedKey::Escape) => events.exit(),
            Key::Named(NamedKey::Space) => drop(self.paused.fetch_xor(true, Ordering::Relaxed)),
            Key::Named(NamedKey::Tab) => {
                self.target = self.target.next(self.loaded.scene.elements.len());
                self.draw();
            }
            Key::Character(character) => match character.to_lowercase().as_str() {
                "q" => events.exit(),
                "l" => {
                    self.show_lattice = !self.show_lattice;
                    self.ask(None);
                }
                "u" => {
                    self.uncompensated = !self.uncompensated;
                    self.ask(None);
                }
                "o" => {
                    self.show_overlay = !self.show_overlay;
                    self.draw();
                }
                "f" => {
                    if let Some(screen) = &self.screen {
                        let full = screen.window.fullscreen().is_some();
                        screen
                            .window
                            .set_fullscreen((!full).then_some(Fullscreen::Borderless(None)));
                        screen.window.set_cursor_visible(full);
                    }
                }
                "c" => self.calibrate(),
                "s" => self.save(),
                _ => {}
            },
            _ => {}
        }
    }

    /// Takes the viewer to be at the scene's viewpoint now.
    fn calibrate(&mut self) {
        if let Some((reading, _)) = self.tracked {
            let viewpoint = Vec3::from_array(self.loaded.scene.viewpoint);
            self.calibration = self.calibration.taking(&reading, viewpoint);
            self.steady = Steady::new(self.options.smoothing);
            self.tracked = Some((reading, viewpoint));
            self.ask(None);
            self.say("the tracker's present reading is the scene's viewpoint".to_owned());
        }
    }

    fn save(&mut self) {
        let path = self.options.save_to.clone();
        match write_bytes_atomically(&path, to_toml(&self.loaded.scene).as_bytes()) {
            Ok(()) => {
                self.say(format!("saved {}", path.display()));
                if !self.saved.contains(&path) {
                    self.saved.push(path);
                }
            }
            Err(error) => self.say(error.to_string()),
        }
        self.draw();
    }
}
