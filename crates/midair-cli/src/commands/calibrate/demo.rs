//! `midair calibrate demo`: the whole chain on photographs that our simulator takes.

use super::fit::{lines, write_finding};
use crate::arguments::open_scene;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, paths};
use midair::Monitor as _;
use midair::files::{Output, renamed, write_bytes_atomically};
use midair::map::{Accuracy, Map, invert};
use midair::scene::{Format, InMemory, Loaded, SceneEdit, load_text};
use midair::transport::Setup;
use midair_calibrate::bench::Bench;
use midair_calibrate::rehearsal::film::Film;
use midair_calibrate::rehearsal::{Displacement, camera, displacement, disturbed};
use midair_calibrate::{
    Options, Patterns, SightedView, Sighting, Uncertainty, fit, survey, without_elements,
};
use serde_json::json;
use std::path::{Path, PathBuf};

/// The paper's cube behind a plate of slit mirrors.
const SCENE: &str = include_str!("../../../../../scenes/paper/cube.toml");

/// Rehearse a calibration: photographs by the simulator, decoded, fitted, and what it gains
///
/// A set-up that is some millimetres and degrees off its scene is photographed from three places without and with the object: slit-mirror plate, stray
/// light, lens distortion, photon noise, JPEG. What is written is a bench to try the other commands on, and the fitted scene; what is told is how far a
/// lattice would be from where it belongs with the assumed scene, with the fitted one, and with the map that needs no model.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  midair calibrate demo --out rehearsal")]
pub struct Arguments {
    /// Scene file (TOML or JSON); left out: the paper's cube behind a slit-mirror plate
    scene: Option<PathBuf>,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR", default_value = "out/calibrate-demo")]
    out: PathBuf,
    /// Width of the photographs, px
    #[arg(long, value_name = "N", default_value = "1200", value_parser = clap::value_parser!(u32).range(300..=8000))]
    width: u32,
    /// Which bench is rehearsed: each number is another one
    #[arg(long, value_name = "N", default_value = "1")]
    seed: u64,
}

/// Names and places of the views: degrees to the right and upwards of the scene's viewpoint.
const VIEWS: [(&str, f64, f64); 3] =
    [("front", 0.0, 0.0), ("right", 12.0, 2.0), ("oblique", -9.0, 10.0)];

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let mut output = crate::output::into_folder(&arguments.out)?;
    let (assumed, text, name) = assumed(arguments)?;
    let mut draw = midair_calibrate::rehearsal::dice(arguments.seed);
    let uncertainty = Uncertainty::default();
    let real = disturbed(&still(&assumed), &uncertainty, &[], &[], &mut draw)?;
    let (setup, patterns) = (Setup::new(&real)?, Patterns::of(&Setup::new(&assumed)?));
    let film = Film::over_image(&setup, arguments.width as usize);
    output.write(name, |path| write_bytes_atomically(path, text.as_bytes()))?;

    let bar = Bar::new();
    let mut sighted = photograph(&mut output, &film, &setup, &patterns, &mut draw, &bar)?;
    let bench = bench_text(name, &film);
    output.write("bench.toml", |path| write_bytes_atomically(path, bench.as_bytes()))?;
    let bench = Bench::parse(&bench, "bench.toml".as_ref())?;
    let survey = survey(&assumed, bench.lens, &mut sighted, &bar)?;
    let options = Options { uncertainty, lens: bench.lens, ..Options::default() };
    let finding = fit(&assumed, &survey.views, &options, &bar)?;

    bar.stage("what it gains", 3);
    let eye = camera(&setup, VIEWS[0].1, VIEWS[0].2).origin;
    let of = |map: &Map| displacement(&setup, eye, map, 7);
    let by_scene = |loaded: &Loaded| -> Result<Displacement, Failure> {
        let (map, _) = invert(&Setup::new(loaded)?.with_viewpoint(eye), Accuracy::default());
        bar.advance(1);
        Ok(of(&map))
    };
    let (before, fitted) = (by_scene(&still(&assumed))?, by_scene(&finding.loaded)?);
    let model_free = match &sighted[0].object {
        Sighting::Photographs(decoded) => {
            let camera = &survey.cameras[0];
            let setup = Setup::new(&assumed)?;
            Some(of(&midair_calibrate::model_free::model_free(
                &setup,
                camera,
                &survey.lens,
                decoded,
            )))
        }
        Sighting::Points(_) => None,
    };
    bar.finish();
    let mut told = json!(finding);
    told["midair"] = json!(env!("CARGO_PKG_VERSION"));
    told["command"] = json!("calibrate demo");
    told["scene"] = json!(assumed.scene.name);
    told["displacement_px_of_1024"] =
        json!({ "assumed": before, "fitted": fitted, "model_free": model_free });
    let from = arguments.scene.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
    let rename = |name: &Path| renamed(name, from, &arguments.out);
    write_finding(&mut output, &assumed, &finding, &told, &[], &rename)?;
    let files = output.finish()?;
    told["files"] = paths(&files);
    let line = |what: &str, d: &Displacement| {
        format!(
            "{what:26} {:>7.3} px mean, {:>7.3} px largest ({} of {} crossings)\n",
            d.mean, d.largest, d.compared, d.of
        )
    };
    let mut text = lines(&finding);
    text += "a lattice at the real bench, seen by the first camera, in pixels of 1024:\n";
    text += &line("  with the assumed scene", &before);
    text += &line("  with the fitted scene", &fitted);
    if let Some(model_free) = &model_free {
        text += &line("  with the model-free map", model_free);
    }
    text += &format!(
        "see {}; a bench to try: {}\n",
        arguments.out.join("report.html").display(),
        arguments.out.join("bench.toml").display()
    );
    voice.tell(&text, &told)
}

