//! The window and what happens in it.

use crate::draw::Screen;
use crate::options::{Options, PlayError};
use midair::geometry::Vec3;
use midair::picture::Drive;
use midair::scene::Loaded;
use midair_live::{
    COLOURS, Calibration, Departures, Frame, Job, Latency, Lit, Newest, Player, Protocol, Reading,
    Request, Settled, Solved, Spent, Stages, Steady, Target, latency, listen, send, start,
};
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use winit::application::ApplicationHandler;
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::keyboard::ModifiersState;
use winit::window::WindowId;

/// What other threads tell the window.
#[derive(Debug)]
enum Event {
    Map,
    Settled(Settled),
    Frame,
    Reading(Reading, Instant),
    SourceFailed(String),
    SolveFailed(String),
    End,
}

/// What came of a show.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The latency, if it was measured.
    pub latency: Option<Latency>,
    /// The scene files that were saved.
    pub saved: Vec<PathBuf>,
    /// What made the picture at the end.
    pub renderer: String,
}

/// Runs the show until it is closed.
///
/// # Errors
/// [`PlayError`] where there is no window, port or source.
pub fn run(loaded: Loaded, options: Options) -> Result<Outcome, PlayError> {
    let window = |error: &dyn std::fmt::Display| PlayError::Window(error.to_string());
    let events = EventLoop::<Event>::with_user_event().build().map_err(|error| window(&error))?;
    let proxy = events.create_proxy();
    let tell = |proxy: &EventLoopProxy<Event>| {
        let proxy = proxy.clone();
        // Nobody listens any more once the show has ended.
        move |event| drop(proxy.send_event(event))
    };
    let (requests, solved, spent) =
        (Arc::new(Newest::new()), Arc::new(Newest::new()), Arc::new(Spent::default()));
    let (ready, settled, refused) = (tell(&proxy), tell(&proxy), tell(&proxy));
    start(
        Arc::clone(&requests),
        Arc::clone(&solved),
        Arc::clone(&spent),
        move || ready(Event::Map),
        move |gain| settled(Event::Settled(gain)),
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
        requests: Arc::clone(&requests),
        solved,
        spent,
        frames,
        paused,
        screen: None,
        stale: false,
        gain_due: false,
        map: None,
        drive: Drive::of_screen(&loaded.screen, COLOURS),
        evened: options.gain.map(|overflow| Drive::of_evened(&loaded.screen, COLOURS, overflow)),
        options,
        light: Lit::default(),
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
        shown: Vec::new(),
        message: None,
        saved: Vec::new(),
        failure: None,
        loaded: Arc::new(loaded),
    };
    let ran = events.run_app(&mut show);
    gone.store(true, Ordering::Relaxed);
    requests.close();
    ran.map_err(|error| window(&error))?;
    if let Some(failure) = show.failure {
        return Err(failure);
    }
    let sent = show.options.trial.map_or(0, |trial| trial.packets);
    let renderer =
        show.screen.map_or_else(String::new, |screen| screen.presenter.name().to_owned());
    Ok(Outcome { latency: latency(sent, &show.shown), saved: show.saved, renderer })
}

pub(crate) struct Show {
    pub options: Options,
    proxy: EventLoopProxy<Event>,
    port: Option<u16>,
    pub loaded: Arc<Loaded>,
    requests: Arc<Newest<Job>>,
    solved: Arc<Newest<Solved>>,
    /// Warps that were shown, for the solver to use their memory again.
    spent: Arc<Spent>,
    pub frames: Arc<Newest<Frame>>,
    pub paused: Arc<AtomicBool>,
    pub screen: Option<Screen>,
    /// Whether there is something new to be drawn, once all that has happened is known: a picture for each event would fall behind them.
    stale: bool,
    /// Whether there is a map whose gain the solver may go on with.
    gain_due: bool,
    pub map: Option<Solved>,
    /// The display's codes, blue first.
    pub drive: Drive,
    /// The codes for frames whose gain was divided out.
    pub evened: Option<Drive>,
    /// The frame's light, for these two.
    pub light: Lit,
    pub frame: Option<Frame>,
    pub lattice: Frame,
    pub show_lattice: bool,
    pub show_overlay: bool,
    pub uncompensated: bool,
    pub calibration: Calibration,
    /// The viewer as the tracker last told: the reading, and the viewpoint that was made of it.
    pub tracked: Option<(Reading, Vec3)>,
    pub steady: Steady,
    pub target: Target,
    pub modifiers: ModifiersState,
    /// When the last frames were presented.
    pub presented: VecDeque<Instant>,
    /// Seconds from a packet's arrival to its presentation, averaged.
    pub delay: Option<f64>,
    pub departures: Option<Departures>,
    /// The stages of each viewpoint of a trial that was shown.
    pub shown: Vec<Stages>,
    pub message: Option<(String, Instant)>,
    pub saved: Vec<PathBuf>,
    pub failure: Option<PlayError>,
}

impl Show {
    pub fn shown_frame(&self) -> Option<&Frame> {
        if self.show_lattice { Some(&self.lattice) } else { self.frame.as_ref() }
    }

    /// Asks for the map of what is now.
    pub fn ask(&self, packet: Option<(u64, Instant)>) {
        let (Some(screen), Some(frame)) = (&self.screen, self.shown_frame()) else { return };
        let size = screen.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return;
        }
        self.requests.put(Job::Map(Request {
            loaded: Arc::clone(&self.loaded),
            viewpoint: self.tracked.map(|(_, eye)| eye),
            resolution: [size.width as usize, size.height as usize],
            source: frame.size,
            uncompensated: self.uncompensated,
            gain: self.options.gain,
            packet,
        }));
    }

    pub fn say(&mut self, text: String) {
        self.message = Some((text, Instant::now()));
    }

    fn heard(&mut self, reading: Reading, time: Instant) {
        let ahead = self.options.predict.or(self.delay).unwrap_or(0.0).min(0.1);
        let measured = self.calibration.viewpoint(&reading);
        let eye = self.steady.follow(time, measured, ahead);
        self.tracked = Some((reading, eye));
        self.ask(Some((reading.angles[0].max(0.0) as u64, time)));
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

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        if std::mem::take(&mut self.stale) {
            self.draw();
        }
        // Not before the map is shown: both would take the same processor cores.
        if std::mem::take(&mut self.gain_due) {
            self.requests.offer(Job::Gain);
        }
        // A trial begins when the first picture has been drawn.
        if self.departures.is_none()
            && self.map.is_some()
            && let (Some(trial), Some(port)) = (self.options.trial, self.port)
        {
            let end = self.proxy.clone();
            let done = move || drop(end.send_event(Event::End));
            match send(trial, port, self.loaded.scene.viewpoint, done) {
                Ok(departures) => self.departures = Some(departures),
                Err(source) => self.fail(PlayError::Port { port, source }, events),
            }
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, event: Event) {
        match event {
            Event::Map => {
                if let Some(solved) = self.solved.take()
                    && let Some(before) = self.map.replace(solved)
                {
                    self.spent.put(before.warp);
                }
                self.stale = true;
                self.gain_due = self.options.gain.is_some();
            }
            Event::Settled(Settled { viewpoint, evening }) => {
                // A newer map has its own.
                if let Some(map) = &mut self.map
                    && map.viewpoint == viewpoint
                    && map.evening.is_some()
                {
                    map.evening = Some(evening);
                    self.stale = true;
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
                self.stale = true;
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
