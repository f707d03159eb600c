//! The description of a set-up: model, files, validation.
//!
//! A scene file is TOML, or JSON of the same shape. [`load`] reads one with the meshes and
//! pictures it names, [`load_text`] one in memory with what an [`Assets`] brings, [`parse`] a text alone; both report what is wrong as a [`SceneError`] with
//! the place in the file and a remedy. [`schema`] describes the format for editors. [`to_toml`]
//! writes a scene from nothing; [`SceneEdit`] changes values of a file that people have written. A scene that a program has changed passes
//! [`validate`] before it is used.

mod assets;
mod conform;
pub mod devices;
mod edit;
mod error;
pub mod form;
mod grammar;
mod grammar_of_solids;
pub(crate) mod heights;
mod load;
pub mod model;
mod placement;
mod read;
mod save;
mod schema;
pub(crate) mod section;
mod sense;
#[cfg(test)]
mod solids_tests;
pub mod template;
#[cfg(test)]
mod tests;
mod tree;
mod validate;

pub use assets::{Assets, Folder, InMemory};
pub use edit::{SceneEdit, Setting};
pub use error::{SceneError, SceneText};
pub use heights::Heights;
pub use load::{Asset, Loaded, load, load_text, scene_file_text, with_files};
pub use save::to_toml;
pub use schema::schema;
pub use tree::Format;
pub use validate::{validate, validate_viewpoint};

use model::Scene;

/// Reads a scene from text. `file_name` stands in messages, and names a scene without a name.
///
/// Files that the scene refers to are not opened; what depends on them is not checked.
///
/// # Errors
/// The first thing wrong with the text, with its line and a remedy; further ones as its others.
pub fn parse(text: &str, file_name: &str, format: Format) -> Result<Scene, SceneError> {
    let (scene, source) = parse_with_places(text, file_name, format)?;
    match SceneError::gathered(sense::faults(&scene, &source, &[])) {
        Some(error) => Err(error),
        None => Ok(scene),
    }
}

/// The scene that conforms to the grammar, whether or not it makes sense, with the place of each
/// key for later messages.
///
/// # Errors
/// As [`parse`].
fn parse_with_places(
    text: &str,
    file_name: &str,
    format: Format,
) -> Result<(Scene, SceneText), SceneError> {
    let (table, source) = form::read(&grammar::SCENE, text, file_name, format)?;
    let stem = std::path::Path::new(file_name).file_stem().and_then(|s| s.to_str());
    let scene = read::scene(&grammar::SCENE, &table, stem.unwrap_or("scene")).ok_or_else(|| {
        source.error(None, "the scene cannot be read", "compare it with `midair schema`")
    })?;
    Ok((scene, source))
}
