//! A graphics device, and what went wrong on it.

use std::sync::{Arc, Mutex, PoisonError};
use wgpu::DeviceType;

/// Why a graphics device cannot be used, or not any more.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct GraphicsError(pub(crate) String);

impl GraphicsError {
    pub(crate) fn of(error: impl std::fmt::Display) -> Self {
        Self(error.to_string())
    }
}

/// A device with a queue of its own.
#[derive(Debug)]
pub struct Device {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    name: String,
    /// What went wrong that nobody waited for: the device was lost, or has no memory left.
    failure: Arc<Mutex<Option<String>>>,
}

impl Device {
    /// A device that draws off screen; `software` says whether it may be the processor in disguise.
    ///
    /// # Errors
    /// [`GraphicsError`] where there is none.
    pub async fn off_screen(software: bool) -> Result<Self, GraphicsError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        Self::found(&instance, None, software).await.map(|(device, _)| device)
    }

    /// The device that drives a surface, or any.
    pub(crate) async fn found(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
        software: bool,
    ) -> Result<(Self, wgpu::Adapter), GraphicsError> {
        let wanted = wgpu::RequestAdapterOptions {
            // Of two devices the one within the processor's chip: it shares the processor's memory, and mostly drives the screen. A warp is
            // little work even for that.
            power_preference: wgpu::PowerPreference::LowPower,
            compatible_surface: surface,
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter = instance.request_adapter(&wanted).await.map_err(GraphicsError::of)?;
        if adapter.get_info().device_type == DeviceType::Cpu && !software {
            return Err(GraphicsError("there is a graphics device in software only".to_owned()));
        }
        Ok((Self::open(&adapter).await?, adapter))
    }

    async fn open(adapter: &wgpu::Adapter) -> Result<Self, GraphicsError> {
        let info = adapter.get_info();
        let asked = wgpu::DeviceDescriptor {
            // A display of 8K has taps of 265 MB: more than is promised everywhere.
            required_limits: adapter.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = adapter.request_device(&asked).await.map_err(GraphicsError::of)?;
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

    /// The device's name and how it is spoken to.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Has what was submitted done, and tells what went wrong until then.
    ///
    /// # Errors
    /// [`GraphicsError`] where the device was lost, or could not do what it was asked for.
    pub fn finish(&self) -> Result<(), GraphicsError> {
        let done = self.device.poll(wgpu::PollType::wait_indefinitely());
        let failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner).clone();
        match (failure, done) {
            (Some(why), _) => Err(GraphicsError(why)),
            (None, Err(error)) => Err(GraphicsError::of(error)),
            (None, Ok(_)) => Ok(()),
        }
    }
}
