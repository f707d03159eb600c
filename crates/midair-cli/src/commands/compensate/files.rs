//! The files of a compensation: maps in every format, the display image.

use super::Arguments;
use crate::failure::Failure;
use midair::compensate::{Compensation, Solved};
use midair::files::Output;
use midair::map::format::{Format, write_channels, write_map_and_gain};
use midair::map::{Gain, Map, Status, bleed, forward};
use midair::picture::{Depth, Picture, Still, write_still, write_still_of_pitch};

impl Arguments {
    /// Writes the maps as they were asked for, for pictures of `source` pixels; returns what the user should know.
    pub(super) fn write_maps(
        &self,
        compensation: &Compensation,
        source: [usize; 2],
        output: &mut Output,
    ) -> Result<Vec<String>, Failure> {
        let mut notes = Vec::new();
        let rings = usize::from(self.bleed);
        for (c, solved) in compensation.solved().iter().enumerate() {
            let name = match compensation.is_by_colour() {
                true => ["map_r", "map_g", "map_b"][c],
                false => "map",
            };
            let bled = (rings > 0).then(|| bleed(&solved.map, rings));
            let map = bled.as_ref().unwrap_or(&solved.map);
            let gain = compensation.gains().map(|gains| &gains[c]);
            notes.extend(write_maps(output, map, gain, name, source, &self.format)?);
            if self.forward {
                let map = bleed(&forward(&solved.setup, &solved.map, source), rings);
                let name = name.replacen("map", "forward", 1);
                let size = solved.setup.resolution;
                notes.extend(write_maps(output, &map, None, &name, size, &self.format)?);
            }
        }
        if compensation.is_by_colour() && self.format.contains(&Format::Exr) {
            write_six_channels(output, compensation.solved())?;
        }
        Ok(notes)
    }
}

/// Writes the map in each format, under the format's file name with `name` in the place of "map", and its gain where there is a place
/// for it; returns what the user should know.
pub fn write_maps(
    output: &mut Output,
    map: &Map,
    gain: Option<&Gain>,
    name: &str,
    source: [usize; 2],
    formats: &[Format],
) -> Result<Vec<String>, Failure> {
    let mut notes = Vec::new();
    for &format in formats {
        let name = format.file_name().replacen("map", name, 1);
        let written =
            output.write(&name, |path| write_map_and_gain(map, gain, source, format, path))?;
        notes.extend(written.notes.into_iter().map(|note| format!("{name}: {note}")));
        if gain.is_some() && !matches!(format, Format::Exr | Format::ExrHalf) {
            notes.push(format!("{name}: this kind of map has no place for the gain; map.exr has"));
        }
    }
    Ok(notes)
}

/// Writes the maps of red, green and blue as one OpenEXR file of six channels and coverage.
fn write_six_channels(output: &mut Output, solved: &[Solved]) -> Result<(), Failure> {
    let mut channels = Vec::new();
    let maps: Vec<&Map> = solved.iter().map(|solved| &solved.map).collect();
    for (map, names) in maps.iter().zip([["R.u", "R.v"], ["G.u", "G.v"], ["B.u", "B.v"]]) {
        for (axis, name) in names.into_iter().enumerate() {
            channels.push((name, map.uv.iter().map(|uv| uv[axis] as f32).collect()));
        }
    }
    let all_ok = |pixel: usize| maps.iter().all(|map| map.status[pixel] == Status::Ok);
    let [width, height] = [maps[0].width, maps[0].height];
    channels.push(("A", (0..width * height).map(|pixel| f32::from(all_ok(pixel))).collect()));
    Ok(output.write("map_rgb.exr", |path| write_channels(path, width, height, channels, false))?)
}

/// Writes what the display shows: 8 bits for a picture of 8 bits, else 16, and OpenEXR for an OpenEXR picture as well. `pitch` is the width and
/// height of its pixels in mm.
pub fn write_display(
    output: &mut Output,
    still: &Still,
    display: &Picture,
    pitch: [f64; 2],
) -> Result<(), Failure> {
    output.write("display.png", |path| write_still_of_pitch(path, display, still.depth, pitch))?;
    if still.depth == Depth::Float {
        output.write("display.exr", |path| write_still(path, display, Depth::Float))?;
    }
    Ok(())
}
