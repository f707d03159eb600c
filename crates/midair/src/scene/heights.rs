//! Height samples from a picture.

use crate::geometry::HeightField;
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, read as exr_file};
use image::{DynamicImage, ImageFormat, ImageReader, Limits};
use std::io::Cursor;
use std::sync::{Arc, Mutex, PoisonError};

/// More pixels on a side than this are not a height-field that is traced.
const MOST_SIDE: u32 = 8192;

/// The samples of a height field's picture, with the surface last fitted to them.
#[derive(Debug)]
pub struct Heights {
    rows: Vec<Vec<f64>>,
    fitted: Mutex<Option<Fitted>>,
}

/// A surface, and what it was fitted for.
#[derive(Clone, Debug)]
struct Fitted {
    size: [f64; 2],
    amplitude: f64,
    depth: Option<f64>,
    field: Arc<HeightField>,
}

impl Heights {
    /// Of rows of one length, the first at the +y edge, before the amplitude.
    pub fn new(rows: Vec<Vec<f64>>) -> Self {
        Self { rows, fitted: Mutex::default() }
    }

    /// The rows, the first at the +y edge, before the amplitude.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }

    /// The surface of this size and amplitude in mm, of a solid that reaches `depth` mm below it. The last one is kept, so that a
    /// scene in which something is moved need not fit it again.
    pub fn field(&self, size: [f64; 2], amplitude: f64, depth: Option<f64>) -> Arc<HeightField> {
        // A panic while it was held has left it as it was.
        let mut fitted = self.fitted.lock().unwrap_or_else(PoisonError::into_inner);
        match &*fitted {
            Some(f) if (f.size, f.amplitude, f.depth) == (size, amplitude, depth) => {
                Arc::clone(&f.field)
            }
            _ => {
                let field = Arc::new(fit(&self.rows, size, amplitude, depth));
                *fitted = Some(Fitted { size, amplitude, depth, field: Arc::clone(&field) });
                field
            }
        }
    }
}

/// The surface through samples times an amplitude.
pub(crate) fn fit(
    rows: &[Vec<f64>],
    size: [f64; 2],
    amplitude: f64,
    depth: Option<f64>,
) -> HeightField {
    let heights: Vec<Vec<f64>> =
        rows.iter().map(|row| row.iter().map(|h| h * amplitude).collect()).collect();
    HeightField::new(&heights, size, depth)
}

/// One number for each pixel, the top row first.
struct Samples {
    width: usize,
    values: Vec<f64>,
}

/// The samples of a grey picture, the top row first: 0 to 1 for 8 and 16 bit, as they are for
/// EXR. A picture in colour gives its first channel where the three are equal, else an error.
///
/// The error is a message that names the file, `name`.
pub(super) fn decode(bytes: &[u8], name: &str) -> Result<Vec<Vec<f64>>, String> {
    let samples = match image::guess_format(bytes) {
        // The reader is known to index out of bounds on some damaged files.
        Ok(ImageFormat::OpenExr) => std::panic::catch_unwind(|| of_exr(bytes))
            .unwrap_or_else(|_| Err("is a damaged EXR picture".to_owned())),
        _ => of_picture(bytes),
    };
    let Samples { width, values } = samples.map_err(|problem| format!("{name}: {problem}"))?;
    let height = values.len() / width.max(1);
    if width < 2 || height < 2 {
        return Err(format!("{name}: has only {width} x {height} pixels"));
    }
    if let Some(at) = values.iter().position(|s| !s.is_finite()) {
        return Err(format!(
            "{name}: pixel [{}, {}] is not a finite number",
            at % width,
            at / width
        ));
    }
    Ok(values.chunks(width).map(<[f64]>::to_vec).collect())
}

const COLOURED: &str = "is not grey: its colours stand for no height";

fn of_picture(bytes: &[u8]) -> Result<Samples, String> {
    let unfit = |e: String| format!("is no picture: {e}");
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|e| unfit(e.to_string()))?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_SIDE);
    limits.max_image_height = Some(MOST_SIDE);
    reader.limits(limits);
    let picture = reader.decode().map_err(|e| unfit(e.to_string()))?;
    let width = picture.width() as usize;
    Ok(Samples { width, values: grey(picture).ok_or(COLOURED)? })
}

