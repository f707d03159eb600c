//! What a command says when it is done: a few lines, or JSON.

use crate::failure::Failure;
use midair::map::format::FileError;
pub use midair_report::{counts_line, percent};
use serde_json::{Value, json};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How the user wants to be told.
#[derive(Clone, Copy, Debug)]
pub struct Voice {
    /// The summary as JSON on standard output.
    pub json: bool,
    /// Explanations on standard error.
    pub verbose: bool,
}

impl Voice {
    /// The summary: lines for people, or the JSON that says the same.
    pub fn tell(self, lines: &str, value: &Value) -> Result<(), Failure> {
        if self.json { print(&format!("{value:#}\n")) } else { print(lines) }
    }

    /// What the user should know in any case; JSON has it as well.
    pub fn note(self, notes: &[String]) {
        if !self.json {
            notes.iter().for_each(|note| say(&format!("note: {note}")));
        }
    }

    /// What only `-v` tells.
    pub fn explain(self, line: &str) {
        if self.verbose {
            say(line);
        }
    }
}

fn say(line: &str) {
    // A closed standard error is no reason to stop.
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Writes to standard output. A reader that has gone away (`midair schema | head`) is no failure.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(FileError::io(Path::new("standard output"), "write", error).into())
        }
        _ => Ok(()),
    }
}

/// Stages and their times in ms, as in report.json.
pub fn timings(laps: &[(&'static str, Duration)]) -> Value {
    let entry = |&(name, time): &(&str, Duration)| (name.to_owned(), json!(milliseconds(time)));
    Value::Object(laps.iter().map(entry).collect())
}

/// A time in ms to the microsecond.
pub fn milliseconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() / 1e3
}

/// A number for JSON, which has no infinities: `null` for those.
pub fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

/// Paths as JSON.
pub fn paths(files: &[PathBuf]) -> Value {
    files.iter().map(|file| file.display().to_string()).collect()
}

/// Paths for people.
pub fn wrote(files: &[PathBuf]) -> String {
    let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    format!("wrote {}\n", names.join(", "))
}
