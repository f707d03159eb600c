//! Text over the show.

use midair_letters::Size;

/// Pixels from the picture's edges to the text, and between its lines.
const MARGIN: usize = 6;
const LEADING: usize = 2;
const SIZE: Size = Size::Small;

/// Columns and rows from the upper left that lines of text reach into.
pub(crate) fn extent(lines: &[String]) -> [usize; 2] {
    let widest = lines.iter().map(|line| SIZE.width(line)).max();
    widest.map_or([0; 2], |widest| {
        [MARGIN + widest, MARGIN + lines.len() * (SIZE.height() + LEADING)]
    })
}

/// Writes lines of white text on a dark ground at the upper left of a picture of 0RGB pixels.
pub(crate) fn overlay(pixels: &mut [u32], width: usize, lines: &[String]) {
    let height = pixels.len() / width.max(1);
    for (index, line) in lines.iter().enumerate() {
        let top = MARGIN + index * (SIZE.height() + LEADING);
        let mut left = MARGIN;
        for character in line.chars() {
            let glyph = SIZE.glyph(character);
            for y in 0..glyph.height() {
                for x in 0..glyph.width() {
                    let level = u32::from(glyph.cover(x, y)).max(24);
                    let (x, y) = (left + x, top + y);
                    if x < width && y < height {
                        pixels[y * width + x] = level << 16 | level << 8 | level;
                    }
                }
            }
            left += glyph.width();
        }
    }
}
