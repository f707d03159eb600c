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
mod grammar;
pub(crate) mod heights;
mod load;
pub mod model;
mod placement;
mod read;
mod save;
mod schema;
mod sense;
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
use tree::Value;

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
    // Some editors begin a file with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut source = SceneText::new(file_name, text);
    let root = tree::parse(&source, text, format)?;
    let Value::Table(table) = &root.value else {
        return Err(source.error(None, "the scene is not a table", "give it keys and blocks"));
    };
    let mut conformance = conform::Conformance { source: &mut source, faults: Vec::new() };
    conformance.block(&grammar::SCENE, "", table, &root.span);
    if let Some(error) = SceneError::gathered(conformance.faults) {
        return Err(error);
    }
    let stem = std::path::Path::new(file_name).file_stem().and_then(|s| s.to_str());
    let scene = read::scene(&grammar::SCENE, table, stem.unwrap_or("scene")).ok_or_else(|| {
        source.error(None, "the scene cannot be read", "compare it with `midair schema`")
    })?;
    Ok((scene, source))
}
