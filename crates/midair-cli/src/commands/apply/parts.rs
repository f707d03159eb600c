//! The pieces of long work, kept so that it can be gone on with.

use super::Arguments;
use crate::failure::Failure;
use crate::output::inputs;
use midair::files::{Kept, write_bytes_atomically};
use midair::map::Map;
use midair::map::format::FileError;
use midair_video::Part;
use serde_json::{Value, json};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};

/// Begins work on a film or on numbered pictures, or goes on with it.
pub fn begin(arguments: &Arguments, map: &Map) -> Result<Kept, Failure> {
    let work = format!("{:#}\n", description(arguments, map));
    Ok(Kept::begin(&arguments.output, &work, arguments.resume, inputs())?)
}

/// What must succeed before the work. Where it does not, and there is nothing to go on with, the pieces' folder goes.
pub fn prepared<T>(
    kept: Kept,
    anything: bool,
    prepare: impl FnOnce(&Kept) -> Result<T, Failure>,
) -> Result<(Kept, T), Failure> {
    match prepare(&kept) {
        Ok(ready) => Ok((kept, ready)),
        Err(failure) => {
            if !anything {
                // Why it cannot be is what is to be told.
                let _ = kept.finish();
            }
            Err(failure)
        }
    }
}

/// The pieces of a film that are complete, from the first on without a gap.
pub fn pieces(kept: &Kept, extension: &str) -> Vec<Piece> {
    (0..).map_while(|index| Piece::read(kept, index, extension)).collect()
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
        "gain": arguments.gain.map(|mode| mode.overflow().name()),
        "no_gain": arguments.no_gain,
        "fit": format!("{:?} {:?}", arguments.fit, arguments.proportions),
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

    fn read(kept: &Kept, index: usize, extension: &str) -> Option<Self> {
        let [_, name, note] = Self::names(index, extension);
        let note: Value = serde_json::from_slice(&std::fs::read(kept.path(&note)).ok()?).ok()?;
        let path = kept.path(&name);
        let (frames, start) = (note["frames"].as_u64()?, note["start"].as_f64()?);
        path.is_file().then_some(Self { path, frames, start })
    }

    /// Gives a complete piece its name, and notes that it is complete.
    pub fn keep(
        kept: &Kept,
        index: usize,
        extension: &str,
        frames: u64,
        start: f64,
    ) -> Result<Self, Failure> {
        let [making, name, note] = Self::names(index, extension);
        let path = kept.path(&name);
        std::fs::rename(kept.path(&making), &path)
            .map_err(|error| FileError::io(&path, "write", error))?;
        let told = json!({ "frames": frames, "start": start });
        write_bytes_atomically(&kept.path(&note), told.to_string().as_bytes())?;
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
