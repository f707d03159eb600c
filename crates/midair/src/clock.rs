//! How long work takes, on any target.
//!
//! `std::time::Instant` traps where a target has no clock, as wasm32-unknown-unknown has none. There the host lends its own by
//! `lend`; without one, all work takes no time.

use std::time::Duration;

#[cfg(not(all(target_arch = "wasm32", target_os = "unknown")))]
mod source {
    use std::sync::LazyLock;
    use std::time::{Duration, Instant};

    #[expect(clippy::disallowed_methods, reason = "the one place that may")]
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);

    pub fn now() -> Duration {
        START.elapsed()
    }
}

#[cfg(all(target_arch = "wasm32", target_os = "unknown"))]
mod source {
    use std::sync::OnceLock;
    use std::time::Duration;

    static LENT: OnceLock<fn() -> Duration> = OnceLock::new();

    /// Lends the clock of the host, for instance the browser's `performance.now`: the time since any fixed moment. Only the first
    /// one counts.
    pub fn lend(clock: fn() -> Duration) {
        // A second clock could run behind the first.
        let _ = LENT.set(clock);
    }

    pub fn now() -> Duration {
        LENT.get().map_or(Duration::ZERO, |clock| clock())
    }
}

#[cfg(all(target_arch = "wasm32", target_os = "unknown"))]
pub use source::lend;

/// Measures how long something takes.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    started: Duration,
}

impl Stopwatch {
    /// Starts now.
    pub fn start() -> Self {
        Self { started: source::now() }
    }

    /// The time since it was started.
    pub fn elapsed(self) -> Duration {
        source::now().saturating_sub(self.started)
    }

    /// The time since it was started; it starts anew.
    pub fn lap(&mut self) -> Duration {
        let now = source::now();
        let time = now.saturating_sub(self.started);
        self.started = now;
        time
    }
}

/// The stages of some work and the time that each took.
#[derive(Clone, Debug)]
pub struct Laps {
    stopwatch: Stopwatch,
    all: Vec<(&'static str, Duration)>,
}

impl Laps {
    /// The first stage starts now.
    pub fn start() -> Self {
        Self { stopwatch: Stopwatch::start(), all: Vec::new() }
    }

    /// A stage has ended, and the next one starts. The time that it took.
    pub fn lap(&mut self, name: &'static str) -> Duration {
        let time = self.stopwatch.lap();
        self.all.push((name, time));
        time
    }

    /// The stages that have ended.
    pub fn all(&self) -> &[(&'static str, Duration)] {
        &self.all
    }

    /// The stages that have ended, to keep.
    pub fn into_all(self) -> Vec<(&'static str, Duration)> {
        self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laps_add_up_to_the_whole() {
        let whole = Stopwatch::start();
        let mut watch = whole;
        let pause = Duration::from_millis(5);
        std::thread::sleep(pause);
        let first = watch.lap();
        std::thread::sleep(pause);
        let second = watch.lap();
        // A sleep is never shorter than asked for.
        assert!(first >= pause && second >= pause);
        assert!(whole.elapsed() >= first + second);
    }
}
