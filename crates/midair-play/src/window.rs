//! The window's thread: it tells the show what happens, and does what the show asks for.

use crate::draw::Screen;
use crate::keys;
use crate::letters::Letters;
use crate::options::{Options, Outcome, PlayError};
use midair::files::write_bytes_atomically;
use midair::scene::Loaded;
use midair_live::{
    Clock, Departures, Found, Frame, Heard, Job, Newest, Player, Protocol, Show, Spent, Stages,
    Wish, latency, listen, send, start,
};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::keyboard::ModifiersState;
use winit::window::WindowId;

/// What other threads tell the window.
#[derive(Debug)]
enum Event {
    Found(Found),
    Frame,
    Heard(Heard, Duration),
    SourceFailed(String),
    /// The hours of the show have begun, or ended.
    Open(bool),
    End,
}

/// Runs the show until it is closed. `note` is told what happens that people should know.
///
/// # Errors
/// [`PlayError`] where there is no window, port or source.
pub fn run(
    loaded: Loaded,
    options: Options,
    note: &mut dyn FnMut(&str),
) -> Result<Outcome, PlayError> {
    let wrong = |error: &dyn std::fmt::Display| PlayError::Window(error.to_string());
    let events = EventLoop::<Event>::with_user_event().build().map_err(|error| wrong(&error))?;
    let proxy = events.create_proxy();
    let clock = Clock::start();
    let tell = || {
        let proxy = proxy.clone();
        // Nobody listens any more once the show has ended.
        move |event| drop(proxy.send_event(event))
    };
    let (jobs, spent) = (Arc::new(Newest::new()), Arc::new(Spent::default()));
    let found = tell();
    start(Arc::clone(&jobs), Arc::clone(&spent), move |what| found(Event::Found(what)));
    let (frames, paused, gone) =
        (Arc::new(Newest::new()), Arc::default(), Arc::new(AtomicBool::new(false)));
    let gone_home = Arc::clone(&gone);
    let announce = tell();
    let player = Player {
        frames: Arc::clone(&frames),
        paused: Arc::clone(&paused),
        ready: Box::new(move || announce(Event::Frame)),
        gone: Arc::clone(&gone),
        clock,
        sound: options.sound,
        fit: options.fit,
        image: loaded.scene.image.size,
    };
    let (kind, failed) = (options.source.clone(), tell());
    std::thread::spawn(move || {
        if let Err(error) = player.play(&kind) {
            failed(Event::SourceFailed(error.to_string()));
        }
    });
    if let Some(hours) = options.hours {
        let open = tell();
        std::thread::spawn(move || {
            let mut last = None;
            while !gone_home.load(Ordering::Relaxed) {
                let time = jiff::ZonedDateTime::now().time();
                let now = hours.hold(60 * time.hour() as u16 + time.minute() as u16);
                if last.replace(now) != Some(now) {
                    open(Event::Open(now));
                }
                std::thread::sleep(Duration::from_secs(1));
            }
        });
    }
    let mut port = None;
    let wanted = options.settings.tracker.or(options.trial.map(|_| (Protocol::OpenTrack, 0)));
    if let Some((protocol, wanted)) = wanted {
        let hear = proxy.clone();
        let heard = listen(protocol, wanted, clock, move |heard, time| {
            hear.send_event(Event::Heard(heard, time)).is_ok()
        });
        port = Some(heard.map_err(|source| PlayError::Port { port: wanted, source })?);
    }
    if let Some(after) = options.end_after {
        let end = tell();
        std::thread::spawn(move || {
            std::thread::sleep(after);
            end(Event::End);
        });
    }
    let mut window = Window {
        show: Show::new(loaded, options.settings.clone()),
        options,
        clock,
        note,
        proxy,
        port,
        jobs: Arc::clone(&jobs),
        spent,
        frames,
        paused,
        screen: None,
        letters: Letters::default(),
        modifiers: ModifiersState::empty(),
        departures: None,
        stages: Vec::new(),
        saved: Vec::new(),
        failure: None,
    };
    let ran = events.run_app(&mut window);
    gone.store(true, Ordering::Relaxed);
    jobs.close();
    ran.map_err(|error| wrong(&error))?;
    if let Some(failure) = window.failure {
        return Err(failure);
    }
    let sent = window.options.trial.map_or(0, |trial| trial.packets);
    let renderer =
        window.screen.map_or_else(String::new, |screen| screen.presenter.name().to_owned());
    Ok(Outcome {
        latency: latency(sent, &window.stages),
        saved: window.saved,
        renderer,
        packets: window.show.packets(),
    })
}

