//! A picture as the optics sees it.

/// A still in linear light: premultiplied RGBA, sRGB primaries, 1.0 = the display's white.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row-major, row 0 at the top; each pixel is premultiplied linear R, G, B and alpha.
    pub pixels: Vec<[f32; 4]>,
}

impl Picture {
    /// A picture of one colour.
    pub fn filled(width: usize, height: usize, colour: [f32; 4]) -> Self {
        Self { width, height, pixels: vec![colour; width * height] }
    }
}
