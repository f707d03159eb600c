//! The show: what happens, one thing after the other, and what is to be seen. It knows neither window nor clock: readings of the clock
//! come with what happens.

mod commands;
mod picture;

use crate::arrangement::{Arrangement, Target};
use crate::attendance::Attendance;
use crate::lit::Lit;
use crate::solver::{COLOURS, Job, Request, Settled, Solved};
use crate::source::Frame;
use crate::steady::OneEuro;
use crate::tracker::{Calibration, Heard, Protocol, Reception};
use crate::viewer::Viewer;
use midair::geometry::Vec3;
use midair::picture::{Drive, LightFrame, Overflow, Warp};
use midair::scene::Loaded;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

/// How a show is run.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Who tells where the viewer is, and on which port.
    pub tracker: Option<(Protocol, u16)>,
    /// From the tracker's frame to the scene's.
    pub calibration: Calibration,
    /// Smoothing; `None`: none.
    pub smoothing: Option<OneEuro>,
    /// How far ahead the viewer is looked for, s; `None`: the measured latency.
    pub predict: Option<f64>,
    /// Whether the gain is divided out, and what is done where that takes a brighter display.
    pub gain: Option<Overflow>,
    /// Whether figures are shown from the beginning.
    pub figures: bool,
    /// With a tracker: so long after its last reading the display goes dark, until the next; `None`: never.
    pub blank_after: Option<Duration>,
}

