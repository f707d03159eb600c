//! A line between two crossings, which the edge of an object may cut: how much of it belongs to either end.

use super::curve::least_squares;
use super::graph::distance;
use super::ridge::unit;

/// The centres of a line from one crossing to the next, in that order.
#[derive(Clone, Debug, Default)]
pub(super) struct Stretch {
    centres: Vec<[f64; 2]>,
    /// How many of the first belong to the start, and from which on they belong to the end: all, and none left
    /// out, where the line is whole.
    from_start: usize,
    from_end: usize,
}

/// Fewer centres than this tell nothing about a break.
const FEWEST: usize = 10;
/// No centre of a smooth line lies further from its curve than this many standard deviations of its own noise: one
/// line in a thousand has a centre beyond four, and what deviation 20 centres show is uncertain by a quarter.
const STEADY: f64 = 6.0;
/// Nor than this many times what is usual in the lattice: a line's texture (a plate's slits, a print's grain) displaces
/// neighbouring centres together, which a line's own noise, told by neighbours, does not show. One line in ten thousand has a centre beyond 4.5.
const USUAL: f64 = 4.5;
/// What interpolation and bends beyond the third degree leave on a clean picture, and more, pixels.
const LEAST_BREAK: f64 = 0.1;

impl Stretch {
    /// Centres in their order; those within `reach` pixels of a break see both of its sides and belong to neither. Lines of this
    /// lattice `usually` deviate from a curve by so many pixels.
    pub fn new(centres: Vec<[f64; 2]>, reach: f64, usually: f64) -> Self {
        let count = centres.len();
        let from_start = first_whole(&centres, reach, usually);
        let from_end = if from_start == count {
            0
        } else {
            let backwards: Vec<[f64; 2]> = centres.iter().rev().copied().collect();
            count - first_whole(&backwards, reach, usually)
        };
        Self { centres, from_start, from_end }
    }

    /// What belongs to the crossing at its start.
    pub fn start(&self) -> &[[f64; 2]] {
        &self.centres[..self.from_start]
    }

    /// What belongs to the crossing at its end.
    pub fn end(&self) -> &[[f64; 2]] {
        &self.centres[self.from_end..]
    }

    /// Whether the line goes on unbroken from one crossing to the other.
    pub fn is_whole(&self) -> bool {
        !self.centres.is_empty() && self.from_start == self.centres.len()
    }
}

/// How many centres from the first on are free of breaks.
fn first_whole(centres: &[[f64; 2]], reach: f64, usually: f64) -> usize {
    let mut count = centres.len();
    while !is_smooth(&centres[..count], 3, usually) {
        let at = likeliest_break(&centres[..count]);
        let near = |p: &&[f64; 2]| distance(**p, centres[at]) <= reach;
        count = at - centres[..at].iter().rev().take_while(near).count();
    }
    count
}

/// What lines of a lattice usually deviate from a curve by: the median of their root mean square deviations, pixels. A cut goes
/// through few of them.
pub(super) fn usual_deviation<'a>(lines: impl Iterator<Item = &'a [[f64; 2]]>) -> f64 {
    let deviation = |centres: &[[f64; 2]]| {
        if centres.len() < FEWEST {
            return None;
        }
        let off = residuals(centres, 3)?;
        // Four numbers were taken from the centres.
        let freedom = (off.len() - 4) as f64;
        Some((off.iter().map(|v| v * v).sum::<f64>() / freedom).sqrt())
    };
    let mut all: Vec<f64> = lines.filter_map(deviation).collect();
    if all.is_empty() {
        return 0.0;
    }
    let middle = all.len() / 2;
    *all.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Whether centres, in their order along a line, lie on a curve as closely as their own noise, and what is usual, let them.
///
/// Noise is told by second differences of centres two apart, which share no pixels along the line and leave slopes out: a
/// jump changes few of them, so that their median stays that of the noise, while the curve is off on both sides of the jump.
pub(super) fn is_smooth(centres: &[[f64; 2]], degree: usize, usually: f64) -> bool {
    if centres.len() < FEWEST.max(2 * degree) {
        return true;
    }
    let Some(off) = residuals(centres, degree) else { return true };
    let mut apart: Vec<f64> = off.windows(5).map(|w| (w[0] - 2.0 * w[2] + w[4]).abs()).collect();
    let middle = apart.len() / 2;
    let (_, &mut median, _) = apart.select_nth_unstable_by(middle, f64::total_cmp);
    // The median of a normal distribution's magnitude is 0.6745 deviations, and the difference's variance 1 + 4 + 1 of one.
    let noise = 1.4826 * median / 6_f64.sqrt();
    let most = off.iter().copied().fold(0.0, |most: f64, off| most.max(off.abs()));
    most <= (STEADY * noise).max(USUAL * usually).max(LEAST_BREAK)
}

/// Distances of the centres from the polynomial that fits them best.
fn residuals(centres: &[[f64; 2]], degree: usize) -> Option<Vec<f64>> {
    let (first, last) = (centres.first()?, centres.last()?);
    let [ax, ay] = unit([last[0] - first[0], last[1] - first[1]]);
    let half = 0.5 * distance(*first, *last);
    if half < 1.0 {
        return None;
    }
    let local = |p: &[f64; 2]| {
        let [dx, dy] = [p[0] - first[0], p[1] - first[1]];
        ((dx * ax + dy * ay) / half - 1.0, dy * ax - dx * ay)
    };
    let points: Vec<(f64, f64)> = centres.iter().map(local).collect();
    let (coefficients, _) = least_squares(&points, degree, 0.0)?;
    let curve = |t: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c);
    Some(points.iter().map(|&(t, v)| v - curve(t)).collect())
}

