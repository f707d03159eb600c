//! What the display shows while it is photographed: Gray code with each pattern's inverse down to stripes that the plate's blur leaves, then a
//! sinusoid in steps for the rest; white and black. Each pattern carries its number in two corners.

use crate::number::Numbers;
use midair::optics::plate::Model;
use midair::optics::screen::Screen;
use midair::picture::{Picture, drive};
use midair::transport::Setup;

/// One of the patterns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// All lit.
    White,
    /// All dark.
    Black,
    /// Stripes: a bit of the Gray code of the cell that a pixel lies in.
    Gray {
        /// 0: across s, 1: across t.
        axis: usize,
        /// Which bit, 0 the finest.
        bit: u32,
        /// Lit where the bit is 0.
        inverse: bool,
    },
    /// A sinusoid of light.
    Phase {
        /// 0: across s, 1: across t.
        axis: usize,
        /// Which of [`STEPS`].
        step: usize,
    },
}

/// Steps of the sinusoid: eight of them leave harmonics up to the sixth without effect, so that neither the display's nor the camera's response
/// has to be known.
pub const STEPS: usize = 8;

/// The patterns of a display.
#[derive(Clone, Debug)]
pub struct Patterns {
    /// The display's pixels.
    pub resolution: [usize; 2],
    /// Bits of the Gray code along either axis.
    pub bits: [u32; 2],
    /// Side of a corner's squares, px.
    pub square: usize,
    /// How far the plate spreads a display pixel's light, px.
    pub blur: f64,
    /// In the order in which they are shown.
    pub list: Vec<Pattern>,
    numbers: Numbers,
}

/// The finest stripes, display pixels, where nothing blurs them.
const FINEST: f64 = 16.0;

/// Squares of a corner: columns and rows.
const CORNER: [usize; 2] = [5, 2];

impl Patterns {
    /// For a set-up's display: as fine as its plate lets them be.
    pub fn of(setup: &Setup) -> Self {
        // A slit mirror sends what falls between two mirrors aside by up to their distance.
        let blur = match setup.plate.model() {
            Model::SlitMirror(plate) => plate.parameters().pitch,
            Model::Ideal | Model::Measured(_) => 0.0,
        };
        let pitch = setup.pixel_pitch();
        Self::new(setup.resolution, blur / pitch[0].min(pitch[1]))
    }

    /// For a display of some pixels, behind what blurs by so many of them.
    pub fn new(resolution: [usize; 2], blur: f64) -> Self {
        let finest = FINEST.max(1.2 * blur);
        let bits = resolution.map(|side| (side as f64 / finest).log2().floor().max(1.0) as u32);
        let mut list = vec![Pattern::White, Pattern::Black];
        // Both axes by turns: where something moves between two photographs, neither axis agrees with itself.
        for bit in (0..bits[0].max(bits[1])).rev() {
            for axis in (0..2).filter(|&axis| bit < bits[axis]) {
                list.extend([false, true].map(|inverse| Pattern::Gray { axis, bit, inverse }));
            }
        }
        for step in 0..STEPS {
            list.extend([0, 1].map(|axis| Pattern::Phase { axis, step }));
        }
        let shorter = resolution[0].min(resolution[1]);
        let square = (3.0 * blur).max(24.0).min(shorter as f64 / 12.0).max(1.0) as usize;
        let numbers = Numbers::new(list.len());
        Self { resolution, bits, square, blur, list, numbers }
    }

    /// The numbers that the corners show.
    pub fn numbers(&self) -> &Numbers {
        &self.numbers
    }

    /// Width of a stripe of the finest Gray pattern along an axis, px.
    pub fn cell(&self, axis: usize) -> f64 {
        self.resolution[axis] as f64 / f64::from(1u32 << self.bits[axis])
    }

    /// Length of the sinusoid along an axis, px: two cells, so that a cell that is one off still tells which of them it is.
    pub fn period(&self, axis: usize) -> f64 {
        2.0 * self.cell(axis)
    }

    /// Which square of a corner a pixel (from the left, from the bottom) lies in.
    fn corner(&self, [x, y]: [usize; 2]) -> Option<usize> {
        let [width, height] = self.resolution;
        let of = |x: usize, y: usize| {
            let (column, row) = (x / self.square, y / self.square);
            (column < CORNER[0] && row < CORNER[1]).then_some(row * CORNER[0] + column)
        };
        // The upper right corner is the lower left one turned by half a turn.
        of(x, y).or_else(|| of(width - 1 - x, height - 1 - y))
    }

