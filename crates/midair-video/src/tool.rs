//! ffmpeg and ffprobe as sub-processes: found or not, and what they say.

use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

/// Why a film cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum VideoError {
    /// The program is not there.
    #[error(
        "{program} is not installed, or not on the PATH; install it with: {}",
        install_command()
    )]
    Missing {
        /// `ffmpeg` or `ffprobe`.
        program: &'static str,
    },
    /// The program refused or gave up.
    #[error("{}: ffmpeg cannot {doing}: {said}", path.display())]
    Refused {
        /// The film.
        path: PathBuf,
        /// What was to be done, as an infinitive.
        doing: &'static str,
        /// ffmpeg's own words.
        said: String,
    },
    /// The file holds no moving pictures.
    #[error("{}: there is no video in it", path.display())]
    NoVideo {
        /// The file.
        path: PathBuf,
    },
    /// A pipe to or from the program broke.
    #[error("{}: cannot {doing}: {source}", path.display())]
    Pipe {
        /// The film.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
        /// The operating system's word.
        source: io::Error,
    },
}

/// How ffmpeg is installed here.
fn install_command() -> &'static str {
    match std::env::consts::OS {
        "macos" => "brew install ffmpeg",
        "windows" => "winget install ffmpeg",
        _ => "sudo apt install ffmpeg (Debian, Ubuntu), or what your system calls it",
    }
}

/// A command of ffmpeg's that says what happens, a level before each line, and asks nothing.
pub(super) fn ffmpeg(level: &str) -> Command {
    let mut command = Command::new("ffmpeg");
    command.args(["-nostdin", "-hide_banner", "-nostats", "-loglevel", &format!("level+{level}")]);
    command
}

/// An error in starting `program`.
pub(super) fn not_started(program: &'static str, path: &Path, source: io::Error) -> VideoError {
    match source.kind() {
        io::ErrorKind::NotFound => VideoError::Missing { program },
        _ => VideoError::Pipe { path: path.to_owned(), doing: "start ffmpeg", source },
    }
}

/// A file's name as ffmpeg's argument: one that begins with a dash, or with what looks like a protocol, is still a file.
pub(super) fn file_argument(path: &Path) -> std::ffi::OsString {
    let mut argument = std::ffi::OsString::from("file:");
    argument.push(path);
    argument
}

/// What ffmpeg says on its standard error, gathered by a thread: its errors, and the lines that someone else wants.
#[derive(Debug)]
pub(super) struct Said {
    errors: Arc<Mutex<Vec<String>>>,
    reader: Option<JoinHandle<()>>,
}

/// The most complaints that are kept: a damaged film has one for each of its blocks.
const MOST_ERRORS: usize = 200;

impl Said {
    /// Listens; `other` gets the lines that are no errors.
    pub fn listen(
        stream: impl Read + Send + 'static,
        mut other: impl FnMut(&str) + Send + 'static,
    ) -> Self {
        let errors = Arc::new(Mutex::new(Vec::new()));
        let kept = Arc::clone(&errors);
        let reader = std::thread::spawn(move || {
            for line in BufReader::new(stream).split(b'\n') {
                let Ok(line) = line else { return };
                let line = String::from_utf8_lossy(&line);
                if ["[error]", "[fatal]", "[panic]"].iter().any(|level| line.contains(level)) {
                    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
                    if kept.len() < MOST_ERRORS {
                        kept.push(plain(&line));
                    }
                } else {
                    other(&line);
                }
            }
        });
        Self { errors, reader: Some(reader) }
    }

    /// All complaints, after the program has ended.
    pub fn finish(&mut self) -> Vec<String> {
        if let Some(reader) = self.reader.take() {
            // A reader that panicked has said so already.
            let _ = reader.join();
        }
        self.errors.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// A line of ffmpeg's without addresses and levels.
fn plain(line: &str) -> String {
    let mut rest = line.trim();
    let mut source = "";
    while let Some(tail) = rest.strip_prefix('[') {
        let Some((tag, after)) = tail.split_once(']') else { break };
        if let Some((name, _)) = tag.split_once(" @ ") {
            source = name;
        }
        rest = after.trim_start();
    }
    if source.is_empty() { rest.to_owned() } else { format!("{source}: {rest}") }
}

/// Complaints in one line: the first ones, which tend to be the cause.
pub(super) fn summary(errors: &[String], otherwise: &str) -> String {
    match errors {
        [] => otherwise.to_owned(),
        _ => errors.iter().take(3).map(|e| e.trim_end_matches('.')).collect::<Vec<_>>().join("; "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_lose_their_addresses() {
        assert_eq!(plain("[h264 @ 0x55] [error] bad block"), "h264: bad block");
        assert_eq!(plain("[error] x.mp4: No such file"), "x.mp4: No such file");
        assert_eq!(
            plain("[mov,mp4 @ 0x1] [fatal] moov atom not found\r"),
            "mov,mp4: moov atom not found"
        );
    }

    #[test]
    fn a_missing_program_is_told_with_its_remedy() {
        let error = not_started("ffmpeg", Path::new("a.mp4"), io::ErrorKind::NotFound.into());
        assert!(error.to_string().contains("install it with"), "{error}");
    }
}