pub(crate) struct Window<'a> {
    pub show: Show,
    pub options: Options,
    pub clock: Clock,
    note: &'a mut dyn FnMut(&str),
    proxy: EventLoopProxy<Event>,
    port: Option<u16>,
    jobs: Arc<Newest<Job>>,
    spent: Arc<Spent>,
    frames: Arc<Newest<Frame>>,
    paused: Arc<AtomicBool>,
    pub screen: Option<Screen>,
    pub letters: Letters,
    modifiers: ModifiersState,
    pub departures: Option<Departures>,
    /// The stages of each viewpoint of a trial that was shown.
    pub stages: Vec<Stages>,
    saved: Vec<PathBuf>,
    failure: Option<PlayError>,
}

impl Window<'_> {
    fn fail(&mut self, failure: PlayError, events: &ActiveEventLoop) {
        self.failure = Some(failure);
        events.exit();
    }

    fn resized(&mut self) {
        if let Some(screen) = &self.screen {
            self.show.resize(screen.size(), screen.is_full(), self.clock.now());
        }
    }

    fn save(&mut self, text: &str) {
        let path = self.options.save_to.clone();
        let written = write_bytes_atomically(&path, text.as_bytes());
        let outcome = match written {
            Ok(()) => Ok(path.display().to_string()),
            Err(error) => Err(error.to_string()),
        };
        if outcome.is_ok() && !self.saved.contains(&path) {
            self.saved.push(path);
        }
        self.show.saved(outcome, self.clock.now());
    }

    /// Hands on what the show wants of others.
    fn pass_on(&mut self) {
        if let Some(job) = self.show.take_job() {
            self.jobs.put(job);
        }
        while let Some(warp) = self.show.take_spent() {
            self.spent.put(warp);
        }
        self.paused.store(self.show.paused(), Ordering::Relaxed);
        for note in self.show.take_notes() {
            (self.note)(&note);
        }
    }

    /// A trial begins when the first picture has been drawn.
    fn try_out(&mut self, events: &ActiveEventLoop) {
        if self.departures.is_none()
            && self.show.has_map()
            && let (Some(trial), Some(port)) = (self.options.trial, self.port)
        {
            let end = self.proxy.clone();
            let done = move || drop(end.send_event(Event::End));
            match send(trial, port, self.show.loaded().scene.viewpoint, self.clock, done) {
                Ok(departures) => self.departures = Some(departures),
                Err(source) => self.fail(PlayError::Port { port, source }, events),
            }
        }
    }
}

impl ApplicationHandler<Event> for Window<'_> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.screen.is_none() {
            match self.open(events) {
                Ok(screen) => self.screen = Some(screen),
                Err(failure) => return self.fail(failure, events),
            }
            if !self.options.fullscreen {
                (self.note)(
                    "a window is not to scale: --fullscreen, or the key F, shows the image at its size",
                );
            }
        }
        self.resized();
        self.pass_on();
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::RedrawRequested => self.draw(),
            WindowEvent::Resized(_) => self.resized(),
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                let command = keys::command(&event.logical_key, self.modifiers);
                match command.and_then(|command| self.show.command(command, self.clock.now())) {
                    None => {}
                    Some(Wish::End) => events.exit(),
                    Some(Wish::FillScreen) => self.screen.iter().for_each(Screen::turn),
                    Some(Wish::Save(text)) => self.save(&text),
                }
            }
            _ => {}
        }
        self.pass_on();
    }

    fn user_event(&mut self, events: &ActiveEventLoop, event: Event) {
        let now = self.clock.now();
        match event {
            Event::Found(Found::Map(solved)) => self.show.solved(solved),
            Event::Found(Found::Gain(settled)) => self.show.settled(settled),
            Event::Found(Found::Refused(why)) => {
                if let Err(why) = self.show.refused(why, now) {
                    self.fail(PlayError::Solve(why), events);
                }
            }
            Event::Frame => {
                if let Some(frame) = self.frames.take() {
                    self.show.frame(frame, now);
                }
            }
            Event::Heard(heard, time) => self.show.heard(heard, time),
            Event::Open(open) => self.show.open(open, now),
            Event::SourceFailed(why) => self.fail(PlayError::Source(why), events),
            Event::End => events.exit(),
        }
        self.pass_on();
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        self.show.tick(self.clock.now());
        self.pass_on();
        if self.show.take_stale() {
            self.draw();
        }
        // Not before the map is shown: both would take the same processor cores.
        if self.show.take_gain_due() {
            self.jobs.offer(Job::Gain);
        }
        self.try_out(events);
        let now = self.clock.now();
        events.set_control_flow(match self.show.next_tick(now) {
            Some(then) => ControlFlow::WaitUntil(Instant::now() + then.saturating_sub(now)),
            None => ControlFlow::Wait,
        });
    }
}
