//! Files that people write, of any form: a form is said as blocks of keys, and a text is held to it with places, near misses and remedies.
//!
//! The scene file is one such form; others beside it are read with the same care.
//!
//! ```
//! use midair::scene::Format;
//! use midair::scene::form::{Block, Kind, Need, block, optional, read, required};
//!
//! static SHELF: Block = block("the shelf", "What stands where.", &[
//!     required("board", Kind::Integer(1, 9), None, "Which board, from below."),
//!     optional("height", Kind::Number(0.0, 1e3), Some("mm"), Need::Number(300.0), "How far it is to the next one."),
//! ]);
//!
//! let (keys, _) = read(&SHELF, "board = 3", "shelf.toml", Format::Toml)?;
//! assert_eq!(keys[0].key, "board");
//! let error = read(&SHELF, "bord = 3", "shelf.toml", Format::Toml).unwrap_err();
//! assert!(error.help.contains("board"), "{}", error.help);
//! # Ok::<(), midair::scene::SceneError>(())
//! ```

use super::Format;
use super::conform::Conformance;
use super::error::{SceneError, SceneText};
use super::tree;

pub use super::grammar::{Block, Key, Kind, Need, block, optional, required};
pub use super::read::Fields;
pub use super::tree::{Entry, Node, Value};

/// A text's keys, which conform to the form, and the text with the place of each for later messages.
///
/// # Errors
/// The first thing wrong with the text, with its line and a remedy; further ones as its others.
pub fn read(
    form: &Block,
    text: &str,
    file_name: &str,
    format: Format,
) -> Result<(Vec<Entry>, SceneText), SceneError> {
    // Some editors begin a file with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut source = SceneText::new(file_name, text);
    let root = tree::parse(&source, text, format)?;
    let Value::Table(table) = root.value else {
        let message = format!("{} is not a table", form.name);
        return Err(source.error(None, message, "give it keys and blocks"));
    };
    let mut conformance = Conformance { source: &mut source, faults: Vec::new() };
    conformance.block(form, "", &table, &root.span);
    match SceneError::gathered(conformance.faults) {
        Some(error) => Err(error),
        None => Ok((table, source)),
    }
}
