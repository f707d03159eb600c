//! `midair eyebox`: one map for several viewpoints.

use super::compensate::{write_maps, write_report};
use crate::arguments::{Point, Size, map_formats, open_picture, open_scene};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, milliseconds, paths, wrote};
use midair::evaluate::eyebox::{Eye, check_count, eyebox, region, two_eyes};
use midair::geometry::Vec3;
use midair::map::format::Format;
use midair::picture::{display_image, write_still};
use midair::transport::Setup;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Make one map for several viewpoints: the least-squares compromise, and the displacement that it leaves at each
///
/// For both eyes, a region, or viewpoints of your own. Writes the map, display.png if there is a picture, and report.json with the displacement that remains
/// at each viewpoint, beside that of the map for the scene's viewpoint alone.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  midair eyebox scene.toml --out out --ipd 63\n  \
    midair eyebox scene.toml --out out --region 200x80 --grid 5x3\n  \
    midair eyebox scene.toml --out out --viewpoint -40,0,800 --viewpoint 40,0,800")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Picture that the mid-air image is to show: PNG, JPEG, TIFF, WebP, BMP or OpenEXR
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// The display's resolution instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Both eyes of a viewer whose nose is at the viewpoint: mm from one to the other [default: 63]
    #[arg(long, value_name = "MM", conflicts_with_all = ["region", "viewpoint"], value_parser = crate::arguments::positive)]
    ipd: Option<f64>,
    /// A region around the viewpoint, square to the line of sight: width and height in mm
    #[arg(long, value_name = "WxH", conflicts_with = "viewpoint")]
    region: Option<Size>,
    /// Viewpoints over the region
    #[arg(long, value_name = "WxH", default_value = "5x3", requires = "region")]
    grid: Size,
    /// A viewpoint in mm; give several
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    viewpoint: Vec<Point>,
    /// Kinds of map files, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "exr", value_parser = map_formats())]
    format: Vec<Format>,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let loaded = open_scene(&arguments.scene, arguments.size)?;
    let mut notes = loaded.notes.clone();
    let still = arguments.image.as_ref().map(|path| open_picture(path, &mut notes)).transpose()?;
    let setup = Setup::new(&loaded)?;
    let grid = arguments.grid.0;
    if arguments.region.is_some() {
        check_count(&setup, grid[0].saturating_mul(grid[1]))?;
    }
    let eyes: Vec<Vec3> = match (arguments.region, &arguments.viewpoint[..]) {
        (Some(Size(size)), _) => region(&setup, size.map(|mm| mm as f64), grid),
        (None, []) => two_eyes(&setup, arguments.ipd.unwrap_or(63.0)),
        (None, given) => given.iter().map(|Point(at)| Vec3::from_array(*at)).collect(),
    };
    let mut output = crate::output::into_folder(&arguments.out)?;
    let start = Instant::now();
    let bar = Bar::new();
    let found = eyebox(&setup, &eyes, &bar)?;
    bar.finish();
    let map = &found.map;
    let counts = map.counts();
    if counts.ok + counts.folded == 0 {
        notes.push("no display pixel reaches the image from any of the viewpoints".to_owned());
    }
    if let Some(still) = &still {
        let display = display_image(&still.picture, map);
        output.write("display.png", |path| write_still(path, &display, still.depth))?;
    }
    let source = match &still {
        Some(still) => [still.picture.width, still.picture.height],
        None => setup.view_size(setup.resolution[0]),
    };
    notes.extend(write_maps(&mut output, map, None, "map", source, &arguments.format)?);
    let mut report = json!(found);
    report["midair"] = json!(env!("CARGO_PKG_VERSION"));
    report["command"] = json!("eyebox");
    report["scene"] = json!(loaded.scene.name);
    report["timings_ms"] = json!({ "maps": milliseconds(start.elapsed()) });
    report["notes"] = json!(notes);
    write_report(&mut output, &report)?;
    let files = output.finish()?;
    voice.note(&notes);
    let mut lines = format!(
        "{}: displacement that remains, mm on the image's plane (mean, largest)\n  viewpoint                     compromise        one viewpoint's map\n",
        loaded.scene.name
    );
    for Eye { position: [x, y, z], compromise, single } in found.eyes.iter().take(20) {
        let place = format!("({x:.1}, {y:.1}, {z:.1})");
        lines += &format!(
            "  {place:28} {:7.3} {:7.3}   {:7.3} {:7.3}\n",
            compromise.mean, compromise.max, single.mean, single.max
        );
    }
    let [all, alone] = found.rms();
    lines += &format!(
        "  root mean square of all       {:7.3}           {:7.3}\n{}",
        all,
        alone,
        wrote(&files)
    );
    report["files"] = paths(&files);
    voice.tell(&lines, &report)
}
