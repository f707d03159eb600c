//! How far long work is: a bar on a terminal, and off one (a log, a pipe) a line every ten seconds.

use crate::output::is_stopped;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use midair::Monitor;
use std::io::{IsTerminal as _, Write as _};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Progress on standard error.
#[derive(Debug)]
pub struct Bar {
    stage: Mutex<Option<Stage>>,
    is_terminal: bool,
}

/// A stage of the work under way.
#[derive(Debug)]
enum Stage {
    /// A bar that draws itself anew.
    Drawn(ProgressBar),
    Told(Lines),
}

/// Between two lines.
const PAUSE: Duration = Duration::from_secs(10);

/// A stage that is told in lines.
#[derive(Debug)]
struct Lines {
    name: String,
    steps: usize,
    done: usize,
    began: Instant,
    /// When the last line was written, of this stage or of one before.
    told: Instant,
}

impl Lines {
    /// What is to be said now, if it is time.
    fn advance(&mut self, steps: usize, now: Instant) -> Option<String> {
        self.done += steps;
        if now.duration_since(self.told) < PAUSE {
            return None;
        }
        self.told = now;
        let share = self.done as f64 / self.steps.max(1) as f64;
        let spent = now.duration_since(self.began).as_secs_f64();
        Some(match share {
            // Steps that took no longer than a line's pause tell nothing of what is left.
            share if share > 0.0 && share < 1.0 => {
                let left = (spent / share - spent).ceil();
                format!("{}: {:.0} %, about {left} s left", self.name, share * 100.0)
            }
            _ => self.name.clone(),
        })
    }
}

impl Bar {
    /// A bar without a stage yet.
    pub fn new() -> Self {
        Self { stage: Mutex::new(None), is_terminal: std::io::stderr().is_terminal() }
    }

    fn change<T>(&self, change: impl FnOnce(&mut Option<Stage>) -> T) -> T {
        change(&mut self.stage.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.change(|stage| {
            if let Some(Stage::Drawn(bar)) = stage.take() {
                bar.finish_and_clear();
            }
        });
    }

    fn draw(&self, name: &str, steps: usize) {
        let bar = ProgressBar::with_draw_target(Some(steps as u64), ProgressDrawTarget::stderr());
        let template = match steps {
            0 | 1 => "{msg} {spinner}",
            _ => "{msg:22} {bar:30} {percent:>3} %  {eta} left",
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(name.to_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
        self.change(|stage| *stage = Some(Stage::Drawn(bar)));
    }
}

/// A log that is full or closed does not end the work.
fn tell(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

impl Monitor for Bar {
    fn is_cancelled(&self) -> bool {
        is_stopped()
    }

    fn stage(&self, name: &str, steps: usize) {
        if self.is_terminal {
            self.finish();
            self.draw(name, steps);
            return;
        }
        let line = self.change(|stage| {
            let now = Instant::now();
            let told = match stage {
                Some(Stage::Told(before)) => before.told,
                _ => now,
            };
            let mut lines = Lines { name: name.to_owned(), steps, done: 0, began: now, told };
            let line = lines.advance(0, now);
            *stage = Some(Stage::Told(lines));
            line
        });
        line.iter().for_each(|line| tell(line));
    }

    fn advance(&self, steps: usize) {
        let line = self.change(|stage| match stage {
            Some(Stage::Drawn(bar)) => {
                bar.inc(steps as u64);
                None
            }
            Some(Stage::Told(lines)) => lines.advance(steps, Instant::now()),
            None => None,
        });
        line.iter().for_each(|line| tell(line));
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.finish();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_comes_every_ten_seconds_and_says_what_is_left() {
        let began = Instant::now();
        let after = |seconds: u64| began + Duration::from_secs(seconds);
        let mut lines =
            Lines { name: "light by light".to_owned(), steps: 60, done: 0, began, told: began };
        assert_eq!(lines.advance(10, after(9)), None);
        // 15 of 60 steps in 10 seconds: 30 for the rest.
        let told = lines.advance(5, after(10));
        assert_eq!(told.as_deref(), Some("light by light: 25 %, about 30 s left"));
        assert_eq!(lines.advance(15, after(19)), None);
        let told = lines.advance(15, after(21));
        assert_eq!(told.as_deref(), Some("light by light: 75 %, about 7 s left"));
    }

    #[test]
    fn a_stage_without_steps_is_named() {
        let began = Instant::now();
        let mut lines = Lines { name: "solving".to_owned(), steps: 1, done: 0, began, told: began };
        let told = lines.advance(0, began + PAUSE);
        assert_eq!(told.as_deref(), Some("solving"));
    }
}