/// The scene that is assumed, its text, and what its file is called.
fn assumed(arguments: &Arguments) -> Result<(Loaded, String, &'static str), Failure> {
    match &arguments.scene {
        Some(path) => {
            let loaded = open_scene(path, None)?;
            let mut edit = SceneEdit::of(&loaded.text)?;
            let from = path.parent().unwrap_or(Path::new(""));
            edit.rename_files(&|name| renamed(name, from, &arguments.out))?;
            let json = edit.format() == Format::Json;
            let text = edit.text().to_owned();
            Ok((loaded, text, if json { "assumed.json" } else { "assumed.toml" }))
        }
        None => {
            let text = SCENE
                .replace("size = [488.0, 488.0]", "size = [488.0, 488.0]\nmodel = \"slit-mirror\"");
            let loaded = load_text(&text, "assumed.toml", Format::Toml, &InMemory::new())?;
            Ok((loaded, text, "assumed.toml"))
        }
    }
}

/// The scene with its display's place said: what is moved is the object, not the display.
fn still(loaded: &Loaded) -> Loaded {
    midair_calibrate::standing_still(loaded)
}

/// Photographs all views, writes them in an order that nobody knows, and decodes them from the files.
fn photograph(
    output: &mut Output,
    film: &Film,
    setup: &Setup,
    patterns: &Patterns,
    draw: &mut midair_calibrate::rehearsal::Dice,
    bar: &Bar,
) -> Result<Vec<SightedView>, Failure> {
    let bare = without_elements(setup);
    let mut views = Vec::new();
    for (name, right, up) in VIEWS {
        let camera = camera(setup, right, up);
        let mut state = |state: &str, setup: &Setup| -> Result<Sighting, Failure> {
            bar.stage(&format!("{name}, {state}"), 1);
            let (files, _) = film.shoot(setup, &camera, patterns, draw.u64(..));
            let folder = format!("{name}-{state}");
            let mut numbers: Vec<usize> = (0..files.len()).collect();
            draw.shuffle(&mut numbers);
            for (file, number) in files.iter().zip(numbers) {
                let name = format!("{folder}/IMG_{:04}.jpg", 1001 + number);
                let place = output.path(&folder);
                std::fs::create_dir_all(&place)
                    .map_err(|error| midair::files::FileError::io(&place, "create", error))?;
                output.write(&name, |path| write_bytes_atomically(path, file))?;
            }
            let place = output.path(&folder);
            let decoded = midair_calibrate::decode::decode_folder(patterns, &place, &())?;
            Ok(Sighting::Photographs(Box::new(decoded)))
        };
        views.push(SightedView {
            name: name.to_owned(),
            empty: state("empty", &bare)?,
            object: state("object", setup)?,
        });
    }
    Ok(views)
}

/// The bench file of what was photographed.
fn bench_text(scene: &str, film: &Film) -> String {
    let lens = &film.lens;
    let mut text = format!(
        "# A rehearsal: photographs that midair's simulator took.\nscene = \"{scene}\"\n\n[camera]\nsize = {:?}\nfocal = {:?}\ncentre = {:?}\ndistortion = {:?}\n",
        film.size, lens.focal, lens.centre, lens.distortion
    );
    for (name, ..) in VIEWS {
        text += &format!(
            "\n[[view]]\nname = \"{name}\"\nempty = \"{name}-empty/\"\nobject = \"{name}-object/\"\n"
        );
    }
    text
}
