//! The window and what happens in it.

use crate::letters::overlay;
use crate::nudge::{Nudge, Target};
use crate::solver::{self, Newest, Request, Solved};
use crate::source::{Frame, Player, SourceKind};
use crate::steady::{OneEuro, Steady};
use crate::tracker::{Calibration, Protocol, Reading, listen};
use crate::trial::{Departures, Latency, Trial, latency, send};
use midair::geometry::Vec3;
use midair::map::format::write_bytes_atomically;
use midair::scene::{Loaded, to_toml};
use std::collections::VecDeque;
use std::num::NonZeroU32;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::keyboard::{Key, ModifiersState, NamedKey};
use winit::window::{Fullscreen, Window, WindowId};

/// How the show is run.
#[derive(Clone, Debug)]
pub struct Options {
    /// What is shown.
    pub source: SourceKind,
    /// Pixels of the window; `None`: the display's.
    pub size: Option<[usize; 2]>,
    /// Whether the window fills its screen.
    pub fullscreen: bool,
    /// Which screen, from 0; `None`: the system's choice.
    pub screen: Option<usize>,
    /// Who tells where the viewer is, and on which port.
    pub tracker: Option<(Protocol, u16)>,
    /// From the tracker's frame to the scene's.
    pub calibration: Calibration,
    /// Smoothing; `None`: none.
    pub smoothing: Option<OneEuro>,
    /// How far ahead the viewer is looked for, s; `None`: the measured latency.
    pub predict: Option<f64>,
    /// Whether figures are shown from the beginning.
    pub overlay: bool,
    /// Where a nudged scene is saved.
    pub save_to: PathBuf,
    /// The show ends by itself.
    pub end_after: Option<Duration>,
    /// Latency is measured with a synthetic tracker, and the show ends with it.
    pub trial: Option<Trial>,
}

/// Why there is no show.
#[derive(Debug, thiserror::Error)]
pub enum PlayError {
    /// No window can be opened.
    #[error(
        "no window can be opened: {0}; a screen is needed (on a machine without one, xvfb-run gives a virtual one)"
    )]
    Window(String),
    /// The tracker's port cannot be had.
    #[error("port {port}: {source}; choose another, or end the program that has it")]
    Port {
        /// The port.
        port: u16,
        /// The operating system's word.
        source: std::io::Error,
    },
    /// The source has no frames.
    #[error("{0}")]
    Source(String),
    /// The scene cannot be solved.
    #[error("{0}")]
    Solve(String),
    /// There is no such screen.
    #[error("there is no screen {asked}; there are {there}, counted from 0")]
    Screen {
        /// The one asked for.
        asked: usize,
        /// How many there are.
        there: usize,
    },
}

/// What other threads tell the window.
#[derive(Debug)]
enum Event {
    Map,
    Frame,
    Reading(Reading, Instant),
    SourceFailed(String),
    SolveFailed(String),
    End,
}

/// Runs the show until it is closed. Returns the latency if that was measured, and the scene files that were saved.
///
/// # Errors
/// [`PlayError`] where there is no window, port or source.
pub fn run(loaded: Loaded, options: Options) -> Result<(Option<Latency>, Vec<PathBuf>), PlayError> {
    let window = |error: &dyn std::fmt::Display| PlayError::Window(error.to_string());
    let events = EventLoop::<Event>::with_user_event().build().map_err(|error| window(&error))?;
    let proxy = events.create_proxy();
    let tell = |proxy: &EventLoopProxy<Event>| {
        let proxy = proxy.clone();
        // Nobody listens any more once the show has ended.
        move |event| drop(proxy.send_event(event))
    };
    let (requests, solved) = (Arc::new(Newest::new()), Arc::new(Newest::new()));
    let (ready, refused) = (tell(&proxy), tell(&proxy));
    solver::start(
        Arc::clone(&requests),
        Arc::clone(&solved),
        move || ready(Event::Map),
        move |why| refused(Event::SolveFailed(why)),
    );
    let (frames, paused, gone) =
        (Arc::new(Newest::new()), Arc::default(), Arc::new(AtomicBool::new(false)));
    let announce = tell(&proxy);
    let player = Player {
        frames: Arc::clone(&frames),
        paused: Arc::clone(&paused),
        ready: Box::new(move || announce(Event::Frame)),
        gone: Arc::clone(&gone),
    };
    let (kind, image, failed) = (options.source.clone(), loaded.scene.image.size, tell(&proxy));
    std::thread::spawn(move || {
        if let Err(error) = player.play(&kind, image) {
            failed(Event::SourceFailed(error.to_string()));
        }
    });
    let mut port = None;
    let wanted = options.tracker.or(options.trial.map(|_| (Protocol::OpenTrack, 0)));
    if let Some((protocol, wanted)) = wanted {
        let hear = proxy.clone();
        let heard = listen(protocol, wanted, move |reading, time| {
            hear.send_event(Event::Reading(reading, time)).is_ok()
        });
        port = Some(heard.map_err(|source| PlayError::Port { port: wanted, source })?);
    }
    if let Some(after) = options.end_after {
        let end = tell(&proxy);
        std::thread::spawn(move || {
            std::thread::sleep(after);
            end(Event::End);
        });
    }
    let steady = Steady::new(options.smoothing);
    let lattice = Frame::lattice(image);
    let mut show = Show {
        calibration: options.calibration,
        show_overlay: options.overlay,
        proxy,
        port,
        loaded: Arc::new(loaded),
        options,
        requests: Arc::clone(&requests),
        solved,
        frames,
        paused,
        screen: None,
        map: None,
        frame: None,
        lattice,
        show_lattice: false,
        uncompensated: false,
        tracked: None,
        steady,
        target: Target::Viewpoint,
        modifiers: ModifiersState::empty(),
        presented: VecDeque::new(),
        delay: None,
        departures: None,
        latencies: Vec::new(),
        solves: Vec::new(),
        message: None,
        saved: Vec::new(),
        failure: None,
    };
    let ran = events.run_app(&mut show);
    gone.store(true, Ordering::Relaxed);
    requests.close();
    ran.map_err(|error| window(&error))?;
    if let Some(failure) = show.failure {
        return Err(failure);
    }
    let sent = show.options.trial.map_or(0, |trial| trial.packets);
    Ok((latency(sent, show.latencies, show.solves), show.saved))
}

