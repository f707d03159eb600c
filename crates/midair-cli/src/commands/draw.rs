//! `midair draw`: a drawing to build by, and a picture of the set-up.

use crate::arguments::open_scene;
use crate::failure::Failure;
use crate::summary::{Voice, paths, wrote};
use midair::evaluate::layout::Layout;
use midair::files::write_bytes_atomically;
use midair::transport::Setup;
use midair_report::drawing::set_up;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Draw a set-up: side and top view to scale with measures, and a picture in perspective
///
/// The drawing is one sheet of A4, true to scale: the set-up from its side and from above, light's way through the image's middle and edges,
/// distances between the middles of display, plate and image in millimetres, and a table of all parts. The picture shows the set-up as one
/// stands before it. Both are SVG: browsers show and print them, also as PDF.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair draw scene.toml --out drawing.svg --picture set-up.svg")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Drawing to write: .svg
    #[arg(long, value_name = "FILE", default_value = "drawing.svg")]
    out: PathBuf,
    /// Picture in perspective to write as well: .svg
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    for file in std::iter::once(&arguments.out).chain(&arguments.picture) {
        check_name(file)?;
    }
    let loaded = open_scene(&arguments.scene, None)?;
    let layout = Layout::of(&Setup::new(&loaded)?);
    let name = &loaded.scene.name;
    let mut files = Vec::new();
    let drawings = [
        Some((&arguments.out, set_up::drawing(&layout, name))),
        arguments.picture.as_ref().map(|file| (file, set_up::picture(&layout, name))),
    ];
    for (file, svg) in drawings.into_iter().flatten() {
        let (mut output, name) = crate::output::of_file(file)?;
        output.write(&name, |path| write_bytes_atomically(path, svg.as_bytes()))?;
        files.extend(output.finish()?);
    }
    voice.note(&loaded.notes);
    let light = match layout.courses.len() {
        0 => "no light reaches the display: midair check tells why\n",
        _ => "",
    };
    let told = json!({
        "scene": name,
        "courses": layout.courses.len(),
        "notes": loaded.notes,
        "files": paths(&files),
    });
    voice.tell(&format!("{light}{}", wrote(&files)), &told)
}

/// Refuses an output name that is not an SVG's.
pub(super) fn check_name(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if extension.eq_ignore_ascii_case("svg") {
        return Ok(());
    }
    Err(Failure::new(
        format!("{}: drawings are written as SVG", path.display()),
        "let the name end in .svg; a browser prints it as PDF",
    ))
}
