//! `midair measure`: what a photograph of the real thing shows.

use crate::arguments::open_picture;
use crate::failure::Failure;
use crate::summary::{Voice, number, paths, wrote};
use clap::{Subcommand, ValueEnum};
use midair::files::write_bytes_atomically;
use midair::measure::Plane;
use midair::measure::lattice::{
    Alignment, Count, Displacement, Lattice, LatticeError, aligned, detect, detect_part,
    displacement,
};
use midair::picture::{Depth, Picture, write_still};
use midair_report::drawing::lattice_picture;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Measure photographs of a set-up
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair measure lattice photo.jpg --out measured")]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Lattice(LatticeArguments),
}

/// Find the intersections of a lattice in a photograph, to a fraction of a pixel
///
/// The lattice may be turned by up to 45 degrees, seen in perspective, bent and unevenly lit. Where an edge of the object cuts it, what no line joins
/// to the rest is left out, and that is said: behind an edge lines may be missing, seen twice or in another order. Places are in
/// pixels from the photograph's top left corner, x right and y down; the first pixel's centre is (0.5, 0.5).
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  midair measure lattice photo.jpg --out measured\n  \
    midair measure lattice with-object.jpg --against without-object.jpg --out measured")]
pub struct LatticeArguments {
    /// Photograph: PNG, JPEG, TIFF, WebP, BMP or OpenEXR
    photo: PathBuf,
    /// Folder for lattice.json, lattice.csv and lattice.png, the photograph with what was found drawn into it
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Lines of the lattice in each direction, or those that run down and those that run across
    #[arg(long, value_name = "N|NxM", default_value = "7", value_parser = count)]
    lines: Count,
    /// Measure what is seen of a lattice that may be larger: the largest joined piece, rows and columns counted from its own top left
    #[arg(long, conflicts_with = "against")]
    part: bool,
    /// Distance from line to line, mm: lengths are told in mm as well, by the median distance in the photograph (the reference's with --against)
    #[arg(long, value_name = "MM", value_parser = crate::arguments::positive)]
    spacing: Option<f64>,
    /// The lines are darker than their ground
    #[arg(long)]
    dark: bool,
    /// Photograph of where the intersections belong: tells how far each is from there
    #[arg(long, value_name = "PHOTO")]
    against: Option<PathBuf>,
    /// Alignment before the comparison, if the camera moved between the photographs
    #[arg(long, value_enum, default_value_t, requires = "against")]
    align: Align,
}

/// One number of lines for both directions, or two.
fn count(text: &str) -> Result<Count, String> {
    let (columns, rows) = text.split_once(['x', 'X', '×']).unwrap_or((text, text));
    let lines = |text: &str| match text.trim().parse::<usize>() {
        Ok(lines @ 2..=40) => Ok(lines),
        _ => Err("give 2 to 40 lines, as in 7 or 9x6".to_owned()),
    };
    Ok(Count { columns: lines(columns)?, rows: lines(rows)? })
}

/// See [`Alignment`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum Align {
    /// None: the camera did not move
    #[default]
    None,
    /// Translation
    Shift,
    /// Translation, rotation and scale
    Similarity,
    /// A homography: the camera stood elsewhere; a tilt of the whole lattice goes with it
    Perspective,
}

impl Align {
    fn alignment(self) -> Alignment {
        match self {
            Self::None => Alignment::None,
            Self::Shift => Alignment::Shift,
            Self::Similarity => Alignment::Similarity,
            Self::Perspective => Alignment::Perspective,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Shift => "shift",
            Self::Similarity => "similarity",
            Self::Perspective => "perspective",
        }
    }
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    match &arguments.what {
        What::Lattice(arguments) => lattice(arguments, voice),
    }
}

/// A photograph and what was found in it.
struct Measured {
    picture: Picture,
    lattice: Lattice,
}

fn measured(
    path: &Path,
    arguments: &LatticeArguments,
    notes: &mut Vec<String>,
) -> Result<Measured, Failure> {
    let picture = open_picture(path, notes)?.picture;
    let plane = Plane::luminance(&picture);
    let plane = if arguments.dark { plane.inverted() } else { plane };
    let found = match arguments.part {
        true => detect_part(&plane, arguments.lines),
        false => detect(&plane, arguments.lines),
    };
    let lattice = found.map_err(|error| not_found(path, &error, arguments.dark))?;
    Ok(Measured { picture, lattice })
}

