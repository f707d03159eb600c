//! `midair compensate`: the map, and what the display must show.

use crate::arguments::{GainMode, Size, map_formats, open_picture, open_scene};
use crate::failure::Failure;
use crate::output::Output;
use crate::progress::Bar;
use crate::summary::{Counts, Voice, number, paths, timings, wrote};
use clap::ValueEnum;
use maps::{Solutions, Solved, write_six_channels};
use midair::Monitor as _;
use midair::evaluate::proof::view_size;
use midair::map::format::{Format, write_bytes_atomically};
use midair::map::{bleed, forward};
use midair::picture::Picture;
use midair::scene::Loaded;
use midair::transport::Setup;
use serde_json::{Value, json};
use show::{colour, finish, gains, optimal};
use std::path::PathBuf;
use std::time::{Duration, Instant};

mod maps;
mod show;

pub use maps::write_maps;
pub use show::write_display;

/// Work out what the display must show: the map, and the display image of a picture
///
/// Writes the map (map.exr: R = u, G = v, A = 1 where ok), display.png if there is a picture, and report.json with counts, error bound and times.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  midair compensate scene.toml --out out\n  \
    midair compensate scene.toml --image photo.jpg --out out --size 1920x1080 --optimal\n  \
    midair compensate scene.toml --out out --format exr,npy,opencv\n  \
    midair compensate scene.toml --image photo.jpg --out out --gain fit --per-channel")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Picture that the mid-air image is to show: PNG, JPEG or OpenEXR
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The display's resolution instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// How the map is made
    #[arg(long, value_enum, default_value_t)]
    method: Method,
    /// Samples per pixel of `splat` [default: 1000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    spp: Option<u32>,
    /// The display image whose view comes nearest to the picture, by least squares
    #[arg(long, requires = "image")]
    optimal: bool,
    /// Divide out how much of the display's light arrives (Fresnel's losses, tints, mirrors, the plate), so that the image is even
    #[arg(long, value_name = "MODE", value_enum, num_args = 0..=1, default_missing_value = "fit")]
    gain: Option<GainMode>,
    /// A map for each of the display's colours, so that glass with dispersion leaves no fringes: map_r, map_g, map_b, and map_rgb.exr with
    /// all three
    #[arg(long)]
    per_channel: bool,
    /// Kinds of map files, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "exr", value_parser = map_formats())]
    format: Vec<Format>,
    /// Let the maps go on for N pixels beyond the covered region, for tools that interpolate between their pixels; coverage stays as it
    /// is
    #[arg(long, value_name = "N", default_value = "0", value_parser = clap::value_parser!(u16).range(0..=4096))]
    bleed: u16,
    /// Write the forward map as well: for each pixel of the picture the place on the display that shows it (forward.exr, ...)
    #[arg(long)]
    forward: bool,
}

/// How a map is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Exactly, by adaptive inversion with an error bound
    #[default]
    Inverse,
    /// The paper's way: random samples through the view, kept where they land
    Splat,
}

