//! `midair compensate`: the map, and what the display must show.

use crate::arguments::{
    FitMode, GainMode, Size, check_view, map_formats, open_picture, open_scene,
};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, counts_line, paths, percent, timings, wrote};
use clap::ValueEnum;
use midair::Monitor as _;
use midair::clock::Laps;
use midair::compensate::{self, Brightness, Compensation, Options};
use midair::files::{Output, write_bytes_atomically};
use midair::map::format::Format;
use midair::picture::Picture;
use midair::simulate::Camera;
use midair::transport::Setup;
use midair_report::image_warning;
use serde_json::{Value, json};
use std::path::PathBuf;

mod files;

pub use files::{write_display, write_maps};

/// Compute what the display must show: the map, and the display image of a picture
///
/// Writes the map (map.exr: R = u, G = v, A = 1 where ok), display.png if a picture is given, and report.json with pixel counts, error bound and times.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  midair compensate scene.toml --out out\n  \
    midair compensate scene.toml --image photo.jpg --out out --size 1920x1080 --optimal\n  \
    midair compensate scene.toml --out out --format exr,npy,opencv\n  \
    midair compensate scene.toml --image photo.jpg --out out --gain fit --per-channel")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Picture that the mid-air image is to show: PNG, JPEG, TIFF, WebP, BMP or OpenEXR
    #[arg(long, value_name = "FILE")]
    image: Option<PathBuf>,
    /// How a picture of other proportions fills the image
    #[arg(long, value_enum, default_value_t, requires = "image")]
    fit: FitMode,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The display's resolution instead of the scene's
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// How the map is made
    #[arg(long, value_enum, default_value_t)]
    method: Method,
    /// Samples per pixel of `splat` [default: 1000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    spp: Option<u32>,
    /// Find the display image whose view is nearest to the picture, by least squares
    #[arg(long, requires = "image")]
    optimal: bool,
    /// Uniformity correction: divide by the gain, the throughput of each display pixel's path (Fresnel losses, absorption, mirrors, the plate)
    #[arg(long, value_name = "MODE", value_enum, num_args = 0..=1, default_missing_value = "fit")]
    gain: Option<GainMode>,
    /// Correct chromatic dispersion: make a map for each of the display's primaries. Writes map_r, map_g, map_b, and map_rgb.exr with all
    /// three
    #[arg(long)]
    per_channel: bool,
    /// Kinds of map files, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "exr", value_parser = map_formats())]
    format: Vec<Format>,
    /// Extrapolate the maps by N pixels beyond their coverage, for tools that interpolate between pixels; the coverage does not change
    #[arg(long, value_name = "N", default_value = "0", value_parser = clap::value_parser!(u16).range(0..=4096))]
    bleed: u16,
    /// Write the forward map as well: for each pixel of the picture, the display point that shows it (forward.exr, ...)
    #[arg(long)]
    forward: bool,
}

/// How a map is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Invert the transport adaptively, with an error bound
    #[default]
    Inverse,
    /// The paper's method: random samples through the view, scattered onto the display
    Splat,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let options = arguments.options()?;
    let loaded = open_scene(&arguments.scene, arguments.size)?;
    let mut notes = loaded.notes.clone();
    let mut still =
        arguments.image.as_ref().map(|path| open_picture(path, &mut notes)).transpose()?;
    let setup = Setup::new(&loaded)?;
    notes.extend(colour_note(&setup, options.by_colour));
    let mut output = crate::output::into_folder(&arguments.out)?;
    let maps = arguments.format.iter().map(|format| format.file_name());
    maps.chain(["display.png", "display.exr", "report.json"])
        .try_for_each(|name| output.claim(name))?;

    let bar = Bar::new();
    let mut laps = Laps::start();
    let compensation = Compensation::of(&setup, &options, &bar);
    laps.lap("map");
    let mut brightness = None;
    if let Some(still) = &mut still {
        notes.extend(fit_note(&setup, &still.picture, arguments.fit));
        let pixels = std::mem::take(&mut still.picture.pixels);
        still.picture = arguments.fit.apply(&setup, Picture { pixels, ..still.picture });
        let mut light = compensation.light(&still.picture);
        laps.lap("colour");
        if arguments.optimal {
            bar.stage("best display image", 1);
            // Nothing needs the photograph after that, and the search needs the memory.
            let pixels = std::mem::take(&mut still.picture.pixels);
            let picture = Picture { pixels, ..still.picture };
            let camera = Camera::at_viewpoint(&setup, setup.view_size(setup.resolution[0]));
            check_view(camera.size, camera.supersampling)?;
            light = compensation.best_light(picture, light)?;
            laps.lap("optimal");
        }
        let shown = compensation.shown(light);
        laps.lap("brightness");
        write_display(&mut output, still, &shown.display, setup.pixel_pitch())?;
        laps.lap("write_display");
        brightness = Some(shown.brightness);
    }
    let source = match &still {
        Some(still) => [still.picture.width, still.picture.height],
        None => setup.view_size(setup.resolution[0]),
    };
    notes.extend(arguments.write_maps(&compensation, source, &mut output)?);
    laps.lap("write_map");
    bar.finish();

    let report = compensation.report();
    notes.extend(image_warning(&report.image));
    let mut told = json!(report);
    told["midair"] = json!(env!("CARGO_PKG_VERSION"));
    told["command"] = json!("compensate");
    told["scene"] = json!(loaded.scene.name);
    told["optimal"] = json!(arguments.optimal);
    told["brightness"] = json!(brightness);
    told["timings_ms"] = timings(laps.all());
    told["notes"] = json!(notes);
    write_report(&mut output, &told)?;
    let files = output.finish()?;
    voice.note(&notes);
    voice.explain(&format!("the map took {} rays; effort {}", report.rays, told["effort"]));
    for (name, time) in laps.all() {
        voice.explain(&format!("{name}: {:.1} ms", time.as_secs_f64() * 1e3));
    }
    let lines = format!(
        "{}: {} x {} display pixels mapped{} in {:.1} ms\n{}\n{}\n{}{}",
        loaded.scene.name,
        report.size[0],
        report.size[1],
        if report.colours.is_some() { " for each of three colours" } else { "" },
        report.time.as_secs_f64() * 1e3,
        counts_line(&report.status),
        bound_line(report.error_bound),
        brightness.map(brightness_lines).unwrap_or_default(),
        wrote(&files)
    );
    told["files"] = paths(&files);
    voice.tell(&lines, &told)
}

