//! A film's frames made into the display's.

use super::Arguments;
use crate::failure::Failure;
use midair::map::Map;
use midair::picture::colour::ToSrgb;
use midair::picture::{
    Crop, Curve, DeepScratch, Drive, Evening, LightFrame, Picture, Warp, WarpError, srgb, wide,
};

/// A map made ready, and how its frames are coded.
pub struct Warper {
    /// What is shown of a frame.
    crop: Crop,
    warp: Warp,
    /// With the gain that is divided out.
    drive: Drive,
    deep: bool,
    curve: Curve,
    light: LightFrame,
    scratch: DeepScratch,
    samples: [Vec<u16>; 2],
}

impl Warper {
    pub fn new(
        arguments: &Arguments,
        map: &Map,
        size: [usize; 2],
        evening: Option<Evening>,
        deep: bool,
        curve: Curve,
    ) -> Result<Self, Failure> {
        let crop = arguments.crop(size);
        let warp = Warp::new(map, crop.to, arguments.filter()).map_err(unfit)?;
        let drive = Drive::default().with_evening(evening);
        let (light, scratch) = (LightFrame::default(), DeepScratch::default());
        Ok(Self {
            crop,
            warp,
            drive,
            deep,
            curve,
            light,
            scratch,
            samples: [Vec::new(), Vec::new()],
        })
    }

    /// The display's frame for a film's frame.
    pub fn apply(&mut self, frame: &[u8]) -> Result<Vec<u8>, Failure> {
        let [width, height] = self.warp.size();
        let bytes = if self.deep { 6 } else { 3 };
        let [columns, rows] = self.crop.from;
        // A frame of another size is refused below.
        let cropped = (!self.crop.is_whole() && frame.len() == columns * rows * bytes)
            .then(|| self.crop.frame(frame, bytes));
        let frame = cropped.as_deref().unwrap_or(frame);
        if !self.deep {
            let mut output = vec![0; width * height * 3];
            self.light.decode(frame, 3).map_err(unfit)?;
            self.warp.apply_light(&self.light, 3, &self.drive, &mut output).map_err(unfit)?;
            return Ok(output);
        }
        let [input, output] = &mut self.samples;
        input.clear();
        input.extend(frame.as_chunks::<2>().0.iter().map(|&bytes| u16::from_le_bytes(bytes)));
        output.resize(width * height * 3, 0);
        let evening = self.drive.evening();
        self.warp
            .apply_deep(input, self.curve, evening, &mut self.scratch, output)
            .map_err(unfit)?;
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

/// A frame as a picture in linear light with sRGB's primaries, to which `matrix` leads. Light of a wide range is brought into a display's, unless
/// `whole` asks for all of it.
pub fn picture(
    frame: &[u8],
    [width, height]: [usize; 2],
    deep: bool,
    curve: Curve,
    matrix: Option<&ToSrgb>,
    whole: bool,
) -> Picture {
    let mut picture = Picture::filled(width, height, [0.0, 0.0, 0.0, 1.0]);
    let is_wide = matches!(curve, Curve::Pq | Curve::Hlg);
    let table: Vec<f32> = match deep {
        true => (0..=u16::MAX).map(|c| curve.decode(f64::from(c) / 65535.0) as f32).collect(),
        false => (0..=u8::MAX).map(srgb::decode_8).collect(),
    };
    for (i, pixel) in picture.pixels.iter_mut().enumerate() {
        let light: [f32; 3] = std::array::from_fn(|c| {
            let at = 3 * i + c;
            table[match deep {
                true => usize::from(u16::from_le_bytes([frame[2 * at], frame[2 * at + 1]])),
                false => usize::from(frame[at]),
            }]
        });
        let light = match is_wide {
            true => wide::display_light(curve, light.map(f64::from)).map(|light| light as f32),
            false => light,
        };
        let light = matrix.map_or(light, |matrix| matrix.apply(light));
        let light = match is_wide && !whole {
            true => wide::shown(light),
            false => light.map(|light| light.max(0.0)),
        };
        pixel[..3].copy_from_slice(&light);
    }
    picture
}