/// The window and its pixels.
struct Screen {
    window: Rc<Window>,
    surface: softbuffer::Surface<Rc<Window>, Rc<Window>>,
}

struct Show {
    options: Options,
    proxy: EventLoopProxy<Event>,
    port: Option<u16>,
    loaded: Arc<Loaded>,
    requests: Arc<Newest<Request>>,
    solved: Arc<Newest<Solved>>,
    frames: Arc<Newest<Frame>>,
    paused: Arc<AtomicBool>,
    screen: Option<Screen>,
    map: Option<Solved>,
    frame: Option<Frame>,
    lattice: Frame,
    show_lattice: bool,
    show_overlay: bool,
    uncompensated: bool,
    calibration: Calibration,
    /// The viewer as the tracker last told: the reading, and the viewpoint that was made of it.
    tracked: Option<(Reading, Vec3)>,
    steady: Steady,
    target: Target,
    modifiers: ModifiersState,
    /// When the last frames were presented.
    presented: VecDeque<Instant>,
    /// Seconds from a packet's arrival to its presentation, averaged.
    delay: Option<f64>,
    departures: Option<Departures>,
    latencies: Vec<f64>,
    solves: Vec<f64>,
    message: Option<(String, Instant)>,
    saved: Vec<PathBuf>,
    failure: Option<PlayError>,
}

impl Show {
    fn open(&self, events: &ActiveEventLoop) -> Result<Screen, PlayError> {
        let wrong = |error: &dyn std::fmt::Display| PlayError::Window(error.to_string());
        let [width, height] = self.options.size.unwrap_or(self.loaded.scene.display.resolution);
        let mut attributes = Window::default_attributes()
            .with_title(format!("midair: {}", self.loaded.scene.name))
            .with_inner_size(PhysicalSize::new(width as u32, height as u32));
        let monitors: Vec<_> = events.available_monitors().collect();
        let monitor = match self.options.screen {
            None => None,
            Some(asked) => match monitors.get(asked) {
                Some(monitor) => Some(monitor.clone()),
                None => return Err(PlayError::Screen { asked, there: monitors.len() }),
            },
        };
        if let Some(monitor) = &monitor {
            attributes = attributes.with_position(monitor.position());
        }
        if self.options.fullscreen {
            attributes = attributes.with_fullscreen(Some(Fullscreen::Borderless(monitor)));
        }
        let window = Rc::new(events.create_window(attributes).map_err(|error| wrong(&error))?);
        window.set_cursor_visible(!self.options.fullscreen);
        let context =
            softbuffer::Context::new(Rc::clone(&window)).map_err(|error| wrong(&error))?;
        let surface = softbuffer::Surface::new(&context, Rc::clone(&window))
            .map_err(|error| wrong(&error))?;
        Ok(Screen { window, surface })
    }

    fn shown_frame(&self) -> Option<&Frame> {
        if self.show_lattice { Some(&self.lattice) } else { self.frame.as_ref() }
    }

