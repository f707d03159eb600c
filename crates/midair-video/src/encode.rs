//! From raw frames to a film.

use super::matroska;
use super::options::{Coded, Plan, coded};
use super::tool::{Said, VideoError, ffmpeg, file_argument, not_started, summary};
use super::{Colour, Timing};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Stdio};

/// A film being encoded. It has no sound; [`join`](super::join()) adds that.
#[derive(Debug)]
pub struct Encoder {
    process: Child,
    frames: Option<BufWriter<ChildStdin>>,
    said: Said,
    path: PathBuf,
    first: Option<i64>,
}

/// What frames a film is made of, and how.
#[derive(Clone, Debug)]
pub struct Recipe<'a> {
    /// Width and height of the frames.
    pub size: [usize; 2],
    /// Whether samples have 16 bits.
    pub deep: bool,
    /// Frames a second, about.
    pub rate: [u64; 2],
    /// Of the film that is written.
    pub colour: &'a Colour,
    /// The unit that times are multiples of.
    pub base: [u64; 2],
    /// ffmpeg's options for its encoder; none: chosen by the file's name and the depth.
    pub options: &'a [String],
    /// What the encoder makes of the options, where that has been asked for already by [`coded`].
    pub coded: Option<&'a Coded>,
}

impl Encoder {
    /// Starts encoding to a file, which is overwritten.
    ///
    /// # Errors
    /// [`VideoError`] where ffmpeg cannot be started.
    pub fn new(path: &Path, recipe: &Recipe) -> Result<Self, VideoError> {
        let coded = match recipe.coded {
            Some(known) => known.clone(),
            None => coded(path, recipe)?,
        };
        Self::start(path, recipe, &Plan::new(path, recipe, Some(&coded)))
    }

    /// As [`Encoder::new`], with all that is said to ffmpeg.
    pub(crate) fn start(path: &Path, recipe: &Recipe, plan: &Plan) -> Result<Self, VideoError> {
        let mut command = ffmpeg("error");
        command
            .args(["-y", "-f", "matroska", "-i", "pipe:0", "-map", "0:v:0", "-vf", &plan.filter])
            .args(["-fps_mode", "passthrough"])
            .args(["-enc_time_base", &format!("{}/{}", recipe.base[0], recipe.base[1])])
            .args(&plan.tags)
            .args(&plan.options);
        let mut process = command
            .arg(file_argument(path))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| not_started("ffmpeg", path, error))?;
        let (Some(frames), Some(errors)) = (process.stdin.take(), process.stderr.take()) else {
            let source = std::io::ErrorKind::BrokenPipe.into();
            return Err(VideoError::Pipe { path: path.to_owned(), doing: "encode it", source });
        };
        let said = Said::listen(errors, |_| {});
        let mut frames = BufWriter::with_capacity(1 << 16, frames);
        // Whether this succeeds is seen with the first frame.
        let _ = frames.write_all(&matroska::header(recipe.size, recipe.deep, recipe.rate));
        Ok(Self { process, frames: Some(frames), said, path: path.to_owned(), first: None })
    }

    /// Adds a frame: packed RGB rows from the top. The film begins with its first frame's time.
    ///
    /// # Errors
    /// [`VideoError::Refused`] with ffmpeg's words where it has given up.
    pub fn write(&mut self, frame: &[u8], timing: Timing) -> Result<(), VideoError> {
        let time = timing.nanoseconds();
        let since = time - *self.first.get_or_insert(time);
        let frames = self.frames.as_mut();
        let written =
            frames.map(|frames| matroska::write_frame(frames, since.max(0) as u64, frame));
        match written {
            Some(Ok(())) => Ok(()),
            _ => Err(self.end().err().unwrap_or_else(|| VideoError::Refused {
                path: self.path.clone(),
                doing: "encode it",
                said: "it ended early".to_owned(),
            })),
        }
    }

    /// Completes the file.
    ///
    /// # Errors
    /// [`VideoError::Refused`] with ffmpeg's words where it could not.
    pub fn finish(mut self) -> Result<(), VideoError> {
        self.end()
    }

    fn end(&mut self) -> Result<(), VideoError> {
        let flushed = self.frames.take().map_or(Ok(()), |mut frames| frames.flush());
        let status = self.process.wait();
        let errors = self.said.finish();
        let ok = status.as_ref().is_ok_and(std::process::ExitStatus::success);
        if ok && flushed.is_ok() {
            return Ok(());
        }
        let said = summary(&errors, "it ended early, without a word");
        Err(VideoError::Refused { path: self.path.clone(), doing: "encode it", said })
    }
}

impl Drop for Encoder {
    fn drop(&mut self) {
        self.frames = None;
        // Of no effect once it has ended.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
