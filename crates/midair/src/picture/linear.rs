//! A picture as the optics sees it.

use crate::Error;
use crate::map::format::MAX_PIXELS;

/// The longest side of a display or view, pixels.
pub const LONGEST: usize = 32_768;

/// Whether a display or view may have so many pixels: width, height.
///
/// # Errors
/// What is wrong with them, and what is possible.
pub fn check_size(size: [usize; 2]) -> Result<(), Error> {
    let [width, height] = size;
    if size.iter().any(|side| !(1..=LONGEST).contains(side)) {
        return Err(Error::request(
            format!("there is no picture of {width} x {height} pixels"),
            format!("give each side from 1 to {LONGEST} pixels"),
        ));
    }
    if width as u64 * height as u64 > MAX_PIXELS {
        return Err(Error::request(
            format!("{width} x {height} pixels are too large"),
            format!("ask for a smaller picture, of at most {MAX_PIXELS} pixels in all"),
        ));
    }
    Ok(())
}

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
