//! OpenEXR files as named float channels: what both maps and pictures are kept in.

use super::FileError;
use crate::files::write_bytes_atomically;
use exr::block::reader::ChunksReader as _;
use exr::meta::MetaData;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, Text, Vec2,
    WritableImage, f16,
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

/// Channels of one part of an EXR file.
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
}

/// Reads the first flat part of an EXR file from memory, at full resolution, placed in the display
/// window; what the file's data window leaves out is `fill`.
///
/// # Errors
/// [`FileError::Malformed`] naming `path` where the bytes are not a whole, flat EXR file with a
/// size between 1 and [`MAX_PIXELS`].
pub fn decode_channels(path: &Path, bytes: &[u8], fill: f32) -> Result<Channels, FileError> {
    let file = ExrFile::open(path, bytes)?;
    let names: Vec<String> =
        file.headers()[file.first].channels.list.iter().map(|c| c.name.to_string()).collect();
    file.read(file.first, &names.iter().map(String::as_str).collect::<Vec<_>>(), fill)
}

/// An EXR file whose header has been read: channels are read from it by name, and no others cost anything.
pub(crate) struct ExrFile<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    meta: MetaData,
    /// The first part that is not deep.
    first: usize,
}

/// Deflate packs at most 1032 bytes in one; the other compressions pack less.
const MOST_PACKED: u64 = 1032;

/// A display window of so many times the pixels that are there is no frame around them.
const WIDEST_FRAME: u64 = 256;
/// Frames up to this size cost little enough to be filled whatever they hold.
const CHEAP_FRAME: u64 = 1 << 22;

impl<'a> ExrFile<'a> {
    /// Reads the header.
    pub(crate) fn open(path: &'a Path, bytes: &'a [u8]) -> Result<Self, FileError> {
        let bad = |problem: String| {
            FileError::malformed(path, "header", problem, "export the EXR file again")
        };
        // The reader is known to index out of bounds on some damaged files; a panic in it is an error in the file.
        let meta = match catch_unwind(|| MetaData::read_from_buffered(Cursor::new(bytes), false)) {
            Ok(Ok(meta)) => meta,
            Ok(Err(error)) => return Err(bad(error.to_string())),
            Err(_) => return Err(bad("the data make no sense".into())),
        };
        for header in &meta.headers {
            let data = (header.layer_size.0 as u64, header.layer_size.1 as u64);
            check_size(path, data.0, data.1)?;
            let window = header.shared_attributes.display_window.size;
            let window = (window.0 as u64, window.1 as u64);
            check_size(path, window.0, window.1)?;
            let (held, framed) = (data.0 * data.1, window.0 * window.1);
            if framed > CHEAP_FRAME && framed / WIDEST_FRAME > held {
                return Err(bad(format!(
                    "a display window of {} x {} pixels around {} x {} that are there",
                    window.0, window.1, data.0, data.1
                )));
            }
            let claimed = held.saturating_mul(header.channels.bytes_per_pixel as u64);
            if claimed / MOST_PACKED > bytes.len() as u64 {
                let problem = format!(
                    "{} x {} pixels cannot come from {} bytes",
                    data.0,
                    data.1,
                    bytes.len()
                );
                let remedy = "it seems cut short: copy or export it again";
                return Err(FileError::malformed(path, "header", problem, remedy));
            }
        }
        let Some(first) = meta.headers.iter().position(|header| !header.deep) else {
            return Err(bad("it holds deep samples only".into()));
        };
        Ok(Self { path, bytes, meta, first })
    }

    /// The parts, deep ones as well.
    pub(super) fn headers(&self) -> &[Header] {
        &self.meta.headers
    }

    /// The colours that red, green, blue and white are, as CIE x and y, where the file says.
    pub(crate) fn chromaticities(&self) -> Option<[[f32; 2]; 4]> {
        let told = self.meta.headers[self.first].shared_attributes.chromaticities?;
        Some([told.red, told.green, told.blue, told.white].map(|Vec2(x, y)| [x, y]))
    }

