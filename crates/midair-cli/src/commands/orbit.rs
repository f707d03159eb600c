//! `midair orbit`: a viewer who walks around, with a fixed map and with one that follows.

use crate::arguments::{Size, check_view, open_picture, open_scene};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, milliseconds, paths, wrote};
use midair::Monitor as _;
use midair::evaluate::orbit::{Seen, Settings, orbit};
use midair::files::write_bytes_atomically;
use midair::measure::lattice::LatticeStyle;
use midair::picture::{Depth, Picture, write_still};
use midair::transport::Setup;
use midair_report::orbit::{chart, page, pixel_mm, strips};
use midair_report::paper::strip;
use midair_video::{Colour, Encoder, Recipe, Timing, VideoError};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Move the eye around the image: views from -15 to 15 degrees, with one fixed map and with a map for each eye position
///
/// Writes orbit.html (strips, a chart of the lattice's displacement), displacement.svg (the chart), strip-fixed.png, strip-tracked.png, orbit.mp4 (fixed left, tracked right; needs ffmpeg)
/// and orbit.json.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  midair orbit scene.toml --out out\n  \
    midair orbit scene.toml --out out --image photo.jpg --from -30 --to 30 --step 10")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Picture that the mid-air image is to show; left out: a lattice
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// The display's resolution instead of the scene's; views are as wide
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// First azimuth in degrees, about the vertical through the image's centre; the scene's viewpoint is at 0
    #[arg(long, value_name = "DEGREES", default_value = "-15", allow_hyphen_values = true, value_parser = degrees)]
    from: f64,
    /// Last azimuth in degrees
    #[arg(long, value_name = "DEGREES", default_value = "15", allow_hyphen_values = true, value_parser = degrees)]
    to: f64,
    /// Degrees from one view to the next
    #[arg(long, value_name = "DEGREES", default_value = "5", value_parser = crate::arguments::positive)]
    step: f64,
    /// How much of the image's plane is shown: 1 the image exactly
    #[arg(long, default_value = "1.3", value_parser = crate::arguments::positive)]
    window: f64,
    /// Frames of the film; 0 leaves it out
    #[arg(long, value_name = "N", default_value = "61", value_parser = clap::value_parser!(u16).range(0..=2000))]
    frames: u16,
}

fn degrees(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.abs() <= 180.0 => Ok(value),
        _ => Err("give degrees from -180 to 180".to_owned()),
    }
}

