//! `midair check`: what can be formed, what cannot, and why.

mod stray;

use crate::arguments::{Size, check_picture_name, open_scene};
use crate::failure::Failure;
use crate::summary::{Voice, paths, percent, wrote};
use midair::evaluate::preflight::{Check, Part, Preflight, Severity};
use midair::files::Output;
use midair::map::Map;
use midair::picture::{Depth, write_still};
use midair::scene::Loaded;
use midair::transport::Setup;
use midair_report::drawing::status_picture;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
pub use stray::Stray;

/// Look a set-up over before it is built: what is wrong, what helps, and which part of the image is formed
///
/// Tells what stands in something else, where the image floats, what no light meets, how much light arrives, which display pixels the image gets,
/// and which part of it is formed or why not. Where a value of the scene file would help, it is there to be copied. Also draws it: the image as
/// the viewer sees it, and the display's pixels, coloured by status.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair check scene.toml --out check.png --stray stray.png")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Picture to write: .png or .exr
    #[arg(long, value_name = "FILE", default_value = "check.png")]
    out: PathBuf,
    /// The display's resolution instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Draw as well where the plate's stray images fall, four times as wide as the image: the image white, stray images orange and blue, what is
    /// seen through the plate green
    #[arg(long, value_name = "FILE")]
    stray: Option<PathBuf>,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    check_picture_name(&arguments.out)?;
    let loaded = open_scene(&arguments.scene, arguments.size)?;
    let (mut output, name) = crate::output::of_file(&arguments.out)?;
    let stray_output = match &arguments.stray {
        Some(file) => {
            check_picture_name(file)?;
            Some(crate::output::of_file(file)?)
        }
        None => None,
    };
    let mut checked = write_check(&loaded, &mut output, &name)?;
    let mut files = output.finish()?;
    let asked = arguments.stray.is_some();
    let model = &loaded.scene.plate.model;
    if let Some(stray) = Stray::of(model, &checked.setup, &checked.map, asked)? {
        checked.lines += &stray.lines();
        checked.json["stray"] = stray.json();
        if let Some((mut output, name)) = stray_output {
            output.write(&name, |path| write_still(path, &stray.picture(), Depth::Eight))?;
            files.extend(output.finish()?);
        }
    }
    voice.note(&loaded.notes);
    checked.explained.iter().for_each(|line| voice.explain(line));
    let mut told = checked.json;
    told["notes"] = json!(loaded.notes);
    told["files"] = paths(&files);
    voice.tell(&format!("{}{}", checked.lines, wrote(&files)), &told)
}

/// What a check says.
pub struct Checked {
    setup: Setup,
    map: Map,
    lines: String,
    /// For those who want to know more.
    explained: Vec<String>,
    json: Value,
}

/// Checks a scene and draws the outcome.
pub fn write_check(
    loaded: &Loaded,
    output: &mut Output,
    name: impl AsRef<Path>,
) -> Result<Checked, Failure> {
    let check = Check::of(loaded)?;
    let json = check.to_json();
    let Check { setup, map, formation, parts, preflight, .. } = check;
    let picture = status_picture::draw(&loaded.scene.name, &formation, &parts, &map);
    output.write(name, |path| write_still(path, &picture, Depth::Eight))?;
    let lines = lines(loaded, &parts, &preflight);
    let explained = explained(&setup, &preflight);
    Ok(Checked { setup, map, lines, explained, json })
}

fn lines(loaded: &Loaded, parts: &[Part], preflight: &Preflight) -> String {
    let mut lines =
        format!("{}: {} of the image is formed\n", loaded.scene.name, percent(parts[0].share));
    for finding in &preflight.findings {
        lines += &format!("{}: {}\n", finding.severity.name(), finding.sentence);
        if let Some(remedy) = &finding.remedy {
            lines += &format!("  {remedy}\n");
        }
        finding.lines_as_toml().lines().for_each(|line| lines += &format!("    {line}\n"));
    }
    let [faults, warnings] =
        [Severity::Fault, Severity::Warning].map(|severity| preflight.count(severity));
    let number = |count: usize, what: &str| match count {
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    };
    lines += &match (faults, warnings) {
        (0, 0) => "nothing found that has to be mended\n".to_owned(),
        _ => format!("{}, {}\n", number(faults, "fault"), number(warnings, "warning")),
    };
    lines
}

/// The figures behind the findings.
fn explained(setup: &Setup, preflight: &Preflight) -> Vec<String> {
    let [x, y, z] = setup.display_place().frame.origin.to_array();
    let [w, h] = preflight.pixels.pitch;
    let mut lines = vec![
        "the image is followed along lines of sight from the viewpoint, through the objects and the plate, to the display".to_owned(),
        format!("the display belongs at ({x:.2}, {y:.2}, {z:.2}): the image, mirrored in flat mirrors and in the plate"),
        format!("a display pixel is {w:.4} x {h:.4} mm"),
    ];
    if let Some(offset) = preflight.floating.offset {
        let tilt = preflight.floating.tilt;
        lines.push(format!(
            "the plate's image of it lies {offset:.2} mm from the image's place, tilted by {tilt:.2} degrees"
        ));
    }
    if let Some(light) = preflight.light {
        lines.push(format!(
            "light meets the plate at {:.1} degrees from its normal; {:.3} of it is sent on, and {:.3} at best",
            light.incidence, light.plate, light.best
        ));
    }
    lines
}
