//! `midair map`: what is done with maps themselves.

use crate::arguments::{Size, map_formats, open_map};
use crate::failure::Failure;
use crate::summary::{Voice, counts_line, milliseconds, paths, timings, wrote};
use clap::Subcommand;
use midair::map::format::{FileError, Format, Reading, write_map_and_gain};
use midair::map::{bleed, reversed};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Convert maps between tools, extrapolate them, invert them
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair map convert out/map.exr map.mpcdi --source 1920x1080")]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Convert(Convert),
}

/// Convert a map from one tool's format to another's
///
/// The kinds are those of `midair compensate --format`. A name ending in .exr, .npy, .png, .pgm, .yml, .xml, .json or .mpcdi tells its kind, of two
/// kinds the more general one; --from and --to tell it otherwise. Kinds of two files (ffmpeg, opencv) are named by either of them (xmap.pgm finds
/// ymap.pgm), by their common name, or by both with a comma between, that of x first. Places off the picture, as OpenCV's -1, show nothing.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  midair map convert out/map.exr maps/m.npy --to opencv --source 1920x1080\n  \
    midair map convert theirs.pgm ours.exr --source 1280x720\n  \
    midair map convert out/map.exr wide.exr --bleed 8\n  \
    midair map convert out/map.exr forward.exr --forward --source 1920x1080"
)]
struct Convert {
    /// The map to read
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The map to write
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Kind of the map that is read
    #[arg(long, value_name = "KIND", value_parser = map_formats())]
    from: Option<Format>,
    /// Kind of the map to write
    #[arg(long, value_name = "KIND", value_parser = map_formats())]
    to: Option<Format>,
    /// Pixels of the picture that the map is for; required by ffmpeg and opencv maps
    #[arg(long, value_name = "WxH")]
    source: Option<Size>,
    /// Region of an MPCDI file that has several, one for each projector
    #[arg(long, value_name = "ID")]
    region: Option<String>,
    /// Extrapolate the map by N pixels beyond its coverage; the coverage does not change
    #[arg(long, value_name = "N", default_value = "0", value_parser = clap::value_parser!(u16).range(0..=4096))]
    bleed: u16,
    /// Invert the map: write, for each pixel of the picture, the display point that shows it. The picture has --source pixels, or as many
    /// as the map. The inverse of a forward map is the map for the display again
    #[arg(long, visible_alias = "reverse")]
    forward: bool,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    match &arguments.command {
        Command::Convert(arguments) => convert(arguments, voice),
    }
}

fn convert(arguments: &Convert, voice: Voice) -> Result<(), Failure> {
    let given = arguments.source.map(|Size(size)| size);
    let to = arguments.to.or_else(|| Format::of_path(&arguments.output)).ok_or_else(|| {
        Failure::new(
            format!(
                "{}: its name does not tell which kind of map to write",
                arguments.output.display()
            ),
            "end it in .exr, .npy, .png, .pgm, .yml or .mpcdi, or name the kind with --to",
        )
    })?;
    let absolute = matches!(to, Format::Ffmpeg | Format::OpenCv | Format::OpenCvYaml);
    if absolute && given.is_none() && !arguments.forward {
        return Err(FileError::SourceUnknown { path: arguments.output.clone() }.into());
    }
    let start = Instant::now();
    let region = arguments.region.as_deref();
    let reading = Reading { format: arguments.from, source: given, region };
    let loaded = open_map(&arguments.input, &reading)?;
    let (mut output, name) = crate::output::of_file(&arguments.output)?;
    let mut notes = loaded.notes;
    let (mut map, mut gain) = (loaded.map, loaded.gain);
    let left_out = match to {
        _ if arguments.forward => {
            Some("it is of the display's pixels, and this map has the picture's")
        }
        Format::Exr | Format::ExrHalf => None,
        _ => Some("this kind of map has no place for it"),
    };
    if let Some(why) = left_out
        && gain.take().is_some()
    {
        notes.push(format!("the map's gain is left out: {why}"));
    }
    let read = start.elapsed();

    let start = Instant::now();
    let display = [map.width, map.height];
    let mut source = given.unwrap_or(display);
    if arguments.forward {
        map = reversed(&map, source);
        source = display;
    }
    let counts = map.counts();
    if arguments.bleed > 0 {
        map = bleed(&map, usize::from(arguments.bleed));
    }
    let work = start.elapsed();

    let start = Instant::now();
    let written =
        output.write(&name, |path| write_map_and_gain(&map, gain.as_ref(), source, to, path))?;
    notes.extend(
        written.notes.into_iter().map(|note| format!("{}: {note}", arguments.output.display())),
    );
    let files = output.finish()?;
    let laps = [("read", read), ("convert", work), ("write", start.elapsed())];
    voice.note(&notes);
    laps.iter()
        .for_each(|(name, time)| voice.explain(&format!("{name}: {} ms", milliseconds(*time))));
    let lines = format!(
        "a map of {} x {} pixels as {to}\n{}\n{}",
        map.width,
        map.height,
        counts_line(&counts),
        wrote(&files)
    );
    voice.tell(
        &lines,
        &json!({
            "kind": to.name(),
            "size": [map.width, map.height],
            "source": source,
            "forward": arguments.forward,
            "bleed": arguments.bleed,
            "status": counts,
            "timings_ms": timings(&laps),
            "files": paths(&files),
            "notes": notes,
        }),
    )
}
