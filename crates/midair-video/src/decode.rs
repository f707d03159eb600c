//! From a film to raw frames.

use super::tool::{Said, VideoError, ffmpeg, file_argument, not_started, summary};
use super::{Film, SCALE_FLAGS};
use midair::picture::OverBlack;
use std::io::Read;
use std::path::Path;
use std::process::{Child, ChildStdout, Stdio};
use std::sync::mpsc::{Receiver, channel};

/// When a frame is shown: `ticks` times `base[0] / base[1]` seconds after the film's beginning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// In units of `base`.
    pub ticks: i64,
    /// A fraction of a second.
    pub base: [u64; 2],
}

impl Timing {
    /// In seconds.
    pub fn seconds(self) -> f64 {
        self.ticks as f64 * self.base[0] as f64 / self.base[1] as f64
    }

    /// In nanoseconds, rounded.
    pub fn nanoseconds(self) -> i64 {
        let (numerator, denominator) = (
            i128::from(self.ticks) * i128::from(self.base[0]) * 1_000_000_000,
            i128::from(self.base[1]),
        );
        (numerator + denominator / 2).div_euclid(denominator) as i64
    }
}

/// What ffmpeg says of a frame before it is there.
enum News {
    Base([u64; 2]),
    Frame { ticks: i64, size: [usize; 2] },
}

/// A film being decoded: packed RGB rows from the top, 8 bits a sample or 16 (little-endian). What is transparent is black, as in stills.
#[derive(Debug)]
pub struct Decoder {
    process: Child,
    frames: ChildStdout,
    said: Said,
    news: Receiver<News>,
    base: Option<[u64; 2]>,
    size: [usize; 2],
    deep: bool,
    /// For films with alpha, whose frames come as RGBA.
    over_black: Option<OverBlack>,
    with_alpha: Vec<u8>,
    path: std::path::PathBuf,
}

impl std::fmt::Debug for News {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("News")
    }
}

