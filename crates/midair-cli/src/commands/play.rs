//! `midair play`: the live show, and the patterns that a camera photographs.

mod patterns;

use crate::arguments::{FitMode, GainMode, Point, Size, open_scene};
use crate::failure::Failure;
use crate::summary::{Voice, paths};
use midair::geometry::Vec3;
use midair::picture::{Sequence, is_picture_name};
use midair::scene::Loaded;
use midair_live::{Calibration, Hours, Latency, OneEuro, Protocol, Settings, SourceKind, Trial};
use midair_play::{Options, Outcome, PlayError, Renderer, run as show, screens};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

/// Show the compensated source live, following the viewer
///
/// Opens a window on the light source's screen. Only a picture that fills the screen (--fullscreen, or the key F) is true to scale: a window is as
/// large as its pixels. The key H shows what the keys do: O figures, Tab what to nudge, arrows and Page Up/Down nudge it, Backspace takes the last step
/// back, R all of them, S saves the scene, Esc ends. A nudge or a reading of a tracker that a scene file could not say is refused, and the last map stays.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  midair play --list-displays\n  \
    midair play scene.toml film.mp4 --fullscreen --display 1\n  \
    midair play scene.toml lattice --track opentrack:4242\n  \
    midair play scene.toml photo.jpg --track osc:9000 --tracker-position 0,300,100 --tracker-rotation 0,180,0\n  \
    other-program | midair play scene.toml - --source-size 1280x720\n  \
    midair play scene.toml film.mp4 --gain soft\n  \
    midair play scene.toml one.mp4 two.mp4 logo.png --fit contain --sound --hours 09:00-18:00 --fullscreen\n  \
    midair play scene.toml --bench --size 1920x1080\n  \
    midair play scene.toml patterns --display 1\n  \
    midair play scene.toml patterns --display 1 --shutter 'gphoto2 --capture-image-and-download --filename \"$MIDAIR_PATTERN.%C\"'")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    #[arg(required_unless_present = "list_displays")]
    scene: Option<PathBuf>,
    /// A picture, a film, numbered pictures (frames/%04d.png), `lattice`, or - for raw RGBA frames on standard input; several are shown one after the
    /// other, over and over. `patterns`: what `calibrate patterns` draws, full screen, uncompensated
    #[arg(default_value = "lattice", num_args = 1.., value_name = "SOURCE")]
    sources: Vec<String>,
    /// Of several sources: how long a picture stands [default: 10]; of patterns: how long each stands [default: until a key]
    #[arg(long, value_name = "SECONDS", value_parser = crate::arguments::positive)]
    each: Option<f64>,
    /// Of patterns: a command that photographs each, run by the shell; $MIDAIR_PATTERN is the pattern's name. If it fails the show ends
    #[arg(long, value_name = "COMMAND", conflicts_with = "each")]
    shutter: Option<String>,
    /// With --shutter: how long a pattern stands before the command is run [default: 0.3]
    #[arg(long, value_name = "SECONDS", requires = "shutter", value_parser = crate::arguments::positive)]
    settle: Option<f64>,
    /// Play the sound of films, by ffplay; it follows the pictures to a few tenths of a second
    #[arg(long)]
    sound: bool,
    /// Hours of the day in which there is a show, local time; the display is dark otherwise
    #[arg(long, value_name = "HH:MM-HH:MM")]
    hours: Option<Hours>,
    /// With --track: go dark when the tracker has seen nobody for so long, until it sees somebody
    #[arg(long, value_name = "SECONDS", requires = "track", value_parser = crate::arguments::positive)]
    blank_after: Option<f64>,
    /// Pixels of a frame on standard input
    #[arg(long, value_name = "WxH", required_if_eq("sources", "-"))]
    source_size: Option<Size>,
    /// Numbered pictures a second
    #[arg(long, value_name = "R", default_value = "25", value_parser = crate::arguments::positive)]
    rate: f64,
    /// How a source of other proportions fills the image
    #[arg(long, value_enum, default_value_t)]
    fit: FitMode,
    /// The screen, counted from 0 as --list-displays lists them
    #[arg(long, value_name = "N")]
    display: Option<usize>,
    /// List the screens of this machine, and end
    #[arg(long, conflicts_with = "scene")]
    list_displays: bool,
    /// Fill the screen: only then is the image true to scale
    #[arg(long)]
    fullscreen: bool,
    /// Pixels of the window, which is the display, instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Renderer: a graphics device (gpu), the processor (cpu), or the device if there is a hardware one (auto)
    #[arg(long, value_name = "WHICH", value_enum, default_value_t)]
    renderer: RendererMode,
    /// Follow the viewer: opentrack:PORT (UDP over network) or osc:PORT (/midair/viewpoint x y z, mm)
    #[arg(long, value_name = "WHO:PORT")]
    track: Option<Track>,
    /// Where the tracker stands in the scene, mm [default: as the scene's [tracker] says, else 0,0,0]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    tracker_position: Option<Point>,
    /// How it is turned, degrees (Rx*Ry*Rz) [default: as the scene's [tracker] says, else 0,0,0]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    tracker_rotation: Option<Point>,
    /// Take the tracker's readings as they are, without smoothing
    #[arg(long)]
    no_smoothing: bool,
    /// Prediction in ms [default: the measured latency from packet to screen]
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u16).range(0..=100))]
    predict: Option<u16>,
    /// Uniformity correction: divide by the gain; the level is that of the scene's own viewpoint
    #[arg(long, value_name = "MODE", value_enum, num_args = 0..=1, default_missing_value = "fit")]
    gain: Option<GainMode>,
    /// Show figures over the picture: frames a second, the eye, latency (the key O)
    #[arg(long)]
    overlay: bool,
    /// File for the nudged scene, which keeps the comments of the scene file [default: the scene's name with -nudged]
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Quit after this many seconds
    #[arg(long = "for", value_name = "SECONDS", value_parser = crate::arguments::positive)]
    seconds: Option<f64>,
    /// Measure the latency from a packet to the screen, with a synthetic tracker (300 packets, 60 a second)
    #[arg(long, conflicts_with_all = ["track", "seconds"])]
    bench: bool,
}