fn not_found(path: &Path, error: &LatticeError, dark: bool) -> Failure {
    let help = match error {
        LatticeError::NoLattice if dark => {
            "leave --dark out if the lines are brighter than their ground; crop the photograph to the lattice"
        }
        LatticeError::NoLattice => {
            "with --dark lines darker than their ground are looked for; crop the photograph to the lattice; \
             expose so that the lines are not black"
        }
        LatticeError::NothingMeasured { .. } => {
            "draw thinner lines (a tenth of their distance), focus on them, expose so that they are neither black nor burnt out"
        }
        LatticeError::Partial { .. } => {
            "crop the photograph to the lattice with some ground around it, focus on it, keep reflections out; \
             --lines says how many lines there are; --part measures the piece that is seen"
        }
        LatticeError::TooMany { .. } => {
            "crop the photograph to the lattice; --lines says how many lines there are"
        }
        LatticeError::TooSmall { .. } => "give a larger photograph, or a smaller --lines",
        LatticeError::TooFewLines { .. } => "give --lines 2 or more",
        LatticeError::NotFinite { .. } => "export the photograph again",
    };
    Failure::new(format!("{}: {error}", path.display()), help)
}

fn lattice(arguments: &LatticeArguments, voice: Voice) -> Result<(), Failure> {
    let mut notes = Vec::new();
    let seen = measured(&arguments.photo, arguments, &mut notes)?;
    let points = seen.lattice.points();
    let against = match &arguments.against {
        Some(path) => {
            let reference = measured(path, arguments, &mut notes)?;
            let size = |m: &Measured| [m.picture.width, m.picture.height];
            let [theirs, ours] = [size(&reference), size(&seen)];
            if theirs != ours && !matches!(arguments.align, Align::Similarity | Align::Perspective)
            {
                return Err(Failure::new(
                    format!(
                        "{} has {} x {} pixels, {} has {} x {}: displacements between them would mean nothing",
                        arguments.photo.display(),
                        ours[0],
                        ours[1],
                        path.display(),
                        theirs[0],
                        theirs[1]
                    ),
                    "give photographs of one size, or --align similarity",
                ));
            }
            let belongs = reference.lattice.points();
            let moved = aligned(&points, &belongs, arguments.align.alignment());
            let found = displacement(&moved, &belongs).map_err(|error| {
                Failure::new(error.to_string(), "give two whole photographs of one lattice")
            })?;
            Some(Against { belongs, found, spacing: reference.lattice.spacing() })
        }
        None => None,
    };
    let told = told(arguments, &seen, against.as_ref(), &notes);
    let files = match &arguments.out {
        Some(folder) => write(folder, &seen, against.as_ref(), &told)?,
        None => Vec::new(),
    };
    voice.note(&notes);
    let scale = arguments.scale(&seen, against.as_ref());
    let mut said = lines(&seen.lattice, against.as_ref(), scale);
    if files.is_empty() {
        said += &csv(&seen.lattice, against.as_ref());
    } else {
        said += &wrote(&files);
    }
    let mut told = told;
    told["files"] = paths(&files);
    voice.tell(&said, &told)
}

/// Where intersections belong, and how far they are from there.
struct Against {
    belongs: Vec<Option<[f64; 2]>>,
    found: Displacement,
    /// From line to line there, pixels.
    spacing: Option<f64>,
}

impl LatticeArguments {
    /// Pixels to a millimetre, if the lattice's spacing is known.
    fn scale(&self, seen: &Measured, against: Option<&Against>) -> Option<f64> {
        let spacing = match against {
            Some(against) => against.spacing,
            None => seen.lattice.spacing(),
        };
        Some(spacing? / self.spacing?)
    }
}

