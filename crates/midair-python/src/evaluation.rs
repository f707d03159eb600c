//! The paper's evaluation of a scene.

use crate::error::{raised, refused};
use crate::picture;
use crate::threads::interruptible;
use midair::evaluate::paper::{
    Evaluation, PaperError, Photograph, QualityView, Settings, Subject, quality, shape,
};
use midair::measure::lpips::Lpips;
use midair::optics::plate::{Model, SlitMirror, SlitMirrorPlate};
use midair::picture::Picture;
use midair::scene::Loaded;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

/// Options as `midair evaluate` has them.
pub struct Options {
    pub azimuths: Vec<f64>,
    pub plate: String,
    pub spp: u32,
    pub size: usize,
    pub lpips: bool,
}

/// Figure 7 for the azimuths, and a row of table 1 for each photograph.
pub fn evaluate(
    py: Python<'_>,
    loaded: &Loaded,
    photographs: Option<&Bound<'_, PyDict>>,
    options: Options,
) -> PyResult<Value> {
    let plate = match &options.plate[..] {
        "ideal" => Model::Ideal,
        "slit-mirror" => {
            SlitMirrorPlate::new(SlitMirror::default()).map_err(|error| raised(py, error))?.into()
        }
        other => {
            let message = format!("there is no plate model {other:?}");
            return Err(refused(py, message, "ask for \"ideal\" or \"slit-mirror\""));
        }
    };
    let lpips = match options.lpips {
        true => Some(Lpips::find().map_err(|error| {
            refused(
                py,
                error.to_string(),
                "get the weights by `midair weights`, or leave lpips out",
            )
        })?),
        false => None,
    };
    let mut pictures = Vec::new();
    for (name, array) in photographs.iter().flat_map(|dict| dict.iter()) {
        let (picture, _) = picture::read(&array)?;
        pictures.push(Photograph { name: name.extract()?, picture });
    }
    let settings = Settings {
        samples_per_pixel: options.spp,
        // As many for the lattice as the program takes.
        shape_samples_per_pixel: (options.spp / 4).max(16),
        quality_width: options.size,
        shape_size: options.size,
        azimuths: options.azimuths,
        ..Settings::default()
    };
    let found = interruptible(py, |watch| -> Result<Evaluation, PaperError> {
        let subject = Subject { surface: &loaded.scene.name, scene: loaded };
        // The paper's figures stand beside, whatever the scene.
        let mut evaluation = Evaluation { published: true, ..Evaluation::default() };
        if !settings.azimuths.is_empty() {
            let done = |_: f64, _: [Picture; 4]| Ok::<(), PaperError>(());
            let (found, notes) = shape(subject, &plate, &settings, watch, done)?;
            evaluation.shapes.push(found);
            evaluation.notes.extend(notes);
        }
        let done = |view: QualityView| {
            evaluation.quality.push(view.row);
            Ok::<(), PaperError>(())
        };
        quality(subject, &pictures, &plate, &settings, lpips.as_ref(), watch, done)?;
        Ok(evaluation)
    })?;
    Ok(found.map_err(|error| raised(py, error))?.to_json())
}
