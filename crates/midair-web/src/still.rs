//! Pictures.

use crate::fault::thrown;
use midair::picture::{Picture, decode_still, srgb};
use wasm_bindgen::prelude::*;

/// A picture in linear light.
#[wasm_bindgen]
#[derive(Clone)]
pub struct Still(Picture);

#[wasm_bindgen]
impl Still {
    /// Reads a PNG, JPEG, TIFF, WebP, BMP or OpenEXR file.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Still, JsValue> {
        Ok(Self(decode_still(name.as_ref(), bytes).map_err(thrown)?.picture))
    }

    /// Pixels in a row.
    #[wasm_bindgen(getter)]
    pub fn width(&self) -> usize {
        self.0.width
    }

    /// Rows.
    #[wasm_bindgen(getter)]
    pub fn height(&self) -> usize {
        self.0.height
    }

    /// Its sRGB codes: R, G, B and an alpha of 255.
    pub fn rgba(&self) -> Vec<u8> {
        codes(&self.0)
    }
}

impl Still {
    pub(crate) fn of(picture: Picture) -> Self {
        Self(picture)
    }

    pub(crate) fn picture(&self) -> &Picture {
        &self.0
    }
}

/// A picture's sRGB codes, opaque.
pub fn codes(picture: &Picture) -> Vec<u8> {
    let pixel = |&[r, g, b, _]: &[f32; 4]| {
        let [r, g, b] = [r, g, b].map(srgb::encode_8);
        [r, g, b, u8::MAX]
    };
    picture.pixels.iter().flat_map(pixel).collect()
}