fn lines(lattice: &Lattice, against: Option<&Against>, scale: Option<f64>) -> String {
    let count = lattice.count.intersections();
    let mut lines = format!(
        "{} of {count} intersections found; lines are {:.1} px wide",
        lattice.found(),
        lattice.line_width
    );
    match lattice.spacing() {
        Some(spacing) => {
            let _ = writeln!(lines, " and {spacing:.1} px apart");
        }
        None => lines.push('\n'),
    }
    if lattice.left_out > 0 {
        let _ = writeln!(
            lines,
            "  {} more crossings, which no line joins to these, are left out: which ones they are cannot be told",
            lattice.left_out
        );
    }
    if let Some(scale) = scale {
        let _ = writeln!(lines, "{scale:.3} px to the mm");
    }
    let mut missing: Vec<(String, usize)> = Vec::new();
    for why in lattice.intersections.iter().filter_map(|found| found.as_ref().err()) {
        let why = why.to_string();
        match missing.iter_mut().find(|(other, _)| *other == why) {
            Some((_, count)) => *count += 1,
            None => missing.push((why, 1)),
        }
    }
    for (why, count) in missing {
        let _ = writeln!(lines, "  {count} missing: {why}");
    }
    if let Some(Against { found, .. }) = against {
        let _ = writeln!(
            lines,
            "displacement of the {} in both: mean {:.3} px, max {:.3} px",
            found.compared(),
            found.mean,
            found.max
        );
        if let Some(scale) = scale {
            let (mean, max) = (found.mean / scale, found.max / scale);
            let _ = writeln!(lines, "in mm: mean {mean:.4}, max {max:.4}");
        }
    }
    lines
}

fn told(
    arguments: &LatticeArguments,
    seen: &Measured,
    against: Option<&Against>,
    notes: &[String],
) -> Value {
    let lattice = &seen.lattice;
    let columns = lattice.count.columns;
    let scale = arguments.scale(seen, against);
    let point = |place: Option<[f64; 2]>| match place {
        Some([x, y]) => json!([x, y]),
        None => Value::Null,
    };
    let intersections: Vec<Value> = lattice
        .intersections
        .iter()
        .enumerate()
        .map(|(at, found)| {
            let mut one = json!({
                "row": at / columns,
                "column": at % columns,
                "place": point(found.as_ref().ok().copied()),
            });
            if let Err(why) = found {
                one["missing"] = json!(why.to_string());
            }
            if let Some(against) = against {
                one["belongs"] = point(against.belongs[at]);
                one["displacement"] = against.found.points[at].map_or(Value::Null, number);
            }
            one
        })
        .collect();
    json!({
        "midair": env!("CARGO_PKG_VERSION"),
        "command": "measure lattice",
        "photo": arguments.photo.display().to_string(),
        "size": [seen.picture.width, seen.picture.height],
        "lines": [lattice.count.columns, lattice.count.rows],
        "part": arguments.part,
        "line_width": lattice.line_width,
        "spacing": lattice.spacing().map(number),
        "pixels_per_mm": scale.map(number),
        "found": lattice.found(),
        "left_out": lattice.left_out,
        "intersections": intersections,
        "against": against.map(|against| json!({
            "photo": arguments.against.as_ref().map(|path| path.display().to_string()),
            "align": arguments.align.name(),
            "mean": number(against.found.mean),
            "max": number(against.found.max),
            "mean_mm": scale.map(|scale| number(against.found.mean / scale)),
            "max_mm": scale.map(|scale| number(against.found.max / scale)),
            "compared": against.found.compared(),
        })),
        "notes": notes,
    })
}

/// A line for each intersection; what is missing is empty.
fn csv(lattice: &Lattice, against: Option<&Against>) -> String {
    let mut out = "row,column,x,y".to_owned();
    out += if against.is_some() { ",belongs_x,belongs_y,displacement\n" } else { "\n" };
    let pair = |place: Option<[f64; 2]>| match place {
        Some([x, y]) => format!("{x:.4},{y:.4}"),
        None => ",".to_owned(),
    };
    let columns = lattice.count.columns;
    for (at, place) in lattice.points().into_iter().enumerate() {
        let _ = write!(out, "{},{},{}", at / columns, at % columns, pair(place));
        if let Some(against) = against {
            let off = against.found.points[at].map(|off| format!("{off:.4}")).unwrap_or_default();
            let _ = write!(out, ",{},{off}", pair(against.belongs[at]));
        }
        out.push('\n');
    }
    out
}

fn write(
    folder: &Path,
    seen: &Measured,
    against: Option<&Against>,
    told: &Value,
) -> Result<Vec<PathBuf>, Failure> {
    let mut output = crate::output::into_folder(folder)?;
    output.write("lattice.json", |path| {
        write_bytes_atomically(path, format!("{told:#}\n").as_bytes())
    })?;
    let table = csv(&seen.lattice, against);
    output.write("lattice.csv", |path| write_bytes_atomically(path, table.as_bytes()))?;
    let belongs = against.map(|against| against.belongs.as_slice());
    let drawn = lattice_picture::draw(&seen.picture, &seen.lattice, belongs);
    output.write("lattice.png", |path| write_still(path, &drawn, Depth::Eight))?;
    Ok(output.finish()?)
}
