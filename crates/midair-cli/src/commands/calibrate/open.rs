//! Opening a bench: its file, its scene, its photographs.

use crate::arguments::open_scene;
use crate::failure::Failure;
use crate::output::inputs;
use midair::Monitor;
use midair::scene::Loaded;
use midair::transport::Setup;
use midair_calibrate::bench::Source;
use midair_calibrate::decode::decode_folder;
use midair_calibrate::{Bench, Decoded, Patterns, SightedView, Sighting, correspondences};
use std::path::Path;

/// The bench file and the scene that it names.
pub fn bench(path: &Path) -> Result<(Bench, Loaded), Failure> {
    inputs().add(path);
    let bench = Bench::load(path)?;
    let loaded = open_scene(&bench.scene, None)?;
    Ok((bench, loaded))
}

/// Each view's photographs decoded, or its points read.
pub fn views(
    bench: &Bench,
    setup: &Setup,
    monitor: &dyn Monitor,
) -> Result<Vec<SightedView>, Failure> {
    let patterns = Patterns::of(setup);
    let sighting = |source: &Source, key: &str| -> Result<Sighting, Failure> {
        Ok(match source {
            Source::Points(file) => {
                inputs().add(file);
                Sighting::Points(correspondences::read(file)?)
            }
            Source::Photographs(folder) => {
                let decoded = decode_folder(&patterns, folder, monitor)?;
                check_size(bench, &decoded, key)?;
                Sighting::Photographs(Box::new(decoded))
            }
        })
    };
    let views = bench.views.iter().enumerate().map(|(i, view)| {
        Ok(SightedView {
            name: view.name.clone(),
            empty: sighting(&view.empty, &format!("view[{i}].empty"))?,
            object: sighting(&view.object, &format!("view[{i}].object"))?,
        })
    });
    views.collect()
}

/// Photographs are of the camera that the bench describes.
fn check_size(bench: &Bench, decoded: &Decoded, key: &str) -> Result<(), Failure> {
    let size = [decoded.width, decoded.height];
    match bench.size {
        Some(given) if given != size => {
            let message = format!(
                "its photographs have {} x {} pixels, [camera] says {} x {}",
                size[0], size[1], given[0], given[1]
            );
            let help = "give the camera of these photographs, at the size that they were taken in";
            Err(bench.text.error_at(key, message, help).into())
        }
        _ => Ok(()),
    }
}

/// What the photographs' decoding noted.
pub fn notes(views: &[SightedView]) -> Vec<String> {
    let states = views.iter().flat_map(|view| [&view.empty, &view.object]);
    states
        .filter_map(|sighting| match sighting {
            Sighting::Photographs(decoded) => Some(decoded.notes.clone()),
            Sighting::Points(_) => None,
        })
        .flatten()
        .collect()
}
