//! `midair evaluate`: a set-up as a camera sees it, with and without compensation; the paper's, or one's own.

mod pictures;
mod pieces;
mod subjects;
mod tables;
mod ways;
mod words;

use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, number, paths};
use clap::ValueEnum;
use midair::evaluate::paper::{
    Evaluation, PaperError, QualityView, Settings, Subject, quality, shape,
};
use midair::files::write_bytes_atomically;
use midair::measure::lpips::{Lpips, LpipsError};
use midair::picture::Picture;
use midair_report::paper::paper_page;
use pieces::Pieces;
use serde_json::json;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Instant;
use subjects::{Subjects, photographs};

/// Evaluate a set-up as a camera sees it: similarity of photographs, displacement of a lattice over the camera's azimuth
///
/// Views of the scene are rendered through the plate: without the object, compensated, and without compensation. With --paper: the paper's cylinder,
/// cube and bent mirrors (which bend either way, as the paper does not say which), compared with the published figures. Writes report.html,
/// self-contained, report.json, likeness.csv, displacement.csv, and as they come a strip of the three views for each photograph and the lattice from
/// each azimuth. After an interruption the same command with --resume continues.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    midair evaluate scene.toml --images photos --out evaluation --azimuths -15:15:5\n  \
    midair evaluate --paper --images photos --out evaluation --quick --compare")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    #[arg(required_unless_present = "paper", conflicts_with = "paper")]
    scene: Option<PathBuf>,
    /// The paper's set-ups, its figures beside
    #[arg(long)]
    paper: bool,
    /// Folder of photographs: PNG, JPEG, TIFF, WebP, BMP or OpenEXR; cropped to the image's proportions
    #[arg(long, value_name = "DIR")]
    images: PathBuf,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Azimuths of the camera about the image's centre, degrees: from:to:step, or numbers with commas between [default: -15:15:5]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    azimuths: Option<Azimuths>,
    /// Pixels of the camera's picture to a millimetre at the image, which displacements are told in
    #[arg(long, value_name = "N", default_value = "16.8", value_parser = crate::arguments::positive)]
    pixels_per_mm: f64,
    /// The plate [default: as the scene has it; slit-mirror with --paper]
    #[arg(long, value_enum)]
    plate: Option<PlateKind>,
    /// Paths through each pixel [default: 512, with --quick 128]
    ///
    /// Too few, and likeness is that of noise: the report tells beside each how like the reference is to itself with other random numbers.
    /// The lattice gets a quarter of them.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65536))]
    spp: Option<u32>,
    /// Diameter of the camera's pupil, mm; 0 is a pinhole
    #[arg(long, value_name = "MM", default_value = "20", value_parser = pupil)]
    aperture: f64,
    /// Three photographs, three azimuths and small views: minutes become seconds
    #[arg(long)]
    quick: bool,
    /// Set other ways to fill the display beside the exact map: as it is, a homography, structured light, the paper's samples, the best display image
    ///
    /// Displacement, similarity and time of each, on every surface; about a minute for each. ways.csv has the figures.
    #[arg(long)]
    compare: bool,
    /// Continue an interrupted run of the same command
    #[arg(long)]
    resume: bool,
}

/// How the plate is modelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PlateKind {
    /// Two layers of slit mirrors, by Monte Carlo path tracing: blur, loss and stray light
    SlitMirror,
    /// Plane symmetry, without loss
    Ideal,
}

/// Azimuths in degrees.
#[derive(Clone, Debug, PartialEq)]
struct Azimuths(Vec<f64>);

impl FromStr for Azimuths {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        /// More are a film.
        const MOST: f64 = 1000.0;
        let wrong = || {
            "give from:to:step, such as -15:15:5, or numbers such as -10,0,10, of less than 90 degrees".to_owned()
        };
        let number = |text: &str| {
            text.trim().parse::<f64>().ok().filter(|n| n.abs() < 90.0).ok_or_else(wrong)
        };
        let parts: Vec<&str> = text.split(':').collect();
        let all = match parts[..] {
            [list] => list.split(',').map(number).collect::<Result<Vec<_>, _>>()?,
            [from, to, step] => {
                let (from, to, step) = (number(from)?, number(to)?, number(step)?);
                let count = (to - from) / step;
                if !(0.0..=MOST).contains(&count) {
                    return Err(wrong());
                }
                // A last step that rounding makes a hair too long still counts.
                (0..=(count + 1e-9) as usize).map(|k| from + k as f64 * step).collect()
            }
            _ => return Err(wrong()),
        };
        Ok(Self(all))
    }
}

fn pupil(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=200.0).contains(&value) => Ok(value),
        _ => Err("give a diameter from 0 to 200 mm".to_owned()),
    }
}

impl From<PaperError> for Failure {
    fn from(error: PaperError) -> Self {
        match error {
            PaperError::Setup(error) => error.into(),
            other => Self::Told { message: other.to_string(), help: None },
        }
    }
}

