//! `midair calibrate patterns`: what the display shows while it is photographed.

use crate::arguments::open_scene;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, paths};
use midair::Monitor as _;
use midair::files::{Output, write_bytes_atomically};
use midair::picture::{Depth, write_still};
use midair::transport::Setup;
use midair_calibrate::{Patterns, page};
use serde_json::json;
use std::path::PathBuf;

/// Draw the patterns to photograph, and a page that says how
///
/// Gray code with each pattern's inverse, sinusoids, white and black: about 40 pictures in the display's own pixels. Show each full screen, without
/// scaling, and photograph it from a tripod, first without the object, then with it. The order does not matter. `midair play cube.toml patterns` shows them,
/// and runs the camera.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair calibrate patterns scene.toml --out patterns")]
pub struct Arguments {
    /// Scene file (TOML or JSON), whose display it is for
    scene: PathBuf,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let loaded = open_scene(&arguments.scene, None)?;
    let setup = Setup::new(&loaded)?;
    let mut output = crate::output::into_folder(&arguments.out)?;
    let bar = Bar::new();
    let patterns = Patterns::of(&setup);
    bar.stage("patterns", patterns.list.len());
    write_patterns(&mut output, "", &patterns, &setup, &bar)?;
    let html = page::instructions(&loaded, &patterns).to_html();
    output.write("how-to.html", |path| write_bytes_atomically(path, html.as_bytes()))?;
    bar.finish();
    let files = output.finish()?;
    let told = json!({
        "scene": loaded.scene.name,
        "patterns": patterns.list.len(),
        "size": patterns.resolution,
        "finest_stripe_px": [patterns.cell(0), patterns.cell(1)],
        "files": paths(&files),
    });
    let lines = format!(
        "{} patterns of {} x {} pixels; see {}\n",
        patterns.list.len(),
        patterns.resolution[0],
        patterns.resolution[1],
        arguments.out.join("how-to.html").display()
    );
    voice.tell(&lines, &told)
}

/// Writes all patterns as the display is sent them.
pub fn write_patterns(
    output: &mut Output,
    folder: &str,
    patterns: &Patterns,
    setup: &Setup,
    bar: &Bar,
) -> Result<(), Failure> {
    for pattern in 0..patterns.list.len() {
        let picture = patterns.picture(pattern, &setup.screen);
        let name = format!("{folder}{}", patterns.file_name(pattern));
        output.write(&name, |path| write_still(path, &picture, Depth::Eight))?;
        bar.advance(1);
    }
    Ok(())
}
