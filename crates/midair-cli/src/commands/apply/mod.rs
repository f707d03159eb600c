//! `midair apply`: a map on stills, films and numbered stills.

mod film;
mod frames;
mod parts;
mod stills;
mod warper;

use crate::arguments::{FitMode, GainMode, Proportions, Size, map_formats, open_map};
use crate::failure::Failure;
use crate::summary::Voice;
use clap::ValueEnum;
use midair::map::format::{Format, Reading};
use midair::map::{Gain, Map};
use midair::picture::{Crop, Evening, Filter, Fit, READ, Sequence, is_picture, is_picture_name};
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Apply a map to a still, a film or numbered stills: what the display must show
///
/// Films are decoded and encoded by ffmpeg. Each frame keeps its time stamp; sound, chapters and metadata are copied. Pixels are interpolated in linear
/// light. A film is made in pieces: after an interruption, the same command with --resume continues.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  midair apply out/map.exr photo.jpg display.png\n  \
    midair apply out/map.exr film.mp4 display.mp4\n  \
    midair apply out/map.exr film.mov display.mov -- -c:v prores_ks -profile:v 3\n  \
    midair apply out/map.exr frames/%04d.png shown/%04d.png\n  \
    midair apply out/map.exr frames/%04d.exr display.mp4 --rate 30\n  \
    midair apply out/map.exr film.mp4 display.mp4 --gain soft")]
pub struct Arguments {
    /// The map
    map: PathBuf,
    /// What the mid-air image shows: a picture (PNG, JPEG, TIFF, WebP, BMP, OpenEXR), a film (any format that ffmpeg reads), or numbered pictures
    /// (frames/%04d.png)
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// What to write: a picture, a film, or numbered pictures
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Format of the map, if its name does not tell
    #[arg(long, value_name = "KIND", value_parser = map_formats())]
    from: Option<Format>,
    /// Pixels of the picture that an ffmpeg or opencv map was made for [default: those of IN]
    #[arg(long, value_name = "WxH")]
    source: Option<Size>,
    /// Region of an MPCDI map that has several, one for each projector
    #[arg(long, value_name = "ID")]
    region: Option<String>,
    /// How frames of other proportions fill the image; needs --proportions, which the map does not know
    #[arg(long, value_enum, default_value_t, requires = "proportions")]
    fit: FitMode,
    /// Width and height of the scene's image, in any unit, for --fit
    #[arg(long, value_name = "W:H")]
    proportions: Option<Proportions>,
    /// Filter for films; pictures always use sharp
    #[arg(long, value_enum, default_value_t)]
    filter: FilterName,
    /// Uniformity correction by the map's gain (`compensate --gain` writes it into map.exr) [default: fit, if the map has a gain]
    #[arg(long, value_name = "MODE", value_enum)]
    gain: Option<GainMode>,
    /// Ignore the map's gain
    #[arg(long, conflicts_with = "gain")]
    no_gain: bool,
    /// Frames a second of a film made of numbered pictures
    #[arg(long, value_name = "R", default_value = "25", value_parser = crate::arguments::positive)]
    rate: f64,
    /// Continue an interrupted run of the same command
    #[arg(long)]
    resume: bool,
    /// Accept a damaged or truncated film: use the frames that can be decoded
    #[arg(long)]
    keep_going: bool,
    /// Write no sound and no subtitles
    #[arg(long)]
    no_audio: bool,
    /// Frames in a piece; an interruption loses one piece at most
    #[arg(long, value_name = "N", default_value = "250", value_parser = clap::value_parser!(u32).range(1..))]
    piece: u32,
    /// ffmpeg's options for its encoder, after --
    #[arg(last = true, value_name = "FFMPEG OPTIONS", allow_hyphen_values = true)]
    encoder: Vec<String>,
}

/// How pixels are made of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum FilterName {
    /// Area average where the map minifies, Catmull-Rom where it magnifies
    #[default]
    Sharp,
    /// Bilinear interpolation, the fastest
    Bilinear,
}

