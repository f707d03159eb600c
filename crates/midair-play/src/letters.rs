//! Text over the show.

use midair_letters::{Glyph, Size};

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
    font: Size,
    /// Pixels that stand for one of the letter's.
    scale: usize,
}

impl Lettering {
    /// For a picture of so many rows: they hold 30 to 50 lines.
    fn of(rows: usize) -> Self {
        match rows {
            0..700 => Self { font: Size::Small, scale: 1 },
            700..1000 => Self { font: Size::Medium, scale: 1 },
            _ => Self { font: Size::Large, scale: rows / 1000 },
        }
    }

    /// Pixels that a text takes in width.
    fn width(self, text: &str) -> usize {
        self.font.width(text) * self.scale
    }

    /// Pixels from one line to the next.
    fn height(self) -> usize {
        self.font.height() * self.scale
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
        let fits = |text: &str| lettering.width(text) <= picture[0];
        let rows: Vec<String> = lines.iter().flat_map(|line| broken(line, fits)).collect();
        let longest = rows.iter().map(|row| lettering.width(row)).max().unwrap_or(0);
        self.size = [longest.min(picture[0]), (rows.len() * lettering.height()).min(picture[1])];
        self.words.clear();
        self.words.resize(self.size[0] * self.size[1], 0);
        for (row, text) in rows.iter().enumerate() {
            let width = lettering.width(text).min(self.size[0]);
            let lines = row * lettering.height()..(row + 1) * lettering.height();
            for y in lines.take_while(|&y| y < self.size[1]) {
                self.words[y * self.size[0]..][..width].fill(GROUND);
            }
            let mut left = 0;
            for character in text.chars() {
                let glyph = lettering.font.glyph(character);
                self.letter(&glyph, [left, row * lettering.height()], lettering.scale);
                left += glyph.width() * lettering.scale;
            }
        }
        (self.lines, self.picture) = (lines, picture);
    }

    fn letter(&mut self, glyph: &Glyph, [left, top]: [usize; 2], scale: usize) {
        for y in 0..glyph.height() * scale {
            for x in 0..glyph.width() * scale {
                let level = u32::from(glyph.cover(x / scale, y / scale));
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

/// A line in pieces that fit, of at least one letter each, parted at blanks where there are some.
fn broken(line: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    let (mut rest, mut pieces) = (line, Vec::new());
    while !fits(rest) {
        let ends = rest.char_indices().map(|(at, _)| at).skip(1);
        let most = ends.clone().take_while(|&at| fits(&rest[..at])).last().or(ends.clone().next());
        let Some(most) = most else { break };
        // A blank just behind what fits may go as well.
        let blank =
            rest.as_bytes()[..=most].iter().rposition(|&byte| byte == b' ').filter(|&at| at > 0);
        let (piece, after) = match blank {
            Some(at) => (&rest[..at], &rest[at + 1..]),
            None => rest.split_at(most),
        };
        pieces.push(piece.to_owned());
        rest = after;
    }
    pieces.push(rest.to_owned());
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_parted_at_blanks() {
        let parted = |line, most| broken(line, |text| text.chars().count() <= most);
        assert_eq!(parted("not moved: the eye", 10), ["not moved:", "the eye"]);
        assert_eq!(parted("abcdefgh", 3), ["abc", "def", "gh"]);
        assert_eq!(parted("ab cd", 5), ["ab cd"]);
        assert_eq!(parted("", 5), [""]);
        assert_eq!(parted("杯の水 杯", 3), ["杯の水", "杯"]);
        // A picture narrower than a letter gets a letter a line.
        assert_eq!(parted("杯水", 0), ["杯", "水"]);
    }

    #[test]
    fn names_in_any_script_are_drawn_as_wide_as_they_are() {
        let mut letters = Letters::default();
        let mut width_of = |text: &str| {
            letters.write(vec![text.to_owned()], [640, 480]);
            letters.size[0]
        };
        // GNU Unifont's letters are 16 pixels wide, Latin ones as those of the Latin font.
        assert_eq!(width_of("杯"), 16);
        assert_eq!(width_of("杯.toml") - width_of(".toml"), 16);
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
