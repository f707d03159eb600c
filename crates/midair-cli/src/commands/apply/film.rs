//! Films: frame by frame, piece by piece.

use super::Arguments;
use super::frames::{Frame, Frames, WAITING};
use super::parts::{self, Piece, extension, in_a_row};
use super::warper::{Warper, picture};
use crate::failure::Failure;
use crate::output::inputs;
use crate::progress::Bar;
use crate::summary::{Voice, milliseconds};
use midair::Monitor as _;
use midair::map::Map;
use midair::map::format::FileError;
use midair::picture::{Curve, Depth, Evening, Sequence, read_still, wide, write_still};
use midair_video::{
    Colour, Encoder, Extras, Film, Joining, Recipe, VideoError, coded, is_avi, join, probe,
};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

/// A film made of a film.
pub fn of_film(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    let film = open(arguments)?;
    let (map, evening, mut notes) = arguments.read_map(film.size)?.for_many();
    let deep = film.deep || film.colour.curve() != Curve::Srgb;
    notes.extend(remarks(&film));
    if is_wide(&film) {
        notes.push(format!(
            "{}: a wide range of light; the range is kept, the mastering display's data are not",
            film.path.display()
        ));
    }
    let extras = (!arguments.no_audio)
        .then(|| Extras::new(&film.path, film.sounds, &film.subtitles, &arguments.output));
    if let Some(left) = extras.as_ref().map(Extras::subtitles_left).filter(|&left| left > 0) {
        notes.push(format!(
            "{}: {left} of {} streams of subtitles are left out, which this kind of film cannot hold; .mkv holds them",
            film.path.display(),
            film.subtitles.len()
        ));
    }
    let work = Work {
        arguments,
        map: &map,
        evening,
        deep,
        rate: film.rate,
        colour: &film.colour,
        total: film.frames(),
        film: Some(&film),
    };
    let source = |skip: u64| Frames::of_film(&film, deep, skip);
    work.make(film.size, source, extras.as_ref(), notes, voice)
}

/// A film made of numbered pictures.
pub fn of_stills(arguments: &Arguments, from: &Sequence, voice: Voice) -> Result<(), Failure> {
    let numbers = from.numbers()?;
    numbers.iter().for_each(|&number| inputs().add(&from.file(number)));
    let first = read_still(&from.file(numbers[0]))?;
    let size = [first.picture.width, first.picture.height];
    let (map, evening, mut notes) = arguments.read_map(size)?.for_many();
    notes.extend(first.notes);
    notes.extend(gaps(from, &numbers));
    let deep = first.depth != Depth::Eight;
    // Rates such as 29.97 to the thousandth.
    let rate = [(arguments.rate * 1000.0).round().max(1.0) as u64, 1000];
    let colour = Colour::usual(map.height);
    let total = Some(numbers.len() as u64);
    let work =
        Work { arguments, map: &map, evening, deep, rate, colour: &colour, total, film: None };
    let source =
        |skip: u64| Ok(Frames::of_stills(from.clone(), numbers.clone(), size, deep, rate, skip));
    work.make(size, source, None, notes, voice)
}

/// What is said of numbers that are missing on the way.
fn gaps(from: &Sequence, numbers: &[u64]) -> Option<String> {
    const NAMED: usize = 3;
    let (first, last) = (*numbers.first()?, *numbers.last()?);
    let missing = last - first + 1 - numbers.len() as u64;
    if missing == 0 {
        return None;
    }
    let gaps = numbers.windows(2).filter(|pair| pair[1] > pair[0] + 1);
    let named: Vec<String> = gaps
        .flat_map(|pair| pair[0] + 1..pair[1])
        .take(NAMED)
        .map(|number| from.file(number).display().to_string())
        .collect();
    let more = if missing > NAMED as u64 { ", ..." } else { "" };
    Some(format!(
        "{missing} of the pictures {first} to {last} are missing ({}{more}); the film goes on without them",
        named.join(", ")
    ))
}

/// Numbered pictures made of a film.
pub fn into_stills(arguments: &Arguments, to: &Sequence, voice: Voice) -> Result<(), Failure> {
    crate::arguments::check_picture_name(&arguments.output)?;
    let film = open(arguments)?;
    let (map, evening, mut notes) = arguments.read_map(film.size)?.for_many();
    let curve = film.colour.curve();
    let deep = film.deep || curve != Curve::Srgb;
    notes.extend(remarks(&film));
    notes.extend(colour_remark(&film, &arguments.output));
    std::fs::create_dir_all(to.folder())
        .map_err(|error| FileError::io(to.folder(), "create", error))?;
    let job = parts::begin(arguments, &map)?;
    crate::output::on_interrupt_say("interrupted; the same command with --resume goes on");
    let anything = job.resumed;
    let (job, (mut warper, frames)) = parts::prepared(job, anything, |_| {
        let warper = Warper::new(arguments, &map, film.size, evening, deep, curve)?;
        Ok((warper, Frames::of_film(&film, deep, 0)?))
    })?;
    let matrix = film.colour.wide_primaries().and_then(|primaries| primaries.to_srgb());
    let wide = is_exr(&arguments.output);
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
        let picture = picture(&shown, [map.width, map.height], deep, curve, matrix.as_ref(), wide);
        let depth = if deep { Depth::Sixteen } else { Depth::Eight };
        job.write(&target, |path| write_still(path, &picture, depth))?;
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
    inputs().add(&arguments.input);
    Ok(probe(&arguments.input)?)
}

