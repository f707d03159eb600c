//! Warped by the processor, into memory that the window system takes over.

use super::{Picture, Presenter};
use crate::letters::overlay;
use crate::options::PlayError;
use std::num::NonZeroU32;
use std::sync::Arc;
use std::time::Instant;
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
        [width, height]: [u32; 2],
        picture: &Picture,
    ) -> Result<Option<Instant>, String> {
        let (Some(columns), Some(rows)) = (NonZeroU32::new(width), NonZeroU32::new(height)) else {
            return Ok(None);
        };
        let resized = self.surface.resize(columns, rows);
        let Ok(mut buffer) = resized.and_then(|()| self.surface.buffer_mut()) else {
            return Ok(None);
        };
        let pixels: &mut [u32] = &mut buffer;
        // Frames are blue, green, red, nothing: on a little-endian machine the buffer's own form.
        let bytes = bytemuck::cast_slice_mut(pixels);
        if picture.map.warp.apply_light(picture.light, 4, picture.drive, bytes).is_err() {
            return Ok(None);
        }
        if cfg!(target_endian = "big") {
            pixels.iter_mut().for_each(|pixel| *pixel = pixel.swap_bytes());
        }
        overlay(pixels, width as usize, picture.lines);
        let drawn = Instant::now();
        self.window.pre_present_notify();
        Ok(buffer.present().is_ok().then_some(drawn))
    }

    fn name(&self) -> &str {
        "processor"
    }
}
