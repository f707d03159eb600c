//! `midair plate`: a plate's character as pictures and numbers.

use crate::arguments::{length, open_scene};
use crate::failure::Failure;
use crate::summary::{Voice, paths, wrote};
use midair::evaluate::character::Character;
use midair::files::write_bytes_atomically;
use midair::picture::{Depth, write_still};
use midair_report::character::{lines, shares, sharpness, viewpoints};
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
    let character = Character::of(&loaded, arguments.aperture)?;
    notes.extend_from_slice(&character.notes);
    let mut output = crate::output::into_folder(&arguments.out)?;
    for (name, picture) in [
        ("shares.png", shares(&character)),
        ("viewpoints.png", viewpoints(&character)),
        ("sharpness.png", sharpness(&character)),
    ] {
        output.write(name, |path| write_still(path, &picture, Depth::Eight))?;
    }
    let mut told = json!(character);
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
