//! The window, and what is drawn in it.

use crate::options::PlayError;
use crate::present::{self, Presenter};
use crate::screens;
use crate::window::Window;
use std::sync::Arc;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::window::Fullscreen;

/// The window, and who makes its picture.
pub(crate) struct Screen {
    pub window: Arc<winit::window::Window>,
    pub presenter: Box<dyn Presenter>,
}

impl Screen {
    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        let PhysicalSize { width, height } = self.window.inner_size();
        [width as usize, height as usize]
    }

    /// Whether the picture is all that the screen shows.
    pub fn is_full(&self) -> bool {
        self.window.fullscreen().is_some()
    }

    /// Fills the screen, or gives it back.
    pub fn turn(&self) {
        let full = self.is_full();
        self.window.set_fullscreen((!full).then_some(Fullscreen::Borderless(None)));
        self.window.set_cursor_visible(full);
    }
}

/// Opens a window of so many pixels on the screen of this number, or of the system's choice.
pub(crate) fn open_window(
    events: &ActiveEventLoop,
    title: &str,
    [width, height]: [usize; 2],
    screen: Option<usize>,
    fullscreen: bool,
) -> Result<Arc<winit::window::Window>, PlayError> {
    let wrong = |error: &dyn std::fmt::Display| PlayError::Window(error.to_string());
    let mut attributes = winit::window::Window::default_attributes()
        .with_title(title)
        .with_inner_size(PhysicalSize::new(width as u32, height as u32));
    let monitor = match screen {
        None => None,
        Some(asked) => match events.available_monitors().nth(asked) {
            Some(monitor) => Some(monitor),
            None => return Err(PlayError::Screen { asked, there: screens::there(events) }),
        },
    };
    if let Some(monitor) = &monitor {
        attributes = attributes.with_position(monitor.position());
    }
    if fullscreen {
        attributes = attributes.with_fullscreen(Some(Fullscreen::Borderless(monitor)));
    }
    let window = events.create_window(attributes).map_err(|error| wrong(&error))?;
    window.set_cursor_visible(!fullscreen);
    Ok(Arc::new(window))
}

impl Window<'_> {
    pub fn open(&self, events: &ActiveEventLoop) -> Result<Screen, PlayError> {
        let scene = &self.show.loaded().scene;
        let size = self.options.size.unwrap_or(scene.display.resolution);
        let title = format!("midair: {}", scene.name);
        let (screen, fullscreen) = (self.options.screen, self.options.fullscreen);
        let window = open_window(events, &title, size, screen, fullscreen)?;
        let presenter = present::open(&window, self.options.renderer)?;
        Ok(Screen { window, presenter })
    }

    /// The show goes on by the processor where a graphics device gives up.
    fn fall_back(&mut self, why: &str) {
        let now = self.clock.now();
        let Some(screen) = &mut self.screen else { return };
        match present::processor(&screen.window) {
            Ok(processor) => {
                screen.presenter = processor;
                screen.window.request_redraw();
                let text = format!("the graphics device gave up, the processor goes on: {why}");
                self.show.say(text, now);
            }
            // Without either there is nothing to be done but to keep the last picture.
            Err(_) => self.show.say(why.to_owned(), now),
        }
    }

    /// Warps the newest frame by the newest map, and presents it.
    pub fn draw(&mut self) {
        let begun = self.clock.now();
        let Some(screen) = &mut self.screen else { return };
        let lines = self.show.lines(screen.presenter.name(), begun);
        let Some(picture) = self.show.picture(begun) else { return };
        self.letters.write(lines, picture.size);
        match screen.presenter.show(&picture, &self.letters, self.clock) {
            Ok(Some(ready)) => {
                let (now, trial) = (self.clock.now(), self.departures.as_ref());
                self.stages.extend(self.show.presented(begun, ready, now, trial));
            }
            Ok(None) => {}
            Err(why) => self.fall_back(&why),
        }
    }
}
