//! Films: frame by frame, piece by piece.

use super::Arguments;
use super::parts::{Job, Piece, extension, in_a_row};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::{Counts, Voice, milliseconds};
use midair::evaluate::proof::Watch as _;
use midair::map::Map;
use midair::map::format::FileError;
use midair::media::video::{
    Colour, Decoder, Encoder, Film, Recipe, Timing, VideoError, join, probe,
};
use midair::media::{
    Curve, DeepScratch, Depth, LinearScratch, Picture, Sequence, Warp, WarpError, read_still, srgb,
    write_still,
};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

/// A frame's bytes and when it is shown.
type Frame = (Vec<u8>, Timing);

/// Frames that may wait between reading, warping and writing.
const WAITING: usize = 3;

/// A map made ready, and how its frames are coded.
struct Warper {
    warp: Warp,
    deep: bool,
    curve: Curve,
    linear: LinearScratch,
    scratch: DeepScratch,
    samples: [Vec<u16>; 2],
}

impl Warper {
    fn new(
        arguments: &Arguments,
        map: &Map,
        size: [usize; 2],
        deep: bool,
        curve: Curve,
    ) -> Result<Self, Failure> {
        let warp = Warp::new(map, size, arguments.filter()).map_err(unfit)?;
        let (linear, scratch) = (LinearScratch::default(), DeepScratch::default());
        Ok(Self { warp, deep, curve, linear, scratch, samples: [Vec::new(), Vec::new()] })
    }

    /// The display's frame for a film's frame.
    fn apply(&mut self, frame: &[u8]) -> Result<Vec<u8>, Failure> {
        let [width, height] = self.warp.size();
        if !self.deep {
            let mut output = vec![0; width * height * 3];
            self.warp
                .apply_in_linear_light(frame, 3, &mut self.linear, &mut output)
                .map_err(unfit)?;
            return Ok(output);
        }
        let [input, output] = &mut self.samples;
        input.clear();
        input.extend(frame.as_chunks::<2>().0.iter().map(|&bytes| u16::from_le_bytes(bytes)));
        output.resize(width * height * 3, 0);
        self.warp.apply_deep(input, self.curve, &mut self.scratch, output).map_err(unfit)?;
        Ok(output.iter().flat_map(|sample| sample.to_le_bytes()).collect())
    }
}

/// A frame that is not of the film's size.
fn unfit(error: WarpError) -> Failure {
    Failure::new(
        format!("the frames cannot be warped: {error}"),
        "a film whose size changes on its way: make it of one size first (ffmpeg -vf scale=W:H)",
    )
}

/// A film made of a film.
pub fn of_film(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let film = open(arguments)?;
    let (map, mut notes) = arguments.read_map(film.size)?;
    let deep = film.deep || film.colour.curve() != Curve::Srgb;
    notes.extend(remarks(&film));
    let work = Work {
        arguments,
        map: &map,
        deep,
        rate: film.rate,
        colour: &film.colour,
        total: film.frames(),
        film: Some(&film),
    };
    let source = |skip: u64| Frames::of_film(&film, deep, skip);
    let sound = (!arguments.no_audio).then_some(arguments.input.as_path());
    work.make(film.size, source, sound, notes, voice)
}

/// A film made of numbered pictures.
pub fn of_stills(arguments: &Arguments, from: &Sequence, voice: Voice) -> Result<(), Failure> {
    let numbers = from.numbers()?;
    let first = read_still(&from.file(numbers[0]))?;
    let size = [first.picture.width, first.picture.height];
    let (map, notes) = arguments.read_map(size)?;
    let deep = first.depth != Depth::Eight;
    // Rates such as 29.97 to the thousandth.
    let rate = [(arguments.rate * 1000.0).round().max(1.0) as u64, 1000];
    let colour = Colour::usual(map.height);
    let total = Some(numbers.len() as u64);
    let work = Work { arguments, map: &map, deep, rate, colour: &colour, total, film: None };
    let source =
        |skip: u64| Ok(Frames::of_stills(from.clone(), numbers.clone(), size, deep, rate, skip));
    work.make(size, source, None, notes, voice)
}

