//! Maps.

use crate::fault::{data, thrown};
use crate::files::File;
use crate::still::{Still, codes};
use midair::compensate::{Compensation, Options, uncompensated_map};
use midair::map::Map;
use midair::map::format::{Format, UnknownFormat, put_map};
use midair::picture::{Depth, Overflow, display_image, encode_still};
use midair::transport::Setup;
use serde_json::json;
use std::path::Path;
use wasm_bindgen::prelude::*;

/// A set-up's map on a display.
#[wasm_bindgen]
pub struct Solution {
    compensation: Compensation,
}

#[wasm_bindgen]
impl Solution {
    /// Display pixels in a row.
    #[wasm_bindgen(getter)]
    pub fn width(&self) -> usize {
        self.map().width
    }

    /// Rows.
    #[wasm_bindgen(getter)]
    pub fn height(&self) -> usize {
        self.map().height
    }

    /// Upper bound of the error of all pixels that are ok, in widths of the image.
    #[wasm_bindgen(getter)]
    pub fn error_bound(&self) -> f64 {
        self.map().error_bound
    }

    /// Pixels by status.
    #[wasm_bindgen(unchecked_return_type = "Counts")]
    pub fn counts(&self) -> JsValue {
        data(&json!(self.map().counts()))
    }

    /// For each pixel, row 0 at the top: u, v, its status (0 ok, 1 folded, 2 outside, 3 blocked), and 1 where it has an answer, else 0.
    pub fn pixels(&self) -> Vec<f32> {
        let map = self.map();
        let pixel = |pixel: usize| {
            let status = f32::from(map.status[pixel] as u8);
            match map.answer(pixel) {
                Some([u, v]) => [u as f32, v as f32, status, 1.0],
                None => [0.0, 0.0, status, 0.0],
            }
        };
        (0..map.uv.len()).flat_map(pixel).collect()
    }

    /// The light that the display must emit to show a picture.
    pub fn light(&self, picture: &Still) -> Still {
        Still::of(self.compensation.light(picture.picture()))
    }

    /// The light of a display that shows the picture as it is.
    pub fn uncompensated_light(&self, picture: &Still) -> Still {
        Still::of(display_image(picture.picture(), &uncompensated_map(self.setup())))
    }

    /// What the display is sent to show a picture: sRGB codes. `even`: the gain is divided out, as far as the display is bright enough.
    pub fn display(&self, picture: &Still, even: bool) -> Vec<u8> {
        codes(&self.shown(picture, even))
    }

    /// The same as a file, PNG or OpenEXR by its name.
    pub fn display_file(&self, picture: &Still, even: bool, name: &str) -> Result<File, JsValue> {
        let path = Path::new(name);
        let bytes = encode_still(path, &self.shown(picture, even), Depth::Eight);
        Ok(File::new(path, &bytes.map_err(thrown)?))
    }

    /// The map as files of a format, for a picture of so many pixels.
    pub fn files(&self, format: &str, width: usize, height: usize) -> Result<Vec<File>, JsValue> {
        let format: Format = format.parse().map_err(|error: UnknownFormat| {
            let remedy = "choose one of the list";
            thrown(midair::Error::request(error.to_string(), remedy))
        })?;
        let mut files = Vec::new();
        let mut put = |path: &Path, bytes: &[u8]| {
            files.push(File::new(path, bytes));
            Ok(())
        };
        let path = Path::new(format.file_name());
        put_map(self.map(), None, [width, height], format, path, &mut put).map_err(thrown)?;
        Ok(files)
    }
}

impl Solution {
    pub(crate) fn of(setup: Setup) -> Self {
        Self { compensation: Compensation::of(&setup, &Options::new(), &()) }
    }

    pub(crate) fn map(&self) -> &Map {
        self.compensation.map()
    }

    fn setup(&self) -> &Setup {
        self.compensation.setup()
    }

    fn shown(&self, picture: &Still, even: bool) -> midair::picture::Picture {
        let picture = picture.picture();
        match even {
            false => self.compensation.display(picture).display,
            true => {
                let even = self.compensation.clone().with_gain(Overflow::Fit, &());
                even.display(picture).display
            }
        }
    }
}
