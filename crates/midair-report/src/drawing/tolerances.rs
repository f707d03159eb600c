//! Tolerances as a chart of bars.

use super::vector::{Anchor, INK, Vector};
use midair::evaluate::tolerance::Shift;

const WIDTH: f64 = 200.0;
const MARGIN: f64 = 8.0;
/// Where bars begin, and how far the longest goes.
const LEFT: f64 = 78.0;
const LONGEST: f64 = 92.0;
const ROW: f64 = 6.0;
const LETTERS: f64 = 3.2;

/// The chart: a bar for each measure of each part, the one that needs most care first. The bar is the mean shift, a thin line goes on to the
/// largest one. What moves the image by less than a thousandth of the first is left out, and counted.
pub fn draw(shifts: &[Shift], name: &str) -> String {
    let most = shifts.iter().map(|shift| shift.most).fold(0.0, f64::max);
    let worth = |shift: &&Shift| shift.mean > 0.0 && shift.mean >= 1e-3 * shifts[0].mean;
    let shown: Vec<&Shift> = shifts.iter().filter(worth).collect();
    let left_out = shifts.len() - shown.len();
    let height =
        2.0 * MARGIN + 14.0 + ROW * shown.len() as f64 + if left_out > 0 { ROW } else { 0.0 };
    let mut vector = Vector::new([WIDTH, height]);
    vector.text([MARGIN, MARGIN + 4.0], 4.5, Anchor::Start, 0.0, name);
    let about = "how far the lattice moves: bar, the mean; line, the largest; mm on the image";
    vector.text([MARGIN, MARGIN + 10.0], LETTERS, Anchor::Start, 0.0, about);
    let mut y = MARGIN + 14.0;
    for shift in &shown {
        vector.text([LEFT - 2.0, y + 0.7 * ROW], LETTERS, Anchor::End, 0.0, &shift.name());
        let end = |value: f64| LEFT + LONGEST * value / most.max(1e-300);
        let (mean, largest) = (end(shift.mean), end(shift.most));
        let bar = [[LEFT, y + 1.0], [mean, y + 1.0], [mean, y + ROW - 1.0], [LEFT, y + ROW - 1.0]];
        vector.path(&bar, true, "fill=\"#0072b2\"");
        let middle = y + 0.5 * ROW;
        let style = format!("fill=\"none\" stroke=\"{INK}\" stroke-width=\"0.3\"");
        vector.path(&[[mean, middle], [largest, middle]], false, &style);
        vector.text(
            [largest + 1.5, y + 0.7 * ROW],
            LETTERS,
            Anchor::Start,
            0.0,
            &format!("{:.2}", shift.mean),
        );
        y += ROW;
    }
    if left_out > 0 {
        let told = format!("{left_out} more move it by less than a thousandth of the first");
        vector.text([LEFT - 2.0, y + 0.7 * ROW], LETTERS, Anchor::Start, 0.0, &told);
    }
    vector.finish(&format!("{name}: tolerances"))
}
