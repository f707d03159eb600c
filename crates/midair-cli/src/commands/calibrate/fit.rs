//! `midair calibrate fit`: the scene that says what the photographs say.

use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, paths, wrote};
use midair::files::{Output, renamed, write_bytes_atomically};
use midair::scene::Loaded;
use midair::transport::Setup;
use midair_calibrate::{
    Bench, Finding, Options, SightedView, Sighting, fit, page, scene_file, survey,
};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Fit the scene to photographs: where each part really stands, how it is turned, its index
///
/// Writes scene.toml (the assumed scene's text with the fitted values), calibration.json (each number with its standard deviation) and report.html.
/// By default each element's position and rotation are fitted, and each index that the scene gives as a number. Names for --free and --fix are the
/// scene's: NAME, NAME.position, NAME.rotation.y, NAME.ior, NAME.shape, NAME.shape.radius; plate.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  midair calibrate fit bench.toml --out fitted\n  midair calibrate fit bench.toml --out fitted --free cube.shape --fix cube.ior"
)]
pub struct Arguments {
    /// Bench file (TOML)
    bench: PathBuf,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// What to fit besides the usual, with commas between
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    free: Vec<String>,
    /// What to leave as it is, with commas between
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fix: Vec<String>,
    /// From how many places over the uncertainty the fit sets out
    #[arg(long, value_name = "N", default_value = "8", value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: u16,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let (bench, loaded) = super::open::bench(&arguments.bench)?;
    let setup = Setup::new(&loaded)?;
    let mut output = crate::output::into_folder(&arguments.out)?;
    let bar = Bar::new();
    let mut sighted = super::open::views(&bench, &setup, &bar)?;
    let views = survey(&loaded, bench.lens, &mut sighted, &bar)?.views;
    let options = Options {
        uncertainty: bench.uncertainty,
        lens: bench.lens,
        together: bench.together.clone(),
        free: arguments.free.clone(),
        fix: arguments.fix.clone(),
        starts: arguments.starts.into(),
        ..Options::default()
    };
    let finding = fit(&loaded, &views, &options, &bar)?;
    bar.finish();
    let mut notes = loaded.notes.clone();
    notes.extend(super::open::notes(&sighted));
    let mut told = told(&bench, &loaded, &finding, &sighted);
    let from = bench.scene.parent().unwrap_or(Path::new(""));
    let rename = |name: &Path| renamed(name, from, &arguments.out);
    write_finding(&mut output, &loaded, &finding, &told, &notes, &rename)?;
    let files = output.finish()?;
    told["files"] = paths(&files);
    voice.note(&notes);
    voice.note(&finding.notes);
    voice.tell(&format!("{}{}", lines(&finding), wrote(&files)), &told)
}

/// Writes the fitted scene, calibration.json and the page. `rename` says how the files that the scene names are found from there.
pub fn write_finding(
    output: &mut Output,
    loaded: &Loaded,
    finding: &Finding,
    told: &Value,
    notes: &[String],
    rename: &dyn Fn(&Path) -> PathBuf,
) -> Result<(), Failure> {
    let text = scene_file::fitted_text(loaded, finding, rename)?;
    let name = if loaded.text.name().ends_with(".json") { "scene.json" } else { "scene.toml" };
    output.write(name, |path| write_bytes_atomically(path, text.as_bytes()))?;
    let json = format!("{told:#}\n");
    output.write("calibration.json", |path| write_bytes_atomically(path, json.as_bytes()))?;
    let html = page::page(loaded, finding, notes).to_html();
    output.write("report.html", |path| write_bytes_atomically(path, html.as_bytes()))?;
    Ok(())
}

/// calibration.json.
fn told(bench: &Bench, loaded: &Loaded, finding: &Finding, sighted: &[SightedView]) -> Value {
    let mut told = json!(finding);
    for (told, view) in told["views"].as_array_mut().into_iter().flatten().zip(sighted) {
        for (state, sighting) in [("empty", &view.empty), ("object", &view.object)] {
            if let Sighting::Photographs(decoded) = sighting {
                told[state]["pixels"] = json!(decoded.counts());
            }
        }
    }
    told["midair"] = json!(env!("CARGO_PKG_VERSION"));
    told["command"] = json!("calibrate fit");
    told["scene"] = json!(loaded.scene.name);
    told["bench"] = json!(bench.text.name());
    told
}

/// What was found, for people.
pub fn lines(finding: &Finding) -> String {
    let wide = finding.parameters.iter().map(|p| p.name.chars().count()).max().unwrap_or(0);
    let mut lines = String::new();
    for p in finding.parameters.iter().filter(|p| !p.name.starts_with("view.")) {
        let told = if p.determined { "" } else { "  not determined" };
        lines += &format!(
            "{:wide$}  {:>10.4} ± {:<8.4} (assumed {:.4}){told}\n",
            p.name, p.value, p.sigma, p.start
        );
    }
    lines += &format!(
        "left: {:.3} display pixels rms; {:.2} with the scene as assumed\n",
        finding.residual.rms, finding.residual.before
    );
    if let Some(advice) = &finding.advice {
        lines += &format!("{}\n", advice.in_words());
    }
    lines
}
