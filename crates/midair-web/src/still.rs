//! Pictures.

use crate::fault::refused;
use midair::picture::{Picture, srgb};
use wasm_bindgen::prelude::*;

/// A picture in linear light.
#[wasm_bindgen]
#[derive(Clone)]
pub struct Still(Picture);

#[wasm_bindgen]
impl Still {
    /// Of opaque sRGB codes, R, G, B and alpha, the top row first: browsers decode files and obey their colour profiles by themselves.
    pub fn of_codes(width: usize, height: usize, codes: &[u8]) -> Result<Still, JsValue> {
        let (pixels, rest) = codes.as_chunks::<4>();
        if !rest.is_empty() || width.checked_mul(height) != Some(pixels.len()) || pixels.is_empty()
        {
            return Err(refused("this is no picture", "open one that the browser shows"));
        }
        let light: [f32; 256] =
            std::array::from_fn(|code| srgb::decode(code as f64 / 255.0) as f32);
        let pixel = |&[r, g, b, _]: &[u8; 4]| {
            let [r, g, b] = [r, g, b].map(|code| light[usize::from(code)]);
            [r, g, b, 1.0]
        };
        Ok(Self(Picture { width, height, pixels: pixels.iter().map(pixel).collect() }))
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
