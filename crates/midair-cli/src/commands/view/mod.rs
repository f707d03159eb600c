//! `midair view`: what is seen of a display.

mod by_chance;

use crate::arguments::{
    Point, Size, check_picture_name, check_view, open_picture, open_scene, positive,
};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, milliseconds, paths, percent, wrote};
use midair::Monitor as _;
use midair::files::Output;
use midair::geometry::Vec3;
use midair::picture::optimal::{ViewRays, view_through};
use midair::picture::{Depth, Still, emitted, write_still};
use midair::scene::Loaded;
use midair::simulate::{Camera, Sight};
use midair::transport::Setup;
use serde_json::json;
use std::ffi::OsString;
use std::ops::Range;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Render what the viewer sees of a display
///
/// The view shows the image's plane: a view pixel is an image point, wherever the eye is. Pixels that no light of the display
/// reaches are black.
///
/// By default each ray follows one path, through an ideal plate and refracting or reflecting surfaces, into a pinhole. With --spp, or
/// any other option under "Monte Carlo path tracing", light is traced statistically: with reflections, absorption,
/// dispersion, a pupil of finite size, and the plate's mirrors with their stray images.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  midair view scene.toml --display out/display.png --out view.png --from 50,0,800
  midair view scene.toml --display out/display.png --out view.png --out view.exr \\
      --plate slit-mirror --spp 256 --aperture 4
  midair view scene.toml --display out/display.png --out stray.png --plate slit-mirror \\
      --light stray --exposure 4 --window 3")]
pub struct Arguments {
    /// Scene file (TOML or JSON)
    scene: PathBuf,
    /// Picture that the display shows: PNG, JPEG, TIFF, WebP, BMP or OpenEXR
    #[arg(long, value_name = "FILE")]
    display: PathBuf,
    /// Picture to write: .png or .exr (linear light); may be given more than once
    #[arg(long, value_name = "FILE", required = true)]
    out: Vec<PathBuf>,
    /// Position of the eye in mm, instead of the scene's viewpoint
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    from: Option<Point>,
    /// Pixels of the view; left out: as wide as the scene's display, in the image's proportions
    #[arg(long, value_name = "WxH")]
    size: Option<Size>,
    /// Size of the view over the size of the image
    #[arg(long, default_value = "1", value_parser = positive)]
    window: f64,
    /// Rays along each side of a pixel
    #[arg(long, value_name = "N", default_value = "2", value_parser = clap::value_parser!(u16).range(1..=64))]
    supersampling: u16,
    #[command(flatten)]
    by_chance: by_chance::Options,
}

/// What is rendered, and from where.
struct Shot {
    loaded: Loaded,
    setup: Setup,
    still: Still,
    camera: Camera,
    outputs: Vec<(Output, OsString)>,
    notes: Vec<String>,
}

/// The exit code tells a view that was interrupted from a whole one.
pub fn run(arguments: &Arguments, voice: Voice) -> Result<ExitCode, Failure> {
    let by_chance = arguments.by_chance.any();
    let shot = prepare(arguments, if by_chance { by_chance::MEMORY_AS_RAYS } else { 1 })?;
    if by_chance {
        return by_chance::run(&arguments.by_chance, shot, voice);
    }
    one_course(shot, voice)?;
    Ok(ExitCode::SUCCESS)
}

/// Reads and checks everything. `weight`: how many rays a pixel counts for in memory, along each side.
fn prepare(arguments: &Arguments, weight: usize) -> Result<Shot, Failure> {
    arguments.out.iter().try_for_each(|out| check_picture_name(out))?;
    let loaded = open_scene(&arguments.scene, None)?;
    let mut notes = loaded.notes.clone();
    let mut still = open_picture(&arguments.display, &mut notes)?;
    if !loaded.screen.is_plain() {
        still.picture = emitted(&still.picture, &loaded.screen);
    }
    let setup = Setup::new(&loaded)?;
    let size = match arguments.size {
        Some(Size(size)) => size,
        None => setup.view_size(setup.resolution[0]),
    };
    let supersampling = usize::from(arguments.supersampling);
    check_view(size, supersampling.max(weight))?;
    let outputs =
        arguments.out.iter().map(|out| crate::output::of_file(out)).collect::<Result<_, _>>()?;
    let eye = arguments.from.map_or(setup.viewpoint, |Point(at)| Vec3::from_array(at));
    let camera = Camera { eye, size, window: arguments.window, supersampling };
    Ok(Shot { loaded, setup, still, camera, outputs, notes })
}

/// Rays that are counted and told of as they are traced.
struct Watched<'a> {
    rays: Sight<'a>,
    bar: &'a Bar,
    traced: AtomicUsize,
    formed: AtomicUsize,
}

impl ViewRays for Watched<'_> {
    fn size(&self) -> [usize; 2] {
        self.rays.size()
    }

    fn rays_per_pixel(&self) -> usize {
        self.rays.rays_per_pixel()
    }

    fn ends(&self, pixels: Range<usize>, ends: &mut [[f64; 2]]) {
        let rows = pixels.len() / self.size()[0];
        self.rays.ends(pixels, ends);
        let formed = ends.iter().filter(|st| st[0].is_finite()).count();
        self.traced.fetch_add(ends.len(), Ordering::Relaxed);
        self.formed.fetch_add(formed, Ordering::Relaxed);
        self.bar.advance(rows);
    }
}

/// The view by the one course that light has through an ideal plate and clear elements.
fn one_course(shot: Shot, voice: Voice) -> Result<(), Failure> {
    let Shot { loaded, setup, still, camera, outputs, notes } = shot;
    let (eye, size) = (camera.eye, camera.size);
    let start = Instant::now();
    let bar = Bar::new();
    bar.stage("rays of the view", size[1]);
    let watched =
        Watched { rays: camera.rays(&setup), bar: &bar, traced: 0.into(), formed: 0.into() };
    let view = view_through(&watched, &still.picture)?;
    bar.finish();
    let time = start.elapsed();
    let rays = watched.traced.into_inner();
    let lit = watched.formed.into_inner() as f64 / rays as f64;

    let depth = if still.depth == Depth::Eight { Depth::Eight } else { Depth::Sixteen };
    let mut files = Vec::new();
    for (mut output, name) in outputs {
        output.write(&name, |path| write_still(path, &view, depth))?;
        files.extend(output.finish()?);
    }
    voice.note(&notes);
    voice.explain(&format!(
        "{} rays from ({}, {}, {}) mm, each the bilinear interpolation of four display pixels",
        rays, eye.x, eye.y, eye.z
    ));
    let lines = format!(
        "{}: a view of {} x {} pixels, {} of it reached by the display's light\n{}",
        loaded.scene.name,
        size[0],
        size[1],
        percent(lit),
        wrote(&files)
    );
    voice.tell(
        &lines,
        &json!({
            "scene": loaded.scene.name,
            "size": size,
            "from": [eye.x, eye.y, eye.z],
            "window": camera.window,
            "rays": rays,
            "lit": lit,
            "timings_ms": { "view": milliseconds(time) },
            "files": paths(&files),
            "notes": notes,
        }),
    )
}
