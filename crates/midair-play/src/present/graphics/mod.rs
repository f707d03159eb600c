//! Warped by a graphics device, through wgpu (Vulkan, Metal, Direct3D 12).
//!
//! Taps and frames are uploaded when they change; a shader does the processor's integer arithmetic on them ([`Warper`]).

mod warper;

use super::{Picture, Presenter};
use crate::letters::{extent, overlay};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use warper::Warper;
use wgpu::{CurrentSurfaceTexture, DeviceType, PresentMode, TextureFormat};
use winit::window::Window;

/// A device with a queue of its own.
pub(super) struct Device {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// The device's name and how it is spoken to.
    pub name: String,
    /// What went wrong that nobody waited for: the device was lost, or has no memory left.
    failure: Arc<Mutex<Option<String>>>,
}

impl Device {
    /// Makes an adapter ready to be used.
    pub fn open(adapter: &wgpu::Adapter) -> Result<Self, String> {
        let info = adapter.get_info();
        let asked = wgpu::DeviceDescriptor {
            // A display of 8K has taps of 265 MB: more than is promised everywhere.
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&asked))
            .map_err(|error| error.to_string())?;
        let failure = Arc::new(Mutex::new(None));
        let note = |failure: &Arc<Mutex<Option<String>>>| {
            let failure = Arc::clone(failure);
            move |why: String| {
                let mut known = failure.lock().unwrap_or_else(PoisonError::into_inner);
                known.get_or_insert(why);
            }
        };
        let (wrong, lost) = (note(&failure), note(&failure));
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| wrong(error.to_string())));
        device.set_device_lost_callback(move |_, why| lost(format!("the device was lost: {why}")));
        Ok(Self { device, queue, name: format!("{} ({})", info.name, info.backend), failure })
    }

    /// Has what was submitted done, and tells what went wrong until then.
    pub fn finish(&self) -> Result<(), String> {
        let done = self.device.poll(wgpu::PollType::wait_indefinitely());
        let failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner).clone();
        match (failure, done) {
            (Some(why), _) => Err(why),
            (None, Err(error)) => Err(error.to_string()),
            (None, Ok(_)) => Ok(()),
        }
    }
}

/// A window's surface and the device that draws it.
pub(super) struct Graphics {
    // Dropped before the device that it belongs to.
    surface: wgpu::Surface<'static>,
    window: Arc<Window>,
    instance: wgpu::Instance,
    device: Device,
    settings: wgpu::SurfaceConfiguration,
    warper: Warper,
    /// The numbers of the map and of the light that were uploaded last.
    map: Option<u64>,
    light: Option<u64>,
}

impl Graphics {
    /// Takes the device that drives the window's screen; `software` says whether it may be the processor in disguise.
    pub fn open(window: &Arc<Window>, software: bool) -> Result<Self, String> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let surface =
            instance.create_surface(Arc::clone(window)).map_err(|error| error.to_string())?;
        let wanted = wgpu::RequestAdapterOptions {
            // Of two devices the one within the processor's chip: it shares the processor's memory, and mostly drives the screen. A warp is little
            // work even for that.
            power_preference: wgpu::PowerPreference::LowPower,
            compatible_surface: Some(&surface),
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&wanted))
            .map_err(|error| error.to_string())?;
        if adapter.get_info().device_type == DeviceType::Cpu && !software {
            return Err("there is a graphics device in software only".to_owned());
        }
        let size = window.inner_size();
        let mut settings = surface
            .get_default_config(&adapter, size.width.max(1), size.height.max(1))
            .ok_or("the device cannot draw in this window")?;
        let there = surface.get_capabilities(&adapter);
        // Codes are computed: a surface must not encode them once more.
        settings.format = [TextureFormat::Bgra8Unorm, TextureFormat::Rgba8Unorm]
            .into_iter()
            .find(|format| there.formats.contains(format))
            .ok_or("the window takes no plain 8-bit pixels")?;
        settings.view_formats = Vec::new();
        // The newest picture at the screen's next refresh, without waiting for older ones.
        let newest = there.present_modes.contains(&PresentMode::Mailbox);
        settings.present_mode = if newest { PresentMode::Mailbox } else { PresentMode::Fifo };
        settings.desired_maximum_frame_latency = 1;
        let device = Device::open(&adapter)?;
        surface.configure(&device.device, &settings);
        let warper = Warper::new(&device, settings.format);
        device.finish()?;
        let window = Arc::clone(window);
        Ok(Self { surface, window, instance, device, settings, warper, map: None, light: None })
    }

    /// The texture that the window shows next; `None` if it takes none now.
    fn texture(
        &mut self,
        [width, height]: [u32; 2],
    ) -> Result<Option<wgpu::SurfaceTexture>, String> {
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
                    let again = self.instance.create_surface(Arc::clone(&self.window));
                    self.surface = again.map_err(|error| error.to_string())?;
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
    fn upload(&mut self, picture: &Picture) -> bool {
        if self.map != Some(picture.map.number) {
            if !self.warper.take_map(&self.device, &picture.map.warp, picture.map.source) {
                return false;
            }
            self.map = Some(picture.map.number);
        }
        if self.light != Some(picture.light_number) {
            self.warper.take_frame(&self.device, picture.light, picture.drive);
            self.light = Some(picture.light_number);
        }
        true
    }
}

impl Presenter for Graphics {
    fn show(&mut self, size: [u32; 2], picture: &Picture) -> Result<Option<Instant>, String> {
        if !self.upload(picture) {
            return Ok(None);
        }
        let [width, height] = extent(picture.lines);
        let extent = [width.min(size[0] as usize), height.min(size[1] as usize)];
        let mut letters = vec![0; extent[0] * extent[1]];
        overlay(&mut letters, extent[0], picture.lines);
        self.warper.take_letters(&self.device, extent, &letters);
        let Some(texture) = self.texture(size)? else { return Ok(None) };
        self.warper.draw(&self.device, &texture.texture);
        // A picture counts as drawn when it is, not when it has been asked for.
        self.device.finish()?;
        let drawn = Instant::now();
        self.window.pre_present_notify();
        self.device.queue.present(texture);
        Ok(Some(drawn))
    }

    fn name(&self) -> &str {
        &self.device.name
    }
}
