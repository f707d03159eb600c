//! Text in pictures.

use midair::picture::Picture;
use midair_letters::{Glyph, Size};

/// A size of text.
#[derive(Clone, Copy, Debug)]
pub struct Lettering {
    size: Size,
    /// Linear-light colour.
    colour: [f32; 3],
}

impl Lettering {
    /// 16 pixels high.
    pub fn small(colour: [f32; 3]) -> Self {
        Self { size: Size::Small, colour }
    }

    /// 20 pixels high.
    pub fn medium(colour: [f32; 3]) -> Self {
        Self { size: Size::Medium, colour }
    }

    /// 32 pixels high.
    pub fn large(colour: [f32; 3]) -> Self {
        Self { size: Size::Large, colour }
    }

    /// Pixels that a line of text takes in height.
    pub fn height(self) -> usize {
        self.size.height()
    }

    /// Pixels that a text takes in width.
    pub fn width(self, text: &str) -> usize {
        self.size.width(text)
    }

    /// Writes a text with its top left corner at a pixel. What reaches beyond the picture is cut off.
    pub fn write(self, picture: &mut Picture, text: &str, [left, top]: [usize; 2]) {
        self.enlarged(picture, text, [left as f64, top as f64], 1.0);
    }

    /// Writes a text `scale` times as large.
    pub fn enlarged(self, picture: &mut Picture, text: &str, [left, top]: [f64; 2], scale: f64) {
        let mut left = left;
        for character in text.chars() {
            let glyph = self.size.glyph(character);
            self.glyph(picture, &glyph, [left, top], scale);
            left += glyph.width() as f64 * scale;
        }
    }

    fn glyph(self, picture: &mut Picture, glyph: &Glyph, [left, top]: [f64; 2], scale: f64) {
        let cover = |x: isize, y: isize| -> f64 {
            let place = usize::try_from(x).ok().zip(usize::try_from(y).ok());
            f64::from(place.map_or(0, |(x, y)| glyph.cover(x, y))) / 255.0
        };
        let end =
            |start: f64, length: usize| (start + length as f64 * scale).ceil().max(0.0) as usize;
        for row in top.max(0.0) as usize..end(top, glyph.height()).min(picture.height) {
            for column in left.max(0.0) as usize..end(left, glyph.width()).min(picture.width) {
                // Between the glyph's own pixels its cover is interpolated.
                let x = (column as f64 + 0.5 - left) / scale - 0.5;
                let y = (row as f64 + 0.5 - top) / scale - 0.5;
                let (i, j) = (x.floor(), y.floor());
                let (a, b) = (x - i, y - j);
                let (i, j) = (i as isize, j as isize);
                let alpha = (1.0 - a) * (1.0 - b) * cover(i, j)
                    + a * (1.0 - b) * cover(i + 1, j)
                    + (1.0 - a) * b * cover(i, j + 1)
                    + a * b * cover(i + 1, j + 1);
                // Enlarged, an edge stays one pixel wide: it runs where the cover is a half.
                let alpha =
                    if scale > 1.0 { ((alpha - 0.5) * scale + 0.5).clamp(0.0, 1.0) } else { alpha };
                let pixel = &mut picture.pixels[row * picture.width + column];
                for (value, ink) in pixel.iter_mut().zip(self.colour) {
                    *value += alpha as f32 * (ink - *value);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_drawn_within_its_box_and_cut_off_at_the_border() {
        let mut picture = Picture::filled(100, 40, [0.0, 0.0, 0.0, 1.0]);
        let letters = Lettering::small([1.0; 3]);
        letters.write(&mut picture, "Hi \u{4e16}", [10, 12]);
        let inked = |x: usize, y: usize| picture.pixels[y * 100 + x][0] > 0.3;
        let all: Vec<(usize, usize)> = (0..40)
            .flat_map(|y| (0..100).map(move |x| (x, y)))
            .filter(|&(x, y)| inked(x, y))
            .collect();
        assert!(all.len() > 30);
        let right = 10 + letters.width("Hi \u{4e16}");
        assert!(
            all.iter().all(|&(x, y)| x >= 10 && x < right && y >= 12 && y < 12 + letters.height())
        );
        // Nothing to see beyond the border, and no panic.
        letters.enlarged(&mut picture, "far away", [95.0, -7.0], 3.0);
        letters.write(&mut picture, "x", [1000, 1000]);
    }
}
