//! Warped by the processor, into memory that the window system takes over.

use super::Presenter;
use crate::letters::Letters;
use crate::options::PlayError;
use midair_live::{Clock, Picture};
use std::num::NonZeroU32;
use std::sync::Arc;
use std::time::Duration;
use winit::window::Window;

/// The window's pixels in memory.
pub(crate) struct Processor {
    window: Arc<Window>,
    surface: softbuffer::Surface<Arc<Window>, Arc<Window>>,
}

impl Processor {
    pub fn open(window: &Arc<Window>) -> Result<Self, PlayError> {
        let surface = softbuffer::Context::new(Arc::clone(window))
            .and_then(|context| softbuffer::Surface::new(&context, Arc::clone(window)))
            .map_err(|error| PlayError::Window(error.to_string()))?;
        Ok(Self { window: Arc::clone(window), surface })
    }

    /// Has the window's 0RGB words written, rows from the top, and shows them. The clock's reading when they were ready; `None` if nothing was shown: nothing
    /// was written, or the window takes none just now.
    pub fn present(
        &mut self,
        size: [usize; 2],
        clock: Clock,
        write: impl FnOnce(&mut [u32]) -> bool,
    ) -> Option<Duration> {
        let [width, height] = size.map(|side| NonZeroU32::new(side as u32));
        self.surface.resize(width?, height?).ok()?;
        let mut buffer = self.surface.buffer_mut().ok()?;
        if !write(&mut buffer) {
            return None;
        }
        let ready = clock.now();
        self.window.pre_present_notify();
        buffer.present().ok().map(|()| ready)
    }
}

impl Presenter for Processor {
    fn show(
        &mut self,
        picture: &Picture<'_>,
        letters: &Letters,
        clock: Clock,
    ) -> Result<Option<Duration>, String> {
        let write = |pixels: &mut [u32]| {
            match picture.warp {
                None => pixels.fill(0),
                Some((warp, _)) => {
                    // Frames are blue, green, red, nothing: on a little-endian machine the buffer's own form.
                    let bytes = bytemuck::cast_slice_mut(pixels);
                    if warp.apply_light(picture.light.0, 4, picture.drive, bytes).is_err() {
                        return false;
                    }
                    if cfg!(target_endian = "big") {
                        pixels.iter_mut().for_each(|pixel| *pixel = pixel.swap_bytes());
                    }
                }
            }
            letters.lay_over(pixels, picture.size[0]);
            true
        };
        Ok(self.present(picture.size, clock, write))
    }

    fn name(&self) -> &str {
        "processor"
    }
}
