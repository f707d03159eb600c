//! `midair demo`: a built-in set-up and picture, end to end.

use super::check::write_check;
use super::report::write_proof;
use crate::arguments::Size;
use crate::failure::Failure;
use crate::summary::Voice;
use midair::files::write_bytes_atomically;
use midair::picture::{Depth, Still, write_still};
use midair::scene::load;
use midair_report::drawing::test_picture;
use std::path::PathBuf;

/// An acrylic ball with the image at its centre.
const SCENE: &str = include_str!("../../../../scenes/ball.toml");

/// Samples per pixel of the paper's method: enough to show its holes, few enough to end in seconds.
const SPLAT_SPP: usize = 4;

/// Run a built-in scene and picture from end to end, and write everything
///
/// An acrylic ball with a picture floating at its centre: writes the scene, the picture, the display image, the map, the views, what can be
/// formed, and report.html that shows it all. Begin your own scene from this folder.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair demo --out first-try")]
pub struct Arguments {
    /// Folder for all that is written
    #[arg(long, value_name = "DIR", default_value = "out/demo")]
    out: PathBuf,
    /// The display's resolution instead of the scene's; views are as wide
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let mut output = crate::output::into_folder(&arguments.out)?;
    let mut loaded = output.write("scene.toml", |path| {
        write_bytes_atomically(path, SCENE.as_bytes())?;
        Ok(load(path))
    })??;
    if let Some(Size(size)) = arguments.size {
        loaded.scene.display.resolution = size;
    }
    let picture = test_picture::draw(1024, 1024);
    let still = Still { picture, depth: Depth::Eight, notes: Vec::new() };
    output.write("picture.png", |path| write_still(path, &still.picture, still.depth))?;
    write_check(&loaded, &mut output, "check.png")?;
    write_proof(&loaded, &still, SPLAT_SPP, Vec::new(), output, voice)
}
