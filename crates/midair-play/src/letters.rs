//! Text over the show.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Pixels from the picture's edges to the text, and between its lines.
const MARGIN: usize = 6;
const LEADING: usize = 2;

/// Columns and rows from the upper left that lines of text reach into.
pub(crate) fn extent(lines: &[String]) -> [usize; 2] {
    let size = RasterHeight::Size16;
    let longest = lines.iter().map(|line| line.chars().count()).max();
    longest.map_or([0; 2], |longest| {
        let advance = get_raster_width(FontWeight::Regular, size);
        [MARGIN + longest * advance, MARGIN + lines.len() * (size.val() + LEADING)]
    })
}

/// Writes lines of white text on a dark ground at the upper left of a picture of 0RGB pixels.
pub(crate) fn overlay(pixels: &mut [u32], width: usize, lines: &[String]) {
    let (size, weight) = (RasterHeight::Size16, FontWeight::Regular);
    let advance = get_raster_width(weight, size);
    let height = pixels.len() / width.max(1);
    for (index, line) in lines.iter().enumerate() {
        let top = MARGIN + index * (size.val() + LEADING);
        for (column, character) in line.chars().enumerate() {
            let Some(glyph) =
                get_raster(character, weight, size).or_else(|| get_raster('?', weight, size))
            else {
                continue;
            };
            for y in 0..glyph.height() {
                for x in 0..glyph.width() {
                    let level = u32::from(glyph.pixel(x, y).unwrap_or(0)).max(24);
                    let (x, y) = (MARGIN + column * advance + x, top + y);
                    if x < width && y < height {
                        pixels[y * width + x] = level << 16 | level << 8 | level;
                    }
                }
            }
        }
    }
}