/// What makes the picture.
#[derive(Clone, Copy, Debug, Default, clap::ValueEnum)]
enum RendererMode {
    #[default]
    Auto,
    Gpu,
    Cpu,
}

impl From<RendererMode> for Renderer {
    fn from(mode: RendererMode) -> Self {
        match mode {
            RendererMode::Auto => Self::Auto,
            RendererMode::Gpu => Self::Gpu,
            RendererMode::Cpu => Self::Cpu,
        }
    }
}

/// Who tells where the viewer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Track(Protocol, u16);

impl FromStr for Track {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "give opentrack:PORT or osc:PORT, such as opentrack:4242".to_owned();
        let (who, port) = text.split_once(':').ok_or_else(wrong)?;
        let protocol = match who {
            "opentrack" => Protocol::OpenTrack,
            "osc" => Protocol::Osc,
            _ => return Err(wrong()),
        };
        let port = port.parse().ok().filter(|&port| port > 0).ok_or_else(wrong)?;
        Ok(Self(protocol, port))
    }
}

/// Seconds that a picture stands, of several sources.
const EACH: f64 = 10.0;

const BENCH: Trial = Trial { packets: 300, rate: 60.0 };

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let Some(scene) = &arguments.scene else { return list_displays(voice) };
    if patterns::are_meant(arguments) {
        return patterns::run(scene, arguments, voice);
    }
    if arguments.shutter.is_some() {
        return Err(Failure::new(
            "--shutter photographs patterns",
            "name them as the source: midair play SCENE patterns --shutter COMMAND",
        ));
    }
    let loaded = open_scene(scene, arguments.size)?;
    let source = match arguments.sources.as_slice() {
        [one] => source(one, arguments)?,
        several => {
            if several.iter().any(|source| source == "-") {
                return Err(Failure::new(
                    "standard input has no place in a list: it is shown as it comes",
                    "give - alone, or leave it out",
                ));
            }
            let kinds = several.iter().map(|one| source(one, arguments));
            SourceKind::List(kinds.collect::<Result<_, _>>()?, arguments.each.unwrap_or(EACH))
        }
    };
    let options = Options {
        source,
        fit: arguments.fit.fit(),
        sound: arguments.sound,
        hours: arguments.hours,
        size: arguments.size.map(|Size(size)| size),
        fullscreen: arguments.fullscreen,
        screen: arguments.display,
        renderer: arguments.renderer.into(),
        settings: Settings {
            tracker: arguments.track.map(|Track(protocol, port)| (protocol, port)),
            calibration: calibration(arguments, &loaded),
            smoothing: (!arguments.no_smoothing).then(OneEuro::default),
            predict: arguments.predict.map(|ms| f64::from(ms) / 1e3),
            gain: arguments.gain.map(GainMode::overflow),
            figures: arguments.overlay,
            blank_after: arguments.blank_after.map(Duration::from_secs_f64),
        },
        save_to: arguments.save.clone().unwrap_or_else(|| nudged(scene)),
        end_after: arguments.seconds.map(Duration::from_secs_f64),
        trial: arguments.bench.then_some(BENCH),
    };
    voice.note(&loaded.notes);
    let (name, size) = (loaded.scene.name.clone(), loaded.scene.display.resolution);
    let outcome = show(loaded, options, &mut |note| voice.note(&[note.to_owned()]))?;
    let Outcome { latency, saved, renderer, packets } = outcome;
    let mut lines =
        saved.iter().map(|path| format!("saved {}\n", path.display())).collect::<String>();
    if let Some(latency) = &latency {
        lines += &told(&name, size, &renderer, latency);
    } else if arguments.bench {
        return Err(Failure::new(
            "not one viewpoint reached the screen",
            "keep the window open until the trial has ended",
        ));
    }
    let report = json!({
        "scene": name,
        "size": size,
        "saved": paths(&saved),
        "renderer": renderer,
        "packets": packets.map(|[readings, others]| json!({ "readings": readings, "others": others })),
        "latency_ms": latency.map(|l| json!({
            "sent": l.sent, "shown": l.shown, "median": l.median, "percentile_99": l.percentile_99, "max": l.max,
            "map_median": l.stages.solve, "draw_median": l.stages.draw, "present_median": l.stages.present,
        })),
    });
    voice.tell(&lines, &report)
}

