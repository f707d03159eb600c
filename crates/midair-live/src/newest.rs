//! What threads hand one another: the newest counts.

use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Nothing came in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Late;

/// A place for one thing, of which the newest counts.
#[derive(Debug)]
pub struct Newest<T> {
    slot: Mutex<(Option<T>, bool)>,
    bell: Condvar,
}

impl<T> Default for Newest<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> Newest<T> {
    /// An empty place.
    pub fn new() -> Self {
        Self { slot: Mutex::new((None, false)), bell: Condvar::new() }
    }

    /// Puts a thing in the place of what was there, which is given back.
    pub fn put(&self, thing: T) -> Option<T> {
        let before = self.slot.lock().unwrap_or_else(PoisonError::into_inner).0.replace(thing);
        self.bell.notify_one();
        before
    }

    /// Puts a thing that gives way to whatever else is there.
    pub fn offer(&self, thing: T) {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner).0.get_or_insert(thing);
        self.bell.notify_one();
    }

    /// Whether there is a thing, or will be none any more.
    pub fn calls(&self) -> bool {
        let slot = self.slot.lock().unwrap_or_else(PoisonError::into_inner);
        slot.0.is_some() || slot.1
    }

    /// Takes the thing, if there is one.
    pub fn take(&self) -> Option<T> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner).0.take()
    }

    /// Waits for a thing, but no longer than that; `None` once [`close`](Self::close)d.
    ///
    /// # Errors
    /// [`Late`] where none came in time.
    pub fn wait_within(&self, longest: Duration) -> Result<Option<T>, Late> {
        let start = Instant::now();
        let mut slot = self.slot.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if slot.1 {
                return Ok(None);
            }
            if let Some(thing) = slot.0.take() {
                return Ok(Some(thing));
            }
            let left = longest.saturating_sub(start.elapsed());
            if left.is_zero() {
                return Err(Late);
            }
            slot = self.bell.wait_timeout(slot, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Nothing more is wanted.
    pub fn close(&self) {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner).1 = true;
        self.bell.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_wins_and_closing_ends_the_wait() {
        let newest = Newest::new();
        assert_eq!(newest.wait_within(Duration::from_millis(1)), Err(Late));
        assert_eq!((newest.put(1), newest.put(2)), (None, Some(1)));
        // What is offered gives way.
        newest.offer(3);
        assert!(newest.calls());
        assert_eq!(newest.wait_within(Duration::MAX), Ok(Some(2)));
        assert_eq!(newest.take(), None);
        assert!(!newest.calls());
        newest.offer(4);
        assert_eq!(newest.wait_within(Duration::MAX), Ok(Some(4)));
        newest.close();
        assert_eq!(newest.wait_within(Duration::MAX), Ok(None));
    }
}
