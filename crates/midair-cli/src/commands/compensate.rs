//! `midair compensate`: the map, and what the display must show.

use crate::arguments::{Size, check_view, map_formats, open_picture, open_scene};
use crate::failure::Failure;
use crate::output::Output;
use crate::progress::Bar;
use crate::summary::{Counts, Voice, number, paths, timings, wrote};
use clap::ValueEnum;
use midair::evaluate::proof::{Reference, Watch as _, view_size};
use midair::map::format::{Format, write_bytes_atomically, write_map};
use midair::map::{Accuracy, Map, bleed, forward, invert, splat};
use midair::media::optimal::{Weighting, optimal_display, view_through};
use midair::media::{Depth, Picture, Still, display_image, write_still};
use midair::scene::Loaded;
use midair::simulate::Camera;
use midair::transport::Setup;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Work out what the display must show: the map, and the display image of a picture
///
/// Writes the map (map.exr: R = u, G = v, A = 1 where ok), display.png if there is a picture, and report.json with counts, error bound and times.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  midair compensate scene.toml --out out\n  \
    midair compensate scene.toml --image photo.jpg --out out --size 1920x1080 --optimal\n  \
    midair compensate scene.toml --out out --format exr,npy,opencv")]
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
    let still = arguments.image.as_ref().map(|path| open_picture(path, &mut notes)).transpose()?;
    let setup = Setup::new(&loaded)?;
    let mut output = Output::into_folder(&arguments.out)?;

    let bar = Bar::new();
    let spp = arguments.spp.unwrap_or(1000) as usize;
    let solved = solve(&setup, arguments.method, spp, &bar);
    let mut laps = vec![("map", solved.time)];

    if let Some(still) = &still {
        notes.extend(stretch_note(&setup, &still.picture));
        let (mut display, time) = timed(|| Ok(display_image(&still.picture, &solved.map)))?;
        laps.push(("colour", time));
        if arguments.optimal {
            bar.stage("best display image", 1);
            let (best, time) = timed(|| optimal(&loaded, &setup, &still.picture, &display))?;
            display = best;
            laps.push(("optimal", time));
        }
        let ((), time) = timed(|| write_display(&mut output, still, &display))?;
        laps.push(("write_display", time));
    }
    let source = match &still {
        Some(still) => [still.picture.width, still.picture.height],
        None => view_size(&setup, setup.resolution[0]),
    };
    let rings = usize::from(arguments.bleed);
    let (more, time) = timed(|| {
        let bled = (rings > 0).then(|| bleed(&solved.map, rings));
        let map = bled.as_ref().unwrap_or(&solved.map);
        let mut notes = write_maps(&mut output, map, "map", source, &arguments.format)?;
        if arguments.forward {
            let map = bleed(&forward(&setup, &solved.map, source), rings);
            notes.extend(write_maps(
                &mut output,
                &map,
                "forward",
                setup.resolution,
                &arguments.format,
            )?);
        }
        Ok(notes)
    })?;
    notes.extend(more);
    laps.push(("write_map", time));
    bar.finish();

    let counts = Counts::of(&solved.map);
    let report = json!({
        "midair": env!("CARGO_PKG_VERSION"),
        "command": "compensate",
        "scene": loaded.scene.name,
        "method": arguments.method.name(),
        "spp": (arguments.method == Method::Splat).then_some(spp),
        "optimal": arguments.optimal,
        "size": setup.resolution,
        "status": counts.json(),
        "error_bound": number(solved.map.error_bound),
        "rays": solved.rays,
        "effort": solved.effort,
        "timings_ms": timings(&laps),
        "notes": notes,
    });
    write_report(&mut output, &report)?;
    let files = output.finish()?;
    voice.note(&notes);
    explain(&solved, &laps, voice);
    let lines = format!(
        "{}: {} x {} display pixels mapped in {:.1} ms\n{}\n{}\n{}",
        loaded.scene.name,
        setup.resolution[0],
        setup.resolution[1],
        solved.time.as_secs_f64() * 1e3,
        counts.line(),
        bound_line(&solved.map),
        wrote(&files)
    );
    let mut report = report;
    report["files"] = paths(&files);
    voice.tell(&lines, &report)
}

