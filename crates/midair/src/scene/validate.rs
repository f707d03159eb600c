//! A scene that a program has changed, held to what a scene file is held to.

use super::conform::Conformance;
use super::error::{SceneError, SceneText};
use super::load::{Loaded, glass_serves};
use super::model::{Index, Material, Scene};
use super::tree::{self, Format, Value};
use super::{grammar, sense, to_toml};
use crate::geometry::Vec3;

/// Whether a scene in memory is one that a file may describe: its bounds, and whether it makes sense. Errors name the place in the file
/// that the scene was read from.
///
/// # Errors
/// What [`load`](super::load) would refuse of a file that said the same.
pub fn validate(loaded: &Loaded) -> Result<(), SceneError> {
    let Loaded { scene, assets, glasses, text, .. } = loaded;
    let mut faults = bounds(scene, text)?;
    if faults.is_empty() {
        faults = sense::faults(scene, text, assets);
    }
    for (i, (element, glass)) in scene.elements.iter().zip(glasses).enumerate() {
        if let (Material::Refractive { index: Index::File(file), absorption }, Some(glass)) =
            (&element.material, glass)
            && let Err((message, help)) =
                glass_serves(glass, file, scene.display.wavelengths, absorption.is_some())
        {
            faults.push(text.error_at(&format!("element[{i}].material.file"), message, help));
        }
    }
    SceneError::gathered(faults).map_or(Ok(()), Err)
}

/// Whether an eye may be there, mm: outside of the elements, before the image and the plate.
///
/// # Errors
/// What [`validate`] would refuse of the scene with this viewpoint. It takes microseconds, so that each reading of a tracker can be asked
/// about.
pub fn validate_viewpoint(loaded: &Loaded, eye: Vec3) -> Result<(), SceneError> {
    let Loaded { scene, assets, text, .. } = loaded;
    if !eye.to_array().iter().all(|c| c.abs() <= grammar::LARGEST) {
        let limit = grammar::LARGEST;
        return Err(text.error_at(
            "viewpoint.position",
            format!("the viewpoint lies further than {limit} mm away"),
            "lengths are in millimetres",
        ));
    }
    SceneError::gathered(sense::viewpoint_faults(scene, eye, text, assets)).map_or(Ok(()), Err)
}

/// What the grammar refuses of a scene, as the grammar says it of a file.
fn bounds(scene: &Scene, text: &SceneText) -> Result<Vec<SceneError>, SceneError> {
    // What is no number has another name in TOML than in Rust.
    let written = to_toml(scene).replace("NaN", "nan");
    let mut places = SceneText::new(text.name(), &written);
    let root = tree::parse(&places, &written, Format::Toml)?;
    let Value::Table(table) = &root.value else { return Ok(Vec::new()) };
    let mut conformance = Conformance { source: &mut places, faults: Vec::new() };
    conformance.block(&grammar::SCENE, "", table, &root.span);
    let faults = conformance.faults;
    let placed = |fault: SceneError| {
        let key = fault.span().and_then(|span| places.key_at(&span).map(str::to_owned));
        text.error_at(key.as_deref().unwrap_or_default(), fault.message, fault.help)
    };
    Ok(faults.into_iter().map(placed).collect())
}
