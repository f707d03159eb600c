//! OpenEXR files as named float channels: what both maps and pictures are kept in.

use super::{FileError, write_atomically};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, ReadChannels,
    ReadLayers, Text, WritableImage, f16, read,
};
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

/// No picture or map of more pixels than this is read: 2^27 pixels of four floats are 2 GiB.
pub const MAX_PIXELS: u64 = 1 << 27;

/// How a channel's samples are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleKind {
    /// 16-bit float: near 1.0 its step is 1/2048.
    Half,
    /// 32-bit float.
    Float,
    /// 32-bit integer.
    Integer,
}

/// An EXR file's first layer.
#[derive(Clone, Debug)]
pub struct Channels {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Name, storage and `width * height` samples of each channel, row 0 at the top.
    pub channels: Vec<(String, SampleKind, Vec<f32>)>,
}

impl Channels {
    /// The samples of the channel called `name`.
    pub fn get(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|channel| channel.0 == name).map(|channel| &channel.2[..])
    }

    /// The names, for a message.
    pub fn names(&self) -> String {
        self.channels.iter().map(|channel| channel.0.as_str()).collect::<Vec<_>>().join(", ")
    }
}

/// Reads the first layer of an EXR file from memory, at full resolution, placed in the display
/// window; what the file's data window leaves out is `fill`.
///
/// # Errors
/// [`FileError::Malformed`] naming `path` where the bytes are not a whole, flat EXR file with a
/// size between 1 and [`MAX_PIXELS`].
pub fn decode_channels(path: &Path, bytes: &[u8], fill: f32) -> Result<Channels, FileError> {
    let bad = |place: &str, problem: String| {
        FileError::malformed(path, place, problem, "export the EXR file again")
    };
    // The reader is known to index out of bounds on some damaged files; a panic in it is an
    // error in the file.
    let guarded = |place: &str, result: std::thread::Result<exr::error::Result<_>>| match result {
        Ok(Ok(image)) => Ok(image),
        Ok(Err(error)) => Err(bad(place, error.to_string())),
        Err(_) => Err(bad(place, "the data make no sense".into())),
    };
    let meta =
        match catch_unwind(|| exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false)) {
            Ok(Ok(meta)) => meta,
            Ok(Err(error)) => return Err(bad("header", error.to_string())),
            Err(_) => return Err(bad("header", "the data make no sense".into())),
        };
    for header in &meta.headers {
        check_size(path, header.layer_size.0 as u64, header.layer_size.1 as u64)?;
        let window = header.shared_attributes.display_window.size;
        check_size(path, window.0 as u64, window.1 as u64)?;
    }
    let image = guarded(
        "pixels",
        catch_unwind(AssertUnwindSafe(|| {
            read()
                .no_deep_data()
                .largest_resolution_level()
                .all_channels()
                .first_valid_layer()
                .all_attributes()
                .non_parallel()
                .from_buffered(Cursor::new(bytes))
        })),
    )?;
    let layer = image.layer_data;
    let window = image.attributes.display_window;
    let offset = layer.attributes.layer_position - window.position;
    let size = window.size;
    let mut channels = Vec::new();
    for channel in &layer.channel_data.list {
        if channel.sampling.0 != 1 || channel.sampling.1 != 1 {
            let place = format!("channel {}", channel.name);
            return Err(bad(&place, "it has fewer samples than the picture has pixels".into()));
        }
        let (kind, samples) = match &channel.sample_data {
            FlatSamples::F16(values) => {
                (SampleKind::Half, values.iter().map(|value: &f16| value.to_f32()).collect())
            }
            FlatSamples::F32(values) => (SampleKind::Float, values.clone()),
            FlatSamples::U32(values) => {
                (SampleKind::Integer, values.iter().map(|&value| value as f32).collect::<Vec<_>>())
            }
        };
        let samples = if offset.0 == 0 && offset.1 == 0 && layer.size == size {
            samples
        } else {
            place_in_window(&samples, layer.size.into(), offset.into(), size.into(), fill)
        };
        channels.push((channel.name.to_string(), kind, samples));
    }
    Ok(Channels { width: size.0, height: size.1, channels })
}

