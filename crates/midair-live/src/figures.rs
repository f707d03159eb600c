//! What is written over the picture.

use crate::arrangement::Arrangement;
use crate::command::KEYS;
use crate::show::{PATIENCE, Show};
use std::time::Duration;

impl Show {
    /// The lines of text over the picture; `renderer` names what makes it.
    pub fn lines(&self, renderer: &str, now: Duration) -> Vec<String> {
        let mut lines = Vec::new();
        if self.is_dark() {
            return lines;
        }
        if self.help {
            lines.extend(KEYS.map(|[key, what]| format!("{key:<18}  {what}")));
        }
        if self.figures {
            lines.extend(self.figures(renderer));
        }
        if self.figures || self.help || self.nudged.is_some() {
            lines.extend(self.amounts());
        }
        if !self.fits() && self.awaited.is_some_and(|since| now >= since + PATIENCE) {
            let [width, height] = self.size;
            lines.push(format!("the map for {width} x {height} pixels is being made"));
        }
        lines.extend(self.viewer.refusal().map(str::to_owned));
        lines.extend(self.message.as_ref().map(|(text, _)| text.clone()));
        lines
    }

    fn figures(&self, renderer: &str) -> Vec<String> {
        let rate = match (self.presented.front(), self.presented.back()) {
            (Some(first), Some(last)) if last > first => {
                (self.presented.len() - 1) as f64 / (*last - *first).as_secs_f64()
            }
            _ => 0.0,
        };
        let map = self.map.as_ref().map_or(0.0, |map| 1e3 * map.seconds);
        let mut lines = vec![format!("{rate:.0} frames/s   map {map:.1} ms"), renderer.to_owned()];
        if let Some(map) = &self.map {
            let (eye, followed) =
                (map.viewpoint, if self.viewer.eye().is_some() { " (followed)" } else { "" });
            lines.push(format!("eye {:.1} {:.1} {:.1} mm{followed}", eye.x, eye.y, eye.z));
        }
        if let Some(delay) = self.delay {
            lines.push(format!("packet to screen {:.1} ms", 1e3 * delay));
        }
        if self.map.as_ref().is_some_and(|map| map.evening.is_some()) {
            lines.push(format!("gain divided out, {:.1} % clipped", 100.0 * self.light.clipped));
        }
        if !self.fills_screen {
            lines.push("a window is not to scale: F fills the screen".to_owned());
        }
        if self.uncompensated {
            lines.push("uncompensated".to_owned());
        }
        if self.paused {
            lines.push("paused".to_owned());
        }
        lines
    }

    /// What is nudged, and how far it is from where the scene file has it.
    fn amounts(&self) -> Vec<String> {
        let name = self.target.name(&self.loaded.scene);
        let (moved, turned) =
            Arrangement::of(&self.loaded.scene).moved(&self.original, self.target);
        let told = |amounts: [f64; 3], unit: &str| {
            let [x, y, z] = amounts;
            format!("  x {x:+.1}  y {y:+.1}  z {z:+.1} {unit}")
        };
        let mut lines = vec![format!("nudging {name}")];
        lines.extend((moved != [0.0; 3]).then(|| told(moved, "mm")));
        lines.extend((turned != [0.0; 3]).then(|| told(turned, "degrees")));
        lines
    }
}
