//! Drawing the test picture.

use crate::picture::Picture;
use rayon::prelude::*;

/// What a lattice looks like: `lines` x `lines` straight lines, evenly spaced.
#[derive(Clone, Debug, PartialEq)]
pub struct LatticeStyle {
    /// Lines in each direction, at least 2; the paper's lattice has 7.
    pub lines: usize,
    /// Width of a line as a fraction of the picture's width (height, for the horizontal ones).
    pub line_width: f64,
    /// Place of the first line's centre as a fraction of the picture; the last is as far from
    /// the opposite border.
    pub margin: f64,
    /// How far lines run past the centres of the outermost lines they cross, as a fraction of
    /// the picture; 0 for a closed frame (lines then end at the outer edge of the frame). With some
    /// overhang every intersection is a full crossing, which is located more precisely.
    pub overhang: f64,
    /// Linear-light colour of the lines, with alpha.
    pub line: [f32; 4],
    /// Linear-light colour between the lines, with alpha.
    pub ground: [f32; 4],
}

impl Default for LatticeStyle {
    /// The paper's 7 x 7 yellow lines on black.
    fn default() -> Self {
        Self {
            lines: 7,
            line_width: 0.01,
            margin: 0.08,
            overhang: 0.05,
            line: [1.0, 1.0, 0.0, 1.0],
            ground: [0.0, 0.0, 0.0, 1.0],
        }
    }
}

/// A style that cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the lattice's {setting} is {value}: it must be {needed}")]
pub struct LatticeStyleError {
    /// The field at fault.
    pub setting: &'static str,
    /// Its value.
    pub value: f64,
    /// What it must be.
    pub needed: &'static str,
}

impl LatticeStyle {
    /// The places of the lines' centres as fractions of the picture, from its left (or bottom).
    pub fn lines_at(&self) -> Vec<f64> {
        let last = (self.lines - 1) as f64;
        (0..self.lines).map(|i| self.margin + (1.0 - 2.0 * self.margin) * i as f64 / last).collect()
    }

    /// The intersections in image coordinates (u right, v up), `lines * lines` of them, row by
    /// row from the top left.
    pub fn intersections_uv(&self) -> Vec<[f64; 2]> {
        let places = self.lines_at();
        let row = |v: f64| places.iter().map(move |&u| [u, v]);
        places.iter().rev().flat_map(|&v| row(v)).collect()
    }

    /// Whether it can be drawn with every line inside the picture and apart from its neighbours.
    ///
    /// # Errors
    /// Names the setting at fault.
    pub fn check(&self) -> Result<(), LatticeStyleError> {
        let wrong = |setting, value, needed| Err(LatticeStyleError { setting, value, needed });
        if self.lines < 2 {
            return wrong("lines", self.lines as f64, "at least 2");
        }
        let half = 0.5 * self.line_width;
        if !(self.margin >= half && self.margin < 0.5) {
            return wrong("margin", self.margin, "at least half the line width, and below 0.5");
        }
        let spacing = (1.0 - 2.0 * self.margin) / (self.lines - 1) as f64;
        if !(self.line_width > 0.0 && self.line_width < spacing) {
            return wrong("line width", self.line_width, "above 0 and below the lines' spacing");
        }
        if !(self.overhang >= 0.0 && self.overhang <= self.margin) {
            return wrong("overhang", self.overhang, "from 0 to the margin");
        }
        Ok(())
    }
}

/// The lattice as a picture; each pixel holds the exact share of its area that lines cover.
///
/// # Errors
/// When the style cannot be drawn ([`LatticeStyle::check`]).
pub fn draw_lattice(
    width: usize,
    height: usize,
    style: &LatticeStyle,
) -> Result<Picture, LatticeStyleError> {
    style.check()?;
    let columns = Profile::new(width, style);
    let rows = Profile::new(height, style);
    let premultiplied = |[r, g, b, a]: [f32; 4]| [r * a, g * a, b * a, a];
    let (line, ground) = (premultiplied(style.line), premultiplied(style.ground));
    let mut pixels = vec![[0.0; 4]; width * height];
    pixels.par_chunks_mut(width.max(1)).enumerate().for_each(|(row, pixels)| {
        for (column, pixel) in pixels.iter_mut().enumerate() {
            // Lines along both axes cover a product set's complement: vertical lines over the
            // vertical extent, horizontal ones over the horizontal extent, less what they share.
            let (cx, ex) = (columns.lines[column], columns.extent[column]);
            let (cy, ey) = (rows.lines[row], rows.extent[row]);
            let cover = (cx * ey + cy * ex - cx * cy) as f32;
            *pixel = std::array::from_fn(|i| ground[i] + cover * (line[i] - ground[i]));
        }
    });
    Ok(Picture { width, height, pixels })
}

