//! Memory that goes round.

use midair::picture::Warp;
use std::sync::{Mutex, PoisonError};

/// Memory of warps that are no longer shown, for others to use: touched for the first time it takes longer than all the rest of a map.
#[derive(Debug, Default)]
pub struct Spent(Mutex<Vec<Warp>>);

/// One is shown, one waits to be, one is made: no more than two are ever left over at once.
pub(crate) const SPARE: usize = 2;

impl Spent {
    /// Hands a warp over whose map is no longer shown.
    pub fn put(&self, warp: Warp) {
        let mut warps = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if warps.len() < SPARE {
            warps.push(warp);
        }
    }

    pub(crate) fn take(&self) -> Option<Warp> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).pop()
    }
}