/// Copies a data window's samples to where they stand in the display window.
fn place_in_window(
    samples: &[f32],
    (data_width, data_height): (usize, usize),
    (left, top): (i32, i32),
    (width, height): (usize, usize),
    fill: f32,
) -> Vec<f32> {
    let mut placed = vec![fill; width * height];
    for row in 0..data_height {
        for column in 0..data_width {
            let (x, y) = (column as i64 + i64::from(left), row as i64 + i64::from(top));
            if (0..width as i64).contains(&x) && (0..height as i64).contains(&y) {
                placed[y as usize * width + x as usize] = samples[row * data_width + column];
            }
        }
    }
    placed
}

/// Refuses sizes that no picture has, before anything of that size is allocated.
pub(crate) fn check_size(path: &Path, width: u64, height: u64) -> Result<(), FileError> {
    let remedy = "check that the file is whole and is what it says";
    if width == 0 || height == 0 {
        let problem = format!("the picture is {width} x {height} pixels");
        return Err(FileError::malformed(path, "header", problem, remedy));
    }
    if width.saturating_mul(height) > MAX_PIXELS {
        let problem =
            format!("the picture claims {width} x {height} pixels, over the limit of {MAX_PIXELS}");
        return Err(FileError::malformed(path, "header", problem, remedy));
    }
    Ok(())
}

/// Writes 32-bit float (or, where `half` says so, 16-bit) channels of `width * height` samples,
/// row 0 at the top.
///
/// # Errors
/// As [`write_atomically`]; [`FileError::Unsupported`] for an empty picture.
pub fn write_channels(
    path: &Path,
    width: usize,
    height: usize,
    channels: Vec<(&str, Vec<f32>)>,
    half: bool,
) -> Result<(), FileError> {
    if width == 0 || height == 0 || channels.iter().any(|(_, data)| data.len() != width * height) {
        return Err(FileError::unsupported(
            path,
            format!("a picture of {width} x {height} pixels cannot be written"),
            "give it at least one pixel",
        ));
    }
    let list = channels
        .into_iter()
        .map(|(name, samples)| {
            let samples = if half {
                FlatSamples::F16(samples.into_iter().map(f16::from_f32).collect())
            } else {
                FlatSamples::F32(samples)
            };
            AnyChannel::new(Text::new_or_panic(name), samples)
        })
        .collect();
    let layer = Layer::new(
        (width, height),
        LayerAttributes::default(),
        Encoding::FAST_LOSSLESS,
        AnyChannels::sort(list),
    );
    let image = Image::from_layer(layer);
    write_atomically(path, |writer| {
        image.write().to_buffered(writer).map_err(|error| match error {
            exr::error::Error::Io(error) => FileError::io(path, "write", error),
            other => FileError::unsupported(path, other.to_string(), "report this as a bug"),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_come_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let red: Vec<f32> = (0..35).map(|i| (i as f32).sqrt() - 2.0).collect();
        let mut green = red.clone();
        green[3] = f32::NAN;
        write_channels(&path, 7, 5, vec![("R", red.clone()), ("G", green.clone())], false).unwrap();
        let read = decode_channels(&path, &std::fs::read(&path).unwrap(), 0.0).unwrap();
        assert_eq!((read.width, read.height), (7, 5));
        assert_eq!(read.get("R").unwrap(), red);
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(read.get("G").unwrap()), bits(&green));
        assert!(read.channels.iter().all(|channel| channel.1 == SampleKind::Float));
    }

    #[test]
    fn a_cropped_data_window_is_put_in_its_place() {
        let placed = place_in_window(&[1.0, 2.0, 3.0, 4.0], (2, 2), (1, -1), (3, 2), 9.0);
        assert_eq!(placed, [9.0, 3.0, 4.0, 9.0, 9.0, 9.0]);
    }
}