/// What the user should know of a film.
fn remarks(film: &Film) -> Vec<String> {
    let mut notes = Vec::new();
    let path = film.path.display();
    if film.interlaced {
        notes.push(format!("{path}: its frames are woven of two fields; they are taken apart before they are warped (yadif)"));
    }
    if film.films > 1 {
        notes.push(format!(
            "{path}: it has {} streams of moving pictures; stream {} is taken",
            film.films, film.stream
        ));
    }
    if film.alpha {
        notes.push(format!("{path}: what is transparent is black"));
    }
    notes
}

fn is_wide(film: &Film) -> bool {
    matches!(film.colour.curve(), Curve::Pq | Curve::Hlg)
}

fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"))
}

/// What the user should know of a film's colours that become stills.
fn colour_remark(film: &Film, to: &Path) -> Option<String> {
    let path = film.path.display();
    match film.colour.wide_primaries() {
        _ if is_wide(film) && is_exr(to) => Some(format!(
            "{path}: a wide range of light; it is kept, reference white (203 cd/m2) being 1, and the primaries are those of sRGB"
        )),
        _ if is_wide(film) => Some(format!("{path}: a wide range of light; {}", wide::SAID)),
        Some(_) => Some(format!("{path}: its primaries are converted to those of sRGB")),
        None => None,
    }
}

/// A film to be made.
struct Work<'a> {
    arguments: &'a Arguments,
    map: &'a Map,
    evening: Option<Evening>,
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
        extras: Option<&Extras>,
        mut notes: Vec<String>,
        voice: Voice,
    ) -> Result<(), Failure> {
        let arguments = self.arguments;
        let extension = extension(&arguments.output)?;
        // Made and dropped: what cannot be written is refused before the work.
        drop(crate::output::of_file(&arguments.output)?);
        let job = parts::begin(arguments, self.map)?;
        crate::output::on_interrupt_say("interrupted; the same command with --resume goes on");
        let mut pieces = parts::pieces(&job, extension);
        let resumed: u64 = pieces.iter().map(|piece| piece.frames).sum();
        let usual = Recipe {
            size: [self.map.width, self.map.height],
            deep: self.deep,
            rate: self.rate,
            colour: self.colour,
            base: [self.rate[1].max(1), self.rate[0].max(1)],
            options: &arguments.encoder,
            coded: None,
        };
        let (job, (mut warper, coded, frames)) = parts::prepared(job, resumed > 0, |job| {
            let warper = Warper::new(
                arguments,
                self.map,
                size,
                self.evening.clone(),
                self.deep,
                self.colour.curve(),
            )?;
            let trial = job.path(format!("trial.{extension}"));
            if let Some(extras) = extras {
                extras.check(&trial).map_err(|error| self.join_failed(error))?;
            }
            let coded = coded(&trial, &usual).map_err(|error| self.encoder_failed(error))?;
            Ok((warper, coded, source(resumed)?))
        })?;
        let (start, bar) = (Instant::now(), Bar::new());
        let left = self.total.map_or(0, |total| total.saturating_sub(resumed));
        bar.stage("frames", left.max(2) as usize);
        let (mut count, mut last) = (resumed, f64::INFINITY);
        let mut next = frames.frames.recv().ok();
        while let Some((_, timing)) = &next {
            let begin = timing.seconds();
            // An AVI's pictures come in even steps.
            let base = if is_avi(&arguments.output) { usual.base } else { timing.base };
            let index = pieces.len();
            let making = job.path(&Piece::names(index, extension)[0]);
            let recipe = Recipe { base, coded: Some(&coded), ..usual.clone() };
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
        let joined = job.path(format!("joined.{extension}"));
        let begin = pieces.first().map_or(0.0, |piece| piece.start);
        let parts = in_a_row(&pieces);
        // Where all was made before, the last piece's beginning is all that is known of its end.
        let last = if last.is_finite() { last } else { pieces.last().map_or(0.0, |p| p.start) };
        let end = self.end(last);
        let rate = self.rate;
        let joining =
            Joining { parts: &parts, start: begin, last, end, frames: count, rate, extras };
        join(&joining, &job.path("pieces.txt"), &joined)
            .map_err(|error| self.join_failed(error))?;
        job.publish(format!("joined.{extension}"), &arguments.output)?;
        job.finish()?;
        tell(arguments, self.map, count, resumed, start.elapsed(), &notes, voice)
    }

    /// When the time of a last picture that is shown at `last` seconds is over.
    fn end(&self, last: f64) -> f64 {
        let [frames, seconds] = self.rate.map(|n| n as f64);
        let usual = if frames > 0.0 { seconds / frames } else { 0.04 };
        // Of a film that ends early the end is not known.
        let told =
            self.film.and_then(Film::end).filter(|&end| end > last && !self.arguments.keep_going);
        told.unwrap_or(last + usual)
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
        "status": map.counts(),
        "timings_ms": { "all": milliseconds(time) },
        "files": [arguments.output.display().to_string()],
        "notes": notes,
    });
    voice.tell(&lines, &told)
}
