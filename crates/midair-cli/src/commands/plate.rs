//! `midair plate`: a plate's character as pictures and numbers.

use crate::arguments::{length, open_scene};
use crate::failure::Failure;
use crate::summary::{Voice, paths, percent, wrote};
use midair::evaluate::plate::{AZIMUTH, CELLS, Character, INCIDENCE, VIEWERS};
use midair::files::write_bytes_atomically;
use midair::optics::plate::character::Span;
use midair::optics::plate::{Class, luminance};
use midair::picture::{Depth, Picture, write_still};
use midair_report::drawing::chart_sheet::{Axis, Curve, curves, map, row};
use midair_report::drawing::{point_spread_chart, shares_chart, viewpoints_chart};
use serde_json::json;
use std::path::PathBuf;

/// Characterise a plate: efficiency by direction, luminance by viewpoint, sharpness
///
/// Writes shares.png (what becomes of light over incidence and azimuth: mid-air image, stray light, through), viewpoints.png (the
/// image's luminance over the viewer's azimuth and elevation), sharpness.png (how a point of the image spreads, and the modulation
/// transfer in the image's plane) and plate.json with all numbers. The scene's elements are left out.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  midair plate scene.toml --out plate
  midair plate scene.toml --out plate --aperture 25")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR", default_value = "out/plate")]
    out: PathBuf,
    /// Diameter in mm of the pupil that looks at the point: an eye's is 2 to 8
    #[arg(long, value_name = "MM", default_value = "4", allow_negative_numbers = true, value_parser = length)]
    aperture: f64,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let loaded = open_scene(&arguments.scene, None)?;
    let mut notes = loaded.notes.clone();
    let character = Character::of(&loaded, arguments.aperture, &mut notes)?;
    let mut output = crate::output::into_folder(&arguments.out)?;
    for (name, picture) in [
        ("shares.png", shares(&character)),
        ("viewpoints.png", viewpoints(&character)),
        ("sharpness.png", sharpness(&character)),
    ] {
        output.write(name, |path| write_still(path, &picture, Depth::Eight))?;
    }
    let mut told = character.to_json();
    told["notes"] = json!(notes);
    let text = format!("{told:#}\n");
    output.write("plate.json", |path| write_bytes_atomically(path, text.as_bytes()))?;
    let files = output.finish()?;
    voice.note(&notes);
    // The grids are in the file.
    let mut summary = json!({
        "scene": told["scene"],
        "plate": told["plate"],
        "from_viewpoint": told["from_viewpoint"],
        "visible_range": told["viewpoints"]["visible_range"],
        "deviation_mm": told["point_spread"]["deviation_mm"],
        "half_transfer_per_mm": told["modulation_transfer"]["half_per_mm"],
        "notes": told["notes"],
    });
    summary["files"] = paths(&files);
    voice.tell(&format!("{}{}", lines(&character), wrote(&files)), &summary)
}

fn shares(character: &Character) -> Picture {
    let x = Axis { label: "incidence, degrees", range: INCIDENCE, intervals: 3 };
    let y = Axis { label: "azimuth from the plate's +x, degrees", range: AZIMUTH, intervals: 3 };
    row(&[
        (Class::Real, "Mid-air image"),
        (Class::Stray, "Stray light"),
        (Class::Through, "Through, as by a window"),
    ]
    .map(|(class, title)| map(&shares_chart(&character.directions, class, 4), title, &x, &y)))
}

fn viewpoints(character: &Character) -> Picture {
    let x = Axis { label: "viewer's azimuth, degrees", range: VIEWERS, intervals: 4 };
    let y = Axis { label: "viewer's elevation, degrees", range: VIEWERS, intervals: 4 };
    let title = match character.measured {
        true => "Luminance of the image over the display's, measured",
        false => "Luminance of the image over the display's",
    };
    map(&viewpoints_chart(&character.viewpoints, 7), title, &x, &y)
}

fn sharpness(character: &Character) -> Picture {
    let half = 0.5 * character.extent;
    let x = Axis { label: "x in the image, mm", range: [-half, half], intervals: 4 };
    let y = Axis { label: "y in the image, mm", range: [-half, half], intervals: 4 };
    let spread = point_spread_chart(&character.spread, character.extent, CELLS, 5);
    let highest = character.frequencies.last().copied().unwrap_or(1.0);
    let frequency = Axis { label: "cycles per mm", range: [0.0, highest], intervals: 4 };
    let contrast = Axis { label: "contrast", range: [0.0, 1.0], intervals: 4 };
    let points = |axis: usize| {
        let pairs = character.frequencies.iter().zip(&character.transfer[axis]);
        pairs.map(|(&f, &m)| [f, m]).collect::<Vec<_>>()
    };
    let lines = [
        Curve { name: "across x", colour: [0, 114, 178], points: points(0) },
        Curve { name: "across y", colour: [213, 94, 0], points: points(1) },
    ];
    row(&[
        map(&spread, "A point of the image", &x, &y),
        curves(&lines, [400, 400], "Modulation transfer", &frequency, &contrast),
    ])
}

fn lines(character: &Character) -> String {
    let share = |light: [f64; 3]| percent(luminance(light));
    let mut lines = format!(
        "{}: the slit-mirror plate; the viewpoint looks at it at {:.1} degrees of incidence\n\
         there {} of the display's light forms the image, {} is stray, {} goes through, {} is lost\n",
        character.scene,
        character.incidence,
        share(character.shares.real),
        share(character.shares.stray),
        share(character.shares.through),
        share(character.shares.absorbed),
    );
    match &character.range {
        Some(range) => {
            let span = |span: &Span| {
                let end = |value: f64, cut: bool| match cut {
                    true => format!("{value:.0} or further"),
                    false => format!("{value:.0}"),
                };
                format!("{} to {}", end(span.from, span.cut[0]), end(span.to, span.cut[1]))
            };
            lines += &format!(
                "brightest from azimuth {:.0}, elevation {:.0} degrees; above half of that over azimuths {}, elevations {}\n",
                range.brightest[0],
                range.brightest[1],
                span(&range.azimuth),
                span(&range.elevation),
            );
        }
        None => lines += "the image is dark from everywhere\n",
    }
    let [x, y] = character.spread.deviation();
    let half = |axis| character.half(axis).map_or("-".to_owned(), |f| format!("{f:.2}"));
    lines
        + &format!(
            "through a pupil of {} mm a point spreads by {x:.3} x {y:.3} mm (standard deviations); contrast is a half at {} and {} cycles per mm\n",
            character.settings.pupil,
            half(0),
            half(1),
        )
}