/// Along one axis, for each pixel: the share covered by line bands, and by the lines' extent.
struct Profile {
    lines: Vec<f64>,
    extent: Vec<f64>,
}

impl Profile {
    fn new(length: usize, style: &LatticeStyle) -> Self {
        let (size, half) = (length as f64, 0.5 * style.line_width);
        let share = |pixel: usize, from: f64, to: f64| {
            let (from, to) = (from * size, to * size);
            ((pixel as f64 + 1.0).min(to) - (pixel as f64).max(from)).max(0.0)
        };
        let places = style.lines_at();
        let past = style.overhang.max(half);
        let (first, last) = (style.margin - past, 1.0 - style.margin + past);
        let band = |pixel| places.iter().map(|at| share(pixel, at - half, at + half)).sum();
        Self {
            lines: (0..length).map(band).collect(),
            extent: (0..length).map(|pixel| share(pixel, first, last)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn the_light_is_the_lines_area(
            lines in 2_usize..9,
            line_width in 0.002_f64..0.05,
            margin in 0.05_f64..0.2,
            overhang in 0.0_f64..0.05,
            width in 20_usize..90,
            height in 20_usize..90,
        ) {
            let style =
                LatticeStyle { lines, line_width, margin, overhang, ..LatticeStyle::default() };
            let picture = draw_lattice(width, height, &style).unwrap();
            let sum: f64 = picture.pixels.iter().map(|pixel| f64::from(pixel[0])).sum();
            // n lines each way of length l and width w: area 2 n l w - n^2 w^2, of the picture.
            let (n, w) = (lines as f64, line_width);
            let l = 1.0 - 2.0 * margin + 2.0 * overhang.max(0.5 * w);
            let area = 2.0 * n * l * w - n * n * w * w;
            // Each of up to 8100 pixels is rounded to single precision.
            prop_assert!((sum / (width * height) as f64 - area).abs() < 1e-6);
            prop_assert!(picture.pixels.iter().all(|p| (0.0..=1.0).contains(&p[0]) && p[2] == 0.0));
        }
    }

    #[test]
    fn intersections_lie_on_white_and_in_reading_order() {
        let style = LatticeStyle { line_width: 0.03, ..LatticeStyle::default() };
        let (width, height) = (200, 300);
        let picture = draw_lattice(width, height, &style).unwrap();
        let places = style.intersections_uv();
        assert_eq!(places.len(), 49);
        assert!((places[0][0] - 0.08).abs() < 1e-15 && (places[0][1] - 0.92).abs() < 1e-15);
        assert!(places[1][0] > places[0][0] && places[7][1] < places[0][1]);
        for [u, v] in places {
            let (x, y) = ((u * width as f64) as usize, ((1.0 - v) * height as f64) as usize);
            assert_eq!(picture.pixels[y * width + x], [1.0, 1.0, 0.0, 1.0]);
        }
    }

    #[test]
    fn a_closed_frame_has_square_corners_and_nothing_beyond() {
        let style =
            LatticeStyle { margin: 0.1, line_width: 0.02, overhang: 0.0, ..Default::default() };
        let picture = draw_lattice(100, 100, &style).unwrap();
        let red = |x: usize, y: usize| picture.pixels[y * 100 + x][0];
        assert!((red(9, 9) - 1.0).abs() < 1e-6 && (red(9, 50) - 1.0).abs() < 1e-6);
        assert!(red(8, 9) < 1e-6 && red(9, 8) < 1e-6 && red(91, 91) < 1e-6);
    }

    #[test]
    fn a_style_that_cannot_be_drawn_names_its_setting() {
        let style = LatticeStyle { overhang: 0.2, ..LatticeStyle::default() };
        let error = draw_lattice(10, 10, &style).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the lattice's overhang is 0.2: it must be from 0 to the margin"
        );
        for style in [
            LatticeStyle { lines: 1, ..LatticeStyle::default() },
            LatticeStyle { margin: f64::NAN, ..LatticeStyle::default() },
            LatticeStyle { line_width: 0.2, ..LatticeStyle::default() },
        ] {
            assert!(style.check().is_err());
        }
    }
}