impl Arguments {
    fn filter(&self) -> Filter {
        match self.filter {
            FilterName::Sharp => Filter::Sharp,
            FilterName::Bilinear => Filter::Bilinear,
        }
    }

    /// What is shown of pictures of `size` pixels.
    fn crop(&self, size: [usize; 2]) -> Crop {
        match self.proportions {
            Some(Proportions(image)) => self.fit.fit().crop(size, image),
            None => Fit::Stretch.crop(size, [1.0, 1.0]),
        }
    }

    /// The map for pictures of `size` pixels.
    fn read_map(&self, size: [usize; 2]) -> Result<Ready, Failure> {
        let size = self.crop(size).to;
        let size = self.source.map_or(size, |Size(size)| size);
        let region = self.region.as_deref();
        let loaded =
            open_map(&self.map, &Reading { format: self.from, source: Some(size), region })?;
        let gain = match loaded.gain {
            None if self.gain.is_some() => {
                return Err(Failure::new(
                    format!("{}: this map has no gain", self.map.display()),
                    "make one with it (midair compensate SCENE --gain writes it into map.exr), or leave --gain out",
                ));
            }
            Some(gain) if !self.no_gain => Some((gain, self.gain.unwrap_or(GainMode::Fit))),
            _ => None,
        };
        Ok(Ready { map: loaded.map, gain, notes: loaded.notes })
    }
}

/// A map read.
struct Ready {
    map: Map,
    /// What is to be divided out, and how.
    gain: Option<(Gain, GainMode)>,
    /// What is to be said of it.
    notes: Vec<String>,
}

impl Ready {
    /// For pictures that belong together: the map, the gain to divide out of all at the level of white, and what is to be said.
    fn for_many(self) -> (Map, Option<Evening>, Vec<String>) {
        let Self { map, gain, mut notes } = self;
        let evening = gain.map(|(gain, mode)| {
            let evening = Evening::for_white(&gain, mode.overflow());
            notes.push(evened(mode, evening.level()));
            evening
        });
        (map, evening, notes)
    }
}

/// What is said of a gain that is divided out.
fn evened(mode: GainMode, level: f64) -> String {
    format!(
        "uniformity correction by the map's gain ({}): white is {:.1} % of the display's",
        mode.overflow().name(),
        100.0 * level
    )
}

/// What a path is, by its name.
#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Still,
    Stills(Sequence),
    Film,
}

impl Kind {
    fn of(path: &Path) -> Self {
        let still = is_picture_name(path);
        match Sequence::of_path(path) {
            Some(sequence) if still && !path.exists() => Self::Stills(sequence),
            _ if still => Self::Still,
            _ => Self::Film,
        }
    }

    /// What a file is that is there: where its name does not end in anything, by its first bytes.
    fn of_input(path: &Path) -> Self {
        let first = |path: &Path| -> std::io::Result<Vec<u8>> {
            let mut start = Vec::new();
            std::fs::File::open(path)?.take(64).read_to_end(&mut start)?;
            Ok(start)
        };
        match path.extension() {
            None if first(path).is_ok_and(|start| is_picture(&start)) => Self::Still,
            _ => Self::of(path),
        }
    }
}

/// Kinds of picture that are not read, by the ends of their names, and that ffmpeg would take for short films.
const OTHER_PICTURES: [&str; 24] = [
    "heic", "heif", "avif", "jxl", "jp2", "j2k", "psd", "psb", "svg", "hdr", "pfm", "tga", "dds",
    "ico", "pcx", "ppm", "pgm", "pnm", "dpx", "cin", "dng", "cr2", "nef", "arw",
];

