//! The screens of this machine.

use crate::options::PlayError;
use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::monitor::MonitorHandle;
use winit::window::WindowId;

/// A screen.
#[derive(Clone, Debug, PartialEq)]
pub struct ScreenInfo {
    /// The system's name for it.
    pub name: String,
    /// Its pixels.
    pub size: [u32; 2],
    /// Where its upper left lies among the others, in pixels.
    pub position: [i32; 2],
    /// Pictures a second, where the system tells.
    pub rate: Option<f64>,
}

impl std::fmt::Display for ScreenInfo {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { name, size: [width, height], position: [x, y], rate } = self;
        write!(f, "{name}, {width} x {height} at {x}, {y}")?;
        rate.map_or(Ok(()), |rate| write!(f, ", {rate:.0} Hz"))
    }
}

impl From<&MonitorHandle> for ScreenInfo {
    fn from(monitor: &MonitorHandle) -> Self {
        Self {
            name: monitor.name().unwrap_or_else(|| "screen".to_owned()),
            size: monitor.size().into(),
            position: monitor.position().into(),
            rate: monitor.refresh_rate_millihertz().map(|rate| f64::from(rate) / 1e3),
        }
    }
}

pub(crate) fn there(events: &ActiveEventLoop) -> Vec<ScreenInfo> {
    events.available_monitors().map(|monitor| ScreenInfo::from(&monitor)).collect()
}

/// The screens that there are, in the order of their numbers.
///
/// # Errors
/// [`PlayError::Window`] where there is no window system.
pub fn screens() -> Result<Vec<ScreenInfo>, PlayError> {
    #[derive(Default)]
    struct Look(Vec<ScreenInfo>);
    impl ApplicationHandler for Look {
        fn resumed(&mut self, events: &ActiveEventLoop) {
            self.0 = there(events);
            events.exit();
        }

        fn window_event(&mut self, _: &ActiveEventLoop, _: WindowId, _: WindowEvent) {}
    }
    let wrong = |error: winit::error::EventLoopError| PlayError::Window(error.to_string());
    let mut look = Look::default();
    EventLoop::new().map_err(wrong)?.run_app(&mut look).map_err(wrong)?;
    Ok(look.0)
}
