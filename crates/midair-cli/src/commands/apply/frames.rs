//! Frames as they come, from a film or numbered pictures, read ahead by a thread.

use super::Arguments;
use crate::failure::Failure;
use midair::picture::{Sequence, read_still, srgb};
use midair_video::{Decoder, Film, Timing};
use std::sync::mpsc::{Receiver, sync_channel};

/// A frame's bytes and when it is shown.
pub type Frame = (Vec<u8>, Timing);

/// Frames that may wait between reading, warping and writing.
pub const WAITING: usize = 3;

/// Frames that a thread reads ahead.
pub struct Frames {
    pub frames: Receiver<Frame>,
    reader: std::thread::JoinHandle<Result<Vec<String>, Failure>>,
}

impl Frames {
    /// A film's, without the first `skip`.
    pub fn of_film(film: &Film, deep: bool, skip: u64) -> Result<Self, Failure> {
        let mut decoder = Decoder::new(film, deep)?;
        let (sender, frames) = sync_channel(WAITING);
        let reader = std::thread::spawn(move || {
            let mut count = 0;
            let mut frame = Vec::new();
            while let Some(timing) = decoder.next(&mut frame)? {
                count += 1;
                if count > skip && sender.send((std::mem::take(&mut frame), timing)).is_err() {
                    // Nobody wants more; dropping the decoder ends ffmpeg.
                    return Ok(Vec::new());
                }
            }
            Ok(decoder.finish()?)
        });
        Ok(Self { frames, reader })
    }

    /// Pictures as frames of a film.
    pub fn of_stills(
        from: Sequence,
        numbers: Vec<u64>,
        size: [usize; 2],
        deep: bool,
        rate: [u64; 2],
        skip: u64,
    ) -> Self {
        let (sender, frames) = sync_channel(WAITING);
        let reader = std::thread::spawn(move || {
            for (ticks, number) in (0..).zip(numbers).skip(skip as usize) {
                let path = from.file(number);
                let picture = read_still(&path)?.picture;
                if [picture.width, picture.height] != size {
                    let problem = format!(
                        "{}: {} x {} pixels, but the first picture has {} x {}",
                        path.display(),
                        picture.width,
                        picture.height,
                        size[0],
                        size[1]
                    );
                    return Err(Failure::new(problem, "give a film's pictures one size"));
                }
                let codes = picture.pixels.iter().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]);
                let frame: Vec<u8> = match deep {
                    true => codes.flat_map(|light| srgb::encode_16(light).to_le_bytes()).collect(),
                    false => codes.map(srgb::encode_8).collect(),
                };
                if sender.send((frame, Timing { ticks, base: [rate[1], rate[0]] })).is_err() {
                    break;
                }
            }
            Ok(Vec::new())
        });
        Self { frames, reader }
    }

    /// After the last frame, shown at `last` seconds: refuses a film that ended before its end.
    pub fn end(
        self,
        arguments: &Arguments,
        film: Option<&Film>,
        count: u64,
        last: f64,
    ) -> Result<Vec<String>, Failure> {
        drop(self.frames);
        let path = arguments.input.display();
        let ended = match self.reader.join() {
            Ok(ended) => ended,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        let help = "copy or export it again; --keep-going takes what is there";
        let errors = match ended {
            Ok(errors) => errors,
            Err(failure) if arguments.keep_going && count > 0 => {
                return Ok(vec![failure.to_string()]);
            }
            Err(failure) if count == 0 => return Err(failure),
            Err(failure) => {
                return Err(Failure::new(
                    format!("{path}: it ends early, after {count} frames: {failure}"),
                    help,
                ));
            }
        };
        let said = errors.first().map_or_else(String::new, |first| format!(" (ffmpeg: {first})"));
        if count == 0 {
            return Err(Failure::new(format!("{path}: not one frame can be decoded{said}"), help));
        }
        let short = film.and_then(|film| missing(film, count, last, errors.is_empty()));
        match short {
            Some(whole) if !arguments.keep_going => Err(Failure::new(
                format!("{path}: it ends early: {count} frames can be decoded, of {whole}{said}"),
                help,
            )),
            Some(whole) => {
                Ok(vec![format!("{path}: only {count} frames could be decoded, of {whole}{said}")])
            }
            None if errors.is_empty() => Ok(Vec::new()),
            None => Ok(vec![format!(
                "{path}: it is damaged in places; ffmpeg complained {} times{said}",
                errors.len()
            )]),
        }
    }
}

/// What a film should have where its frames, the last one shown at `last` seconds, are far from all. Cuts at either end and roundings are
/// usual, a list of edits may show a part only, and a last picture may stand for long: so that a film that ffmpeg has no complaint about (it is
/// `sound`) is short only where both its count and its clock say so.
fn missing(film: &Film, count: u64, last: f64, sound: bool) -> Option<String> {
    let early = |end: f64, length: f64| last + 0.5 + 0.02 * length < end;
    if let Some(counted) = film.counted {
        let few = count + 3 + counted / 100 < counted;
        let early = film.end().is_none_or(|end| early(end, end - film.start));
        return (few && early).then(|| counted.to_string());
    }
    // The whole file's length may be that of its sound alone.
    let end = film.end().or(film.whole).filter(|_| !sound)?;
    let length = end - film.start;
    early(end, length).then(|| format!("{length:.1} s ending at {last:.1} s"))
}
