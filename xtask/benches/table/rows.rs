//! The rows of the table.

use super::{Outcome, set_ups};
use midair::map::{Accuracy, Map, Status, invert, invert_into, pixel_centre, splat};
use midair::optics::plate::{Model, SlitMirror, SlitMirrorPlate};
use midair::picture::display_image;
use midair::picture::optimal::{ViewSamples, Weighting, optimal_display};
use midair::simulate::{Camera, Settings, Viewer, render};
use midair::transport::{End, Setup};
use rayon::prelude::*;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Duration;

/// The row that the others are compared with.
pub const UNIT: &str = "map, sphere";

/// The paper's samples per pixel.
const PAPER_SPP: usize = 1000;

/// How much is measured.
pub struct Sizes {
    pub quick: bool,
    /// Rounds of the rows that take a few milliseconds, some hundred, and seconds.
    pub rounds: [usize; 3],
    /// Samples per pixel that stand for the paper's.
    spp: usize,
}

impl Sizes {
    pub const FULL: Self = Self { quick: false, rounds: [41, 11, 3], spp: PAPER_SPP };
    pub const QUICK: Self = Self { quick: true, rounds: [15, 5, 3], spp: 4 };
}

/// What one run of a row tells.
#[derive(Default)]
pub struct Done {
    pub remark: String,
    /// Its time, where the row measured it itself.
    pub time: Option<Duration>,
}

/// One run of a row.
pub type Work = Box<dyn FnMut() -> Outcome<Done>>;

/// A row of the table.
pub struct Row {
    pub name: String,
    pub rounds: usize,
    /// What measured times are multiplied by.
    pub extrapolated: f64,
    pub watch_memory: bool,
    prepare: Box<dyn Fn() -> Outcome<Work>>,
}

impl Row {
    pub fn new(name: &str, rounds: usize, prepare: impl Fn() -> Outcome<Work> + 'static) -> Self {
        let (name, prepare) = (name.to_owned(), Box::new(prepare));
        Self { name, rounds, extrapolated: 1.0, watch_memory: true, prepare }
    }

    /// Readies what the row works on, outside the measured time.
    pub fn prepare(&self) -> Outcome<Work> {
        (self.prepare)()
    }
}

/// The rows of midair itself that can be measured here.
pub fn of_midair(sizes: &Sizes) -> Vec<Row> {
    let [often, some, few] = sizes.rounds;
    let mut rows = Vec::new();
    for (name, file) in [
        (UNIT, "paper/sphere.toml"),
        ("map, cube", "paper/cube.toml"),
        ("map, cylinder", "paper/cylinder.toml"),
        ("map, bent mirror", "paper/bent-mirror-convex.toml"),
    ] {
        rows.push(Row::new(name, often, move || Ok(map(set_ups::scene(file)?))));
    }
    let ball = format!("map, ball of {} triangles", set_ups::BALL_TRIANGLES);
    rows.push(Row::new(&ball, some, || Ok(map(set_ups::ball()?))));
    rows.push(Row::new(FORWARD, some, forward));
    rows.push(Row::new("floor: write a map's bytes", often, || Ok(write_bytes())));
    rows.push(Row::new("splat, sphere, 1 spp", some, || scatter("paper/sphere.toml", 1)));
    let spp = sizes.spp;
    rows.push(Row {
        extrapolated: PAPER_SPP as f64 / spp as f64,
        ..Row::new(
            &format!("splat, sphere, {PAPER_SPP} spp (the paper's method)"),
            few,
            move || scatter("paper/sphere.toml", spp),
        )
    });
    rows.push(Row::new("splat, ball of triangles, 1 spp", some, || {
        Ok(splat_work(set_ups::ball()?, 1))
    }));
    rows.push(Row::new(SIMULATOR, some, simulator));
    pictures(&mut rows, [often, some, few]);
    rows.push(program(some));
    rows
}

