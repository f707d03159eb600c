//! How the show is run, and why it may not be.

use crate::screens::ScreenInfo;
use midair::picture::Fit;
use midair_live::{Hours, Latency, Settings, SourceKind, Trial};
use std::path::PathBuf;
use std::time::Duration;

/// How the show is run.
#[derive(Clone, Debug)]
pub struct Options {
    /// What is shown.
    pub source: SourceKind,
    /// How frames of other proportions fill the image.
    pub fit: Fit,
    /// Pixels of the window; `None`: the display's.
    pub size: Option<[usize; 2]>,
    /// Whether the window fills its screen.
    pub fullscreen: bool,
    /// Whether films are heard.
    pub sound: bool,
    /// The hours of the day in which there is a show; the display is dark without.
    pub hours: Option<Hours>,
    /// Which screen, from 0; `None`: the system's choice.
    pub screen: Option<usize>,
    /// What makes the picture.
    pub renderer: Renderer,
    /// The show's own.
    pub settings: Settings,
    /// Where a nudged scene is saved.
    pub save_to: PathBuf,
    /// The show ends by itself.
    pub end_after: Option<Duration>,
    /// Latency is measured with a synthetic tracker, and the show ends with it.
    pub trial: Option<Trial>,
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
    /// Packets of the tracker that were readings, and that were not, if one was listened to.
    pub packets: Option<[u64; 2]>,
}

/// What makes the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Renderer {
    /// The graphics device where there is one, the processor else.
    #[default]
    Auto,
    /// A graphics device, be it one in software.
    Gpu,
    /// The processor.
    Cpu,
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
    /// No graphics device can be used.
    #[error(
        "no graphics device can be used: {0}; --renderer cpu needs none, and a driver for Vulkan gives one (on Debian and Ubuntu mesa-vulkan-drivers, which has one in software)"
    )]
    Graphics(String),
    /// The scene cannot be solved.
    #[error("{0}")]
    Solve(String),
    /// There is no such screen.
    #[error("there is no screen {asked}; there are, counted from 0:{}", listed(there))]
    Screen {
        /// The one asked for.
        asked: usize,
        /// Those that there are.
        there: Vec<ScreenInfo>,
    },
    /// Pictures in the display's own pixels are not shown in others.
    #[error(
        "the window has {} x {} pixels, the display {} x {}: patterns are shown pixel by pixel, never scaled; choose the display's screen by --display (--list-displays lists them), set it to its own resolution and a scale of 100 %, or correct the scene's [display] resolution",
        window[0], window[1], display[0], display[1]
    )]
    Pixels {
        /// The window's, or the screen's.
        window: [usize; 2],
        /// The display's, by the scene.
        display: [usize; 2],
    },
    /// The command that photographs a picture did not do so.
    #[error(
        "{picture}, {number} of {of}: {why}; try the command by itself, then begin again: patterns that were photographed twice do no harm"
    )]
    Shutter {
        /// The picture's name.
        picture: String,
        /// Which it is, from 1.
        number: usize,
        /// Of how many.
        of: usize,
        /// What happened.
        why: String,
    },
}

fn listed(screens: &[ScreenInfo]) -> String {
    screens.iter().enumerate().map(|(i, screen)| format!("\n  {i}: {screen}")).collect()
}