impl Method {
    /// As on the command line and in report.json.
    fn name(self) -> &'static str {
        match self {
            Self::Inverse => "inverse",
            Self::Splat => "splat",
        }
    }
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    if arguments.spp.is_some() && arguments.method == Method::Inverse {
        return Err(Failure::new(
            "--spp is a setting of --method splat; the inverse method takes no samples",
            "add --method splat, or leave --spp out",
        ));
    }
    let loaded = open_scene(&arguments.scene, arguments.size)?;
    let mut notes = loaded.notes.clone();
    let mut still =
        arguments.image.as_ref().map(|path| open_picture(path, &mut notes)).transpose()?;
    let setups = match arguments.per_channel {
        true => Setup::new(&loaded)?.by_colour().into(),
        false => vec![Setup::new(&loaded)?],
    };
    notes.extend(colour_note(&loaded, arguments.per_channel));
    let mut output = Output::into_folder(&arguments.out)?;

    let bar = Bar::new();
    let spp = arguments.spp.unwrap_or(1000) as usize;
    let solutions = Solutions::make(setups, arguments.method, spp, &bar);
    let Solved { setup, map, .. } = solutions.main();
    let mut laps = vec![("map", solutions.time())];
    let gains = match arguments.gain {
        Some(_) => {
            bar.stage("gain", 1);
            let (gains, time) = timed(|| Ok(gains(&solutions)))?;
            laps.push(("gain", time));
            Some(gains)
        }
        None => None,
    };
    let mut shown = None;

    if let Some(still) = &mut still {
        notes.extend(stretch_note(setup, &still.picture));
        let (mut light, time) = timed(|| Ok(colour(&still.picture, &solutions)))?;
        laps.push(("colour", time));
        if arguments.optimal {
            bar.stage("best display image", 1);
            // Nothing needs the photograph after that, and the search needs the memory.
            let pixels = std::mem::take(&mut still.picture.pixels);
            let picture = Picture { pixels, ..still.picture };
            let (best, time) = timed(|| optimal(&solutions, picture, light))?;
            light = best;
            laps.push(("optimal", time));
        }
        let evening = arguments.gain.zip(gains.as_deref());
        let (finished, time) = timed(|| Ok(finish(&loaded, light, evening)))?;
        laps.push(("brightness", time));
        let ((), time) = timed(|| write_display(&mut output, still, &finished.display))?;
        laps.push(("write_display", time));
        shown = Some(finished);
    }
    let source = match &still {
        Some(still) => [still.picture.width, still.picture.height],
        None => view_size(setup, setup.resolution[0]),
    };
    let rings = usize::from(arguments.bleed);
    let (more, time) = timed(|| {
        let mut notes = Vec::new();
        for (c, solved) in solutions.0.iter().enumerate() {
            let name = match solutions.by_colour() {
                true => ["map_r", "map_g", "map_b"][c],
                false => "map",
            };
            let bled = (rings > 0).then(|| bleed(&solved.map, rings));
            let map = bled.as_ref().unwrap_or(&solved.map);
            let gain = gains.as_ref().map(|gains| &gains[c]);
            notes.extend(write_maps(&mut output, map, gain, name, source, &arguments.format)?);
            if arguments.forward {
                let map = bleed(&forward(&solved.setup, &solved.map, source), rings);
                let name = name.replacen("map", "forward", 1);
                let size = solved.setup.resolution;
                notes.extend(write_maps(&mut output, &map, None, &name, size, &arguments.format)?);
            }
        }
        if solutions.by_colour() && arguments.format.contains(&Format::Exr) {
            write_six_channels(&mut output, &solutions)?;
        }
        Ok(notes)
    })?;
    notes.extend(more);
    laps.push(("write_map", time));
    bar.finish();

    let counts = Counts::of(map);
    let report = json!({
        "midair": env!("CARGO_PKG_VERSION"),
        "command": "compensate",
        "scene": loaded.scene.name,
        "method": arguments.method.name(),
        "spp": (arguments.method == Method::Splat).then_some(spp),
        "optimal": arguments.optimal,
        "size": setup.resolution,
        "status": counts.json(),
        "error_bound": number(solutions.error_bound()),
        "rays": solutions.rays(),
        "effort": solutions.main().effort,
        "colours": solutions.colours_json(),
        "brightness": shown.as_ref().map(|shown| &shown.json),
        "timings_ms": timings(&laps),
        "notes": notes,
    });
    write_report(&mut output, &report)?;
    let files = output.finish()?;
    voice.note(&notes);
    explain(&solutions, &laps, voice);
    let lines = format!(
        "{}: {} x {} display pixels mapped{} in {:.1} ms\n{}\n{}\n{}{}",
        loaded.scene.name,
        setup.resolution[0],
        setup.resolution[1],
        if solutions.by_colour() { " for each of three colours" } else { "" },
        solutions.time().as_secs_f64() * 1e3,
        counts.line(),
        bound_line(solutions.error_bound()),
        shown.map(|shown| shown.lines).unwrap_or_default(),
        wrote(&files)
    );
    let mut report = report;
    report["files"] = paths(&files);
    voice.tell(&lines, &report)
}

fn timed<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<(T, Duration), Failure> {
    let start = Instant::now();
    let made = work()?;
    Ok((made, start.elapsed()))
}

/// Writes report.json.
pub fn write_report(output: &mut Output, report: &Value) -> Result<(), Failure> {
    output.write("report.json", |path| {
        write_bytes_atomically(path, format!("{report:#}\n").as_bytes())
    })
}

/// Says so if the picture's proportions are not the image's.
pub fn stretch_note(setup: &Setup, picture: &Picture) -> Option<String> {
    let picture_shape = picture.width as f64 / picture.height as f64;
    let image_shape = setup.image.size[0] / setup.image.size[1];
    // A pixel more or less is rounding.
    let slack = 1.0 / picture.width.min(picture.height) as f64;
    ((picture_shape / image_shape - 1.0).abs() > slack.max(0.005)).then(|| {
        format!(
            "the picture ({} x {} pixels) is stretched over the image ({} x {} mm)",
            picture.width, picture.height, setup.image.size[0], setup.image.size[1]
        )
    })
}

/// Says so if indices depend on the wavelength and the maps do not, or the other way.
fn colour_note(loaded: &Loaded, per_channel: bool) -> Option<String> {
    match (loaded.scene.disperses(), per_channel) {
        (true, false) => Some(
            "a material disperses: this map is for yellow light (587.6 nm); --per-channel makes one for each colour".into(),
        ),
        (false, true) => {
            Some("no material disperses: the three maps are the same".to_owned())
        }
        _ => None,
    }
}

fn bound_line(bound: f64) -> String {
    if bound.is_finite() {
        format!(
            "every ok pixel is within {:.1e} of exact ({:.0e} pixels of a 1024-pixel image)",
            bound,
            bound * 1024.0
        )
    } else {
        "no error bound: the splat method proves none".to_owned()
    }
}

fn explain(solutions: &Solutions, laps: &[(&'static str, Duration)], voice: Voice) {
    voice.explain(&format!(
        "the map took {} rays; effort {}",
        solutions.rays(),
        solutions.main().effort
    ));
    for (name, time) in laps {
        voice.explain(&format!("{name}: {:.1} ms", time.as_secs_f64() * 1e3));
    }
}
