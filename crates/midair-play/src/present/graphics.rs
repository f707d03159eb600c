//! Warped by a graphics device (Vulkan, Metal, Direct3D 12), into the window's surface.

use super::{Picture, Presenter};
use crate::letters::{extent, overlay};
use midair_gpu::{GraphicsError, Letters, Surface};
use std::sync::Arc;
use std::time::Instant;
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
        let surface = pollster::block_on(Surface::open(Arc::clone(window), size, software))?;
        Ok(Self { window: Arc::clone(window), surface })
    }
}

impl Presenter for Graphics {
    fn show(&mut self, size: [u32; 2], picture: &Picture) -> Result<Option<Instant>, String> {
        let [width, height] = extent(picture.lines);
        let extent = [width.min(size[0] as usize), height.min(size[1] as usize)];
        let mut words = vec![0; extent[0] * extent[1]];
        overlay(&mut words, extent[0], picture.lines);
        let picture = midair_gpu::Picture {
            warp: Some((&picture.map.warp, picture.map.number)),
            source: picture.map.source,
            light: (picture.light, picture.light_number),
            drive: picture.drive,
            letters: Letters { size: extent, words: &words },
        };
        let drawn = self.surface.draw(size, &picture).map_err(|error| error.to_string())?;
        let Some(drawn) = drawn else { return Ok(None) };
        let ready = Instant::now();
        self.window.pre_present_notify();
        drawn.present();
        Ok(Some(ready))
    }

    fn name(&self) -> &str {
        self.surface.name()
    }
}
