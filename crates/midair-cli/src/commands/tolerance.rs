//! `midair tolerance`: which measure needs most care.

use crate::arguments::open_scene;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, paths, wrote};
use midair::evaluate::tolerance::{Shift, tolerances};
use midair::files::write_bytes_atomically;
use midair::transport::Setup;
use midair_report::drawing::tolerances as chart;
use serde_json::json;
use std::path::PathBuf;

/// Tell how far the image moves for each millimetre, degree and hundredth of an index that the set-up is off its description
///
/// The display shows what was computed for the scene; each part in turn is moved by a millimetre, turned by a degree, or given an index larger by
/// 0.01. The table says how far a lattice's intersections then are from where they belong, mean and largest, and how exactly each measure is to
/// be known for a mean of half a millimetre. What needs most care comes first.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair tolerance scene.toml --out tolerance.svg")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Chart to write: .svg
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Lines of the lattice in each direction
    #[arg(long, value_name = "N", default_value = "7", value_parser = clap::value_parser!(u16).range(2..=99))]
    lines: u16,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    if let Some(file) = &arguments.out {
        super::draw::check_name(file)?;
    }
    let loaded = open_scene(&arguments.scene, None)?;
    let setup = Setup::new(&loaded)?;
    let bar = Bar::new();
    let shifts = tolerances(&setup, arguments.lines.into(), &bar);
    bar.finish();
    let mut files = Vec::new();
    if let Some(file) = &arguments.out {
        let (mut output, name) = crate::output::of_file(file)?;
        let svg = chart::draw(&shifts, &loaded.scene.name);
        output.write(&name, |path| write_bytes_atomically(path, svg.as_bytes()))?;
        files = output.finish()?;
    }
    voice.note(&loaded.notes);
    let written = if files.is_empty() { String::new() } else { wrote(&files) };
    let told = json!({
        "scene": loaded.scene.name,
        "lines": arguments.lines,
        "shifts": shifts,
        "notes": loaded.notes,
        "files": paths(&files),
    });
    voice.tell(&format!("{}{written}", table(&shifts, usize::from(arguments.lines).pow(2))), &told)
}

/// What moves the image at all, a line each.
fn table(shifts: &[Shift], all: usize) -> String {
    let wide = shifts.iter().map(|shift| shift.name().chars().count()).max().unwrap_or(0);
    let mut lines =
        format!("{:wide$}  {:>9}  {:>9}  {:>8}  for 0.5 mm\n", "", "mean", "largest", "of width");
    let mut still = Vec::new();
    for shift in shifts {
        let Some(exactly) = shift.for_half_a_millimetre else {
            still.push(shift.name());
            continue;
        };
        let (_, unit) = shift.measure.step();
        let part = if shift.compared < all {
            format!("   ({} of {all} seen)", shift.compared)
        } else {
            String::new()
        };
        lines += &format!(
            "{:wide$}  {:>6.3} mm  {:>6.3} mm  {:>6.2} %  {} {unit}{part}\n",
            shift.name(),
            shift.mean,
            shift.most,
            100.0 * shift.share,
            two_digits(exactly)
        );
    }
    if !still.is_empty() {
        lines += &format!("no effect: {}\n", still.join("; "));
    }
    lines
}

/// A number to two digits that count.
fn two_digits(value: f64) -> String {
    let decimals = (1 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    format!("{value:.decimals$}")
}
