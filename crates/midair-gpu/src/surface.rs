//! A warp that is shown: uploads what has changed, draws it, hands it to the surface.

use crate::device::{Device, GraphicsError};
use crate::warper::{Letters, Warper};
use midair::picture::{Drive, LightFrame, Warp};
use wgpu::{CurrentSurfaceTexture, PresentMode, SurfaceTarget, TextureFormat};

/// What is to be shown.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// The map's taps, and a number that no other map has; `None`: black.
    pub warp: Option<(&'a Warp, u64)>,
    /// Pixels of the source that the taps are for.
    pub source: [usize; 2],
    /// The frame's light, and a number that no other light has.
    pub light: (&'a LightFrame, u64),
    /// The display's codes for it.
    pub drive: &'a Drive,
    /// What stands over it.
    pub letters: Letters<'a>,
}

/// A surface and the device that draws it. `T` is what the surface is made of: a window, or a canvas.
pub struct Surface<T> {
    // Dropped before the device that it belongs to.
    surface: wgpu::Surface<'static>,
    target: T,
    instance: wgpu::Instance,
    device: Device,
    settings: wgpu::SurfaceConfiguration,
    warper: Warper,
    /// The numbers of the map and of the light that were uploaded last.
    map: Option<u64>,
    light: Option<u64>,
}

/// A picture that is ready to be shown.
#[must_use = "it is seen when it is presented"]
pub struct Drawn<'a> {
    texture: wgpu::SurfaceTexture,
    queue: &'a wgpu::Queue,
}

impl Drawn<'_> {
    /// Shows it.
    pub fn present(self) {
        self.queue.present(self.texture);
    }
}

impl<T: Into<SurfaceTarget<'static>> + Clone> Surface<T> {
    /// Takes the device that drives the target's screen, for pictures of `size` pixels; `software` says whether it may be the processor
    /// in disguise.
    ///
    /// # Errors
    /// [`GraphicsError`] where there is no device, or none that can draw there.
    pub async fn open(
        target: T,
        [width, height]: [u32; 2],
        software: bool,
    ) -> Result<Self, GraphicsError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let surface = instance.create_surface(target.clone()).map_err(GraphicsError::of)?;
        let (device, adapter) = Device::found(&instance, Some(&surface), software).await?;
        let mut settings = surface
            .get_default_config(&adapter, width.max(1), height.max(1))
            .ok_or_else(|| GraphicsError::of("the device cannot draw in this window"))?;
        let there = surface.get_capabilities(&adapter);
        // Codes are computed: a surface must not encode them once more.
        settings.format = [TextureFormat::Bgra8Unorm, TextureFormat::Rgba8Unorm]
            .into_iter()
            .find(|format| there.formats.contains(format))
            .ok_or_else(|| GraphicsError::of("the window takes no plain 8-bit pixels"))?;
        settings.view_formats = Vec::new();
        // The newest picture at the screen's next refresh, without waiting for older ones.
        let newest = there.present_modes.contains(&PresentMode::Mailbox);
        settings.present_mode = if newest { PresentMode::Mailbox } else { PresentMode::Fifo };
        settings.desired_maximum_frame_latency = 1;
        surface.configure(&device.device, &settings);
        let warper = Warper::for_format(&device, settings.format);
        device.finish()?;
        Ok(Self { surface, target, instance, device, settings, warper, map: None, light: None })
    }

    /// What draws it.
    pub fn name(&self) -> &str {
        self.device.name()
    }

    /// Draws a picture of `size` pixels. Returns when it is drawn, not when it was asked for; `None` if the surface takes none just now,
    /// or the map is not one that the device can use.
    ///
    /// # Errors
    /// [`GraphicsError`] where the device will not work any more.
    pub fn draw(
        &mut self,
        size: [u32; 2],
        picture: &Picture<'_>,
    ) -> Result<Option<Drawn<'_>>, GraphicsError> {
        if !self.upload(size, picture) {
            return Ok(None);
        }
        self.warper.take_letters(&self.device, picture.letters);
        let Some(texture) = self.texture(size)? else { return Ok(None) };
        self.warper.draw(&self.device, &texture.texture);
        self.device.finish()?;
        Ok(Some(Drawn { texture, queue: &self.device.queue }))
    }

    /// The texture that is shown next; `None` if none is taken now.
    fn texture(
        &mut self,
        [width, height]: [u32; 2],
    ) -> Result<Option<wgpu::SurfaceTexture>, GraphicsError> {
        if [self.settings.width, self.settings.height] != [width, height] {
            (self.settings.width, self.settings.height) = (width, height);
            self.configure();
        }
        // A surface that was lost or has changed is made anew, once: then the next picture tries again.
        for _ in 0..2 {
            match self.surface.get_current_texture() {
                CurrentSurfaceTexture::Success(texture)
                | CurrentSurfaceTexture::Suboptimal(texture) => return Ok(Some(texture)),
                CurrentSurfaceTexture::Timeout | CurrentSurfaceTexture::Occluded => {
                    return Ok(None);
                }
                CurrentSurfaceTexture::Outdated => self.configure(),
                CurrentSurfaceTexture::Lost => {
                    let again = self.instance.create_surface(self.target.clone());
                    self.surface = again.map_err(GraphicsError::of)?;
                    self.configure();
                }
                // What was wrong is told by the device.
                CurrentSurfaceTexture::Validation => break,
            }
        }
        self.device.finish()?;
        Ok(None)
    }

    fn configure(&self) {
        self.surface.configure(&self.device.device, &self.settings);
    }

    /// Hands the device what it does not have yet; false for a map that it cannot use.
    fn upload(&mut self, size: [u32; 2], picture: &Picture<'_>) -> bool {
        match picture.warp {
            Some((_, number)) if self.map == Some(number) => {}
            Some((warp, number)) => {
                self.map = None;
                if !self.warper.take_map(&self.device, warp, picture.source) {
                    return false;
                }
                self.map = Some(number);
            }
            None => {
                self.map = None;
                self.warper.take_black(&self.device, size.map(|side| side as usize));
            }
        }
        let (light, number) = picture.light;
        if self.light != Some(number) {
            self.warper.take_frame(&self.device, light, picture.drive);
            self.light = Some(number);
        }
        true
    }
}
