//! `midair calibrate decode`: which display point each camera pixel sees.

use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, paths, percent, wrote};
use midair::files::{Output, write_bytes_atomically};
use midair::picture::{Depth, Picture, write_still};
use midair::transport::Setup;
use midair_calibrate::correspondences::to_csv;
use midair_calibrate::{Correspondence, Decoded, Seen, Sighting, survey};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Decode photographs of the patterns: which display point each camera pixel sees
///
/// Writes for each view and state a CSV file (x,y,s,t,sigma) and a picture of each pixel's status: blue real, orange stray light, grey not sure, black
/// nothing. `calibrate fit` and `map` decode by themselves; this is to look at.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair calibrate decode bench.toml --out decoded")]
pub struct Arguments {
    /// Bench file (TOML)
    bench: PathBuf,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let (bench, loaded) = super::open::bench(&arguments.bench)?;
    let setup = Setup::new(&loaded)?;
    let mut output = crate::output::into_folder(&arguments.out)?;
    let bar = Bar::new();
    let mut views = super::open::views(&bench, &setup, &bar)?;
    let survey = survey(&loaded, bench.lens, &mut views, &bar)?;
    bar.finish();
    let mut told = Vec::new();
    let mut lines = String::new();
    for (view, points) in views.iter().zip(&survey.views) {
        for (state, sighting, points) in
            [("empty", &view.empty, &points.empty), ("object", &view.object, &points.object)]
        {
            let name = format!("{}-{state}", view.name);
            let one = write_state(&mut output, &name, sighting, points)?;
            lines += &format!("{name}: {} points{}\n", points.len(), shares(sighting));
            told.push(one);
        }
    }
    let files = output.finish()?;
    let notes = super::open::notes(&views);
    voice.note(&notes);
    let told =
        json!({ "views": told, "camera": survey.lens, "notes": notes, "files": paths(&files) });
    voice.tell(&format!("{lines}{}", wrote(&files)), &told)
}

/// Writes the points and the status picture of one state of a view.
fn write_state(
    output: &mut Output,
    name: &str,
    sighting: &Sighting,
    points: &[Correspondence],
) -> Result<Value, Failure> {
    let csv = to_csv(points);
    output.write(format!("{name}.csv"), |path| write_bytes_atomically(path, csv.as_bytes()))?;
    let mut told = json!({ "name": name, "points": points.len() });
    if let Sighting::Photographs(decoded) = sighting {
        let picture = picture(decoded);
        output.write(format!("{name}.png"), |path| write_still(path, &picture, Depth::Eight))?;
        told["pixels"] = json!(decoded.counts());
    }
    Ok(told)
}

/// What each pixel sees, as a picture.
fn picture(decoded: &Decoded) -> Picture {
    let colour = |seen: &Seen| match seen {
        Seen::Real => [0.05, 0.25, 0.75, 1.0],
        Seen::Stray => [0.9, 0.3, 0.02, 1.0],
        Seen::Unsure => [0.25, 0.25, 0.25, 1.0],
        Seen::None => [0.0, 0.0, 0.0, 1.0],
    };
    let pixels = decoded.seen.iter().map(colour).collect();
    Picture { width: decoded.width, height: decoded.height, pixels }
}

fn shares(sighting: &Sighting) -> String {
    let Sighting::Photographs(decoded) = sighting else { return String::new() };
    let counts = decoded.counts();
    let all = (decoded.width * decoded.height).max(1) as f64;
    let share = |count: usize| percent(count as f64 / all);
    format!(
        "; {} of the pixels real, {} stray, {} not sure",
        share(counts.real),
        share(counts.stray),
        share(counts.unsure)
    )
}
