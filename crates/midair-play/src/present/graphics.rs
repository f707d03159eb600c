//! Warped by a graphics device (Vulkan, Metal, Direct3D 12), into the window's surface.

use super::Presenter;
use crate::letters::Letters;
use crate::quiet::quietly;
use midair_gpu::{GraphicsError, Surface};
use midair_live::{Clock, Picture};
use std::sync::Arc;
use std::time::Duration;
use winit::window::Window;

/// A window's surface.
pub(super) struct Graphics {
    window: Arc<Window>,
    surface: Surface<Arc<Window>>,
}

impl Graphics {
    /// Takes the device that drives the window's screen; `software` says whether it may be the processor in disguise.
    pub fn open(window: &Arc<Window>, software: bool) -> Result<Self, GraphicsError> {
        let size = window.inner_size().into();
        let opened = || pollster::block_on(Surface::open(Arc::clone(window), size, software));
        let surface = quietly(opened)?;
        Ok(Self { window: Arc::clone(window), surface })
    }
}

impl Presenter for Graphics {
    fn show(
        &mut self,
        picture: &Picture<'_>,
        letters: &Letters,
        clock: Clock,
    ) -> Result<Option<Duration>, String> {
        let Picture { size, warp, source, light, drive } = *picture;
        let letters = midair_gpu::Letters { size: letters.size, words: &letters.words };
        let picture = midair_gpu::Picture { warp, source, light, drive, letters };
        let size = size.map(|side| side as u32);
        let drawn = self.surface.draw(size, &picture).map_err(|error| error.to_string())?;
        let Some(drawn) = drawn else { return Ok(None) };
        let ready = clock.now();
        self.window.pre_present_notify();
        drawn.present();
        Ok(Some(ready))
    }

    fn name(&self) -> &str {
        self.surface.name()
    }
}
