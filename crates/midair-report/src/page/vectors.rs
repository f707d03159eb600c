//! Arrows from where intersections belong to where they are seen.

use super::html::push;

/// A lattice with an arrow at each intersection.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VectorChart {
    /// Size of the view in pixels: width, height.
    pub size: [f64; 2],
    /// Intersections in a row, to join neighbours by lines.
    pub lines: usize,
    /// Where each intersection belongs, pixels from the top left, row by row; None is left out.
    pub reference: Vec<Option<[f64; 2]>>,
    /// Where it is seen, in the same order; None is marked by a ring.
    pub seen: Vec<Option<[f64; 2]>>,
}

/// A displacement that nobody can see and no drawing should show, pixels.
const NOTHING: f64 = 1e-4;

/// Width of the drawing; its height follows the view's.
const WIDTH: f64 = 480.0;

impl VectorChart {
    /// The longest arrow at its true length, pixels; 0 without any.
    fn longest(&self) -> f64 {
        self.reference
            .iter()
            .zip(&self.seen)
            .filter_map(|(a, b)| {
                Some((*a)?.into_iter().zip((*b)?).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt())
            })
            .filter(|length| length.is_finite())
            .fold(0.0, f64::max)
    }

    /// How many times longer than true the arrows are drawn: 1, 2 or 5 times a power of
    /// ten, that keeps the longest below the lattice's spacing; at least 1, and 1 where nothing but rounding would be seen.
    pub fn exaggeration(&self) -> f64 {
        let longest = self.longest();
        if longest < NOTHING {
            return 1.0;
        }
        let spacing = self.size[0] / self.lines.max(1) as f64;
        let most = (spacing / longest).max(1.0);
        let power = 10_f64.powf(most.log10().floor());
        [5.0, 2.0]
            .into_iter()
            .map(|times| times * power)
            .find(|times| *times <= most)
            .unwrap_or(power)
    }

    /// The chart as an SVG element for a page of [`super::Page`].
    pub(super) fn to_svg(&self) -> String {
        let scale = if self.size[0] > 0.0 { WIDTH / self.size[0] } else { 1.0 };
        let (height, times) = (scale * self.size[1], self.exaggeration());
        let foot = 26.0;
        let mut out = format!(
            "<svg viewBox=\"0 0 {WIDTH} {:.1}\" role=\"img\" aria-label=\"Displacement of {} intersections, \
             {}\">",
            height + foot,
            self.reference.len(),
            if times > 1.0 {
                format!("arrows {times} times their length")
            } else {
                "at true length".to_owned()
            }
        );
        push(
            &mut out,
            format_args!("<path class=\"rule\" d=\"M.5 .5H{}V{height:.1}H.5z\"/>", WIDTH - 0.5),
        );
        let at = |index: usize| {
            self.reference.get(index).copied().flatten().map(|[x, y]| [scale * x, scale * y])
        };
        for index in 0..self.reference.len() {
            let Some([x, y]) = at(index) else { continue };
            let lines = self.lines.max(1);
            let right = (index % lines + 1 < lines).then(|| at(index + 1)).flatten();
            for [to_x, to_y] in [right, at(index + lines)].into_iter().flatten() {
                push(
                    &mut out,
                    format_args!("<path class=\"rule\" d=\"M{x:.1} {y:.1}L{to_x:.1} {to_y:.1}\"/>"),
                );
            }
        }
        for index in 0..self.reference.len() {
            let Some([x, y]) = at(index) else { continue };
            match self.seen.get(index).copied().flatten() {
                Some(seen) => {
                    let [dx, dy] = [0, 1].map(|axis| times * (scale * seen[axis] - [x, y][axis]));
                    arrow(&mut out, [x, y], [dx, dy]);
                }
                None => push(
                    &mut out,
                    format_args!("<circle class=\"ring s1\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\"/>"),
                ),
            }
        }
        let pairs = self.reference.iter().zip(&self.seen);
        let how = if pairs.clone().all(|(a, b)| a.is_none() || b.is_none()) {
            "no intersection is known in both: there is nothing to draw".to_owned()
        } else if self.longest() < NOTHING {
            format!("no displacement is longer than {NOTHING} pixel")
        } else if times > 1.0 {
            format!("arrows {times} × their length")
        } else {
            "arrows at their true length".to_owned()
        };
        let missing = self
            .reference
            .iter()
            .zip(&self.seen)
            .filter(|(a, b)| a.is_some() && b.is_none())
            .count();
        let rings =
            if missing > 0 { format!("; rings: {missing} not found") } else { String::new() };
        push(
            &mut out,
            format_args!(
                "<text class=\"faint\" x=\"0\" y=\"{:.1}\">{how}{rings}</text></svg>",
                height + 18.0
            ),
        );
        out
    }
}

/// An arrow with a head of 3 to 8 units, or a dot where it is too short for one.
fn arrow(out: &mut String, [x, y]: [f64; 2], [dx, dy]: [f64; 2]) {
    let length = dx.hypot(dy);
    push(out, format_args!("<circle class=\"f0\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2\"/>"));
    if !length.is_finite() || length < 1.0 {
        return;
    }
    let head = (0.35 * length).clamp(3.0, 8.0).min(length);
    let [ux, uy] = [dx / length, dy / length];
    let (tip_x, tip_y) = (x + dx, y + dy);
    let (back_x, back_y) = (tip_x - head * ux, tip_y - head * uy);
    let half = 0.45 * head;
    push(
        out,
        format_args!("<path class=\"curve s0\" d=\"M{x:.1} {y:.1}L{back_x:.1} {back_y:.1}\"/>"),
    );
    push(
        out,
        format_args!(
            "<path class=\"f0\" d=\"M{tip_x:.1} {tip_y:.1}L{:.1} {:.1} {:.1} {:.1}z\"/>",
            back_x - half * uy,
            back_y + half * ux,
            back_x + half * uy,
            back_y - half * ux
        ),
    );
}
