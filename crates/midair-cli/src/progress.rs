//! How far long work is, on a terminal.

use crate::output::is_stopped;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use midair::Monitor;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A progress bar on standard error; nothing where that is not a terminal.
#[derive(Debug)]
pub struct Bar(Mutex<Option<ProgressBar>>);

impl Bar {
    /// A bar without a stage yet.
    pub fn new() -> Self {
        Self(Mutex::new(None))
    }

    fn change(&self, change: impl FnOnce(&mut Option<ProgressBar>)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.change(|bar| {
            if let Some(bar) = bar.take() {
                bar.finish_and_clear();
            }
        });
    }
}

impl Monitor for Bar {
    fn is_cancelled(&self) -> bool {
        is_stopped()
    }

    fn stage(&self, name: &str, steps: usize) {
        self.finish();
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
        self.change(|current| *current = Some(bar));
    }

    fn advance(&self, steps: usize) {
        self.change(|bar| {
            if let Some(bar) = bar {
                bar.inc(steps as u64);
            }
        });
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.finish();
    }
}
