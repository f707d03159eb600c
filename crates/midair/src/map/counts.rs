//! How many pixels have which status.

use super::{Map, Status};
use serde::Serialize;

/// A map's pixels by status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Counts {
    /// With one image point.
    pub ok: usize,
    /// With several.
    pub folded: usize,
    /// That no image point asks for.
    pub outside: usize,
    /// That an image point asks for, past the plate's edge.
    pub blocked: usize,
}

impl Counts {
    /// All pixels.
    pub fn all(&self) -> usize {
        self.ok + self.folded + self.outside + self.blocked
    }
}

impl Map {
    /// How many pixels have which status.
    pub fn counts(&self) -> Counts {
        let mut counts = Counts::default();
        for status in &self.status {
            match status {
                Status::Ok => counts.ok += 1,
                Status::Folded => counts.folded += 1,
                Status::Outside => counts.outside += 1,
                Status::Blocked => counts.blocked += 1,
            }
        }
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pixel_counts_once() {
        let mut map = Map::identity(4, 2);
        map.status[1] = Status::Folded;
        map.status[3..6].fill(Status::Outside);
        map.status[7] = Status::Blocked;
        let expected = Counts { ok: 3, folded: 1, outside: 3, blocked: 1 };
        assert_eq!(map.counts(), expected);
        assert_eq!(expected.all(), 8);
    }
}