/// Refuses an input that is not there, or is a picture of another kind.
fn check_input(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if matches!(Kind::of(path), Kind::Stills(_)) {
        return Ok(());
    }
    if !path.is_file() {
        let help = match pattern_meant(path) {
            Some(meant) => format!("numbered pictures are named {}", meant.display()),
            None => {
                "check the path; numbered pictures are named by a pattern such as frames/%04d.png"
                    .to_owned()
            }
        };
        return Err(Failure::new(format!("{}: there is no such file", path.display()), help));
    }
    if OTHER_PICTURES.iter().any(|other| extension.eq_ignore_ascii_case(other)) {
        return Err(Failure::new(
            format!("{}: this is not a {READ} picture", path.display()),
            "convert it to one of them",
        ));
    }
    Ok(())
}

/// The pattern that another tool's way of naming numbered pictures stands for: `f####.png`, `f@@@@.png`, `f%4d.png`, `f$F4.png`, `f*.png`,
/// `f[0001-0100].png`.
fn pattern_meant(path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let (at, length, width) = if let Some(at) = name.find(['#', '@']) {
        let run = name[at..].bytes().take_while(|&byte| byte == name.as_bytes()[at]).count();
        (at, run, run)
    } else if let Some(at) = name.find('%') {
        let width = digits(&name[at + 1..]);
        if !name[at + 1 + width..].starts_with('d') {
            return None;
        }
        (at, width + 2, name[at + 1..at + 1 + width].parse().unwrap_or(4))
    } else if let Some(at) = name.find("$F") {
        let width = digits(&name[at + 2..]);
        (at, 2 + width, name[at + 2..at + 2 + width].parse().unwrap_or(1))
    } else if let Some(at) = name.find('[') {
        let length = name[at..].find(']')? + 1;
        (at, length, digits(&name[at + 1..]).max(1))
    } else {
        (name.find(['*', '?'])?, 1, 4)
    };
    let name = format!("{}%{width:02}d{}", &name[..at], &name[at + length..]);
    Some(path.with_file_name(name))
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let mismatch = |made: &str, instead: &str| {
        let message = format!("{}: {made}", arguments.output.display());
        Err(Failure::new(message, instead))
    };
    if arguments.input == arguments.output {
        return mismatch("this is the input as well", "give the output another name");
    }
    check_input(&arguments.input)?;
    match (Kind::of_input(&arguments.input), Kind::of(&arguments.output)) {
        (Kind::Still, Kind::Still) => stills::one(arguments, voice),
        (Kind::Still, _) => mismatch("one picture makes one picture", "name a .png or .exr file"),
        (Kind::Stills(from), Kind::Stills(to)) => stills::each(arguments, &from, &to, voice),
        (Kind::Stills(from), Kind::Film) => film::of_stills(arguments, &from, voice),
        (Kind::Film, Kind::Film) => film::of_film(arguments, voice),
        (Kind::Film, Kind::Stills(to)) => film::into_stills(arguments, &to, voice),
        (_, Kind::Still) => mismatch(
            "a film or numbered pictures make more than one picture",
            "name a film, or numbered pictures such as shown/%04d.png",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_tools_patterns_are_understood() {
        for (given, meant) in [
            ("a/f####.png", "a/f%04d.png"),
            ("f@@@.exr", "f%03d.exr"),
            ("f%4d.png", "f%04d.png"),
            ("f.$F4.exr", "f.%04d.exr"),
            ("f*.png", "f%04d.png"),
            ("f[0001-0100].png", "f%04d.png"),
        ] {
            assert_eq!(pattern_meant(given.as_ref()).as_deref(), Some(meant.as_ref()), "{given}");
        }
        assert_eq!(pattern_meant("nosuch.png".as_ref()), None);
        assert_eq!(pattern_meant("100%.png".as_ref()), None);
    }

    #[test]
    fn kinds_are_told_by_names() {
        assert_eq!(Kind::of("a/b.JPG".as_ref()), Kind::Still);
        assert!(matches!(Kind::of("a/%03d.exr".as_ref()), Kind::Stills(_)));
        assert_eq!(Kind::of("a/b.mkv".as_ref()), Kind::Film);
        assert_eq!(Kind::of("a/b%d.mkv".as_ref()), Kind::Film);
    }
}
