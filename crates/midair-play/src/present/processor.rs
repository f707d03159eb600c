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
pub(super) struct Processor {
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
}

impl Presenter for Processor {
    fn show(
        &mut self,
        picture: &Picture<'_>,
        letters: &Letters,
        clock: Clock,
    ) -> Result<Option<Duration>, String> {
        let [width, height] = picture.size.map(|side| NonZeroU32::new(side as u32));
        let (Some(columns), Some(rows)) = (width, height) else { return Ok(None) };
        let resized = self.surface.resize(columns, rows);
        let Ok(mut buffer) = resized.and_then(|()| self.surface.buffer_mut()) else {
            return Ok(None);
        };
        let pixels: &mut [u32] = &mut buffer;
        match picture.warp {
            None => pixels.fill(0),
            Some((warp, _)) => {
                // Frames are blue, green, red, nothing: on a little-endian machine the buffer's own form.
                let bytes = bytemuck::cast_slice_mut(pixels);
                if warp.apply_light(picture.light.0, 4, picture.drive, bytes).is_err() {
                    return Ok(None);
                }
                if cfg!(target_endian = "big") {
                    pixels.iter_mut().for_each(|pixel| *pixel = pixel.swap_bytes());
                }
            }
        }
        letters.lay_over(pixels, picture.size[0]);
        let ready = clock.now();
        self.window.pre_present_notify();
        Ok(buffer.present().is_ok().then_some(ready))
    }

    fn name(&self) -> &str {
        "processor"
    }
}
