//! Pieces and sound made into a film.

use super::tool::{Said, VideoError, ffmpeg, file_argument, not_started, summary};
use std::ffi::OsString;
use std::path::{Path, PathBuf, absolute};
use std::process::{Command, Stdio};

/// A piece of a film: its file, and how long it lasts in seconds if another one follows.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The file.
    pub path: PathBuf,
    /// Until the next piece begins.
    pub duration: Option<f64>,
}

/// What comes along with the picture: sound, chapters and descriptions as they are, subtitles as the container takes them.
#[derive(Clone, Debug, PartialEq)]
pub struct Extras {
    /// The file that they come from.
    source: PathBuf,
    sounds: usize,
    /// For each stream of subtitles the codec that it gets, `copy` if none.
    subtitles: Vec<Option<&'static str>>,
    /// Whether fonts that subtitles need come along.
    attachments: bool,
}

/// Subtitles that are text, so that one kind can be made of another.
const TEXT: [&str; 12] = [
    "subrip",
    "srt",
    "ass",
    "ssa",
    "webvtt",
    "text",
    "mov_text",
    "microdvd",
    "subviewer",
    "sami",
    "realtext",
    "stl",
];

impl Extras {
    /// What of a file's sounds and subtitles comes along into `target`, whose name tells its kind.
    pub fn new(source: &Path, sounds: usize, subtitles: &[String], target: &Path) -> Self {
        let kind = |path: &Path| {
            path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
        };
        let target = kind(target);
        let codec = |codec: &String| {
            let text = TEXT.contains(&codec.as_str());
            match target.as_str() {
                "mkv" if codec == "mov_text" => Some("srt"),
                "mkv" => Some("copy"),
                "mp4" | "m4v" | "mov" if codec == "mov_text" => Some("copy"),
                "mp4" | "m4v" | "mov" => text.then_some("mov_text"),
                "webm" if codec == "webvtt" => Some("copy"),
                "webm" => text.then_some("webvtt"),
                _ => None,
            }
        };
        let subtitles: Vec<_> = subtitles.iter().map(codec).collect();
        let attachments = target == "mkv" && kind(source) == "mkv" && !subtitles.is_empty();
        Self { source: source.to_owned(), sounds, subtitles, attachments }
    }

    /// How many streams of subtitles stay behind, because the container cannot hold their kind.
    pub fn subtitles_left(&self) -> usize {
        self.subtitles.iter().filter(|codec| codec.is_none()).count()
    }

    /// Tries whether the container takes them, by writing their first moment to `trial`, which is removed again: to be asked before long work.
    ///
    /// # Errors
    /// [`VideoError`] with ffmpeg's words where it does not.
    pub fn check(&self, trial: &Path) -> Result<(), VideoError> {
        if self.sounds == 0 && self.subtitles.iter().all(Option::is_none) {
            return Ok(());
        }
        let mut command = ffmpeg("error");
        command.args(["-y", "-t", "0.5", "-i"]).arg(full(&self.source)?);
        self.select(&mut command, 0);
        command.arg(full(trial)?);
        let result = run(command, trial, "take over sound and subtitles");
        // It has served.
        let _ = std::fs::remove_file(trial);
        result
    }

    /// Selects the streams from input number `input`.
    fn select(&self, command: &mut Command, input: usize) {
        command.args(["-map", &format!("{input}:a?"), "-c:a", "copy"]);
        // ffmpeg 5 calls some sounds experimental that players have taken in MP4 for years: FLAC, TrueHD.
        command.args(["-strict", "experimental"]);
        let mut place = 0;
        for (index, codec) in self.subtitles.iter().enumerate() {
            let Some(codec) = codec else { continue };
            command.args(["-map", &format!("{input}:s:{index}"), &format!("-c:s:{place}"), codec]);
            place += 1;
        }
        if self.attachments {
            command.args(["-map", &format!("{input}:t?"), "-c:t", "copy"]);
        }
    }
}

/// A film to be joined.
#[derive(Clone, Debug)]
pub struct Joining<'a> {
    /// The pieces, all in one folder.
    pub parts: &'a [Part],
    /// When the first picture is shown, in seconds of the extras' clock.
    pub start: f64,
    /// When the last picture is shown, by the same clock.
    pub last: f64,
    /// When the last picture's time is over, by the same clock.
    pub end: f64,
    /// How many pictures there are.
    pub frames: u64,
    /// Pictures a second, about, as a fraction.
    pub rate: [u64; 2],
    /// What comes along.
    pub extras: Option<&'a Extras>,
}

