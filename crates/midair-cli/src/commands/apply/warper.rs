//! A film's frames made into the display's.

use super::Arguments;
use crate::failure::Failure;
use midair::map::Map;
use midair::picture::{
    Curve, DeepScratch, Drive, Evening, LightFrame, Picture, Warp, WarpError, srgb,
};

/// A map made ready, and how its frames are coded.
pub struct Warper {
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
        let warp = Warp::new(map, size, arguments.filter()).map_err(unfit)?;
        let drive = Drive::default().with_evening(evening);
        let (light, scratch) = (LightFrame::default(), DeepScratch::default());
        Ok(Self { warp, drive, deep, curve, light, scratch, samples: [Vec::new(), Vec::new()] })
    }

    /// The display's frame for a film's frame.
    pub fn apply(&mut self, frame: &[u8]) -> Result<Vec<u8>, Failure> {
        let [width, height] = self.warp.size();
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

/// A frame as a picture in linear light.
pub fn picture(frame: &[u8], [width, height]: [usize; 2], deep: bool, curve: Curve) -> Picture {
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
