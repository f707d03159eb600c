//! `midair calibrate map`: the map at a camera's place, with no model of the object.

use crate::arguments::map_formats;
use crate::commands::compensate::write_maps;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Voice, counts_line, paths, wrote};
use midair::map::format::Format;
use midair::transport::Setup;
use midair_calibrate::model_free::model_free;
use midair_calibrate::{Sighting, survey, upright};
use serde_json::json;
use std::path::PathBuf;

/// Make the map for a camera's place straight from its photographs, whatever the object is
///
/// No model of the object is needed or used: each camera pixel's place in the image comes from the empty photographs, its display point from those with
/// the object. The map holds for an eye where the camera was.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  midair calibrate map bench.toml --view front --out maps --format exr,ffmpeg"
)]
pub struct Arguments {
    /// Bench file (TOML)
    bench: PathBuf,
    /// The view whose camera the map is for; left out: the first
    #[arg(long, value_name = "NAME")]
    view: Option<String>,
    /// Folder for all that is written
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Kinds of map, with commas between
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "exr", value_parser = map_formats())]
    format: Vec<Format>,
}

pub fn run(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let (bench, loaded) = super::open::bench(&arguments.bench)?;
    let setup = Setup::new(&loaded)?;
    let name = arguments.view.clone().unwrap_or_else(|| bench.views[0].name.clone());
    let Some(place) = bench.views.iter().position(|view| view.name == name) else {
        let known: Vec<&str> = bench.views.iter().map(|view| view.name.as_str()).collect();
        let message = format!("the bench has no view `{name}`");
        return Err(Failure::new(message, format!("its views are {}", known.join(", "))));
    };
    let mut output = crate::output::into_folder(&arguments.out)?;
    let bar = Bar::new();
    let mut views = super::open::views(&bench, &setup, &bar)?;
    let survey = survey(&loaded, bench.lens, &mut views, &bar)?;
    let Sighting::Photographs(decoded) = &views[place].object else {
        let error = bench.text.error_at(
            &format!("view[{place}].object_points"),
            "a map without a model needs every pixel, not points only",
            "give the photographs' folders as `empty` and `object`, or fit the scene: `midair calibrate fit`",
        );
        return Err(error.into());
    };
    let camera = survey.cameras[place];
    let map = model_free(&setup, &camera, &survey.lens, decoded);
    bar.finish();
    let source = setup.view_size(1024);
    let mut notes = super::open::notes(&views);
    notes.extend(write_maps(&mut output, &map, None, "map", source, &arguments.format)?);
    let files = output.finish()?;
    voice.note(&notes);
    let counts = map.counts();
    let viewpoint = camera.origin.to_array();
    let lines = format!(
        "the map for an eye at {:.1}, {:.1}, {:.1}\n{}\n{}",
        viewpoint[0],
        viewpoint[1],
        viewpoint[2],
        counts_line(&counts),
        wrote(&files)
    );
    let told = json!({
        "view": name,
        "viewpoint": viewpoint,
        "rotation": upright(&camera).rotation(),
        "size": [map.width, map.height],
        "status": counts,
        "files": paths(&files),
        "notes": notes,
    });
    voice.tell(&lines, &told)
}