/// The centre before which the line is cut, if two straight lines fit best when they change there.
fn likeliest_break(centres: &[[f64; 2]]) -> usize {
    let off = |part: &[[f64; 2]]| -> f64 {
        residuals(part, 1).map_or(0.0, |off| off.iter().map(|v| v * v).sum())
    };
    let cost = |&at: &usize| off(&centres[..at]) + off(&centres[at..]);
    // Nothing is known of a break before the first centres.
    (1..centres.len()).min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Centres a pixel apart on a gently bent line that jumps by `jump` at `at`, with noise of a fortieth of a pixel.
    fn line(jump: f64, at: usize) -> Vec<[f64; 2]> {
        let mut state = 1_u32;
        (0..40)
            .map(|i| {
                // A linear congruential generator (Knuth's constants), uniform: deviation 1 / sqrt 12 of the range.
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let noise = 0.087 * (f64::from(state) / f64::from(u32::MAX) - 0.5);
                let x = f64::from(i);
                let jump = if (i as usize) < at { 0.0 } else { jump };
                [x, 0.3 * x + 0.002 * x * x + jump + noise]
            })
            .collect()
    }

    #[test]
    fn a_whole_line_belongs_to_both_ends() {
        let stretch = Stretch::new(line(0.0, 20), 4.0, 0.025);
        assert!(stretch.is_whole());
        assert_eq!((stretch.start().len(), stretch.end().len()), (40, 40));
    }

    #[test]
    fn a_line_that_jumps_is_shared_out_at_the_jump() {
        for jump in [-20.0, -3.0, -1.0, 1.0, 2.0, 30.0] {
            for at in [6, 15, 20, 33] {
                let stretch = Stretch::new(line(jump, at), 4.0, 0.025);
                let (start, end) = (stretch.start().len(), stretch.end().len());
                assert!(!stretch.is_whole(), "{jump} at {at}");
                // Nothing from beyond the jump, nor from within four pixels of it but for the slope's 4 %.
                assert!(start <= at && end <= 40 - at, "{jump} at {at}: {start}, {end}");
                assert!(start + 5 >= at && end + 5 >= 40 - at, "{jump} at {at}: {start}, {end}");
            }
        }
    }

    #[test]
    fn the_usual_deviation_is_that_of_whole_lines() {
        // Uniform noise over a range of 0.087 deviates by 0.087 / sqrt 12 = 0.0251; forty centres tell it to a ninth (1 / sqrt(2 40)).
        let lines = [line(0.0, 20), line(3.0, 20), line(0.0, 5)];
        let usual = usual_deviation(lines.iter().map(Vec::as_slice));
        assert!((usual / 0.0251 - 1.0).abs() < 0.25, "{usual}");
        assert_eq!(usual_deviation(std::iter::empty()), 0.0);
    }

    #[test]
    fn a_texture_that_all_lines_have_is_no_break() {
        // A wave of a quarter of a pixel: neighbouring centres move together, and their differences show little of it.
        let wavy: Vec<[f64; 2]> =
            (0..40).map(f64::from).map(|x: f64| [x, 0.25 * (0.25 * x).sin()]).collect();
        assert!(!Stretch::new(wavy.clone(), 4.0, 0.025).is_whole());
        let usual = usual_deviation(std::iter::once(wavy.as_slice()));
        assert!(Stretch::new(wavy, 4.0, usual).is_whole());
        assert!(!Stretch::new(line(3.0, 20), 4.0, usual).is_whole());
    }

    #[test]
    fn nothing_is_said_of_a_few_centres() {
        assert!(Stretch::new(line(5.0, 3)[..6].to_vec(), 4.0, 0.025).is_whole());
        assert!(!Stretch::default().is_whole());
    }
}
