//! `midair check`: what can be formed, what cannot, and why.

mod stray;

use crate::arguments::{Size, check_picture_name, open_scene};
use crate::failure::Failure;
use crate::summary::{Voice, counts_line, paths, percent, wrote};
use midair::files::Output;
use midair::map::{Accuracy, Formation, ImagePoint, Map, formation, invert};
use midair::picture::{Depth, write_still};
use midair::scene::Loaded;
use midair::transport::Setup;
use midair_report::drawing::status_picture::{self, Part};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
pub use stray::Stray;

/// Report which part of the image is formed, which is not, and why
///
/// Also draws it: the image as the viewer sees it, and the display's pixels, coloured by status.
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
    json: Value,
}

/// Image points along the longer side that are followed.
const POINTS: usize = 512;

/// Checks a scene and draws the outcome.
pub fn write_check(
    loaded: &Loaded,
    output: &mut Output,
    name: impl AsRef<Path>,
) -> Result<Checked, Failure> {
    let setup = Setup::new(loaded)?;
    let (map, _) = invert(&setup, Accuracy::default());
    let [w, h] = setup.image.size;
    let width = if w >= h { POINTS } else { ((POINTS as f64 * w / h) as usize).max(1) };
    let formation = formation(&setup, &map, setup.view_size(width));
    let parts = parts(&setup, &formation);
    let advice = Advice::of(&setup, &formation);
    let picture = status_picture::draw(&loaded.scene.name, &formation, &parts, &map);
    output.write(name, |path| write_still(path, &picture, Depth::Eight))?;
    let lines = lines(loaded, &setup, &parts, &map, advice.as_ref());
    let json = told(loaded, &setup, &parts, &map, advice.as_ref());
    Ok(Checked { setup, map, lines, json })
}

/// The kinds of image points that there are, the most frequent first, formed ones before all.
fn parts(setup: &Setup, formation: &Formation) -> Vec<Part> {
    let mut counts: HashMap<ImagePoint, usize> = HashMap::new();
    formation.points.iter().for_each(|&point| *counts.entry(point).or_default() += 1);
    counts.entry(ImagePoint::Formed).or_default();
    let all = formation.points.len() as f64;
    let mut parts: Vec<Part> = counts
        .into_iter()
        .map(|(point, count)| Part { point, name: reason(setup, point), share: count as f64 / all })
        .collect();
    parts.sort_by(|a, b| {
        let formed = |part: &Part| part.point != ImagePoint::Formed;
        formed(a).cmp(&formed(b)).then(b.share.total_cmp(&a.share)).then(a.name.cmp(&b.name))
    });
    parts
}

/// What becomes of an image point, in words.
fn reason(setup: &Setup, point: ImagePoint) -> String {
    match point {
        ImagePoint::Formed => "formed".to_owned(),
        ImagePoint::Folded => "folded: its display pixel is seen elsewhere too".to_owned(),
        ImagePoint::TotalReflection(element) => {
            let name = setup.elements.get(usize::from(element)).map_or("?", |e| &e.name);
            format!("total internal reflection in \"{name}\"")
        }
        ImagePoint::MissedPlate => "its light goes past the plate".to_owned(),
        ImagePoint::PlateBehind => "its light meets the plate from behind".to_owned(),
        ImagePoint::MissedDisplay => "its light goes past the display".to_owned(),
        ImagePoint::TooManyInteractions => {
            format!("more than {} interactions (max_interactions)", setup.max_interactions)
        }
    }
}

/// A display that would cover the whole image.
struct Advice {
    /// Width and height, mm.
    size: [f64; 2],
    /// Its centre, mm.
    position: [f64; 3],
    /// The part of the display asked for now, lower left and upper right.
    wanted: [[f64; 2]; 2],
}

impl Advice {
    /// Advice if the display is too small or stands off the light's way.
    fn of(setup: &Setup, formation: &Formation) -> Option<Self> {
        let [low, high] = formation.wanted?;
        if !(0..2).any(|axis| low[axis] < 0.0 || high[axis] > 1.0) {
            return None;
        }
        // The points followed are pixel centres: the border lies up to half a point's width further out, for which a
        // whole one is added on each side; sizes are rounded up to a tenth of a millimetre.
        let points = [formation.width, formation.height];
        let size = std::array::from_fn(|axis| {
            let wanted = (high[axis] - low[axis]) * setup.display.size[axis];
            (wanted * (1.0 + 2.0 / points[axis] as f64) * 10.0).ceil() / 10.0
        });
        let middle = setup.display.point([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])]);
        let position =
            [middle.x, middle.y, middle.z].map(|c: f64| (c * 100.0).round() / 100.0 + 0.0);
        Some(Self { size, position, wanted: [low, high] })
    }
}

fn lines(
    loaded: &Loaded,
    setup: &Setup,
    parts: &[Part],
    map: &Map,
    advice: Option<&Advice>,
) -> String {
    let mut lines =
        format!("{}: {} of the image is formed\n", loaded.scene.name, percent(parts[0].share));
    for part in &parts[1..] {
        lines += &format!("  {:>8}  {}\n", percent(part.share), part.name);
    }
    lines += &counts_line(&map.counts());
    lines += "\n";
    if let Some(advice) = advice {
        let [w, h] = setup.display.size;
        lines += &format!(
            "the display ({w} x {h} mm) does not cover the whole image: it would with\n  \
             [display]\n  position = {:?}\n  rotation = {:?}\n  size = {:?}\n",
            advice.position,
            rotation(setup),
            advice.size
        );
    }
    lines
}

/// The display's rotation as a scene file has it: Rx*Ry*Rz, degrees.
fn rotation(setup: &Setup) -> [f64; 3] {
    let [x, y, z] = setup.display.frame.axes;
    // The matrix's columns are the axes; Rx*Ry*Rz has sin(y) at row 0, column 2.
    let about_y = z.x.clamp(-1.0, 1.0).asin();
    let (about_x, about_z) = if z.x.abs() < 1.0 - 1e-12 {
        ((-z.y).atan2(z.z), (-y.x).atan2(x.x))
    } else {
        (y.z.atan2(y.y), 0.0)
    };
    [about_x, about_y, about_z].map(|angle| {
        let degrees = (angle.to_degrees() * 1e6).round() / 1e6;
        // No negative zero in what the user is to copy.
        degrees + 0.0
    })
}

fn told(
    loaded: &Loaded,
    setup: &Setup,
    parts: &[Part],
    map: &Map,
    advice: Option<&Advice>,
) -> Value {
    let share = |wanted: ImagePoint| {
        parts.iter().find(|part| part.point == wanted).map_or(0.0, |part| part.share)
    };
    let not_formed: serde_json::Map<String, Value> = parts
        .iter()
        .filter(|part| !matches!(part.point, ImagePoint::Formed | ImagePoint::Folded))
        .map(|part| (part.name.clone(), json!(part.share)))
        .collect();
    json!({
        "scene": loaded.scene.name,
        "image": {
            "formed": share(ImagePoint::Formed),
            "folded": share(ImagePoint::Folded),
            "not_formed": not_formed,
        },
        "display": {
            "resolution": setup.resolution,
            "size": setup.display.size,
            "status": map.counts(),
            "advice": advice.map(|advice| json!({
                "position": advice.position,
                "rotation": rotation(setup),
                "size": advice.size,
                "asked_for": advice.wanted,
            })),
        },
    })
}