/// The paper's set-up with a bunny, which midair does not bring along.
pub fn bunny(file: PathBuf) -> Row {
    Row::new("map, bunny", 1, move || match file.is_file() {
        true => Ok(map(set_ups::bunny_scene(&file)?)),
        false => Err(format!("{}: the bunny's mesh is not there", file.display()).into()),
    })
}

/// The program from start to end.
fn program(rounds: usize) -> Row {
    Row::new("program: midair compensate, sphere", rounds, || match midair_program() {
        Some(program) => Ok(compensate(program)),
        None => Err("the program is not built: cargo build --release -p midair-cli".into()),
    })
}

/// F as callers of the library ask for it.
pub const FORWARD: &str = "F at 10^6 image points, cylinder";

fn forward() -> Outcome<Work> {
    let setup = set_ups::scene("paper/cylinder.toml")?;
    let uv: Vec<_> = (0..1_000_000).map(|i| pixel_centre(i % 1000, i / 1000, 1000, 1000)).collect();
    Ok(Box::new(move || {
        let st = setup.transport_all(&uv, End::formed);
        let formed = st.iter().filter(|st| st[0].is_finite()).count();
        Ok(Done { remark: format!("{formed} formed"), ..Done::default() })
    }))
}

/// The forward simulator at work.
const SIMULATOR: &str = "Monte Carlo view, cylinder, slit-mirror plate, 64 paths a pixel";

/// 512 x 512 pixels through the paper's cylinder and the usual plate, by a pupil of 6 mm.
///
/// What bounds it is arithmetic: a path costs two Fresnel interfaces with a quadratic, a plate and a display, some 350 operations in
/// double precision, of which 20 are divisions or roots; with vectors of four they take about 25 ns on a core of 3.5 GHz. That is the
/// floor of doing it this way; what comes on top is the display's four pixels (gathered one by one), the sums, and the one path
/// in twelve that is reflected inside and followed by itself.
fn simulator() -> Outcome<Work> {
    let plate = Model::from(SlitMirrorPlate::new(SlitMirror::default())?);
    let setup = set_ups::scene("paper/cylinder.toml")?.with_plate(plate);
    let display = set_ups::picture(1024);
    let camera = Camera::at_viewpoint(&setup, [512, 512]);
    let viewer = Viewer { aperture: 6.0, ..Viewer::pinhole(camera) };
    let settings = Settings { samples_per_pixel: 64, seed: 1 };
    Ok(Box::new(move || {
        let start = std::time::Instant::now();
        let view = render(&setup, &display, &viewer, &settings, &(), &mut |_| ())?;
        let time = start.elapsed();
        let speed = view.paths as f64 / time.as_secs_f64() * 1e-6;
        let remark =
            format!("{speed:.1} million paths/s; standard error {:.4} a pixel", view.error.noise);
        Ok(Done { remark, time: Some(time) })
    }))
}

/// Rows of what follows the map.
fn pictures(rows: &mut Vec<Row>, [_, some, few]: [usize; 3]) {
    rows.push(Row::new("display image, sphere, 1024", some, || {
        let (map, _) = invert(&set_ups::scene("paper/sphere.toml")?, Accuracy::default());
        let picture = set_ups::picture(1024);
        Ok(Box::new(move || {
            std::hint::black_box(display_image(&picture, &map));
            Ok(Done::default())
        }))
    }));
    for size in [256, 1024] {
        let rounds = if size == 256 { some } else { few };
        let name = format!("best display image (--optimal), sphere, {size}");
        rows.push(Row::new(&name, rounds, move || {
            let mut setup = set_ups::scene("paper/sphere.toml")?;
            setup.resolution = [size; 2];
            let (map, _) = invert(&setup, Accuracy::default());
            let picture = set_ups::picture(size);
            let plain = display_image(&picture, &map);
            let camera = Camera::at_viewpoint(&setup, [size; 2]);
            Ok(Box::new(move || {
                let rays = camera.rays(&setup);
                let (target, initial) = (picture.clone(), plain.clone());
                let best = optimal_display(&rays, target, initial, Weighting::Encoded)?;
                Ok(Done { remark: format!("{} steps", best.steps), time: None })
            }))
        }));
    }
    rows.push(Row::new("view's rays, sphere, 1024, 4 a pixel", some, || {
        let setup = set_ups::scene("paper/sphere.toml")?;
        let camera = Camera::at_viewpoint(&setup, [1024; 2]);
        Ok(Box::new(move || {
            std::hint::black_box(ViewSamples::of(&camera.rays(&setup), &|_| {}));
            Ok(Done::default())
        }))
    }));
}