/// A map and what it took.
pub struct Solved {
    pub map: Map,
    pub rays: u64,
    pub effort: Value,
    pub time: Duration,
}

/// Makes the map.
fn solve(setup: &Setup, method: Method, spp: usize, bar: &Bar) -> Solved {
    let start = Instant::now();
    match method {
        Method::Inverse => {
            bar.stage("map", 1);
            let (map, effort) = invert(setup, Accuracy::default());
            let time = start.elapsed();
            let told = json!({ "patches": effort.patches, "solved_pixels": effort.solved_pixels });
            Solved { map, rays: effort.rays, effort: told, time }
        }
        Method::Splat => {
            bar.stage("samples of the view", setup.resolution[1]);
            let splat = splat(setup, spp, &|rows| bar.advance(rows));
            let time = start.elapsed();
            Solved { map: splat.map, rays: splat.rays, effort: Value::Null, time }
        }
    }
}

fn timed<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<(T, Duration), Failure> {
    let start = Instant::now();
    let made = work()?;
    Ok((made, start.elapsed()))
}

/// The display image whose view comes nearest to what would be seen with no object in the way.
fn optimal(
    loaded: &Loaded,
    setup: &Setup,
    picture: &Picture,
    initial: &Picture,
) -> Result<Picture, Failure> {
    let [width, height] = setup.resolution;
    let size = view_size(setup, width);
    let camera = Camera::at_viewpoint(setup, size);
    check_view(size, camera.supersampling)?;
    let open = Reference::new(loaded, &camera, &|_| {});
    let target =
        view_through(&open.samples, &display_image(picture, &Map::identity(width, height)))?;
    let samples = camera.samples(setup, &|_| {});
    Ok(optimal_display(&samples, &target, initial, Weighting::default())?.display)
}

/// Writes what the display shows: 8 bits for a picture of 8 bits, else 16, and OpenEXR for an OpenEXR picture as well.
pub fn write_display(output: &mut Output, still: &Still, display: &Picture) -> Result<(), Failure> {
    output.write("display.png", |path| write_still(path, display, still.depth))?;
    if still.depth == Depth::Float {
        output.write("display.exr", |path| write_still(path, display, Depth::Float))?;
    }
    Ok(())
}

/// Writes the map in each format, under the format's file name with `name` in the place of "map"; returns what the
/// user should know.
pub fn write_maps(
    output: &mut Output,
    map: &Map,
    name: &str,
    source: [usize; 2],
    formats: &[Format],
) -> Result<Vec<String>, Failure> {
    let mut notes = Vec::new();
    for &format in formats {
        let name = format.file_name().replacen("map", name, 1);
        let written = output.write(&name, |path| write_map(map, source, format, path))?;
        // The note may begin with the file's name, which is not yet the final one.
        notes.extend(written.notes.into_iter().map(|note| match note.split_once(": ") {
            Some((file, rest)) if Path::new(file).ends_with(&name) => {
                format!("{name}: {rest}")
            }
            _ => note,
        }));
    }
    Ok(notes)
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

fn bound_line(map: &Map) -> String {
    if map.error_bound.is_finite() {
        format!(
            "every ok pixel is within {:.1e} of exact ({:.0e} pixels of a 1024-pixel image)",
            map.error_bound,
            map.error_bound * 1024.0
        )
    } else {
        "no error bound: the splat method proves none".to_owned()
    }
}

fn explain(solved: &Solved, laps: &[(&'static str, Duration)], voice: Voice) {
    voice.explain(&format!("the map took {} rays; effort {}", solved.rays, solved.effort));
    for (name, time) in laps {
        voice.explain(&format!("{name}: {:.1} ms", time.as_secs_f64() * 1e3));
    }
}
