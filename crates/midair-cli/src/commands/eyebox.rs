//! `midair eyebox`: one map for several viewpoints.

use super::compensate::{write_maps, write_report};
use crate::arguments::{Point, Size, map_formats, open_picture, open_scene};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, milliseconds, number, paths, wrote};
use midair::Monitor as _;
use midair::evaluate::eyebox::{Remaining, compromise, region, remaining, two_eyes};
use midair::geometry::Vec3;
use midair::map::format::Format;
use midair::map::{Accuracy, Map, invert};
use midair::picture::{display_image, write_still};
use midair::transport::Setup;
use serde_json::{Value, json};
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

/// Maps that may be held at once: pixels of them all.
const MOST_PIXELS: usize = 1 << 27;

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let loaded = open_scene(&arguments.scene, arguments.size)?;
    let mut notes = loaded.notes.clone();
    let still = arguments.image.as_ref().map(|path| open_picture(path, &mut notes)).transpose()?;
    let setup = Setup::new(&loaded)?;
    let [width, height] = setup.resolution;
    let grid = arguments.grid.0;
    let count = match arguments.region {
        Some(_) => grid[0].saturating_mul(grid[1]),
        None => arguments.viewpoint.len().max(2),
    };
    if count.saturating_mul(width * height) > MOST_PIXELS {
        return Err(Failure::new(
            format!("{count} maps of {width} x {height} pixels are too much to hold"),
            "ask for fewer viewpoints, or a smaller --size",
        ));
    }
    let eyes: Vec<Vec3> = match (arguments.region, &arguments.viewpoint[..]) {
        (Some(Size(size)), _) => region(&setup, size.map(|mm| mm as f64), grid),
        (None, []) => two_eyes(&setup, arguments.ipd.unwrap_or(63.0)),
        (None, given) => given.iter().map(|Point(at)| Vec3::from_array(*at)).collect(),
    };
    let mut output = crate::output::into_folder(&arguments.out)?;
    let start = Instant::now();
    let bar = Bar::new();
    bar.stage("maps", eyes.len() + 1);
    let map_from = |viewpoint: Vec3| -> Map {
        let (map, _) = invert(&setup.with_viewpoint(viewpoint), Accuracy::default());
        bar.advance(1);
        map
    };
    let single = map_from(setup.viewpoint);
    let maps: Vec<Map> = eyes.iter().map(|&eye| map_from(eye)).collect();
    bar.finish();
    let Some(map) = compromise(&maps) else {
        return Err(Failure::new("there is no viewpoint", "give --ipd, --region or --viewpoint"));
    };
    let counts = map.counts();
    if counts.ok + counts.folded == 0 {
        notes.push("no display pixel reaches the image from any of the viewpoints".to_owned());
    }
    if let Some(still) = &still {
        let display = display_image(&still.picture, &map);
        output.write("display.png", |path| write_still(path, &display, still.depth))?;
    }
    let source = match &still {
        Some(still) => [still.picture.width, still.picture.height],
        None => setup.view_size(width),
    };
    notes.extend(write_maps(&mut output, &map, None, "map", source, &arguments.format)?);
    let size = setup.image.size;
    let left: Vec<[Remaining; 2]> =
        maps.iter().map(|own| [&map, &single].map(|shown| remaining(shown, own, size))).collect();
    let mut report = json!({
        "midair": env!("CARGO_PKG_VERSION"),
        "command": "eyebox",
        "scene": loaded.scene.name,
        "size": setup.resolution,
        "status": counts,
        "viewpoints": eyes.iter().zip(&left).map(|(eye, [compromise, single])| json!({
            "position": [eye.x, eye.y, eye.z],
            "compromise_mm": told(compromise),
            "single_mm": told(single),
        })).collect::<Vec<_>>(),
        "all": { "compromise_rms_mm": number(rms(&left, 0)), "single_rms_mm": number(rms(&left, 1)) },
        "timings_ms": { "maps": milliseconds(start.elapsed()) },
        "notes": notes,
    });
    write_report(&mut output, &report)?;
    let files = output.finish()?;
    voice.note(&notes);
    let mut lines = format!(
        "{}: displacement that remains, mm on the image's plane (mean, largest)\n  viewpoint                     compromise        one viewpoint's map\n",
        loaded.scene.name
    );
    for (eye, [compromise, single]) in eyes.iter().zip(&left).take(20) {
        let place = format!("({:.1}, {:.1}, {:.1})", eye.x, eye.y, eye.z);
        lines += &format!(
            "  {place:28} {:7.3} {:7.3}   {:7.3} {:7.3}\n",
            compromise.mean, compromise.max, single.mean, single.max
        );
    }
    lines += &format!(
        "  root mean square of all       {:7.3}           {:7.3}\n{}",
        rms(&left, 0),
        rms(&left, 1),
        wrote(&files)
    );
    report["files"] = paths(&files);
    voice.tell(&lines, &report)
}

fn told(left: &Remaining) -> Value {
    json!({ "pixels": left.pixels, "rms": number(left.rms), "mean": number(left.mean), "max": number(left.max) })
}

/// Over all viewpoints and pixels.
fn rms(left: &[[Remaining; 2]], which: usize) -> f64 {
    let known = || left.iter().map(|both| both[which]).filter(|left| left.pixels > 0);
    let squares: f64 = known().map(|left| left.rms.powi(2) * left.pixels as f64).sum();
    (squares / known().map(|left| left.pixels as f64).sum::<f64>()).sqrt()
}
