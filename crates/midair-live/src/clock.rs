//! The show's time.

use std::time::{Duration, Instant};

/// A clock that begins with the show. Threads read it and hand the reading on: what decides by the time is told it, so that a test,
/// or a browser, tells another.
#[derive(Clone, Copy, Debug)]
pub struct Clock(Instant);

impl Clock {
    /// A clock that begins now.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Time since then.
    pub fn now(self) -> Duration {
        self.0.elapsed()
    }
}

/// When the frames of a film are due: it stands still in a pause.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    start: Duration,
    paused: Option<Duration>,
}

impl Pace {
    /// A film that begins now.
    pub fn start(now: Duration) -> Self {
        Self { start: now, paused: None }
    }

    /// How long it is still until a moment of the film, in seconds from its start; `None` while it stands still.
    pub fn left(&mut self, now: Duration, paused: bool, at: f64) -> Option<Duration> {
        match (self.paused, paused) {
            (None, true) => self.paused = Some(now),
            (Some(since), false) => {
                self.start += now.saturating_sub(since);
                self.paused = None;
            }
            _ => {}
        }
        let left = at - now.saturating_sub(self.start).as_secs_f64();
        self.paused.is_none().then(|| Duration::try_from_secs_f64(left).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pause_puts_the_rest_off_by_its_length() {
        let s = Duration::from_secs_f64;
        let mut pace = Pace::start(s(10.0));
        assert_eq!(pace.left(s(10.5), false, 2.0), Some(s(1.5)));
        assert_eq!(pace.left(s(11.0), true, 2.0), None);
        assert_eq!(pace.left(s(13.0), true, 2.0), None);
        // Three seconds later: one is gone of the film's time.
        assert_eq!(pace.left(s(14.0), false, 2.0), Some(s(1.0)));
        assert_eq!(pace.left(s(16.0), false, 2.0), Some(s(0.0)));
    }
}