    /// Reads channels of one part, at full resolution, placed in the display window; what the part's data window leaves out is `fill`.
    pub(crate) fn read(
        &self,
        part: usize,
        names: &[&str],
        fill: f32,
    ) -> Result<Channels, FileError> {
        let bad = |place: &str, problem: &str| {
            FileError::malformed(self.path, place, problem, "export the EXR file again")
        };
        let header = &self.headers()[part];
        let mut places = vec![None; header.channels.list.len()];
        let mut channels = Vec::new();
        for (index, channel) in header.channels.list.iter().enumerate() {
            let name = channel.name.to_string();
            if !names.contains(&name.as_str()) {
                continue;
            }
            if channel.sampling != Vec2(1, 1) {
                let problem = "it has fewer samples than the picture has pixels";
                return Err(bad(&format!("channel {name}"), problem));
            }
            let kind = match channel.sample_type {
                SampleType::F16 => SampleKind::Half,
                SampleType::F32 => SampleKind::Float,
                SampleType::U32 => SampleKind::Integer,
            };
            places[index] = Some(channels.len());
            channels.push((name, kind, vec![fill; header.layer_size.area()]));
        }
        let mut rows = 0;
        let decoded = catch_unwind(AssertUnwindSafe(|| {
            let reader = exr::block::read(Cursor::new(self.bytes), false)?;
            let full = Vec2(0, 0);
            let chunks = reader
                .filter_chunks(false, |_, _, block| block.layer == part && block.level == full)?;
            chunks.decompress_sequential(false, |meta, block| {
                for line in block.lines(&meta.headers[part].channels) {
                    let at = line.location;
                    let Some(place) = places[at.channel] else { continue };
                    let (_, kind, samples) = &mut channels[place];
                    let start = at.position.1 * header.layer_size.0 + at.position.0;
                    let row = &mut samples[start..start + at.sample_count];
                    fill_row(row, *kind, line.value);
                    rows += at.sample_count;
                }
                Ok(())
            })
        }));
        match decoded {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(bad("pixels", &error.to_string())),
            Err(_) => return Err(bad("pixels", "the data make no sense")),
        }
        if rows < channels.len() * header.layer_size.area() {
            return Err(bad("pixels", "some rows are missing"));
        }
        let window = header.shared_attributes.display_window;
        let offset = header.own_attributes.layer_position - window.position;
        let (data, size) = (header.layer_size, window.size);
        if offset != Vec2(0, 0) || data != size {
            for (_, _, samples) in &mut channels {
                *samples = place_in_window(samples, data.into(), offset.into(), size.into(), fill);
            }
        }
        Ok(Channels { width: size.0, height: size.1, channels })
    }
}

/// A row's samples from their bytes, which are in the machine's order.
fn fill_row(row: &mut [f32], kind: SampleKind, bytes: &[u8]) {
    match kind {
        SampleKind::Half => {
            let halves = bytes.as_chunks::<2>().0;
            row.iter_mut().zip(halves).for_each(|(to, &b)| *to = f16::from_ne_bytes(b).to_f32());
        }
        SampleKind::Float => {
            let floats = bytes.as_chunks::<4>().0;
            row.iter_mut().zip(floats).for_each(|(to, &b)| *to = f32::from_ne_bytes(b));
        }
        SampleKind::Integer => {
            let numbers = bytes.as_chunks::<4>().0;
            row.iter_mut().zip(numbers).for_each(|(to, &b)| *to = u32::from_ne_bytes(b) as f32);
        }
    }
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
/// As [`write_bytes_atomically`]; [`FileError::Unsupported`] for an empty picture.
pub fn write_channels(
    path: &Path,
    width: usize,
    height: usize,
    channels: Vec<(&str, Vec<f32>)>,
    half: bool,
) -> Result<(), FileError> {
    write_bytes_atomically(path, &encode_channels(path, width, height, channels, half)?)
}

/// As [`write_channels`], into memory; `path` is named in errors.
///
/// # Errors
/// [`FileError::Unsupported`] for an empty picture.
pub(crate) fn encode_channels(
    path: &Path,
    width: usize,
    height: usize,
    channels: Vec<(&str, Vec<f32>)>,
    half: bool,
) -> Result<Vec<u8>, FileError> {
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
    let mut bytes = Cursor::new(Vec::new());
    // By several threads the blocks would come in an order of chance: the same map is to give the same bytes.
    image
        .write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(|error| FileError::unsupported(path, error.to_string(), "report this as a bug"))?;
    Ok(bytes.into_inner())
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