    /// Asks for the map of what is now.
    fn ask(&self, packet: Option<(u64, Instant)>) {
        let (Some(screen), Some(frame)) = (&self.screen, self.shown_frame()) else { return };
        let size = screen.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return;
        }
        self.requests.put(Request {
            loaded: Arc::clone(&self.loaded),
            viewpoint: self.tracked.map(|(_, eye)| eye),
            resolution: [size.width as usize, size.height as usize],
            source: frame.size,
            uncompensated: self.uncompensated,
            packet,
        });
    }

    /// Warps the newest frame by the newest map, and presents it.
    fn draw(&mut self) {
        let lines = if self.show_overlay { self.figures() } else { Vec::new() };
        let Some(frame) = self.shown_frame().cloned() else { return };
        let (Some(map), Some(screen)) = (&self.map, &mut self.screen) else { return };
        let size = screen.window.inner_size();
        let (Some(width), Some(height)) =
            (NonZeroU32::new(size.width), NonZeroU32::new(size.height))
        else {
            return;
        };
        // A map for another window or source is on its way to be replaced.
        if map.warp.size() != [size.width as usize, size.height as usize]
            || map.source != frame.size
        {
            return;
        }
        let resized = screen.surface.resize(width, height);
        let Ok(mut buffer) = resized.and_then(|()| screen.surface.buffer_mut()) else { return };
        let pixels: &mut [u32] = &mut buffer;
        // Frames are blue, green, red, nothing: on a little-endian machine the buffer's own form.
        if map.warp.apply(&frame.bytes, 4, bytemuck::cast_slice_mut(pixels)).is_err() {
            return;
        }
        if cfg!(target_endian = "big") {
            pixels.iter_mut().for_each(|pixel| *pixel = pixel.swap_bytes());
        }
        overlay(pixels, size.width as usize, &lines);
        screen.window.pre_present_notify();
        if buffer.present().is_err() {
            return;
        }
        let now = Instant::now();
        self.presented.push_back(now);
        while self.presented.len() > 60 {
            self.presented.pop_front();
        }
        // A viewpoint counts once, when it is first seen.
        if let Some(map) = &mut self.map
            && let Some((number, came)) = map.packet.take()
        {
            let delay = now.duration_since(came).as_secs_f64();
            self.delay = Some(self.delay.map_or(delay, |known| 0.9 * known + 0.1 * delay));
            if let Some(left) =
                self.departures.as_ref().and_then(|departures| departures.of(number))
            {
                self.latencies.push(1e3 * now.duration_since(left).as_secs_f64());
                self.solves.push(1e3 * map.seconds);
            }
        }
    }

    fn figures(&self) -> Vec<String> {
        let rate = match (self.presented.front(), self.presented.back()) {
            (Some(first), Some(last)) if last > first => {
                (self.presented.len() - 1) as f64 / last.duration_since(*first).as_secs_f64()
            }
            _ => 0.0,
        };
        let mut lines = vec![format!(
            "{rate:.0} frames/s   map {:.1} ms",
            self.map.as_ref().map_or(0.0, |map| 1e3 * map.seconds)
        )];
        if let Some(map) = &self.map {
            let (eye, followed) =
                (map.viewpoint, if self.tracked.is_some() { " (followed)" } else { "" });
            lines.push(format!("eye {:.1} {:.1} {:.1} mm{followed}", eye.x, eye.y, eye.z));
        }
        if let Some(delay) = self.delay {
            lines.push(format!("packet to screen {:.1} ms", 1e3 * delay));
        }
        lines.push(format!("nudging: {}", self.target.name(&self.loaded)));
        if self.uncompensated {
            lines.push("uncompensated".to_owned());
        }
        lines.extend(
            self.message
                .as_ref()
                .filter(|(_, time)| time.elapsed().as_secs() < 5)
                .map(|(text, _)| text.clone()),
        );
        lines
    }

    fn say(&mut self, text: String) {
        self.message = Some((text, Instant::now()));
    }

    fn heard(&mut self, reading: Reading, time: Instant) {
        let ahead = self.options.predict.or(self.delay).unwrap_or(0.0).min(0.1);
        let measured = self.calibration.viewpoint(&reading);
        let eye = self.steady.follow(time, measured, ahead);
        self.tracked = Some((reading, eye));
        self.ask(Some((reading.angles[0].max(0.0) as u64, time)));
    }

    fn key(&mut self, key: &Key, events: &ActiveEventLoop) {
        let step = if self.modifiers.shift_key() { 1.0 } else { 0.1 };
        let turn = self.modifiers.control_key();
        // Along x and y the arrows move what they point to; a turn by an arrow moves the front that way.
        let nudge = |axis: usize, sign: f64| Some(Nudge { axis, by: sign * step, turn });
        let nudge = match (key, turn) {
            (Key::Named(NamedKey::ArrowRight), false) => nudge(0, 1.0),
            (Key::Named(NamedKey::ArrowLeft), false) => nudge(0, -1.0),
            (Key::Named(NamedKey::ArrowUp), false) => nudge(1, 1.0),
            (Key::Named(NamedKey::ArrowDown), false) => nudge(1, -1.0),
            (Key::Named(NamedKey::ArrowRight), true) => nudge(1, 1.0),
            (Key::Named(NamedKey::ArrowLeft), true) => nudge(1, -1.0),
            (Key::Named(NamedKey::ArrowUp), true) => nudge(0, -1.0),
            (Key::Named(NamedKey::ArrowDown), true) => nudge(0, 1.0),
            (Key::Named(NamedKey::PageUp), _) => nudge(2, 1.0),
            (Key::Named(NamedKey::PageDown), _) => nudge(2, -1.0),
            _ => None,
        };
        if let Some(nudge) = nudge {
            let mut moved = (*self.loaded).clone();
            nudge.apply(&mut moved, self.target);
            self.loaded = Arc::new(moved);
            return self.ask(None);
        }
        match key {
            Key::Named(NamedKey::Escape) => events.exit(),
            Key::Named(NamedKey::Space) => drop(self.paused.fetch_xor(true, Ordering::Relaxed)),
            Key::Named(NamedKey::Tab) => {
                self.target = self.target.next(self.loaded.scene.elements.len());
                self.draw();
            }
            Key::Character(character) => match character.to_lowercase().as_str() {
                "q" => events.exit(),
                "l" => {
                    self.show_lattice = !self.show_lattice;
                    self.ask(None);
                }
                "u" => {
                    self.uncompensated = !self.uncompensated;
                    self.ask(None);
                }
                "o" => {
                    self.show_overlay = !self.show_overlay;
                    self.draw();
                }
                "f" => {
                    if let Some(screen) = &self.screen {
                        let full = screen.window.fullscreen().is_some();
                        screen
                            .window
                            .set_fullscreen((!full).then_some(Fullscreen::Borderless(None)));
                        screen.window.set_cursor_visible(full);
                    }
                }
                "c" => self.calibrate(),
                "s" => self.save(),
                _ => {}
            },
            _ => {}
        }
    }

    /// Takes the viewer to be at the scene's viewpoint now.
    fn calibrate(&mut self) {
        if let Some((reading, _)) = self.tracked {
            let viewpoint = Vec3::from_array(self.loaded.scene.viewpoint);
            self.calibration = self.calibration.taking(&reading, viewpoint);
            self.steady = Steady::new(self.options.smoothing);
            self.tracked = Some((reading, viewpoint));
            self.ask(None);
            self.say("the tracker's present reading is the scene's viewpoint".to_owned());
        }
    }

    fn save(&mut self) {
        let path = self.options.save_to.clone();
        match write_bytes_atomically(&path, to_toml(&self.loaded.scene).as_bytes()) {
            Ok(()) => {
                self.say(format!("saved {}", path.display()));
                if !self.saved.contains(&path) {
                    self.saved.push(path);
                }
            }
            Err(error) => self.say(error.to_string()),
        }
        self.draw();
    }

    fn fail(&mut self, failure: PlayError, events: &ActiveEventLoop) {
        self.failure = Some(failure);
        events.exit();
    }
}

