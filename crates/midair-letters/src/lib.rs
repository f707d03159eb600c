//! Letters as pixels, without a font on the machine.
//!
//! Latin letters are Noto Sans Mono's, smoothed. What that lacks is GNU Unifont's, which has a glyph of 16 pixels for every character of Unicode's Basic
//! Multilingual Plane: names of elements and files are written in the script of the laboratory.

use noto_sans_mono_bitmap::{
    FontWeight, RasterHeight, RasterizedChar, get_raster, get_raster_width,
};

/// How high a line of text is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// 16 pixels.
    Small,
    /// 20 pixels.
    Medium,
    /// 32 pixels.
    Large,
}

impl Size {
    fn raster(self) -> RasterHeight {
        match self {
            Self::Small => RasterHeight::Size16,
            Self::Medium => RasterHeight::Size20,
            Self::Large => RasterHeight::Size32,
        }
    }

    /// Pixels from the top of a line to its bottom.
    pub fn height(self) -> usize {
        self.raster().val()
    }

    /// A character's pixels. What no font has is a question mark.
    pub fn glyph(self, character: char) -> Glyph {
        let latin = |character| get_raster(character, FontWeight::Regular, self.raster());
        let (height, scale) = (self.height(), self.height() / UNIFONT);
        if let Some(raster) = latin(character) {
            return Glyph { width: raster.width(), height, pixels: Pixels::Smooth(raster) };
        }
        if let Some(bits) = unifont::get_glyph(character) {
            let width = bits.get_width() * scale;
            return Glyph { width, height, pixels: Pixels::Bits { bits, scale } };
        }
        let pixels = latin('?').map_or(Pixels::None, Pixels::Smooth);
        Glyph { width: get_raster_width(FontWeight::Regular, self.raster()), height, pixels }
    }

    /// Pixels that a text takes in width.
    pub fn width(self, text: &str) -> usize {
        text.chars().map(|character| self.glyph(character).width()).sum()
    }
}

/// The height of GNU Unifont's glyphs.
const UNIFONT: usize = 16;

/// A character's pixels.
#[derive(Debug)]
pub struct Glyph {
    width: usize,
    height: usize,
    pixels: Pixels,
}

#[derive(Debug)]
enum Pixels {
    Smooth(RasterizedChar),
    Bits { bits: &'static unifont::Glyph, scale: usize },
    None,
}

impl Glyph {
    /// Pixels to the next character.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels from top to bottom.
    pub fn height(&self) -> usize {
        self.height
    }

    /// How much of a pixel, counted from the top left, is ink: 0 to 255; 0 outside.
    pub fn cover(&self, x: usize, y: usize) -> u8 {
        match &self.pixels {
            Pixels::Smooth(raster) => raster.pixel(x, y).unwrap_or(0),
            Pixels::Bits { bits, scale } => {
                // In the middle of a line that is not a multiple of 16 pixels high.
                let above = (self.height - UNIFONT * scale) / 2;
                let row = y.checked_sub(above).map(|y| y / scale);
                match row.is_some_and(|row| bits.get_pixel(x / scale, row)) {
                    true => 255,
                    false => 0,
                }
            }
            Pixels::None => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [Size; 3] = [Size::Small, Size::Medium, Size::Large];

    fn ink(glyph: &Glyph) -> Vec<u8> {
        let rows = 0..glyph.height();
        rows.flat_map(|y| (0..glyph.width()).map(move |x| (x, y)))
            .map(|(x, y)| glyph.cover(x, y))
            .collect()
    }

    #[test]
    fn every_script_has_letters_of_its_own() {
        for size in SIZES {
            let unknown = ink(&size.glyph('?'));
            let mut seen = vec![unknown];
            for character in "aÄжλדش試験装置のガ円유리杯".chars() {
                let glyph = size.glyph(character);
                assert_eq!(glyph.height(), size.height());
                let ink = ink(&glyph);
                assert!(ink.iter().any(|&cover| cover > 0), "{character}");
                assert!(!seen.contains(&ink), "{character}");
                seen.push(ink);
            }
        }
    }

    #[test]
    fn a_glyph_of_bits_is_what_its_font_says() {
        // U+2588 FULL BLOCK fills its cell; U+4E00 is one stroke from side to side.
        for size in SIZES {
            let stroke = size.glyph('一');
            let scale = size.height() / 16;
            assert_eq!(stroke.width(), 16 * scale);
            let rows: Vec<usize> = (0..size.height())
                .filter(|&y| {
                    (0..stroke.width()).filter(|&x| stroke.cover(x, y) > 0).count() > 12 * scale
                })
                .collect();
            assert_eq!(rows.len(), scale, "{size:?}: {rows:?}");
            // Nothing beyond the cell.
            assert_eq!(stroke.cover(16 * scale, rows[0]), 0);
            assert_eq!(stroke.cover(0, size.height()), 0);
        }
    }

    #[test]
    fn a_line_is_as_wide_as_its_letters() {
        let latin = Size::Small.width("ab");
        assert_eq!(latin, 2 * Size::Small.glyph('b').width());
        assert_eq!(Size::Small.width("aガb杯"), latin + 2 * 16);
        assert_eq!(Size::Large.width("杯"), 32);
        // Beyond the Basic Multilingual Plane there is a question mark.
        assert_eq!(Size::Small.width("\u{1f600}"), latin / 2);
    }
}
