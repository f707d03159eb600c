//! Text over the show.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Text drawn for a picture of a certain size, and drawn again when it or the size changes.
#[derive(Default)]
pub(crate) struct Letters {
    lines: Vec<String>,
    picture: [usize; 2],
    /// Columns and rows of the picture's upper left that the text takes.
    pub size: [usize; 2],
    /// A 0RGB word for each of these pixels; 0 where the picture is to be seen.
    pub words: Vec<u32>,
}

/// How large letters are: legible from where the picture as a whole is seen.
#[derive(Clone, Copy)]
struct Lettering {
    raster: RasterHeight,
    /// Pixels that stand for one of the letter's.
    scale: usize,
}

impl Lettering {
    /// For a picture of so many rows: they hold 30 to 50 lines.
    fn of(rows: usize) -> Self {
        match rows {
            0..700 => Self { raster: RasterHeight::Size16, scale: 1 },
            700..1000 => Self { raster: RasterHeight::Size20, scale: 1 },
            _ => Self { raster: RasterHeight::Size32, scale: rows / 1000 },
        }
    }

    fn width(self) -> usize {
        get_raster_width(FontWeight::Regular, self.raster) * self.scale
    }

    fn height(self) -> usize {
        self.raster.val() * self.scale
    }
}

/// The ground that letters stand on; they are lighter.
const GROUND: u32 = 0x18_18_18;

impl Letters {
    /// Draws lines of text; what is too long for the picture goes on in the next line.
    pub fn write(&mut self, lines: Vec<String>, picture: [usize; 2]) {
        if lines == self.lines && picture == self.picture {
            return;
        }
        let lettering = Lettering::of(picture[1]);
        let columns = (picture[0] / lettering.width()).max(1);
        let rows: Vec<String> = lines.iter().flat_map(|line| broken(line, columns)).collect();
        let longest = rows.iter().map(|row| row.chars().count()).max().unwrap_or(0);
        self.size = [
            (longest * lettering.width()).min(picture[0]),
            (rows.len() * lettering.height()).min(picture[1]),
        ];
        self.words.clear();
        self.words.resize(self.size[0] * self.size[1], 0);
        for (row, text) in rows.iter().enumerate() {
            let width = (text.chars().count() * lettering.width()).min(self.size[0]);
            let lines = row * lettering.height()..(row + 1) * lettering.height();
            for y in lines.take_while(|&y| y < self.size[1]) {
                self.words[y * self.size[0]..][..width].fill(GROUND);
            }
            for (column, character) in text.chars().enumerate() {
                let place = [column * lettering.width(), row * lettering.height()];
                self.letter(character, place, lettering);
            }
        }
        (self.lines, self.picture) = (lines, picture);
    }

    fn letter(&mut self, character: char, [left, top]: [usize; 2], lettering: Lettering) {
        let drawn = |c| get_raster(c, FontWeight::Regular, lettering.raster);
        let Some(glyph) = drawn(character).or_else(|| drawn('?')) else { return };
        let Lettering { scale, .. } = lettering;
        for y in 0..glyph.height() * scale {
            for x in 0..glyph.width() * scale {
                let level = u32::from(glyph.pixel(x / scale, y / scale).unwrap_or(0));
                if left + x < self.size[0] && top + y < self.size[1] {
                    let word = level << 16 | level << 8 | level;
                    self.words[(top + y) * self.size[0] + left + x] = word.max(GROUND);
                }
            }
        }
    }

    /// Lays the text over a picture of 0RGB pixels.
    pub fn lay_over(&self, pixels: &mut [u32], width: usize) {
        if self.size[0] == 0 {
            return;
        }
        for (row, words) in
            pixels.chunks_exact_mut(width).zip(self.words.chunks_exact(self.size[0]))
        {
            for (pixel, &word) in row.iter_mut().zip(words).filter(|(_, word)| **word != 0) {
                *pixel = word;
            }
        }
    }
}

/// A line in pieces of no more than so many letters, parted at blanks where there are some.
fn broken(line: &str, columns: usize) -> Vec<String> {
    let letters: Vec<char> = line.chars().collect();
    let (mut rest, mut pieces) = (&letters[..], Vec::new());
    while rest.len() > columns {
        let blank = rest[..=columns].iter().rposition(|&c| c == ' ').filter(|&at| at > 0);
        let (piece, after) = match blank {
            Some(at) => (&rest[..at], &rest[at + 1..]),
            None => rest.split_at(columns),
        };
        pieces.push(piece.iter().collect());
        rest = after;
    }
    pieces.push(rest.iter().collect());
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_parted_at_blanks() {
        assert_eq!(broken("not moved: the eye", 10), ["not moved:", "the eye"]);
        assert_eq!(broken("abcdefgh", 3), ["abc", "def", "gh"]);
        assert_eq!(broken("ab cd", 5), ["ab cd"]);
        assert_eq!(broken("", 5), [""]);
    }

    #[test]
    fn letters_stay_within_the_picture_and_grow_with_it() {
        let mut letters = Letters::default();
        let lines = ["figures: 41".to_owned(), "H".to_owned()];
        for (picture, height) in
            [([40, 20], 20), ([640, 480], 32), ([1920, 1080], 64), ([3840, 2160], 128)]
        {
            letters.write(lines.to_vec(), picture);
            assert_eq!(letters.size[1], height, "{picture:?}");
            assert!(letters.size[0] <= picture[0]);
            let mut pixels = vec![7; picture[0] * picture[1]];
            letters.lay_over(&mut pixels, picture[0]);
            // Each line has a ground as long as itself: eleven letters and one.
            let laid = pixels.iter().filter(|&&pixel| pixel != 7).count();
            if picture[0] > 40 {
                assert_eq!(12 * laid, (11 + 1) * letters.size[0] / 11 * height / 2 * 12);
            }
            assert!(pixels.contains(&0xff_ff_ff), "{picture:?}");
        }
        letters.write(Vec::new(), [640, 480]);
        assert_eq!(letters.size, [0, 0]);
        let mut pixels = vec![7; 640 * 480];
        letters.lay_over(&mut pixels, 640);
        assert!(pixels.iter().all(|&pixel| pixel == 7));
    }
}
