//! `midair play` of `patterns`: what is photographed for a calibration, in the display's own pixels.

use super::Arguments;
use crate::arguments::open_scene;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::summary::Voice;
use midair::Monitor as _;
use midair::transport::Setup;
use midair_calibrate::Patterns;
use midair_live::Turn;
use midair_play::{Pictures, show_pictures};
use serde_json::json;
use std::path::Path;
use std::time::Duration;

/// The source that stands for the patterns, unless a file is called so.
const SOURCE: &str = "patterns";

/// Seconds from a pattern's presentation to the command that photographs it.
const SETTLE: f64 = 0.3;

/// Whether the patterns are the source.
pub fn are_meant(arguments: &Arguments) -> bool {
    arguments.sources == [SOURCE] && !Path::new(SOURCE).is_file()
}

/// Options that would change what a camera is to see, or that patterns have nothing to do with.
fn out_of_place(arguments: &Arguments) -> Option<&'static str> {
    let given = [
        (arguments.size.is_some(), "--size"),
        (arguments.sound, "--sound"),
        (arguments.hours.is_some(), "--hours"),
        (arguments.source_size.is_some(), "--source-size"),
        (arguments.track.is_some(), "--track"),
        (arguments.gain.is_some(), "--gain"),
        (arguments.overlay, "--overlay"),
        (arguments.save.is_some(), "--save"),
        (arguments.seconds.is_some(), "--for"),
        (arguments.bench, "--bench"),
    ];
    given.into_iter().find(|(given, _)| *given).map(|(_, name)| name)
}

/// Shows them.
pub fn run(scene: &Path, arguments: &Arguments, voice: Voice) -> Result<(), Failure> {
    if let Some(name) = out_of_place(arguments) {
        return Err(Failure::new(
            format!("{name} does not go with patterns: they are shown as they are, pixel by pixel"),
            format!("leave {name} out"),
        ));
    }
    let loaded = open_scene(scene, None)?;
    let setup = Setup::new(&loaded)?;
    let patterns = Patterns::of(&setup);
    let count = patterns.list.len();
    let seconds = |given: Option<f64>, or: f64| Duration::from_secs_f64(given.unwrap_or(or));
    let turn = match (&arguments.shutter, arguments.each) {
        (Some(_), _) => Turn::Released { settle: seconds(arguments.settle, SETTLE) },
        (None, Some(each)) => Turn::After(Duration::from_secs_f64(each)),
        (None, None) => Turn::ByKey,
    };
    let draw = |pattern: usize| -> Vec<u32> {
        let codes = patterns.picture(pattern, &setup.screen).codes_8();
        codes.as_chunks().0.iter().map(|&[r, g, b]| u32::from_be_bytes([0, r, g, b])).collect()
    };
    let pictures = Pictures {
        title: format!("midair: {}", loaded.scene.name),
        resolution: patterns.resolution,
        names: (0..count).map(|pattern| patterns.name(pattern)).collect(),
        draw: &draw,
        turn,
        command: arguments.shutter.clone().unwrap_or_default(),
        screen: arguments.display,
    };
    voice.note(&loaded.notes);
    if turn == Turn::ByKey {
        let keys =
            "space or an arrow shows the next pattern, an arrow back the one before, Esc ends";
        voice.note(&[keys.to_owned()]);
    }
    let bar = Bar::new();
    bar.stage(SOURCE, count);
    let mut furthest = 0;
    let shown = show_pictures(&pictures, &mut |pattern| {
        bar.advance(pattern.saturating_sub(furthest));
        furthest = furthest.max(pattern);
    });
    bar.finish();
    let done = shown?;
    let line = match turn {
        Turn::Released { .. } => format!("{done} of {count} patterns photographed\n"),
        Turn::ByKey | Turn::After(_) => {
            format!("{} of {count} patterns shown\n", (furthest + 1).min(count))
        }
    };
    let report = json!({
        "scene": loaded.scene.name,
        "size": patterns.resolution,
        "patterns": count,
        "shown": (furthest + 1).min(count),
        "photographed": arguments.shutter.as_ref().map(|_| done),
    });
    voice.tell(&line, &report)
}