/// Numbered pictures made of a film.
pub fn into_stills(arguments: &Arguments, to: &Sequence, voice: Voice) -> Result<(), Failure> {
    crate::arguments::check_picture_name(&arguments.output)?;
    let film = open(arguments)?;
    let (map, mut notes) = arguments.read_map(film.size)?;
    let curve = film.colour.curve();
    let deep = film.deep || curve != Curve::Srgb;
    notes.extend(remarks(&film));
    std::fs::create_dir_all(to.folder())
        .map_err(|error| FileError::io(to.folder(), "create", error))?;
    let job = Job::of_stills(arguments, to, &map)?;
    crate::output::on_interrupt_say("interrupted; the same command with --resume goes on");
    let mut warper = Warper::new(arguments, &map, film.size, deep, curve)?;
    let frames = Frames::of_film(&film, deep, 0)?;
    let (start, bar) = (Instant::now(), Bar::new());
    bar.stage("frames", film.frames().unwrap_or(0).max(2) as usize);
    let (mut number, mut resumed, mut last) = (0, 0, 0.0);
    for (frame, timing) in frames.frames.iter() {
        number += 1;
        last = timing.seconds();
        bar.advance(1);
        let target = to.file(number);
        if job.resumed && target.is_file() {
            resumed += 1;
            continue;
        }
        let shown = warper.apply(&frame)?;
        let picture = picture(&shown, [map.width, map.height], deep, curve);
        write_still(&target, &picture, if deep { Depth::Sixteen } else { Depth::Eight })?;
    }
    bar.finish();
    notes.extend(frames.end(arguments, Some(&film), number, last)?);
    job.finish()?;
    tell(arguments, &map, number, resumed, start.elapsed(), &notes, voice)
}

fn open(arguments: &Arguments) -> Result<Film, Failure> {
    if !arguments.input.is_file() {
        return Err(Failure::new(
            format!("{}: there is no such file", arguments.input.display()),
            "check the path; numbered pictures are named by a pattern such as frames/%04d.png",
        ));
    }
    Ok(probe(&arguments.input)?)
}

/// What the user should know of a film.
fn remarks(film: &Film) -> Vec<String> {
    let mut notes = Vec::new();
    let path = film.path.display();
    if film.interlaced {
        notes.push(format!("{path}: its frames are woven of two fields; they are taken apart before they are warped (yadif)"));
    }
    if matches!(film.colour.curve(), Curve::Pq | Curve::Hlg) {
        notes.push(format!(
            "{path}: a wide range of light; the range is kept, the mastering display's data are not"
        ));
    }
    notes
}

/// A frame as a picture in linear light.
fn picture(frame: &[u8], [width, height]: [usize; 2], deep: bool, curve: Curve) -> Picture {
    let mut picture = Picture::filled(width, height, [0.0, 0.0, 0.0, 1.0]);
    for (i, pixel) in picture.pixels.iter_mut().enumerate() {
        for c in 0..3 {
            let at = 3 * i + c;
            pixel[c] = if deep {
                let code = u16::from_le_bytes([frame[2 * at], frame[2 * at + 1]]);
                curve.decode(f64::from(code) / 65535.0) as f32
            } else {
                srgb::decode_8(frame[at])
            };
        }
    }
    picture
}

/// Frames that a thread reads ahead.
struct Frames {
    frames: Receiver<Frame>,
    reader: std::thread::JoinHandle<Result<Vec<String>, Failure>>,
}

