//! What an exploration has found so far, kept until it is complete.

use super::Arguments;
use crate::failure::Failure;
use crate::output::keep_for_folder;
use midair::evaluate::explore::Point;
use midair::files::Kept;
use midair::map::format::FileError;
use midair::scene::Loaded;
use serde_json::json;
use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead as _, BufReader, Write as _};
use std::sync::{Mutex, PoisonError};

/// Set-ups by their numbers, in a file with a line for each, in a hidden folder beside the output.
pub struct Known {
    kept: Kept,
    before: HashMap<usize, Point>,
    file: Mutex<File>,
}

const FILE: &str = "points.jsonl";

impl Known {
    pub fn begin(arguments: &Arguments, loaded: &Loaded) -> Result<Self, Failure> {
        let work = json!({
            "midair": env!("CARGO_PKG_VERSION"),
            "scene": loaded.text.text(),
            "axes": arguments.vary,
            "resolution": arguments.resolution,
            "settle": arguments.settle,
        });
        let kept = keep_for_folder(&arguments.out, &work, arguments.resume)?;
        let path = kept.path(FILE);
        let failed = |error| FileError::io(&path, "open", error);
        let mut before = HashMap::new();
        if path.is_file() {
            // The last line of a run that was killed may be half there.
            let lines = BufReader::new(File::open(&path).map_err(failed)?).lines();
            for line in lines.map_while(Result::ok) {
                if let Ok((number, point)) = serde_json::from_str::<(usize, Point)>(&line) {
                    before.insert(number, point);
                }
            }
        }
        let file = OpenOptions::new().create(true).append(true).open(&path).map_err(failed)?;
        Ok(Self { kept, before, file: Mutex::new(file) })
    }

    pub fn get(&self, number: usize) -> Option<Point> {
        self.before.get(&number).cloned()
    }

    /// What cannot be kept is looked at again, if ever.
    pub fn keep(&self, number: usize, point: &Point) {
        let Ok(line) = serde_json::to_string(&(number, point)) else { return };
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = writeln!(file, "{line}");
    }

    /// All is found and written.
    pub fn finish(self) -> Result<(), Failure> {
        Ok(self.kept.finish()?)
    }
}