/// Of an EXR file the first flat part: its channel Y, the only one beside A, or R where G and B equal it.
fn of_exr(bytes: &[u8]) -> Result<Samples, String> {
    let unfit = |e: String| format!("is no EXR picture: {e}");
    let header = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|e| unfit(e.to_string()))?;
    let most = MOST_SIDE as usize;
    if header.headers.iter().any(|h| h.layer_size.0 > most || h.layer_size.1 > most) {
        return Err(format!("has more than {most} pixels on a side"));
    }
    let image = exr_file()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| unfit(e.to_string()))?;
    let channels = &image.layer_data.channel_data.list;
    let named = |name: &str| {
        let found =
            channels.iter().find(|channel| channel.name.to_string().eq_ignore_ascii_case(name));
        found.map(|channel| wide(&channel.sample_data))
    };
    let heights: Vec<_> = channels
        .iter()
        .filter(|channel| !channel.name.to_string().eq_ignore_ascii_case("a"))
        .collect();
    let values = match (named("y"), &heights[..], [named("r"), named("g"), named("b")]) {
        (Some(y), ..) => y,
        (None, [only], _) => wide(&only.sample_data),
        (None, _, [Some(r), Some(g), Some(b)]) => {
            let equal = |((&r, &g), &b): ((&f64, &f64), &f64)| (r == g && g == b) || r.is_nan();
            if !r.iter().zip(&g).zip(&b).all(equal) {
                return Err(COLOURED.to_owned());
            }
            r
        }
        _ => {
            let names: Vec<String> = channels.iter().map(|c| c.name.to_string()).collect();
            return Err(format!("has the channels {}, and none of them is Y", names.join(", ")));
        }
    };
    Ok(Samples { width: image.layer_data.size.0, values })
}

fn wide(samples: &FlatSamples) -> Vec<f64> {
    match samples {
        FlatSamples::F16(values) => values.iter().map(|v| v.to_f64()).collect(),
        FlatSamples::F32(values) => values.iter().map(|&v| f64::from(v)).collect(),
        FlatSamples::U32(values) => values.iter().map(|&v| f64::from(v)).collect(),
    }
}

/// One number per pixel; `None` for a picture with colours.
fn grey(picture: DynamicImage) -> Option<Vec<f64>> {
    let equal = |[r, g, b]: [f64; 3]| ((r == g && g == b) || r.is_nan()).then_some(r);
    match picture {
        DynamicImage::ImageLuma8(p) => Some(p.pixels().map(|p| f64::from(p[0]) / 255.0).collect()),
        DynamicImage::ImageLuma16(p) => {
            Some(p.pixels().map(|p| f64::from(p[0]) / 65535.0).collect())
        }
        DynamicImage::ImageLumaA8(_)
        | DynamicImage::ImageRgb8(_)
        | DynamicImage::ImageRgba8(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => picture
            .to_rgb16()
            .pixels()
            .map(|p| equal(p.0.map(|c| f64::from(c) / 65535.0)))
            .collect(),
        _ => picture.to_rgb32f().pixels().map(|p| equal(p.0.map(f64::from))).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, Image, Layer, LayerAttributes, Text, WritableImage,
    };

    /// A picture of 3 x 2 pixels with these channels.
    fn exr_of(channels: &[(&str, [f32; 6])]) -> Vec<u8> {
        let list = channels.iter().map(|(name, samples)| {
            AnyChannel::new(Text::new_or_panic(name), FlatSamples::F32(samples.to_vec()))
        });
        let attributes = LayerAttributes::default();
        let layer = Layer::new(
            (3, 2),
            attributes,
            Encoding::FAST_LOSSLESS,
            AnyChannels::sort(list.collect()),
        );
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn a_surface_is_fitted_once_while_nothing_of_it_changes() {
        let heights = Heights::new(vec![vec![0.0, 1.0], vec![0.5, 0.25]]);
        let first = heights.field([20.0, 10.0], 2.0, Some(5.0));
        assert!(Arc::ptr_eq(&first, &heights.field([20.0, 10.0], 2.0, Some(5.0))));
        for (size, amplitude, depth) in [
            ([20.0, 11.0], 2.0, Some(5.0)),
            ([20.0, 10.0], 3.0, Some(5.0)),
            ([20.0, 10.0], 2.0, None),
        ] {
            let other = heights.field(size, amplitude, depth);
            assert!(!Arc::ptr_eq(&first, &other));
            assert!(!Arc::ptr_eq(&other, &heights.field([20.0, 10.0], 2.0, Some(5.0))));
        }
    }

    #[test]
    fn grey_exr_pictures_are_read_whatever_their_channel_is_called() {
        let heights = [0.0, 0.25, 0.5, 0.75, 1.0, 2.0f32];
        let rows = vec![vec![0.0, 0.25, 0.5], vec![0.75, 1.0, 2.0]];
        let other = [7.0; 6];
        for channels in [
            &[("Y", heights)][..],
            &[("Y", heights), ("A", other)],
            &[("A", other), ("Z", heights)],
            &[("R", heights), ("G", heights), ("B", heights)],
        ] {
            assert_eq!(decode(&exr_of(channels), "a.exr").as_ref(), Ok(&rows), "{channels:?}");
        }
        let coloured = exr_of(&[("R", heights), ("G", other), ("B", heights)]);
        assert!(decode(&coloured, "a.exr").unwrap_err().contains("not grey"));
        let vectors = exr_of(&[("U", heights), ("V", other)]);
        assert!(decode(&vectors, "a.exr").unwrap_err().contains("U, V"));
        assert!(decode(&coloured[..40], "a.exr").unwrap_err().starts_with("a.exr: "));
    }
}
