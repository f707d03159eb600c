//! From raw frames to a film.

use super::matroska;
use super::tool::{Said, VideoError, ffmpeg, file_argument, not_started, summary};
use super::{Colour, SCALE_FLAGS, Timing};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Stdio};

/// A film being encoded. It has no sound; [`join`] adds that.
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
}

impl Encoder {
    /// Starts encoding to a file, which is overwritten.
    ///
    /// # Errors
    /// [`VideoError`] where ffmpeg cannot be started.
    pub fn new(path: &Path, recipe: &Recipe) -> Result<Self, VideoError> {
        let colour = recipe.colour;
        let matrix = colour.scale_matrix();
        let filter = format!("scale=out_color_matrix={matrix}:out_range=tv:flags={SCALE_FLAGS}");
        let options = encoder_options(path, recipe);
        let mut command = ffmpeg("error");
        command
            .args(["-y", "-f", "matroska", "-i", "pipe:0", "-map", "0:v:0", "-vf", &filter])
            .args(["-fps_mode", "passthrough"])
            .args(["-enc_time_base", &format!("{}/{}", recipe.base[0], recipe.base[1])])
            .args(&options);
        let yuv = options.iter().any(|option| option.starts_with("yuv"));
        if yuv {
            command.args(["-colorspace", &colour.matrix, "-color_range", "tv"]);
        }
        for (name, value) in
            [("-color_primaries", &colour.primaries), ("-color_trc", &colour.transfer)]
        {
            if let Some(value) = value {
                command.args([name, value]);
            }
        }
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

/// The options as given, or a choice that looks the same as the source.
fn encoder_options(path: &Path, recipe: &Recipe) -> Vec<String> {
    if !recipe.options.is_empty() {
        return recipe.options.to_vec();
    }
    let extension =
        path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let odd = recipe.size.iter().any(|side| side % 2 == 1);
    let format = match (recipe.deep, odd) {
        (false, false) => "yuv420p",
        (false, true) => "yuv444p",
        (true, false) => "yuv420p10le",
        (true, true) => "yuv444p10le",
    };
    let codec = match (extension.as_str(), recipe.deep) {
        ("webm", _) => "-c:v libvpx-vp9 -crf 18 -b:v 0 -row-mt 1 -cpu-used 4",
        ("mp4" | "mov" | "m4v", true) => {
            "-c:v libx265 -crf 16 -preset fast -x265-params log-level=none -tag:v hvc1"
        }
        (_, true) => "-c:v libx265 -crf 16 -preset fast -x265-params log-level=none",
        (_, false) => "-c:v libx264 -crf 16 -preset fast",
    };
    let mut options: Vec<String> = codec.split(' ').map(str::to_owned).collect();
    options.extend(["-pix_fmt".to_owned(), format.to_owned()]);
    options
}

/// A piece of a film: its file, and how long it lasts in seconds if another one follows.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The file.
    pub path: PathBuf,
    /// Until the next piece begins.
    pub duration: Option<f64>,
}

/// Joins pieces into a film that begins `start` seconds after the beginning of `sound`, from which sound, chapters and
/// descriptions are taken as they are, and subtitles if both files are of a kind. `list` is a file to work with.
///
/// # Errors
/// [`VideoError`] with ffmpeg's words.
pub fn join(
    parts: &[Part],
    start: f64,
    sound: Option<&Path>,
    list: &Path,
    target: &Path,
) -> Result<(), VideoError> {
    let pipe = |source| VideoError::Pipe { path: list.to_owned(), doing: "write it", source };
    let mut text = String::from("ffconcat version 1.0\n");
    for part in parts {
        // Relative to the list, which lies beside them.
        let name = part.path.file_name().unwrap_or_default().to_string_lossy();
        text += &format!("file '{name}'\n");
        if let Some(duration) = part.duration {
            text += &format!("duration {duration:.9}\n");
        }
    }
    std::fs::write(list, text).map_err(pipe)?;
    let mut command = ffmpeg("error");
    command.args(["-y", "-itsoffset", &format!("{start:.9}"), "-f", "concat", "-safe", "0", "-i"]);
    command.arg(file_argument(list));
    if let Some(sound) = sound {
        command.arg("-i").arg(file_argument(sound));
        command.args(["-map", "0:v:0", "-map", "1:a?", "-map_metadata", "1", "-map_chapters", "1"]);
        if sound.extension().map(|e| e.to_ascii_lowercase())
            == target.extension().map(|e| e.to_ascii_lowercase())
        {
            command.args(["-map", "1:s?"]);
        }
    }
    let extension = target.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if ["mp4", "mov", "m4v"].iter().any(|kind| extension.eq_ignore_ascii_case(kind)) {
        // So that it can be played while it is fetched.
        command.args(["-movflags", "+faststart"]);
    }
    let output = command
        .args(["-c", "copy"])
        .arg(file_argument(target))
        .stdin(Stdio::null())
        .output()
        .map_err(|error| not_started("ffmpeg", target, error))?;
    if output.status.success() {
        return Ok(());
    }
    let mut said = Said::listen(std::io::Cursor::new(output.stderr), |_| {});
    let said = summary(&said.finish(), "it ended without a word");
    Err(VideoError::Refused { path: target.to_owned(), doing: "join picture and sound", said })
}
