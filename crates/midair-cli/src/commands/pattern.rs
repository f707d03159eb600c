//! `midair pattern`: what a display shows to be set up by.

use crate::arguments::{Size, check_picture_name, open_scene};
use crate::failure::Failure;
use crate::summary::{Voice, paths, wrote};
use clap::ValueEnum;
use midair::picture::{Depth, write_still_of_pitch};
use midair::transport::Setup;
use midair_report::drawing::pattern::{Pattern, draw};
use serde_json::json;
use std::path::PathBuf;

/// Draw a pattern for the display: to see that it shows things in their true size, and where the object belongs
///
/// The picture has the display's pixels, and says how many there are in a millimetre. Show it full screen, without scaling. "ruler" has a square
/// whose sides are to be measured; "registration" marks where objects stand, seen along the display's normal; "lattice" is the paper's;
/// "grey" has 17 steps of even codes; "white" is all white.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  midair pattern ruler scene.toml --out ruler.png\n  midair pattern registration scene.toml --out marks.png"
)]
pub struct Arguments {
    /// What to draw
    #[arg(value_enum)]
    kind: Kind,
    /// Scene file (TOML or JSON), whose display it is for
    scene: PathBuf,
    /// Picture to write: .png or .exr
    #[arg(long, value_name = "FILE", default_value = "pattern.png")]
    out: PathBuf,
    /// The display's resolution instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Lines of the lattice in each direction
    #[arg(long, value_name = "N", default_value = "7", value_parser = clap::value_parser!(u16).range(2..=99))]
    lines: u16,
}

/// What is drawn.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    /// Yellow lines on black, as the paper's
    Lattice,
    /// Millimetres along both sides, and a square to measure
    Ruler,
    /// Where objects stand
    Registration,
    /// Seventeen steps of grey
    Grey,
    /// White all over
    White,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    check_picture_name(&arguments.out)?;
    let loaded = open_scene(&arguments.scene, arguments.size)?;
    let setup = Setup::new(&loaded)?;
    let pattern = match arguments.kind {
        Kind::Lattice => Pattern::Lattice { lines: arguments.lines.into() },
        Kind::Ruler => Pattern::Ruler,
        Kind::Registration => Pattern::Registration,
        Kind::Grey => Pattern::Grey,
        Kind::White => Pattern::White,
    };
    let picture = draw(pattern, &setup)
        .map_err(|error| Failure::new(error.to_string(), "ask for fewer lines"))?;
    let (mut output, name) = crate::output::of_file(&arguments.out)?;
    let pitch = setup.pixel_pitch();
    output.write(&name, |path| write_still_of_pitch(path, &picture, Depth::Eight, pitch))?;
    let files = output.finish()?;
    let told = json!({
        "scene": loaded.scene.name,
        "resolution": setup.resolution,
        "pixel_pitch_mm": pitch,
        "files": paths(&files),
    });
    voice.tell(&wrote(&files), &told)
}