impl Decoder {
    /// Starts decoding a film; `deep` asks for 16 bits a sample.
    ///
    /// # Errors
    /// [`VideoError`] where ffmpeg cannot be started.
    pub fn new(film: &Film, deep: bool) -> Result<Self, VideoError> {
        let format = match (deep, film.alpha) {
            (false, false) => "rgb24",
            (true, false) => "rgb48le",
            (false, true) => "rgba",
            (true, true) => "rgba64le",
        };
        let weave = if film.interlaced { "yadif," } else { "" };
        let matrix = film.colour.scale_matrix();
        let filter = format!(
            "{weave}scale=in_color_matrix={matrix}:flags={SCALE_FLAGS},format={format},showinfo=checksum=0"
        );
        let mut command = ffmpeg("info");
        if let Some(decoder) = film.decoder {
            command.args(["-c:v", decoder]);
        }
        let mut process = command
            .arg("-i")
            .arg(file_argument(&film.path))
            .args(["-map", &format!("0:{}", film.stream), "-an", "-sn", "-dn", "-vf", &filter])
            .args(["-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt", format, "pipe:1"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| not_started("ffmpeg", &film.path, error))?;
        let (sender, news) = channel();
        let (frames, errors) = (process.stdout.take(), process.stderr.take());
        let (Some(frames), Some(errors)) = (frames, errors) else {
            let source = std::io::ErrorKind::BrokenPipe.into();
            return Err(VideoError::Pipe { path: film.path.clone(), doing: "decode it", source });
        };
        let said = Said::listen(errors, move |line| {
            if let Some(told) = read_news(line) {
                // Nobody listens any more once decoding is given up.
                let _ = sender.send(told);
            }
        });
        let path = film.path.clone();
        let over_black = film.alpha.then(|| OverBlack::new(deep, film.colour.curve()));
        let (size, with_alpha) = (film.size, Vec::new());
        Ok(Self {
            process,
            frames,
            said,
            news,
            base: None,
            size,
            deep,
            over_black,
            with_alpha,
            path,
        })
    }

    /// Width and height of the frames; the film's own until the first one has come.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The next frame into `frame`, and when it is shown; `None` at the end of what can be decoded.
    ///
    /// # Errors
    /// [`VideoError::Pipe`] where the pipe breaks.
    pub fn next(&mut self, frame: &mut Vec<u8>) -> Result<Option<Timing>, VideoError> {
        // ffmpeg tells of a frame before it hands it over; the channel closes with its standard error.
        let ticks = loop {
            match self.news.recv() {
                Ok(News::Base(base)) => self.base = Some(base),
                Ok(News::Frame { ticks, size }) => {
                    self.size = size;
                    break ticks;
                }
                Err(_) => return Ok(None),
            }
        };
        let sample = if self.deep { 2 } else { 1 };
        let pixels = self.size[0] * self.size[1];
        let (raw, channels) = match self.over_black {
            Some(_) => (&mut self.with_alpha, 4),
            None => (&mut *frame, 3),
        };
        raw.resize(pixels * channels * sample, 0);
        match self.frames.read_exact(raw) {
            Ok(()) => {
                if let Some(over_black) = &self.over_black {
                    over_black.apply(&self.with_alpha, frame);
                }
                Ok(Some(Timing { ticks, base: self.base.unwrap_or([1, 1_000_000]) }))
            }
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(None),
            Err(source) => {
                Err(VideoError::Pipe { path: self.path.clone(), doing: "decode it", source })
            }
        }
    }

    /// After the last frame: what ffmpeg complained of.
    ///
    /// # Errors
    /// [`VideoError::Refused`] where it gave up.
    pub fn finish(mut self) -> Result<Vec<String>, VideoError> {
        let pipe =
            |source| VideoError::Pipe { path: self.path.clone(), doing: "decode it", source };
        let status = self.process.wait().map_err(pipe)?;
        let errors = self.said.finish();
        if status.success() {
            return Ok(errors);
        }
        let said = summary(&errors, "it gave up without a word");
        Err(VideoError::Refused { path: self.path.clone(), doing: "decode it", said })
    }
}

impl Drop for Decoder {
    fn drop(&mut self) {
        // Of no effect once it has ended.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// What a line of the showinfo filter tells.
fn read_news(line: &str) -> Option<News> {
    if !line.contains("showinfo") {
        return None;
    }
    let after = |name: &str| line.split(name).nth(1).map(str::trim_start);
    if let Some(base) = after("config in time_base: ") {
        let (a, b) = base.split(',').next()?.trim().split_once('/')?;
        return Some(News::Base([a.parse().ok()?, b.parse().ok().filter(|&b| b > 0)?]));
    }
    let word = |text: &str| text.split_whitespace().next().map(str::to_owned);
    after("n:")?;
    let ticks = word(after(" pts:")?)?.parse().ok()?;
    let (width, height) =
        word(after(" s:")?)?.split_once('x').map(|(w, h)| (w.to_owned(), h.to_owned()))?;
    Some(News::Frame { ticks, size: [width.parse().ok()?, height.parse().ok()?] })
}

/// Only for messages.
impl AsRef<Path> for Decoder {
    fn as_ref(&self) -> &Path {
        &self.path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filters_lines_are_read() {
        let base = "[Parsed_showinfo_2 @ 0x5] [info] config in time_base: 1001/30000, frame_rate: 30000/1001";
        assert!(matches!(read_news(base), Some(News::Base([1001, 30000]))));
        let frame = "[Parsed_showinfo_2 @ 0x5] [info] n:  12 pts:   -512 pts_time:-0.04   duration: 1 pos: -1 fmt:rgb24 sar:1/1 s:64x48 i:P iskey:1";
        assert!(matches!(read_news(frame), Some(News::Frame { ticks: -512, size: [64, 48] })));
        assert!(read_news("[info] Duration: 12").is_none());
        assert!(read_news("[Parsed_showinfo_2 @ 0x5] [info] color_range:tv").is_none());
    }

    #[test]
    fn times_are_exact() {
        let timing = Timing { ticks: 3, base: [1001, 30000] };
        assert_eq!(timing.nanoseconds(), 100_100_000);
        assert_eq!(Timing { ticks: -1, base: [1, 3] }.nanoseconds(), -333_333_333);
        assert!((timing.seconds() - 0.1001).abs() < 1e-15);
    }
}