/// The map into memory that is already there, as a live show would.
fn map(setup: Setup) -> Work {
    let [width, height] = setup.resolution;
    let mut map = Map::unanswered(width, height);
    Box::new(move || {
        let effort = invert_into(&setup, Accuracy::default(), &mut map);
        let ok = map.status.iter().filter(|&&s| s == Status::Ok).count();
        let folded = map.status.iter().filter(|&&s| s == Status::Folded).count();
        let share = |n: usize| 100.0 * n as f64 / map.status.len() as f64;
        let remark = format!(
            "{:.1} % ok, {:.1} % folded; {} patches, {} single pixels; error bound {:.0e}",
            share(ok),
            share(folded),
            effort.patches,
            effort.solved_pixels,
            map.error_bound
        );
        Ok(Done { remark, time: None })
    })
}

/// The least that a map costs in bytes: 16 of uv and one of status for each pixel, written by all threads.
fn write_bytes() -> Work {
    let size = 1024;
    let mut map = Map::unanswered(size, size);
    Box::new(move || {
        let rows = map.uv.par_chunks_mut(size).zip(map.status.par_chunks_mut(size));
        rows.enumerate().for_each(|(row, (uv, status))| {
            let value = pixel_centre(0, row, size, size);
            uv.fill(value);
            status.fill(Status::Ok);
        });
        std::hint::black_box(&map);
        Ok(Done { remark: "17 bytes a pixel, 1024 x 1024".to_owned(), time: None })
    })
}

fn scatter(file: &str, spp: usize) -> Outcome<Work> {
    Ok(splat_work(set_ups::scene(file)?, spp))
}

fn splat_work(setup: Setup, spp: usize) -> Work {
    let (exact, _) = invert(&setup, Accuracy::default());
    let reached = exact.uv.iter().filter(|uv| uv[0].is_finite()).count();
    Box::new(move || {
        let start = std::time::Instant::now();
        let splat = splat(&setup, spp, &|_| {});
        let time = Some(start.elapsed());
        let holes = splat.holes(&exact);
        let share = 100.0 * holes as f64 / reached as f64;
        Ok(Done { remark: format!("at {spp} spp {holes} holes ({share:.2} %)"), time })
    })
}

/// The program beside this benchmark, in the folder that `cargo build --release` fills.
fn midair_program() -> Option<PathBuf> {
    let this = std::env::current_exe().ok()?;
    let name = format!("midair{}", std::env::consts::EXE_SUFFIX);
    // target/release/deps/table-0123
    let program = this.parent()?.parent()?.join(name);
    program.exists().then_some(program)
}

fn compensate(program: PathBuf) -> Work {
    Box::new(move || {
        let out = tempfile::tempdir()?;
        let mut command = Command::new(&program);
        command.arg("compensate").arg(set_ups::root().join("scenes/paper/sphere.toml"));
        command.arg("--out").arg(out.path()).stdout(Stdio::null()).stderr(Stdio::null());
        let start = std::time::Instant::now();
        let status = command.status()?;
        let time = Some(start.elapsed());
        if !status.success() {
            return Err(format!("midair compensate failed ({status})").into());
        }
        Ok(Done { remark: "start, scene, map, map.exr, report".to_owned(), time })
    })
}
