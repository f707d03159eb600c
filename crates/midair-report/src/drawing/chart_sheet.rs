//! Charts with a title, axes and a scale of colours, side by side in one picture.

use super::Lettering;
use super::status_picture::{INK, PAPER, fill, linear, paste};
use super::{Chart, colour_map};
use midair::picture::Picture;

/// An axis that runs from one number to another, in equal intervals between its ticks.
#[derive(Clone, Copy, Debug)]
pub struct Axis<'a> {
    /// Name and unit.
    pub label: &'a str,
    /// The numbers at its ends.
    pub range: [f64; 2],
    /// Intervals between ticks.
    pub intervals: usize,
}

impl Axis<'_> {
    /// The ticks: the share of the axis before each, and its number.
    fn ticks(&self) -> impl Iterator<Item = (f64, String)> {
        let [from, to] = self.range;
        let last = self.intervals.max(1);
        // As many decimals as tell the ticks apart.
        let step = ((to - from) / last as f64).abs();
        let whole = |value: f64| (value - value.round()).abs() < 1e-6;
        let told = |&d: &i32| whole(step * 10f64.powi(d)) && whole(from * 10f64.powi(d));
        let decimals = (0..3).find(told).unwrap_or(3) as usize;
        (0..=last).map(move |tick| {
            let share = tick as f64 / last as f64;
            (share, format!("{:.decimals$}", from + share * (to - from)))
        })
    }
}

/// A curve through points (x, y).
#[derive(Clone, Debug)]
pub struct Curve<'a> {
    /// Its name.
    pub name: &'a str,
    /// sRGB.
    pub colour: [u8; 3],
    /// In rising x.
    pub points: Vec<[f64; 2]>,
}

const LEFT: usize = 74;
const TOP: usize = 72;
const BOTTOM: usize = 62;
const BAR: usize = 14;

/// A sheet with room for a plot of this size, its title, its axes; and where the plot's corner is.
fn sheet([width, height]: [usize; 2], right: usize, title: &str, x: &Axis, y: &Axis) -> Picture {
    let [r, g, b] = linear(PAPER);
    let heading = Lettering::medium(linear(INK));
    let text = Lettering::small(linear(INK));
    let wide = (LEFT + width + right).max(24 + heading.width(title));
    let mut sheet = Picture::filled(wide, TOP + height + BOTTOM, [r, g, b, 1.0]);
    heading.write(&mut sheet, title, [12, 10]);
    text.write(&mut sheet, y.label, [12, TOP - 30]);
    let middle = LEFT + width / 2;
    let under = TOP + height;
    text.write(&mut sheet, x.label, [middle.saturating_sub(text.width(x.label) / 2), under + 34]);
    for (share, number) in x.ticks() {
        let at = LEFT + (share * (width - 1) as f64).round() as usize;
        fill(&mut sheet, [at, under], [1, 6], INK);
        text.write(&mut sheet, &number, [at.saturating_sub(text.width(&number) / 2), under + 10]);
    }
    for (share, number) in y.ticks() {
        let at = under - 1 - (share * (height - 1) as f64).round() as usize;
        fill(&mut sheet, [LEFT - 6, at], [6, 1], INK);
        let left = (LEFT - 10).saturating_sub(text.width(&number));
        text.write(&mut sheet, &number, [left, at.saturating_sub(8)]);
    }
    sheet
}

/// Numbers over two axes in colours, with their scale.
pub fn map(chart: &Chart, title: &str, x: &Axis, y: &Axis) -> Picture {
    let size = [chart.picture.width, chart.picture.height];
    let mut sheet = sheet(size, 110, title, x, y);
    let mut plot = chart.picture.clone();
    // What has no number is transparent: paper.
    for pixel in plot.pixels.iter_mut().filter(|pixel| pixel[3] == 0.0) {
        let [r, g, b] = linear(PAPER);
        *pixel = [r, g, b, 1.0];
    }
    paste(&mut sheet, &plot, [LEFT, TOP]);
    let left = LEFT + size[0] + 18;
    for row in 0..size[1] {
        let [r, g, b] = colour_map(1.0 - row as f64 / (size[1] - 1).max(1) as f64);
        for column in left..left + BAR {
            sheet.pixels[(TOP + row) * sheet.width + column] = [r, g, b, 1.0];
        }
    }
    let text = Lettering::small(linear(INK));
    for (share, value) in [
        (0.0, chart.range[0]),
        (0.5, 0.5 * (chart.range[0] + chart.range[1])),
        (1.0, chart.range[1]),
    ] {
        let at = TOP + ((1.0 - share) * (size[1] - 1) as f64).round() as usize;
        text.write(&mut sheet, &format!("{value:.3}"), [left + BAR + 6, at - 8]);
    }
    sheet
}

