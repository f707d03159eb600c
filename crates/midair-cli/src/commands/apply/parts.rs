//! The pieces of long work, kept so that it can be gone on with.

use super::Arguments;
use crate::arguments::GainMode;
use crate::failure::Failure;
use midair::map::Map;
use midair::map::format::{FileError, write_bytes_atomically};
use midair::picture::Sequence;
use midair_video::Part;
use serde_json::{Value, json};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};

/// A folder of pieces beside what they will become, with a file that says what they are pieces of.
#[derive(Debug)]
pub struct Job {
    folder: PathBuf,
    record: PathBuf,
    /// Whether an interrupted run of the same work is gone on with.
    pub resumed: bool,
    own_folder: bool,
}

impl Job {
    /// Pieces of a film.
    pub fn of_film(arguments: &Arguments, map: &Map) -> Result<Self, Failure> {
        let name = arguments.output.file_name().unwrap_or_default().to_string_lossy();
        let folder = arguments.output.with_file_name(format!(".{name}.midair-pieces"));
        Self::begin(folder.clone(), folder.join("work.json"), arguments, map, true)
    }

    /// Numbered pictures, which are pieces themselves.
    pub fn of_stills(arguments: &Arguments, to: &Sequence, map: &Map) -> Result<Self, Failure> {
        let folder = to.folder().to_owned();
        Self::begin(folder.clone(), folder.join(".midair-work.json"), arguments, map, false)
    }

    fn begin(
        folder: PathBuf,
        record: PathBuf,
        arguments: &Arguments,
        map: &Map,
        own_folder: bool,
    ) -> Result<Self, Failure> {
        let work = description(arguments, map);
        let known = std::fs::read(&record).ok();
        let known: Option<Value> = known.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        let resumed = arguments.resume && known.as_ref() == Some(&work);
        if arguments.resume && !resumed {
            let (message, help) = match known {
                None => ("there is nothing to go on with", "leave --resume out to begin"),
                Some(_) => (
                    "what was interrupted was other work: the map, the input or an option has changed",
                    "give the same command again, or leave --resume out to begin anew",
                ),
            };
            return Err(Failure::new(format!("{}: {message}", arguments.output.display()), help));
        }
        let create = |error| FileError::io(&folder, "create", error);
        if own_folder && !resumed {
            if folder.exists() {
                std::fs::remove_dir_all(&folder).map_err(create)?;
            }
            std::fs::create_dir(&folder).map_err(create)?;
        }
        write_bytes_atomically(&record, format!("{work:#}\n").as_bytes())?;
        Ok(Self { folder, record, resumed, own_folder })
    }

    /// A file among the pieces.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// The pieces that are complete, from the first on without a gap.
    pub fn pieces(&self, extension: &str) -> Vec<Piece> {
        (0..).map_while(|index| Piece::read(self, index, extension)).collect()
    }

    /// The work is done: the record (and the folder of pieces) goes.
    pub fn finish(self) -> Result<(), Failure> {
        let removed = match self.own_folder {
            true => std::fs::remove_dir_all(&self.folder),
            false => std::fs::remove_file(&self.record),
        };
        Ok(removed.map_err(|error| FileError::io(&self.record, "remove", error))?)
    }
}

/// What makes two runs the same work.
fn description(arguments: &Arguments, map: &Map) -> Value {
    let mut hasher = DefaultHasher::new();
    (map.width, map.height).hash(&mut hasher);
    for pixel in 0..map.uv.len() {
        map.answer(pixel).map(|uv| uv.map(f64::to_bits)).hash(&mut hasher);
    }
    let state = std::fs::metadata(&arguments.input).ok();
    let changed = state.as_ref().and_then(|state| state.modified().ok());
    let changed = changed.and_then(|time| time.duration_since(std::time::UNIX_EPOCH).ok());
    json!({
        "midair": env!("CARGO_PKG_VERSION"),
        "map": format!("{:016x}", hasher.finish()),
        "input": arguments.input.display().to_string(),
        "bytes": state.map(|state| state.len()),
        "changed": changed.map(|time| format!("{}.{:09}", time.as_secs(), time.subsec_nanos())),
        "gain": arguments.gain.map(GainMode::name),
        "no_gain": arguments.no_gain,
        "filter": format!("{:?}", arguments.filter),
        "rate": arguments.rate,
        "piece": arguments.piece,
        "encoder": arguments.encoder,
    })
}

/// A complete piece of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its file.
    pub path: PathBuf,
    /// Its number of frames.
    pub frames: u64,
    /// When its first frame is shown, s.
    pub start: f64,
}

impl Piece {
    /// The names of a piece's file, while it is made and after, and of the note that it is complete.
    pub fn names(index: usize, extension: &str) -> [String; 3] {
        [
            format!("making-{index:06}.{extension}"),
            format!("{index:06}.{extension}"),
            format!("{index:06}.json"),
        ]
    }

    fn read(job: &Job, index: usize, extension: &str) -> Option<Self> {
        let [_, name, note] = Self::names(index, extension);
        let note: Value = serde_json::from_slice(&std::fs::read(job.path(&note)).ok()?).ok()?;
        let path = job.path(&name);
        let (frames, start) = (note["frames"].as_u64()?, note["start"].as_f64()?);
        path.is_file().then_some(Self { path, frames, start })
    }

    /// Gives a complete piece its name, and notes that it is complete.
    pub fn keep(
        job: &Job,
        index: usize,
        extension: &str,
        frames: u64,
        start: f64,
    ) -> Result<Self, Failure> {
        let [making, name, note] = Self::names(index, extension);
        let path = job.path(&name);
        std::fs::rename(job.path(&making), &path)
            .map_err(|error| FileError::io(&path, "write", error))?;
        let told = json!({ "frames": frames, "start": start });
        write_bytes_atomically(&job.path(&note), told.to_string().as_bytes())?;
        Ok(Self { path, frames, start })
    }
}

/// The pieces with the time that each lasts.
pub fn in_a_row(pieces: &[Piece]) -> Vec<Part> {
    let next = pieces.iter().skip(1).map(|piece| Some(piece.start)).chain([None]);
    let parts = pieces.iter().zip(next);
    parts
        .map(|(piece, next)| Part {
            path: piece.path.clone(),
            duration: next.map(|n| n - piece.start),
        })
        .collect()
}

/// The extension of a film's name, which tells ffmpeg the container.
pub fn extension(path: &Path) -> Result<&str, Failure> {
    path.extension().and_then(|extension| extension.to_str()).ok_or_else(|| {
        Failure::new(
            format!("{}: its name does not tell which kind of file to write", path.display()),
            "let it end in .mp4, .mov, .mkv, .webm, .png or .exr",
        )
    })
}