impl Frames {
    /// A film's, without the first `skip`.
    fn of_film(film: &Film, deep: bool, skip: u64) -> Result<Self, Failure> {
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
    fn of_stills(
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
    fn end(
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
/// usual.
fn missing(film: &Film, count: u64, last: f64, sound: bool) -> Option<String> {
    if let Some(counted) = film.counted {
        return (count + 3 + counted / 100 < counted).then(|| counted.to_string());
    }
    // The whole file's length may be that of its sound alone, so that it says something only of a film that is
    // damaged for certain.
    let seconds = film.seconds.or_else(|| film.whole.filter(|_| !sound))?;
    (last + 0.5 + 0.02 * seconds < seconds).then(|| format!("{seconds:.1} s ending at {last:.1} s"))
}

/// A film to be made.
struct Work<'a> {
    arguments: &'a Arguments,
    map: &'a Map,
    deep: bool,
    rate: [u64; 2],
    colour: &'a Colour,
    /// Frames, about.
    total: Option<u64>,
    /// The film that they come from.
    film: Option<&'a Film>,
}

impl Work<'_> {
    fn make(
        &self,
        size: [usize; 2],
        source: impl FnOnce(u64) -> Result<Frames, Failure>,
        sound: Option<&Path>,
        mut notes: Vec<String>,
        voice: Voice,
    ) -> Result<(), Failure> {
        let arguments = self.arguments;
        let extension = extension(&arguments.output)?;
        let target_folder = arguments.output.parent().unwrap_or(Path::new(""));
        if !target_folder.as_os_str().is_empty() && !target_folder.is_dir() {
            let message = format!("{}: its folder does not exist", arguments.output.display());
            return Err(Failure::new(message, "make the folder, or choose another"));
        }
        let job = Job::of_film(arguments, self.map)?;
        crate::output::on_interrupt_say("interrupted; the same command with --resume goes on");
        let mut pieces = job.pieces(extension);
        let resumed: u64 = pieces.iter().map(|piece| piece.frames).sum();
        let mut warper = Warper::new(arguments, self.map, size, self.deep, self.colour.curve())?;
        let frames = source(resumed)?;
        let (start, bar) = (Instant::now(), Bar::new());
        let left = self.total.map_or(0, |total| total.saturating_sub(resumed));
        bar.stage("frames", left.max(2) as usize);
        let (mut count, mut last) = (resumed, f64::INFINITY);
        let mut next = frames.frames.recv().ok();
        while let Some((_, timing)) = &next {
            let (begin, base) = (timing.seconds(), timing.base);
            let index = pieces.len();
            let making = job.path(&Piece::names(index, extension)[0]);
            let recipe = Recipe {
                size: [self.map.width, self.map.height],
                deep: self.deep,
                rate: self.rate,
                colour: self.colour,
                base,
                options: &arguments.encoder,
            };
            let mut encoder = Encoder::new(&making, &recipe)?;
            // Encoding goes on while the next frame is warped.
            let (sender, warped) = sync_channel::<Frame>(WAITING);
            let writer = std::thread::spawn(move || -> Result<(), VideoError> {
                for (frame, timing) in warped {
                    encoder.write(&frame, timing)?;
                }
                encoder.finish()
            });
            let mut in_piece = 0;
            while let Some((frame, timing)) = next.take() {
                last = timing.seconds();
                let shown = warper.apply(&frame)?;
                let sent = sender.send((shown, timing)).is_ok();
                in_piece += 1;
                bar.advance(1);
                next = frames.frames.recv().ok();
                // A writer that has ended says why below.
                if !sent || in_piece == u64::from(arguments.piece) {
                    break;
                }
            }
            drop(sender);
            match writer.join() {
                Ok(written) => written.map_err(|error| self.encoder_failed(error))?,
                Err(panic) => std::panic::resume_unwind(panic),
            }
            count += in_piece;
            pieces.push(Piece::keep(&job, index, extension, in_piece, begin)?);
        }
        bar.finish();
        notes.extend(frames.end(arguments, self.film, count, last)?);
        let joined = job.path(&format!("joined.{extension}"));
        let begin = pieces.first().map_or(0.0, |piece| piece.start);
        join(&in_a_row(&pieces), begin, sound, &job.path("pieces.txt"), &joined)
            .map_err(|error| self.join_failed(error))?;
        std::fs::rename(&joined, &arguments.output)
            .map_err(|error| FileError::io(&arguments.output, "write", error))?;
        job.finish()?;
        tell(arguments, self.map, count, resumed, start.elapsed(), &notes, voice)
    }

    fn encoder_failed(&self, error: VideoError) -> Failure {
        match error {
            VideoError::Refused { said, .. } => Failure::new(
                format!("{}: ffmpeg cannot encode it: {said}", self.arguments.output.display()),
                "choose an encoder that this ffmpeg has (ffmpeg -encoders) and the container takes, after --: -- -c:v libx264",
            ),
            other => other.into(),
        }
    }

    fn join_failed(&self, error: VideoError) -> Failure {
        match error {
            VideoError::Refused { said, doing, .. } => Failure::new(
                format!("{}: ffmpeg cannot {doing}: {said}", self.arguments.output.display()),
                "if the container cannot hold this sound, let the name end in .mkv, or add --no-audio; with --resume the frames are not made again",
            ),
            other => other.into(),
        }
    }
}

fn tell(
    arguments: &Arguments,
    map: &Map,
    frames: u64,
    resumed: u64,
    time: Duration,
    notes: &[String],
    voice: Voice,
) -> Result<(), Failure> {
    voice.note(notes);
    let rate = (frames - resumed) as f64 / time.as_secs_f64();
    let before = if resumed > 0 { format!(", {resumed} were there") } else { String::new() };
    let lines = format!(
        "{frames} frames of {} x {} pixels, {rate:.1} a second{before}\nwrote {}\n",
        map.width,
        map.height,
        arguments.output.display()
    );
    let told: Value = json!({
        "size": [map.width, map.height],
        "frames": frames,
        "resumed_frames": resumed,
        "status": Counts::of(map).json(),
        "timings_ms": { "all": milliseconds(time) },
        "files": [arguments.output.display().to_string()],
        "notes": notes,
    });
    voice.tell(&lines, &told)
}