impl Arguments {
    fn settings(&self) -> Settings {
        let mut settings = Settings {
            aperture: self.aperture,
            pixels_per_mm: self.pixels_per_mm,
            ..Settings::default()
        };
        if self.quick {
            settings.quality_width = 240;
            settings.samples_per_pixel = 128;
            settings.shape_samples_per_pixel = 64;
            settings.shape_size = 240;
            settings.line_width = 0.03;
            settings.azimuths = vec![-15.0, 0.0, 15.0];
        }
        if let Some(Azimuths(azimuths)) = &self.azimuths {
            settings.azimuths.clone_from(azimuths);
        }
        if let Some(spp) = self.spp {
            settings.samples_per_pixel = spp;
            settings.shape_samples_per_pixel = (spp / 4).max(16);
        }
        settings
    }
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let start = Instant::now();
    let mut notes = Vec::new();
    let mut photographs = photographs(&arguments.images, &mut notes)?;
    if arguments.quick {
        photographs.truncate(3);
    }
    let settings = arguments.settings();
    let subjects = Subjects::of(arguments, &mut notes)?;
    let (lpips, missing) = match Lpips::find() {
        Ok(lpips) => (Some(lpips), None),
        Err(error @ LpipsError::NoWeights { .. }) => (None, Some(error.to_string())),
        Err(error) => {
            return Err(Failure::new(
                error.to_string(),
                "remove the file, or get it again: midair weights",
            ));
        }
    };
    notes.extend(missing.iter().map(|why| format!("LPIPS was not computed. {why}.")));
    // What cannot be written is refused before the work.
    drop(crate::output::into_folder(&arguments.out)?);
    let pieces = Pieces::begin(arguments, &settings, &photographs, lpips.is_some())?;
    crate::output::on_interrupt_say("interrupted; the same command with --resume goes on");
    let bar = Bar::new();
    let mut evaluation = Evaluation { published: arguments.paper, ..Evaluation::default() };
    for (surface, scene) in &subjects.shape {
        let subject = Subject { surface, scene };
        let (found, why) = match pieces.shape(surface) {
            Some(known) => known,
            None => {
                let done = |azimuth: f64, views: [Picture; 4]| -> Result<(), Failure> {
                    pictures::write_lattices(&pieces, surface, azimuth, &views)
                };
                let found = shape(subject, &subjects.plate, &settings, &bar, done)?;
                pieces.keep_shape(surface, &found)?;
                found
            }
        };
        evaluation.shapes.push(found);
        notes.extend(why);
    }
    let (mut exposures, mut strips) = (Vec::new(), Vec::new());
    for (surface, scene) in &subjects.quality {
        let subject = Subject { surface, scene };
        let todo: Vec<_> = photographs
            .iter()
            .filter(|one| pieces.row(surface, &one.name).is_none())
            .cloned()
            .collect();
        let done = |view: QualityView| -> Result<(), Failure> {
            pictures::write_strip(&pieces, &view)?;
            pieces.keep_row(&view.row, view.exposure)
        };
        if !todo.is_empty() {
            quality(subject, &todo, &subjects.plate, &settings, lpips.as_ref(), &bar, done)?;
        }
        for one in &photographs {
            let Some((row, exposure)) = pieces.row(surface, &one.name) else { continue };
            strips.push(pictures::strip_figure(&pieces, &row)?);
            exposures.push(exposure);
            evaluation.quality.push(row);
        }
    }
    if arguments.compare {
        let columns = if arguments.quick { 1200 } else { 2400 };
        let (subjects, photographs, settings) = (&subjects, &photographs[..], &settings);
        let ground = ways::Ground { subjects, photographs, settings, columns };
        evaluation.ways = ways::compare(&ground, &pieces, &bar, &mut notes)?;
    }
    bar.finish();
    let seconds = start.elapsed().as_secs_f64();
    evaluation.assumptions = words::assumptions(arguments, &subjects, &settings, &exposures);
    evaluation.differences = words::differences(arguments);
    evaluation.notes = notes.clone();
    let colophon = format!(
        "midair {} evaluate{}{}: {} photographs, {seconds:.0} s",
        env!("CARGO_PKG_VERSION"),
        if arguments.paper { " --paper" } else { "" },
        if arguments.quick { " --quick" } else { "" },
        photographs.len(),
    );
    let mut told = evaluation.to_json();
    told["midair"] = json!(env!("CARGO_PKG_VERSION"));
    told["command"] = json!("evaluate");
    told["settings"] = json!({
        "plate": subjects.plate_name(),
        "samples_per_pixel": settings.samples_per_pixel,
        "shape_samples_per_pixel": settings.shape_samples_per_pixel,
        "line_width": settings.line_width,
        "aperture": settings.aperture,
        "quality_width": settings.quality_width,
        "shape_size": settings.shape_size,
        "shape_window": settings.shape_window,
        "azimuths": settings.azimuths,
        "pixels_per_mm": settings.pixels_per_mm,
        "lpips": lpips.is_some(),
    });
    told["exposures"] = exposures.iter().map(|factor| number(*factor)).collect();
    told["seconds"] = json!(seconds);
    let text = |name: &str, text: String| {
        pieces.write(name, |path| write_bytes_atomically(path, text.as_bytes()))
    };
    text("report.json", format!("{told:#}\n"))?;
    text("likeness.csv", evaluation.likeness_csv())?;
    text("displacement.csv", evaluation.displacement_csv())?;
    if arguments.compare {
        text("ways.csv", evaluation.ways_csv())?;
    }
    let page = paper_page(&evaluation, &strips, &colophon);
    pieces.write("report.html", |path| page.write_atomically(path))?;
    let files = pieces.finish()?;
    voice.note(&notes);
    let page = arguments.out.join("report.html");
    told["files"] = paths(&files);
    voice.tell(&format!("{}see {}\n", tables::lines(&told, arguments.paper), page.display()), &told)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_are_a_range_or_a_list() {
        let read = |text: &str| text.parse::<Azimuths>().map(|Azimuths(all)| all);
        assert_eq!(read("-15:15:5"), Ok(vec![-15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0]));
        assert_eq!(read("-0.3:0.3:0.1").unwrap().len(), 7);
        assert_eq!(read("10:-10:-10"), Ok(vec![10.0, 0.0, -10.0]));
        assert_eq!(read("-10, 0,12.5"), Ok(vec![-10.0, 0.0, 12.5]));
        for wrong in ["", "a", "1:2", "0:10:0", "0:10:-1", "0:89:0.0001", "95", "0,nan"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