/// What is to be drawn.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Pixels of the display.
    pub size: [usize; 2],
    /// The map's taps, and a number that no other map has; `None`: black.
    pub warp: Option<(&'a Warp, u64)>,
    /// Pixels of the frame.
    pub source: [usize; 2],
    /// The frame's light, and a number that no other light has.
    pub light: (&'a LightFrame, u64),
    /// The display's codes for it: blue, green, red.
    pub drive: &'a Drive,
}

/// A show as it stands.
pub struct Show {
    pub(crate) settings: Settings,
    /// The set-up as it is now, nudges and all.
    pub(crate) loaded: Arc<Loaded>,
    /// The last one that a map was made for.
    solvable: Arc<Loaded>,
    /// Where everything stands in the scene file.
    pub(crate) original: Arrangement,
    /// Before each nudge.
    history: Vec<Arrangement>,
    pub(crate) target: Target,
    /// Pixels of the display.
    pub(crate) size: [usize; 2],
    frame: Option<Frame>,
    lattice: Frame,
    show_lattice: bool,
    pub(crate) uncompensated: bool,
    pub(crate) paused: bool,
    pub(crate) figures: bool,
    pub(crate) help: bool,
    pub(crate) map: Option<Solved>,
    /// Maps that were shown, whose memory can be used again.
    spent: Vec<Warp>,
    /// Since when a map is awaited.
    pub(crate) awaited: Option<Duration>,
    job: Option<Job>,
    /// Whether the last map's gain is still to be worked out.
    gain_due: bool,
    stale: bool,
    pub(crate) light: Lit,
    /// The display's codes, blue first.
    drive: Drive,
    /// The codes for frames whose gain was divided out.
    evened: Option<Drive>,
    pub(crate) viewer: Viewer,
    attendance: Attendance,
    reception: Option<Reception>,
    /// When the last pictures were presented.
    pub(crate) presented: VecDeque<Duration>,
    /// Seconds from a packet's arrival to its presentation, averaged.
    pub(crate) delay: Option<f64>,
    pub(crate) message: Option<(String, Duration)>,
    /// When something was nudged last.
    pub(crate) nudged: Option<Duration>,
    /// What was not told on the terminal yet.
    notes: Vec<String>,
    /// Whether the picture fills the screen.
    pub(crate) fills_screen: bool,
}

/// How long a message is seen.
pub(crate) const SEEN: Duration = Duration::from_secs(5);

/// So long a map may take before the wait for it is told: until then what is seen stays.
pub(crate) const PATIENCE: Duration = Duration::from_millis(300);

impl Show {
    /// A show of a scene.
    pub fn new(loaded: Loaded, settings: Settings) -> Self {
        let loaded = Arc::new(loaded);
        Self {
            viewer: Viewer::new(settings.calibration, settings.smoothing),
            attendance: Attendance::new(
                settings.blank_after.filter(|_| settings.tracker.is_some()),
            ),
            reception: settings.tracker.map(|(protocol, port)| Reception::new(protocol, port)),
            drive: Drive::of_screen(&loaded.screen, COLOURS),
            evened: settings
                .gain
                .map(|overflow| Drive::of_evened(&loaded.screen, COLOURS, overflow)),
            lattice: Frame::lattice(loaded.scene.image.size),
            original: Arrangement::of(&loaded.scene),
            size: loaded.scene.display.resolution,
            figures: settings.figures,
            settings,
            solvable: Arc::clone(&loaded),
            loaded,
            history: Vec::new(),
            target: Target::Viewpoint,
            frame: None,
            show_lattice: false,
            uncompensated: false,
            paused: false,
            help: false,
            map: None,
            spent: Vec::new(),
            awaited: None,
            job: None,
            gain_due: false,
            stale: false,
            light: Lit::default(),
            presented: VecDeque::new(),
            delay: None,
            message: None,
            nudged: None,
            notes: Vec::new(),
            fills_screen: true,
        }
    }

    /// The set-up as it is now.
    pub fn loaded(&self) -> &Arc<Loaded> {
        &self.loaded
    }

    /// Whether the source stands still: in a pause, and while the display is dark.
    pub fn paused(&self) -> bool {
        self.paused || self.attendance.is_dark()
    }

    /// Whether the display is dark for want of anybody to see it.
    pub fn is_dark(&self) -> bool {
        self.attendance.is_dark()
    }

    /// The hours of the show have begun, or ended: the display is dark without.
    pub fn open(&mut self, open: bool, now: Duration) {
        self.attendance.open(open);
        self.stale |= self.attendance.tick(now);
    }

    /// Whether a map has come yet.
    pub fn has_map(&self) -> bool {
        self.map.is_some()
    }

    /// The display has so many pixels, on all of its screen or in a window, which is true to scale only by chance.
    pub fn resize(&mut self, size: [usize; 2], fills_screen: bool, now: Duration) {
        self.fills_screen = fills_screen;
        self.size = size;
        self.ask(None, now);
        self.stale = true;
    }

    /// There is a new frame.
    pub fn frame(&mut self, frame: Frame, now: Duration) {
        let before = self.wanted().map(|frame| frame.size);
        self.frame = Some(frame);
        if self.wanted().map(|frame| frame.size) != before {
            self.ask(None, now);
        }
        self.stale = true;
    }

    /// A packet has come from the tracker.
    pub fn heard(&mut self, heard: Heard, now: Duration) {
        if let Some(reception) = &mut self.reception {
            reception.count(&heard, now);
        }
        let Heard::Reading(reading) = heard else { return };
        // At its own place a tracker sees nobody.
        if reading.position != Vec3::ZERO {
            self.attendance.somebody(now);
            self.stale |= self.attendance.tick(now);
        }
        let ahead = self.settings.predict.or(self.delay).unwrap_or(0.0).min(0.1);
        let before = self.viewer.refusal().map(str::to_owned);
        if self.viewer.hear(&self.loaded, reading, now, ahead) {
            self.ask(Some((reading.number(), now)), now);
        }
        // A refusal stands over the picture for as long as it lasts; the terminal has it once.
        match (self.viewer.refusal(), &before) {
            (Some(refusal), None) => {
                self.notes.push(format!("{refusal}; the last map stays"));
                self.stale = true;
            }
            (None, Some(_)) => self.stale = true,
            _ => {}
        }
    }

    /// A map has come.
    pub fn solved(&mut self, solved: Solved) {
        self.solvable = Arc::clone(&solved.loaded);
        self.gain_due = self.settings.gain.is_some();
        if let Some(before) = self.map.replace(solved) {
            self.spent.push(before.warp);
        }
        // One for a display of another size is not the one that is waited for.
        if self.fits() {
            self.awaited = None;
        }
        self.stale = true;
    }

    /// A gain has come for a map that is shown with an earlier one.
    pub fn settled(&mut self, settled: Settled) {
        // A newer map has its own.
        if let Some(map) = &mut self.map
            && map.viewpoint == settled.viewpoint
            && map.evening.is_some()
        {
            map.evening = Some(settled.evening);
            self.stale = true;
        }
    }

    /// No map can be made of what was asked for. The show goes on with the last one, and with the set-up that it is of.
    ///
    /// # Errors
    /// Why there is no show at all, where this was the first map.
    pub fn refused(&mut self, why: String, now: Duration) -> Result<(), String> {
        self.awaited = None;
        if self.map.is_none() {
            return Err(why);
        }
        self.loaded = Arc::clone(&self.solvable);
        self.say(format!("no map: {why}; the last one stays"), now);
        Ok(())
    }

    /// Shows a message for a while, and has it told on the terminal.
    pub fn say(&mut self, text: String, now: Duration) {
        self.notes.push(text.clone());
        self.message = Some((text, now));
        self.stale = true;
    }

    /// Time has gone by: messages go, a viewer is lost, a wait becomes long.
    pub fn tick(&mut self, now: Duration) {
        if self.viewer.lose(now) {
            let silent = crate::viewer::LOST.as_secs();
            let text = format!("no reading for {silent} s: back to the scene's viewpoint");
            self.say(text, now);
            self.ask(None, now);
        }
        if let Some(complaint) = self.reception.as_mut().and_then(|r| r.complaint(now)) {
            self.say(complaint, now);
        }
        self.stale |= self.attendance.tick(now);
        let over = |since: Option<Duration>, long: Duration| since.is_some_and(|s| now >= s + long);
        if over(self.message.as_ref().map(|(_, since)| *since), SEEN) {
            self.message = None;
            self.stale = true;
        }
        if over(self.nudged, SEEN) {
            self.nudged = None;
            self.stale = true;
        }
        self.stale |= over(self.awaited, PATIENCE) && !self.fits();
    }

    /// When [`tick`](Self::tick) will have something to do, if nothing else happens.
    pub fn next_tick(&self, now: Duration) -> Option<Duration> {
        let message = self.message.as_ref().map(|(_, since)| *since + SEEN);
        let nudged = self.nudged.map(|since| since + SEEN);
        let awaited = self.awaited.map(|since| since + PATIENCE);
        let awaited = awaited.filter(|&then| then > now && !self.fits());
        let reception = self.reception.as_ref().and_then(Reception::complains_at);
        let events = [message, nudged, awaited, reception, self.viewer.lost_at()];
        events.into_iter().flatten().chain(self.attendance.next()).min()
    }

    /// What the solver is to do next; the newest job counts.
    pub fn take_job(&mut self) -> Option<Job> {
        self.job.take()
    }

    /// Whether the solver may go on with the gain of the map that was presented: once for each map.
    pub fn take_gain_due(&mut self) -> bool {
        std::mem::take(&mut self.gain_due)
    }

    /// A warp that is shown no more, for the solver to use its memory again.
    pub fn take_spent(&mut self) -> Option<Warp> {
        self.spent.pop()
    }

    /// Whether there is something new to be drawn, once all that has happened is known: a picture for each event would fall behind them.
    pub fn take_stale(&mut self) -> bool {
        std::mem::take(&mut self.stale)
    }

    /// What is to be told on the terminal.
    pub fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }

    /// Packets of the tracker that were readings, and that were not.
    pub fn packets(&self) -> Option<[u64; 2]> {
        self.reception.as_ref().map(Reception::packets)
    }

    /// The frame that is to be shown.
    fn wanted(&self) -> Option<&Frame> {
        if self.show_lattice { Some(&self.lattice) } else { self.frame.as_ref() }
    }

    /// Asks for the map of what is now.
    fn ask(&mut self, packet: Option<(u64, Duration)>, now: Duration) {
        let Some(source) = self.wanted().map(|frame| frame.size) else { return };
        if self.size.contains(&0) {
            return;
        }
        self.awaited.get_or_insert(now);
        self.job = Some(Job::Map(Request {
            loaded: Arc::clone(&self.loaded),
            viewpoint: self.viewer.eye(),
            resolution: self.size,
            source,
            uncompensated: self.uncompensated,
            gain: self.settings.gain,
            packet,
        }));
    }

    /// Whether the last map is one for the display as it is.
    pub(crate) fn fits(&self) -> bool {
        self.map.as_ref().is_some_and(|map| map.warp.size() == self.size)
    }
}
