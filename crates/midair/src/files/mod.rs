//! Files: the one floor that knows paths. What is written is there whole or not at all, and never in the place of what is read.
//!
//! [`Output`] makes files in a hidden folder beside their place and moves them there at the end; [`Inputs`] are the files that the work
//! reads, which no output may replace. [`Kept`] holds the pieces of work that can be gone on with after an interruption.
//! [`write_atomically`] is for one file by itself.
//!
//! ```
//! use midair::files::{Inputs, Output};
//!
//! # fn main() -> Result<(), midair::Error> {
//! # let place = tempfile::tempdir().expect("a folder for the example");
//! # let folder = place.path().join("out");
//! let mut output = Output::into_folder(&folder, &Inputs::default())?;
//! output.write("note.txt", |path| midair::files::write_bytes_atomically(path, b"done"))?;
//! assert!(!folder.join("note.txt").exists());
//! let files = output.finish()?;
//! assert_eq!(files, [folder.join("note.txt")]);
//! # Ok(())
//! # }
//! ```

mod inputs;
mod kept;
mod output;
mod place;
mod relative;
mod staging;
mod whole;

pub use crate::map::format::FileError;
pub use inputs::Inputs;
pub use kept::Kept;
pub use output::Output;
pub use relative::renamed;
pub use staging::remove_unfinished;
pub use whole::{write_atomically, write_bytes_atomically};