impl Arguments {
    fn options(&self) -> Result<Options, Failure> {
        let method = match (self.method, self.spp) {
            (Method::Inverse, Some(_)) => {
                return Err(Failure::new(
                    "--spp is a setting of --method splat; the inverse method takes no samples",
                    "add --method splat, or leave --spp out",
                ));
            }
            (Method::Inverse, None) => compensate::Method::default(),
            (Method::Splat, spp) => compensate::Method::Splat { spp: spp.unwrap_or(1000) as usize },
        };
        let gain = self.gain.map(GainMode::overflow);
        Ok(Options::new().method(method).by_colour(self.per_channel).gain(gain))
    }
}

/// Writes report.json.
pub fn write_report(output: &mut Output, report: &Value) -> Result<(), Failure> {
    Ok(output.write("report.json", |path| {
        write_bytes_atomically(path, format!("{report:#}\n").as_bytes())
    })?)
}

/// Says what becomes of a picture whose proportions are not the image's.
pub fn fit_note(setup: &Setup, picture: &Picture, fit: FitMode) -> Option<String> {
    let picture_shape = picture.width as f64 / picture.height as f64;
    let image_shape = setup.image.size[0] / setup.image.size[1];
    // A pixel more or less is rounding.
    let slack = 1.0 / picture.width.min(picture.height) as f64;
    ((picture_shape / image_shape - 1.0).abs() > slack.max(0.005)).then(|| {
        let how = match fit {
            FitMode::Stretch => "is stretched over the image",
            FitMode::Contain => "has black beside it on the image",
            FitMode::Cover => "is cut off at the edges of the image",
        };
        let other = match fit {
            FitMode::Stretch => "; --fit contain or --fit cover keeps its proportions",
            FitMode::Contain | FitMode::Cover => "",
        };
        format!(
            "the picture ({} x {} pixels) {how} ({} x {} mm){other}",
            picture.width, picture.height, setup.image.size[0], setup.image.size[1]
        )
    })
}

/// Says so if indices depend on the wavelength and the maps do not, or the other way.
fn colour_note(setup: &Setup, per_channel: bool) -> Option<String> {
    match (setup.disperses(), per_channel) {
        (true, false) => Some(
            "a material disperses: this map is for yellow light (587.6 nm); --per-channel makes one for each colour".into(),
        ),
        (false, true) => {
            Some("no material disperses: the three maps are the same".to_owned())
        }
        _ => None,
    }
}

fn bound_line(bound: Option<f64>) -> String {
    bound.map_or_else(
        || "no error bound: the splat method proves none".to_owned(),
        |bound| {
            format!(
                "every ok pixel is within {bound:.1e} of exact ({:.0e} pixels of a 1024-pixel image)",
                bound * 1024.0
            )
        },
    )
}

/// What became of the brightness, for people.
fn brightness_lines(found: Brightness) -> String {
    let mut lines = String::new();
    if let Some(gain) = found.gain {
        lines += &format!(
            "gain {:.1} to {:.1} %; uniformity correction ({}): white is {:.1} % of the display's, {} of the samples clipped\n",
            100.0 * gain.least.unwrap_or_default(),
            100.0 * gain.most.unwrap_or_default(),
            gain.mode.name(),
            100.0 * gain.level,
            percent(gain.clipped)
        );
    }
    if let Some(share) = found.darker_than_black.filter(|share| *share > 0.0) {
        lines += &format!(
            "{} of the samples are darker than the display's black: there the image is too bright\n",
            percent(share)
        );
    }
    lines
}