fn told(name: &str, [width, height]: [usize; 2], renderer: &str, l: &Latency) -> String {
    format!(
        "{name}: {width} x {height}, from packet to screen: median {:.1} ms, 99th percentile {:.1} ms, longest {:.1} ms\n\
         {} of {} viewpoints shown, the others overtaken; map and weights take {:.1} ms, drawing ({renderer}) {:.1} ms, the window system {:.1} ms (medians)\n",
        l.median,
        l.percentile_99,
        l.max,
        l.shown,
        l.sent,
        l.stages.solve,
        l.stages.draw,
        l.stages.present
    )
}

/// Where the tracker stands: as the command line says, else as the scene does.
fn calibration(arguments: &Arguments, loaded: &Loaded) -> Calibration {
    let known = loaded.scene.tracker.unwrap_or_default();
    let or = |given: Option<Point>, known: [f64; 3]| given.map_or(known, |Point(given)| given);
    Calibration {
        position: or(arguments.tracker_position, known.pose.position),
        rotation: or(arguments.tracker_rotation, known.pose.rotation),
        offset: Vec3::from_array(known.offset),
    }
}

fn list_displays(voice: Voice) -> Result<(), Failure> {
    let screens = screens()?;
    let line = |(i, screen)| format!("{i}: {screen}\n");
    let lines: String = screens.iter().enumerate().map(line).collect();
    let report: Vec<_> = screens
        .iter()
        .map(|s| json!({ "name": s.name, "size": s.size, "position": s.position, "rate": s.rate }))
        .collect();
    voice.tell(&lines, &json!({ "displays": report }))
}

fn source(name: &str, arguments: &Arguments) -> Result<SourceKind, Failure> {
    let path = Path::new(name);
    Ok(match (name, arguments.source_size) {
        ("-", Some(Size(size))) => SourceKind::Stdin(size),
        ("lattice", _) if !path.exists() => SourceKind::Lattice,
        _ => {
            let still = is_picture_name(path);
            match Sequence::of_path(path) {
                Some(sequence) if still && !path.exists() => {
                    sequence.numbers()?;
                    SourceKind::Stills(sequence, arguments.rate)
                }
                _ if !path.exists() => {
                    return Err(Failure::new(
                        format!("{}: there is no such file", path.display()),
                        "name a picture, a film, numbered pictures (frames/%04d.png), lattice, patterns, or -",
                    ));
                }
                _ if still => SourceKind::Still(path.to_owned()),
                _ => SourceKind::Film(path.to_owned()),
            }
        }
    })
}

/// `scene-nudged.toml` for `scene.toml`.
fn nudged(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
    scene.with_file_name(format!("{}-nudged.toml", stem))
}

impl From<PlayError> for Failure {
    fn from(error: PlayError) -> Self {
        Self::Told { message: error.to_string(), help: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trackers_are_read_and_typos_refused() {
        assert_eq!("opentrack:4242".parse(), Ok(Track(Protocol::OpenTrack, 4242)));
        assert_eq!("osc:9000".parse(), Ok(Track(Protocol::Osc, 9000)));
        for wrong in ["", "osc", "osc:", "osc:0", "osc:70000", "opentrak:1"] {
            assert!(wrong.parse::<Track>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_nudged_scene_has_a_name_of_its_own() {
        assert_eq!(nudged(Path::new("a/s.toml")), Path::new("a/s-nudged.toml"));
    }
}