/// Joins pieces into a film, `target`. `list` is a file to work with, in the folder of the pieces.
///
/// # Errors
/// [`VideoError`] with ffmpeg's words.
pub fn join(joining: &Joining, list: &Path, target: &Path) -> Result<(), VideoError> {
    let pipe = |source| VideoError::Pipe { path: list.to_owned(), doing: "write it", source };
    let mut text = String::from("ffconcat version 1.0\n");
    for part in joining.parts {
        // Relative to the list, which lies beside them.
        let name = part.path.file_name().unwrap_or_default().to_string_lossy();
        text += &format!("file '{name}'\n");
        if let Some(duration) = part.duration {
            text += &format!("duration {duration:.9}\n");
        }
    }
    std::fs::write(list, text).map_err(pipe)?;
    let mut command = ffmpeg("error");
    // From within the folder: in a list's own path ffmpeg takes # and % for parts of an address.
    command
        .current_dir(list.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")));
    let start = joining.start;
    command.args(["-y", "-itsoffset", &format!("{start:.9}"), "-f", "concat", "-safe", "0", "-i"]);
    command.arg(list.file_name().unwrap_or_default());
    if let Some(extras) = joining.extras {
        command.arg("-i").arg(full(&extras.source)?);
        command.args(["-map", "0:v:0", "-map_metadata", "1", "-map_chapters", "1"]);
        extras.select(&mut command, 1);
    }
    let extension = target.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if is_avi(target) {
        // It has no times, only a rate.
        let [frames, seconds] = joining.rate;
        command.args(["-r", &format!("{}/{}", frames.max(1), seconds.max(1))]);
    } else {
        // A film ends when its last picture does: how long that stands no timestamp tells.
        command.args(["-bsf:v", &last_length(joining, extension)]);
    }
    if ["mp4", "mov", "m4v"].iter().any(|kind| extension.eq_ignore_ascii_case(kind)) {
        // So that it can be played while it is fetched.
        command.args(["-movflags", "+faststart"]);
    }
    // Matroska's muxer makes up a number for each film, unless the same run is to write the same bytes.
    command.args(["-fflags", "+bitexact", "-c:v", "copy"]).arg(full(target)?);
    run(command, target, "join picture and sound")
}

/// Whether a file's name is that of an AVI, whose pictures have no times of their own.
pub fn is_avi(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("avi"))
}

/// ffmpeg's filter that gives the last packet the time that is left to the film's end.
fn last_length(joining: &Joining, extension: &str) -> String {
    let (last, whole) = (joining.frames.saturating_sub(1), joining.end - joining.start);
    let unit = match extension.to_ascii_lowercase().as_str() {
        // Packets for Matroska count milliseconds, while ffmpeg 5 tells another unit: whichever brings the last one near its time.
        "mkv" | "webm" | "mka" => {
            let seen = joining.last - joining.start;
            format!(
                "if(lte(abs((PTS-STARTPTS)/1000-{seen:.9}),abs((PTS-STARTPTS)*TB-{seen:.9})),0.001,TB)"
            )
        }
        _ => "TB".to_owned(),
    };
    format!(
        "setts=pts=PTS:dts=DTS:duration='if(eq(N,{last}),max(1,{whole:.9}/({unit})-(PTS-STARTPTS)),DURATION)'"
    )
}

/// A file's whole path, as an argument that stays true in another folder.
fn full(path: &Path) -> Result<OsString, VideoError> {
    let whole = absolute(path);
    let whole = whole.map_err(|source| VideoError::Pipe {
        path: path.to_owned(),
        doing: "find its folder",
        source,
    })?;
    Ok(file_argument(&whole))
}

fn run(mut command: Command, target: &Path, doing: &'static str) -> Result<(), VideoError> {
    let output = command
        .stdin(Stdio::null())
        .output()
        .map_err(|error| not_started("ffmpeg", target, error))?;
    if output.status.success() {
        return Ok(());
    }
    let mut said = Said::listen(std::io::Cursor::new(output.stderr), |_| {});
    let said = summary(&said.finish(), "it ended without a word");
    Err(VideoError::Refused { path: target.to_owned(), doing, said })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subtitles_become_what_the_container_takes() {
        let kinds = ["subrip", "mov_text", "hdmv_pgs_subtitle", "webvtt"].map(str::to_owned);
        for (target, expected, left) in [
            ("a.mkv", [Some("copy"), Some("srt"), Some("copy"), Some("copy")], 0),
            ("a.mp4", [Some("mov_text"), Some("copy"), None, Some("mov_text")], 1),
            ("a.WEBM", [Some("webvtt"), Some("webvtt"), None, Some("copy")], 1),
            ("a.avi", [None; 4], 4),
        ] {
            let extras = Extras::new(Path::new("in.mkv"), 1, &kinds, Path::new(target));
            assert_eq!(extras.subtitles, expected, "{target}");
            assert_eq!(extras.subtitles_left(), left, "{target}");
        }
    }
}