impl ApplicationHandler<Event> for Show {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        events.set_control_flow(ControlFlow::Wait);
        if self.screen.is_none() {
            match self.open(events) {
                Ok(screen) => self.screen = Some(screen),
                Err(failure) => return self.fail(failure, events),
            }
        }
        self.ask(None);
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::RedrawRequested => self.draw(),
            WindowEvent::Resized(_) => self.ask(None),
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                self.key(&event.logical_key, events);
            }
            _ => {}
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, event: Event) {
        match event {
            Event::Map => {
                let first = self.map.is_none();
                if let Some(solved) = self.solved.take() {
                    self.map = Some(solved);
                }
                self.draw();
                // A trial begins when the show does.
                if first && let (Some(trial), Some(port)) = (self.options.trial, self.port) {
                    let end = self.proxy.clone();
                    let done = move || drop(end.send_event(Event::End));
                    match send(trial, port, self.loaded.scene.viewpoint, done) {
                        Ok(departures) => self.departures = Some(departures),
                        Err(source) => self.fail(PlayError::Port { port, source }, events),
                    }
                }
            }
            Event::Frame => {
                let before = self.shown_frame().map(|frame| frame.size);
                if let Some(frame) = self.frames.take() {
                    self.frame = Some(frame);
                }
                if self.shown_frame().map(|frame| frame.size) != before {
                    self.ask(None);
                }
                self.draw();
            }
            Event::Reading(reading, time) => self.heard(reading, time),
            Event::SourceFailed(why) => self.fail(PlayError::Source(why), events),
            // The show goes on with the map that it has.
            Event::SolveFailed(why) if self.map.is_some() => self.say(why),
            Event::SolveFailed(why) => self.fail(PlayError::Solve(why), events),
            Event::End => events.exit(),
        }
    }
}