/// Curves over an axis; their names stand in the plot's upper right corner.
pub fn curves(curves: &[Curve], size: [usize; 2], title: &str, x: &Axis, y: &Axis) -> Picture {
    let mut sheet = sheet(size, 30, title, x, y);
    let [width, height] = size;
    fill(&mut sheet, [LEFT - 1, TOP], [1, height], INK);
    fill(&mut sheet, [LEFT - 1, TOP + height], [width + 1, 1], INK);
    let share = |value: f64, [from, to]: [f64; 2]| (value - from) / (to - from);
    for (index, curve) in curves.iter().enumerate() {
        let place = |[a, b]: [f64; 2]| {
            [
                LEFT as f64 + share(a, x.range) * (width - 1) as f64,
                TOP as f64 + (1.0 - share(b, y.range)) * (height - 1) as f64,
            ]
        };
        for pair in curve.points.windows(2) {
            line(&mut sheet, place(pair[0]), place(pair[1]), curve.colour, [[LEFT, TOP], size]);
        }
        let text = Lettering::small(linear(curve.colour));
        let left = LEFT + width - text.width(curve.name).min(width) - 8;
        text.write(&mut sheet, curve.name, [left, TOP + 6 + 20 * index]);
    }
    sheet
}

/// A line two pixels wide with soft edges, kept within a box (its corner, its size).
fn line(sheet: &mut Picture, a: [f64; 2], b: [f64; 2], colour: [u8; 3], within: [[usize; 2]; 2]) {
    let ink = linear(colour);
    let [[left, top], [width, height]] = within;
    let bounds = |axis: usize, start: usize, length: usize| {
        let low = (a[axis].min(b[axis]) - 2.0).floor().max(start as f64) as usize;
        let high = (a[axis].max(b[axis]) + 2.0).ceil().max(0.0) as usize;
        low..high.min(start + length)
    };
    let along = [b[0] - a[0], b[1] - a[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    for row in bounds(1, top, height) {
        for column in bounds(0, left, width) {
            let to = [column as f64 + 0.5 - a[0], row as f64 + 0.5 - a[1]];
            let t = ((to[0] * along[0] + to[1] * along[1]) / square.max(1e-12)).clamp(0.0, 1.0);
            let distance = (to[0] - t * along[0]).hypot(to[1] - t * along[1]);
            let cover = (1.5 - distance).clamp(0.0, 1.0) as f32;
            let pixel = &mut sheet.pixels[row * sheet.width + column];
            for c in 0..3 {
                pixel[c] += cover * (ink[c] - pixel[c]);
            }
        }
    }
}

/// Sheets side by side.
pub fn row(sheets: &[Picture]) -> Picture {
    let width = sheets.iter().map(|s| s.width).sum();
    let height = sheets.iter().map(|s| s.height).max().unwrap_or(0);
    let [r, g, b] = linear(PAPER);
    let mut whole = Picture::filled(width, height, [r, g, b, 1.0]);
    let mut left = 0;
    for sheet in sheets {
        paste(&mut whole, sheet, [left, 0]);
        left += sheet.width;
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_the_decimals_they_need() {
        let numbers = |range, intervals| {
            let axis = Axis { label: "", range, intervals };
            axis.ticks().map(|(_, number)| number).collect::<Vec<_>>()
        };
        assert_eq!(numbers([0.0, 90.0], 3), ["0", "30", "60", "90"]);
        assert_eq!(numbers([-1.5, 1.5], 2), ["-1.5", "0.0", "1.5"]);
        assert_eq!(numbers([0.0, 1.0], 4), ["0.00", "0.25", "0.50", "0.75", "1.00"]);
    }

    #[test]
    fn a_curve_is_drawn_where_its_numbers_are() {
        let x = Axis { label: "x", range: [0.0, 10.0], intervals: 2 };
        let y = Axis { label: "y", range: [0.0, 1.0], intervals: 2 };
        let colour = [0, 114, 178];
        let curve = Curve { name: "", colour, points: vec![[0.0, 0.75], [10.0, 0.75]] };
        let picture = curves(&[curve], [200, 101], "t", &x, &y);
        let inked: Vec<usize> = (0..picture.width * picture.height)
            .filter(|&i| {
                let p = picture.pixels[i];
                (0..3).all(|c| (p[c] - linear(colour)[c]).abs() < 1e-6)
            })
            .collect();
        // A quarter of 100 pixels below the plot's top, over all of its width.
        let rows: Vec<usize> = inked.iter().map(|i| i / picture.width).collect();
        assert!(
            inked.len() >= 190 && rows.iter().all(|&row| row.abs_diff(TOP + 25) <= 1),
            "{rows:?}"
        );
    }

    #[test]
    fn a_map_lies_between_its_axes_with_its_scale_beside_it() {
        let picture = Picture::filled(60, 40, [0.0, 0.0, 1.0, 1.0]);
        let chart = Chart { picture, range: [0.0, 0.5] };
        let axis = Axis { label: "", range: [0.0, 1.0], intervals: 1 };
        let sheet = map(&chart, "t", &axis, &axis);
        let at = |x: usize, y: usize| sheet.pixels[y * sheet.width + x];
        assert_eq!(at(LEFT + 30, TOP + 20), [0.0, 0.0, 1.0, 1.0]);
        let [r, g, b] = colour_map(1.0);
        assert_eq!(at(LEFT + 60 + 18 + 5, TOP), [r, g, b, 1.0]);
        assert_eq!(row(&[sheet.clone(), sheet.clone()]).width, 2 * sheet.width);
    }
}
