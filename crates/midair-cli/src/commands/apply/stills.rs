//! Pictures to pictures.

use super::parts;
use super::{Arguments, Ready, evened};
use crate::arguments::{check_picture_name, open_picture};
use crate::failure::Failure;
use crate::output::inputs;
use crate::progress::Bar;
use crate::summary::{Voice, milliseconds, paths, wrote};
use midair::Monitor as _;
use midair::picture::{Depth, Sequence, display_image, even_out, read_still, write_still};
use serde_json::json;
use std::path::Path;
use std::time::Instant;

/// One picture.
pub fn one(arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    check_picture_name(&arguments.output)?;
    let mut notes = Vec::new();
    let still = open_picture(&arguments.input, &mut notes)?;
    let Ready { map, gain, notes: more } =
        arguments.read_map([still.picture.width, still.picture.height])?;
    notes.extend(more);
    let (mut output, name) = crate::output::of_file(&arguments.output)?;
    let start = Instant::now();
    let depth = depth_for(&arguments.output, still.depth);
    let crop = arguments.crop([still.picture.width, still.picture.height]);
    let mut shown = display_image(&crop.picture(still.picture), &map);
    if let Some((gain, mode)) = gain {
        let even = even_out(&shown, &gain, mode.overflow());
        notes.push(evened(mode, even.level));
        shown = even.display;
    }
    let time = start.elapsed();
    output.write(&name, |path| write_still(path, &shown, depth))?;
    let files = output.finish()?;
    voice.note(&notes);
    let told = json!({
        "size": [map.width, map.height],
        "frames": 1,
        "status": map.counts(),
        "timings_ms": { "warp": milliseconds(time) },
        "files": paths(&files),
        "notes": notes,
    });
    voice.tell(&wrote(&files), &told)
}

/// A PNG of a float picture has 16 bits, and an OpenEXR file is of floats always.
fn depth_for(path: &Path, depth: Depth) -> Depth {
    let exr = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    match depth {
        _ if exr => Depth::Float,
        Depth::Eight => Depth::Eight,
        _ => Depth::Sixteen,
    }
}

/// Numbered pictures, each by itself.
pub fn each(
    arguments: &Arguments,
    from: &Sequence,
    to: &Sequence,
    voice: Voice,
) -> Result<(), Failure> {
    check_picture_name(&arguments.output)?;
    let numbers = from.numbers()?;
    numbers.iter().for_each(|&number| inputs().add(&from.file(number)));
    let first = read_still(&from.file(numbers[0]))?;
    let size = [first.picture.width, first.picture.height];
    // All at one level, as a film's.
    let (map, evening, mut notes) = arguments.read_map(size)?.for_many();
    notes.extend(first.notes);
    std::fs::create_dir_all(to.folder())
        .map_err(|error| midair::map::format::FileError::io(to.folder(), "create", error))?;
    let job = parts::begin(arguments, &map)?;
    if let Err(refused) = numbers.iter().try_for_each(|&number| job.claim(&to.file(number))) {
        // Nothing was begun that could be gone on with.
        job.finish()?;
        return Err(refused.into());
    }
    // A file is whole or absent, so what is there is done.
    let done = |number: &u64| job.resumed && to.file(*number).is_file();
    let todo: Vec<u64> = numbers.iter().copied().filter(|number| !done(number)).collect();
    crate::output::on_interrupt_say("interrupted; the same command with --resume goes on");
    let start = Instant::now();
    let bar = Bar::new();
    bar.stage("pictures", todo.len().max(2));
    for &number in &todo {
        let still = read_still(&from.file(number))?;
        if [still.picture.width, still.picture.height] != size && notes.len() < 20 {
            let (w, h) = (still.picture.width, still.picture.height);
            notes.push(format!(
                "{}: {w} x {h} pixels, not {} x {} as the first; it is stretched over the same image",
                from.file(number).display(), size[0], size[1]
            ));
        }
        let target = to.file(number);
        let crop = arguments.crop([still.picture.width, still.picture.height]);
        let mut shown = display_image(&crop.picture(still.picture), &map);
        if let Some(evening) = &evening {
            evening.apply(&mut shown);
        }
        let depth = depth_for(&target, still.depth);
        job.write(&target, |path| write_still(path, &shown, depth))?;
        bar.advance(1);
    }
    bar.finish();
    job.finish()?;
    voice.note(&notes);
    let seconds = start.elapsed().as_secs_f64();
    let lines = format!(
        "{} pictures of {} x {} pixels in {seconds:.1} s{}\nwrote {}\n",
        todo.len(),
        map.width,
        map.height,
        if todo.len() < numbers.len() {
            format!(", {} were there", numbers.len() - todo.len())
        } else {
            String::new()
        },
        arguments.output.display()
    );
    let told = json!({
        "size": [map.width, map.height],
        "frames": numbers.len(),
        "resumed_frames": numbers.len() - todo.len(),
        "timings_ms": { "warp": milliseconds(start.elapsed()) },
        "files": [arguments.output.display().to_string()],
        "notes": notes,
    });
    voice.tell(&lines, &told)
}
