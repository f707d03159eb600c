//! A frame's light, decoded once for as long as the frame and its gain stay.

use crate::source::Frame;
use midair::picture::{FrameEvening, LightFrame, WarpError};
use std::sync::Arc;

/// The light of the last frame that was drawn.
#[derive(Debug, Default)]
pub(crate) struct Lit {
    light: LightFrame,
    /// Of which frame, and with which gain divided out.
    of: Option<(Frame, Option<Arc<FrameEvening>>)>,
    /// The share of the frame's samples that take a brighter display.
    pub clipped: f64,
    /// How often light was decoded: no two frames, and no two gains of a frame, have the same number.
    number: u64,
}

impl Lit {
    /// The light of the frame that was decoded last, and its number.
    pub fn last(&self) -> (&LightFrame, u64) {
        (&self.light, self.number)
    }

    /// The light of a frame, its gain divided out if there is one; and its number, which tells it from all others.
    ///
    /// # Errors
    /// [`WarpError`] where the frame's bytes are not as many as its size says.
    pub fn of(
        &mut self,
        frame: &Frame,
        evening: Option<&Arc<FrameEvening>>,
    ) -> Result<(&LightFrame, u64), WarpError> {
        let known = self.of.as_ref().is_some_and(|(of, with)| {
            let same = match (with, evening) {
                (Some(a), Some(b)) => Arc::ptr_eq(a, b),
                (None, None) => true,
                _ => false,
            };
            same && of.size == frame.size && Arc::ptr_eq(&of.bytes, &frame.bytes)
        });
        if !known {
            // Half of another frame is none.
            self.of = None;
            self.clipped = match evening {
                Some(evening) => self.light.decode_evened(&frame.bytes, 4, frame.size, evening)?,
                None => self.light.decode(&frame.bytes, 4).map(|()| 0.0)?,
            };
            self.of = Some((frame.clone(), evening.cloned()));
            self.number += 1;
        }
        Ok((&self.light, self.number))
    }
}
