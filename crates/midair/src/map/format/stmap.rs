//! Maps in OpenEXR files: STMap, Blender, TouchDesigner.

use super::exr_channels::ExrFile;
use super::exr_layers::read_map_channels;
use super::{FileError, LoadedMap, Put, SampleKind, answer, encode_channels};
use crate::map::{Gain, Map, Status};
use std::path::Path;

/// The channel that tells whether a pixel has an answer.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Cover {
    /// A, where there is one.
    A,
    /// B, as Blender's Map UV node has it.
    B,
}

/// The channels of the gain.
const GAIN: [&str; 3] = ["gain.R", "gain.G", "gain.B"];

pub(super) fn write(
    map: &Map,
    gain: Option<&Gain>,
    path: &Path,
    half: bool,
    put: &mut Put<'_>,
) -> Result<(), FileError> {
    let uv = |axis: usize| {
        map.uv.iter().map(|&uv| answer(uv).map_or(f32::NAN, |uv| uv[axis] as f32)).collect()
    };
    let ok = map.status.iter().map(|&status| f32::from(status == Status::Ok)).collect();
    let status = map.status.iter().map(|&status| f32::from(status as u8)).collect();
    let mut channels = vec![("R", uv(0)), ("G", uv(1)), ("A", ok), ("status", status)];
    if let Some(gain) = gain {
        let of = |c: usize| gain.rgb.iter().map(|rgb| rgb[c]).collect();
        channels.extend(GAIN.iter().enumerate().map(|(c, &name)| (name, of(c))));
    }
    put(path, &encode_channels(path, map.width, map.height, channels, half)?)
}

/// u and v, 0 where there is none: these tools multiply by the mask, and NaN would survive that.
fn masked(map: &Map, axis: usize) -> Vec<f32> {
    map.uv.iter().map(|&uv| answer(uv).map_or(0.0, |uv| uv[axis] as f32)).collect()
}

fn cover(map: &Map) -> Vec<f32> {
    map.status.iter().map(|&status| f32::from(status.is_answered())).collect()
}

pub(super) fn write_blender(map: &Map, path: &Path, put: &mut Put<'_>) -> Result<(), FileError> {
    let channels = vec![("R", masked(map, 0)), ("G", masked(map, 1)), ("B", cover(map))];
    put(path, &encode_channels(path, map.width, map.height, channels, false)?)
}

pub(super) fn write_touchdesigner(
    map: &Map,
    path: &Path,
    put: &mut Put<'_>,
) -> Result<(), FileError> {
    let blue = vec![0.0; map.uv.len()];
    let channels =
        vec![("R", masked(map, 0)), ("G", masked(map, 1)), ("B", blue), ("A", cover(map))];
    put(path, &encode_channels(path, map.width, map.height, channels, false)?)
}

pub(super) fn read(path: &Path, bytes: &[u8], cover: Cover) -> Result<LoadedMap, FileError> {
    let mut more = vec!["status"];
    more.extend(GAIN);
    let found = read_map_channels(path, &ExrFile::open(path, bytes)?, &more)?;
    let file = &found.channels;
    let (u, v) = (found.get(&found.u), found.get(&found.v));
    let mask = match (cover, &found.alpha, &found.blue) {
        (Cover::A, alpha, _) => alpha.as_deref(),
        (Cover::B, _, Some(blue)) => Some(blue.as_str()),
        (Cover::B, _, None) => {
            let problem = "it is missing, and holds where there is an answer";
            let remedy = "export it, or read the map as exr";
            return Err(FileError::malformed(path, "channel B", problem, remedy));
        }
    };
    let mask = mask.map(|name| found.get(name));
    let told = file.get("status");
    let mut map = Map {
        width: file.width,
        height: file.height,
        uv: Vec::with_capacity(u.len()),
        status: Vec::with_capacity(u.len()),
        error_bound: f64::INFINITY,
    };
    for i in 0..u.len() {
        let uv = [f64::from(u[i]), f64::from(v[i])];
        let masked_out = mask.is_some_and(|mask| mask[i].is_nan() || mask[i] <= 0.0);
        let status = match told {
            Some(told) => Status::from_code(told[i]).ok_or_else(|| {
                let place = format!("status of column {}, row {}", i % map.width, i / map.width);
                let problem = format!("{} is none of 0, 1, 2, 3", told[i]);
                FileError::malformed(path, place, problem, "leave the channel out or mend it")
            })?,
            None if masked_out || answer(uv).is_none() => Status::Outside,
            None => Status::Ok,
        };
        // 0 under a mask of 0 is what tools write for want of a NaN.
        let none = answer(uv).is_none() || (masked_out && told.is_none() && uv == [0.0; 2]);
        if none && status.is_answered() {
            let place = format!("column {}, row {}", i % map.width, i / map.width);
            let problem = "its status is ok but it has no u and v";
            return Err(FileError::malformed(path, place, problem, "export the map again"));
        }
        map.uv.push(if none { [f64::NAN; 2] } else { uv });
        map.status.push(status);
    }
    let mut loaded = LoadedMap::new(map);
    loaded.notes.extend(found.notes.iter().cloned());
    if let Some(layer) = &found.layer {
        loaded.notes.push(format!("{}: the map is read from its layer {layer}", path.display()));
    }
    if let [Some(r), Some(g), Some(b)] = GAIN.map(|name| file.get(name)) {
        let rgb = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]);
        // Less than nothing is left of no light.
        let rgb = rgb.map(|rgb| if rgb.iter().all(|&g| g >= 0.0) { rgb } else { [f32::NAN; 3] });
        let (width, height) = (file.width, file.height);
        loaded.gain = Some(Gain { width, height, rgb: rgb.collect() });
    }
    if file
        .channels
        .iter()
        .any(|(name, kind, _)| (*name == found.u || *name == found.v) && *kind == SampleKind::Half)
    {
        loaded.notes.push(format!(
            "{}: its half floats place image points in steps of 1/2048 of the source; \
             export 32-bit floats",
            path.display()
        ));
    }
    Ok(loaded)
}
