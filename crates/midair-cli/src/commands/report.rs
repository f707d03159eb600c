//! `midair report`: the proof that a scene is compensated, as figures and as a page.

use super::compensate::{fit_note, write_display, write_maps, write_report};
use crate::arguments::{FitMode, Size, check_view, open_picture, open_scene};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, paths, timings, wrote};
use midair::Monitor as _;
use midair::evaluate::colour::{Colour, colour};
use midair::evaluate::proof::{Proof, Settings, prove};
use midair::files::{Output, write_bytes_atomically};
use midair::map::format::{FileError, Format};
use midair::picture::{Depth, Still, encode_still};
use midair::scene::Loaded;
use midair::transport::Setup;
use midair_report::drawing::test_picture;
use midair_report::proof::{Report, colour_pictures};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Verify the compensation of a scene: views, lattice displacement, similarity, uniformity, colour fringes, stray light, comparison with the
/// paper's method
///
/// Writes report.html (self-contained), report.json with all figures, and the pictures.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  midair report scene.toml --image photo.jpg --out out --splat-spp 0"
)]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Picture that the mid-air image is to show: PNG, JPEG, TIFF, WebP, BMP or OpenEXR; left out: a built-in one
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The display's resolution instead of the scene's; views are as wide
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// How a picture of other proportions fills the image
    #[arg(long, value_enum, default_value_t, requires = "image")]
    fit: FitMode,
    /// Samples per pixel of the paper's own method, measured beside ours; the paper has 1000; 0 leaves it out
    #[arg(long, value_name = "N", default_value = "32", value_parser = clap::value_parser!(u32).range(0..=1_000_000))]
    splat_spp: u32,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let loaded = open_scene(&arguments.scene, arguments.size)?;
    let mut notes = loaded.notes.clone();
    let given = arguments.image.as_ref().map(|path| open_picture(path, &mut notes)).transpose()?;
    let mut still = given.unwrap_or_else(|| built_in(&loaded));
    if arguments.fit != FitMode::Stretch {
        let setup = Setup::new(&loaded)?;
        notes.extend(fit_note(&setup, &still.picture, arguments.fit));
        still.picture = arguments.fit.apply(&setup, still.picture);
    }
    let splat_spp = arguments.splat_spp as usize;
    let output = crate::output::into_folder(&arguments.out)?;
    write_proof(&loaded, &still, splat_spp, notes, output, voice)
}

/// The built-in picture in the image's proportions.
fn built_in(loaded: &Loaded) -> Still {
    let [w, h] = loaded.scene.image.size;
    let width = 1024;
    let height = ((width as f64 * h / w).round() as usize).clamp(1, 4096);
    Still { picture: test_picture::draw(width, height), depth: Depth::Eight, notes: Vec::new() }
}

/// Proves, writes everything, and tells.
pub fn write_proof(
    loaded: &Loaded,
    still: &Still,
    splat_spp: usize,
    mut notes: Vec<String>,
    mut output: Output,
    voice: Voice,
) -> Result<(), Failure> {
    let setup = Setup::new(loaded)?;
    let settings = Settings { splat_spp, ..Settings::for_setup(&setup) };
    check_view(settings.view, settings.supersampling)?;
    notes.extend(fit_note(&setup, &still.picture, FitMode::Stretch));
    let bar = Bar::new();
    let proof = prove(&setup, &still.picture, &settings, &bar)?;
    bar.stage("brightness and colour", 1);
    let colour = colour(loaded, &setup, &settings, &proof.map)?;
    bar.finish();

    let report = Report { loaded, setup: &setup, proof: &proof, colour: &colour, notes: &notes };
    let told = told(&report);
    let (page, pictures) = rayon::join(|| report.page(), || encoded(still, &proof, &colour));
    let page = page.map_err(|error| {
        Failure::new(format!("the page cannot be made: {error}"), "ask for another --size")
    })?;
    write_display(&mut output, still, &proof.compensated.display, setup.pixel_pitch())?;
    for (name, bytes) in pictures? {
        output.write(name, |path| write_bytes_atomically(path, &bytes))?;
    }
    let source = setup.view_size(still.picture.width);
    let more = write_maps(&mut output, &proof.map, None, "map", source, &[Format::Exr])?;
    write_report(&mut output, &told)?;
    let html = page.to_html();
    output.write("report.html", |path| write_bytes_atomically(path, html.as_bytes()))?;
    let files = output.finish()?;
    voice.note(&more);
    voice.note(&notes);
    for (name, time) in proof.timings.iter().chain(&colour.timings) {
        voice.explain(&format!("{name}: {:.1} ms", time.as_secs_f64() * 1e3));
    }
    voice.explain(wrote(&files).trim_end());
    let page = files.iter().find(|file| file.ends_with("report.html"));
    let page = page.map(|page| page.display().to_string()).unwrap_or_default();
    let mut told = told;
    told["files"] = paths(&files);
    voice.tell(&format!("{}see {page}\n", report.lines()), &told)
}

/// report.json.
fn told(report: &Report) -> Value {
    let mut told = json!(report.proof);
    let Colour { timings: more, .. } = report.colour;
    told["midair"] = json!(env!("CARGO_PKG_VERSION"));
    told["command"] = json!("report");
    told["scene"] = json!(report.loaded.scene.name);
    let laps: Vec<_> = report.proof.timings.iter().chain(more).copied().collect();
    told["timings_ms"] = timings(&laps);
    if let (Value::Object(told), Value::Object(colour)) = (&mut told, json!(report.colour)) {
        told.extend(colour);
    }
    told["assumptions"] = json!(report.assumptions());
    told["notes"] = json!(report.notes);
    told
}

/// All pictures but the display's, as files: encoding them takes longer than writing, so all cores do it.
fn encoded(
    still: &Still,
    proof: &Proof,
    colour: &Colour,
) -> Result<Vec<(&'static str, Vec<u8>)>, FileError> {
    let depth = if still.depth == Depth::Eight { Depth::Eight } else { Depth::Sixteen };
    let views = [
        ("display-optimal.png", &proof.optimal.display),
        ("view-reference.png", &proof.reference),
        ("view-compensated.png", &proof.compensated.view),
        ("view-optimal.png", &proof.optimal.view),
        ("view-uncompensated.png", &proof.uncompensated.view),
        ("lattice-reference.png", &proof.lattice.reference),
        ("lattice-compensated.png", &proof.lattice.compensated.view),
        ("lattice-uncompensated.png", &proof.lattice.uncompensated.view),
    ];
    let colours = colour_pictures(colour);
    let colours = colours.iter().map(|(name, picture)| (*name, picture, Depth::Eight));
    let all: Vec<_> =
        views.map(|(name, view)| (name, view, depth)).into_iter().chain(colours).collect();
    all.into_par_iter()
        .map(|(name, picture, depth)| Ok((name, encode_still(name.as_ref(), picture, depth)?)))
        .collect()
}