    /// Whether a display point lies so near to the display's edge or to a corner's squares that the plate mixes its light with theirs: what is decoded there
    /// is drawn aside.
    pub fn is_mixed(&self, st: [f64; 2]) -> bool {
        let size = self.resolution.map(|side| side as f64);
        let at = [st[0] * size[0], st[1] * size[1]];
        let near_edge = (0..2).any(|c| at[c] < self.blur || at[c] > size[c] - self.blur);
        let reach = CORNER.map(|squares| (squares * self.square) as f64 + self.blur);
        let low = at[0] < reach[0] && at[1] < reach[1];
        let high = size[0] - at[0] < reach[0] && size[1] - at[1] < reach[1];
        near_edge || low || high
    }

    /// The light of a pattern's pixel (column from the left, row from the bottom), 0 to 1.
    pub fn light(&self, pattern: usize, at: [usize; 2]) -> f64 {
        if let Some(square) = self.corner(at) {
            return f64::from(u8::from(self.numbers.lit(pattern, square)));
        }
        let place = at.map(|k| k as f64 + 0.5);
        match self.list[pattern] {
            Pattern::White => 1.0,
            Pattern::Black => 0.0,
            Pattern::Gray { axis, bit, inverse } => {
                let cell = (place[axis] / self.cell(axis)) as u32;
                let gray = cell ^ (cell >> 1);
                f64::from(u8::from((gray >> bit & 1 == 1) != inverse))
            }
            Pattern::Phase { axis, step } => {
                let turns = place[axis] / self.period(axis) - step as f64 / STEPS as f64;
                0.5 + 0.5 * (std::f64::consts::TAU * turns).cos()
            }
        }
    }

    /// A pattern's light for all pixels, row 0 at the top.
    pub fn drawn(&self, pattern: usize) -> Vec<f32> {
        let [width, height] = self.resolution;
        (0..width * height)
            .map(|i| self.light(pattern, [i % width, height - 1 - i / width]) as f32)
            .collect()
    }

    /// A pattern as the display is sent it.
    pub fn picture(&self, pattern: usize, screen: &Screen) -> Picture {
        let [width, height] = self.resolution;
        let light = self.drawn(pattern);
        let pixels = light.into_iter().map(|light| [light, light, light, 1.0]).collect();
        drive(&Picture { width, height, pixels }, screen).picture
    }

    /// The name of a pattern.
    pub fn name(&self, pattern: usize) -> String {
        let what = match self.list[pattern] {
            Pattern::White => "white".to_owned(),
            Pattern::Black => "black".to_owned(),
            Pattern::Gray { axis, bit, inverse } => {
                let inverse = if inverse { "-inverse" } else { "" };
                format!("gray-{}-{bit}{inverse}", ["s", "t"][axis])
            }
            Pattern::Phase { axis, step } => format!("phase-{}-{step}", ["s", "t"][axis]),
        };
        format!("{:02}-{what}", pattern + 1)
    }

    /// The name of a pattern's file.
    pub fn file_name(&self, pattern: usize) -> String {
        format!("{}.png", self.name(pattern))
    }
}

/// The cell that a Gray code stands for.
pub fn cell_of_gray(gray: u32) -> u32 {
    let mut cell = gray;
    let mut shift = 1;
    while shift < 32 {
        cell ^= cell >> shift;
        shift <<= 1;
    }
    cell
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gray_codes_come_back_and_neighbours_differ_in_one_bit() {
        for cell in 0..4096u32 {
            let gray = cell ^ (cell >> 1);
            assert_eq!(cell_of_gray(gray), cell);
            let next = (cell + 1) ^ ((cell + 1) >> 1);
            assert_eq!((gray ^ next).count_ones(), 1);
        }
    }

    #[test]
    fn about_forty_patterns_serve_a_full_display() {
        let patterns = Patterns::new([1920, 1080], 0.0);
        // Seven and six bits, stripes of 15 and 16.9 at the least; both ways, the steps, white and black.
        assert!(patterns.cell(0) >= 15.0 && patterns.cell(1) >= 16.0, "{patterns:?}");
        assert_eq!(patterns.list.len(), 2 + 2 * (6 + 6) + 2 * STEPS);
        // Where the plate blurs more, stripes are wider.
        assert!(Patterns::new([1920, 1080], 30.0).cell(0) >= 36.0);
    }
}
