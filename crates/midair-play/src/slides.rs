//! The window of pictures that follow one another in the display's own pixels. What comes when is `midair_live::Slides`'.

use crate::draw::open_window;
use crate::keys::{Slide, slide};
use crate::options::PlayError;
use crate::present::Processor;
use midair_live::{Act, Clock, Slides, Turn, release};
use std::sync::Arc;
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::WindowId;

/// Pictures to be shown one after the other.
pub struct Pictures<'a> {
    /// The window's title.
    pub title: String,
    /// The display's pixels, columns and rows.
    pub resolution: [usize; 2],
    /// A name for each picture.
    pub names: Vec<String>,
    /// A picture's 0RGB words, rows from the top.
    pub draw: &'a dyn Fn(usize) -> Vec<u32>,
    /// What the next one comes by.
    pub turn: Turn,
    /// The command that is run for each, where they come by it.
    pub command: String,
    /// Which screen, from 0; `None`: the system's choice.
    pub screen: Option<usize>,
}

/// The command has ended: why it did not do what it should.
type Released = Result<(), String>;

/// Shows pictures full screen until they have all had their turn, or the window is closed; how many had it. `told` is told which one is on the screen.
///
/// # Errors
/// [`PlayError`] where there is no window, or not of the pictures' size, and where the command fails.
pub fn show_pictures(
    pictures: &Pictures<'_>,
    told: &mut dyn FnMut(usize),
) -> Result<usize, PlayError> {
    let wrong = |error: &dyn std::fmt::Display| PlayError::Window(error.to_string());
    let events = EventLoop::<Released>::with_user_event().build().map_err(|error| wrong(&error))?;
    let mut window = Window {
        slides: Slides::new(pictures.resolution, pictures.names.len(), pictures.turn),
        pictures,
        clock: Clock::start(),
        told,
        proxy: events.create_proxy(),
        screen: None,
        drawn: None,
        failure: None,
    };
    events.run_app(&mut window).map_err(|error| wrong(&error))?;
    match window.failure {
        Some(failure) => Err(failure),
        None => Ok(window.slides.done()),
    }
}

struct Window<'a> {
    slides: Slides,
    pictures: &'a Pictures<'a>,
    clock: Clock,
    told: &'a mut dyn FnMut(usize),
    proxy: EventLoopProxy<Released>,
    screen: Option<(Arc<winit::window::Window>, Processor)>,
    /// The picture that was drawn last, and its words.
    drawn: Option<(usize, Vec<u32>)>,
    failure: Option<PlayError>,
}

impl Window<'_> {
    fn fail(&mut self, failure: PlayError, events: &ActiveEventLoop) {
        self.failure = Some(failure);
        events.exit();
    }

    fn open(&mut self, events: &ActiveEventLoop) -> Result<(), PlayError> {
        let Pictures { title, resolution, screen, .. } = self.pictures;
        let window = open_window(events, title, *resolution, *screen, true)?;
        // A window may be larger than its screen: then it has all pixels, and some are not seen.
        if let Some(monitor) = window.current_monitor() {
            let there = <[u32; 2]>::from(monitor.size()).map(|side| side as usize);
            if (0..2).any(|c| (1..resolution[c]).contains(&there[c])) {
                return Err(PlayError::Pixels { window: there, display: *resolution });
            }
        }
        let processor = Processor::open(&window)?;
        self.screen = Some((window, processor));
        Ok(())
    }

    fn resized(&mut self) {
        if let Some((window, _)) = &self.screen {
            let size = <[u32; 2]>::from(window.inner_size()).map(|side| side as usize);
            self.slides.resize(size, self.clock.now());
        }
    }

    /// Presents a picture, unless the window takes none just now.
    fn show(&mut self, picture: usize) {
        let Some((_, processor)) = &mut self.screen else { return };
        if self.drawn.as_ref().is_none_or(|(drawn, _)| *drawn != picture) {
            self.drawn = Some((picture, (self.pictures.draw)(picture)));
            (self.told)(picture);
        }
        let Some((_, words)) = &self.drawn else { return };
        let write = |pixels: &mut [u32]| {
            let fits = pixels.len() == words.len();
            if fits {
                pixels.copy_from_slice(words);
            }
            fits
        };
        if processor.present(self.pictures.resolution, self.clock, write).is_some() {
            self.slides.presented(self.clock.now());
        }
    }

    fn release(&self, picture: usize) {
        let proxy = self.proxy.clone();
        // Nobody listens any more once the window is closed.
        let done = move |end| drop(proxy.send_event(end));
        release(&self.pictures.command, &self.pictures.names[picture], done);
    }
}

impl ApplicationHandler<Released> for Window<'_> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.screen.is_none()
            && let Err(failure) = self.open(events)
        {
            return self.fail(failure, events);
        }
        self.resized();
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::RedrawRequested => self.slides.redraw(),
            WindowEvent::Resized(_) => self.resized(),
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                match slide(&event.logical_key) {
                    Some(Slide::Next) => self.slides.step(true),
                    Some(Slide::Previous) => self.slides.step(false),
                    Some(Slide::End) => events.exit(),
                    None => {}
                }
            }
            _ => {}
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, end: Released) {
        let (at, names) = (self.slides.done(), &self.pictures.names);
        match end {
            Ok(()) => self.slides.released(),
            Err(why) => {
                let picture = names[at].clone();
                let failure = PlayError::Shutter { picture, number: at + 1, of: names.len(), why };
                self.fail(failure, events);
            }
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let now = self.clock.now();
        match self.slides.act(now) {
            Some(Act::Show(picture)) => self.show(picture),
            Some(Act::Release(picture)) => self.release(picture),
            Some(Act::Refuse(window)) => {
                let display = self.pictures.resolution;
                self.fail(PlayError::Pixels { window, display }, events);
            }
            Some(Act::End) => events.exit(),
            None => {}
        }
        let now = self.clock.now();
        events.set_control_flow(match self.slides.next(now) {
            Some(then) => ControlFlow::WaitUntil(Instant::now() + then.saturating_sub(now)),
            None => ControlFlow::Wait,
        });
    }
}