/// The most views of one run.
const MOST_VIEWS: f64 = 2000.0;

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let (from, to, step) = (arguments.from, arguments.to, arguments.step);
    if !(from < to) || (to - from) / step > MOST_VIEWS {
        return Err(Failure::new(
            format!("from {from} to {to} degrees by {step}: there is no such walk"),
            "give a --from below --to, and a --step that makes at most 2000 views",
        ));
    }
    let loaded = open_scene(&arguments.scene, arguments.size)?;
    let mut notes = loaded.notes.clone();
    let still = arguments.image.as_ref().map(|path| open_picture(path, &mut notes)).transpose()?;
    let picture = still.as_ref().map(|still| &still.picture);
    let setup = Setup::new(&loaded)?;
    let settings = Settings {
        view: setup.view_size(setup.resolution[0].min(1024)),
        window: arguments.window,
        supersampling: 2,
        lattice: LatticeStyle::default(),
    };
    check_view(settings.view, settings.supersampling)?;
    let mut output = crate::output::into_folder(&arguments.out)?;
    let start = Instant::now();
    let bar = Bar::new();
    let count = ((to - from) / step + 1e-9) as usize + 1;
    let azimuths: Vec<f64> = (0..count).map(|i| from + i as f64 * step).collect();
    bar.stage("views", count);
    let stations = orbit(&setup, picture, &azimuths, &settings, &bar)?;

    let strips = strips(&stations);
    for (name, picture) in &strips {
        output
            .write(format!("strip-{name}.png"), |path| write_still(path, picture, Depth::Eight))?;
    }
    if arguments.frames > 1 {
        let small =
            Settings { view: setup.view_size(settings.view[0].min(480)), ..settings.clone() };
        let last = f64::from(arguments.frames - 1);
        let azimuths: Vec<f64> =
            (0..arguments.frames).map(|i| from + (to - from) * f64::from(i) / last).collect();
        bar.stage("frames of the film", azimuths.len());
        let path = output.path("orbit.mp4");
        let make = || film(&setup, picture, &azimuths, &small, &bar, &path);
        if let Err(failure) = make() {
            let _ = std::fs::remove_file(&path);
            notes.push(format!("there is no film: {failure}"));
        }
    }
    bar.finish();
    let chart = chart(&stations, &settings, &setup);
    output.write("displacement.svg", |path| {
        write_bytes_atomically(path, chart.to_svg_file().as_bytes())
    })?;
    let page = page(&loaded.scene.name, &stations, &settings, &setup, &strips, &notes)
        .map_err(|error| Failure::new(error.to_string(), "ask for a smaller --size"))?;
    output.write("orbit.html", |path| write_bytes_atomically(path, page.to_html().as_bytes()))?;
    let millimetres = pixel_mm(&setup, &settings);
    let mut report = json!({
        "midair": env!("CARGO_PKG_VERSION"),
        "command": "orbit",
        "scene": loaded.scene.name,
        "view": settings.view,
        "window": settings.window,
        "mm_per_view_pixel": millimetres,
        "views": stations,
        "timings_ms": { "all": milliseconds(start.elapsed()) },
        "notes": notes,
    });
    output.write("orbit.json", |path| {
        write_bytes_atomically(path, format!("{report:#}\n").as_bytes())
    })?;
    let files = output.finish()?;
    voice.note(&notes);
    let mut lines = format!(
        "{}: mean displacement of the lattice, mm on the image's plane\n azimuth   fixed  tracked\n",
        loaded.scene.name
    );
    // Where nothing is formed there is nothing to be displaced.
    let shown = |seen: &Seen| match seen.exact.mean * millimetres {
        mean if mean.is_finite() => format!("{mean:.3}"),
        _ => "none".to_owned(),
    };
    for station in &stations {
        let (fixed, tracked) = (shown(&station.fixed), shown(&station.tracked));
        lines += &format!("{:7.1}° {fixed:>7} {tracked:>8}\n", station.azimuth);
    }
    lines += &wrote(&files);
    report["files"] = paths(&files);
    voice.tell(&lines, &report)
}

/// The views side by side, there and back.
fn film(
    setup: &Setup,
    picture: Option<&Picture>,
    azimuths: &[f64],
    settings: &Settings,
    bar: &Bar,
    path: &Path,
) -> Result<(), Failure> {
    let mut encoder: Option<Encoder> = None;
    let mut frames: Vec<Vec<u8>> = Vec::new();
    // A few at a time: views are large.
    for part in azimuths.chunks(8) {
        for station in orbit(setup, picture, part, settings, bar)? {
            let both = [&station.fixed.view, &station.tracked.view];
            let frame = strip(&both, 8).unwrap_or_else(|_| station.fixed.view.clone());
            if encoder.is_none() {
                let size = [frame.width, frame.height];
                let colour = Colour::usual(size[1]);
                let recipe = Recipe {
                    size,
                    deep: false,
                    rate: [30, 1],
                    colour: &colour,
                    base: [1, 30],
                    options: &[],
                    coded: None,
                };
                encoder = Some(Encoder::new(path, &recipe)?);
            }
            frames.push(frame.codes_8());
        }
    }
    let Some(mut encoder) = encoder else { return Ok(()) };
    let back = frames.iter().rev().skip(1);
    for (ticks, frame) in (0..).zip(frames.iter().chain(back)) {
        encoder.write(frame, Timing { ticks, base: [1, 30] })?;
    }
    encoder.finish().map_err(|error: VideoError| error.into())
}
