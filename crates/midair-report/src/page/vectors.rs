//! Arrows from where intersections belong to where they are seen.

use crate::svg::Svg;

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
        let mut svg = Svg::default();
        let edge = [[0.5, 0.5], [WIDTH - 0.5, 0.5], [WIDTH - 0.5, height], [0.5, height]];
        svg.line(&edge, true, "class=\"rule\"");
        let at = |index: usize| {
            self.reference.get(index).copied().flatten().map(|[x, y]| [scale * x, scale * y])
        };
        for index in 0..self.reference.len() {
            let Some(from) = at(index) else { continue };
            let lines = self.lines.max(1);
            let right = (index % lines + 1 < lines).then(|| at(index + 1)).flatten();
            for to in [right, at(index + lines)].into_iter().flatten() {
                svg.line(&[from, to], false, "class=\"rule\"");
            }
        }
        for index in 0..self.reference.len() {
            let Some(place) = at(index) else { continue };
            match self.seen.get(index).copied().flatten() {
                Some(seen) => {
                    let by = [0, 1].map(|axis| times * (scale * seen[axis] - place[axis]));
                    arrow(&mut svg, place, by);
                }
                None => svg.circle(place, 5.0, "class=\"ring s1\""),
            }
        }
        svg.text([0.0, height + 18.0], "class=\"faint\"", &self.caption());
        let about = format!(
            "role=\"img\" aria-label=\"Displacement of {} intersections, {}\"",
            self.reference.len(),
            if times > 1.0 {
                format!("arrows {times} times their length")
            } else {
                "at true length".to_owned()
            }
        );
        svg.within([WIDTH, height + 26.0], &about)
    }

    /// How the arrows are drawn, and how many are missing.
    fn caption(&self) -> String {
        let times = self.exaggeration();
        let pairs = || self.reference.iter().zip(&self.seen);
        let how = if pairs().all(|(a, b)| a.is_none() || b.is_none()) {
            "no intersection is known in both: there is nothing to draw".to_owned()
        } else if self.longest() < NOTHING {
            format!("no displacement is longer than {NOTHING} pixel")
        } else if times > 1.0 {
            format!("arrows {times} × their length")
        } else {
            "arrows at their true length".to_owned()
        };
        match pairs().filter(|(a, b)| a.is_some() && b.is_none()).count() {
            0 => how,
            missing => format!("{how}; rings: {missing} not found"),
        }
    }
}

/// An arrow with a head of 3 to 8 units, or a dot where it is too short for one.
fn arrow(svg: &mut Svg, from: [f64; 2], [dx, dy]: [f64; 2]) {
    let length = dx.hypot(dy);
    svg.circle(from, 2.0, "class=\"f0\"");
    if !length.is_finite() || length < 1.0 {
        return;
    }
    let head = (0.35 * length).clamp(3.0, 8.0).min(length);
    let [ux, uy] = [dx / length, dy / length];
    let tip = [from[0] + dx, from[1] + dy];
    let back = [tip[0] - head * ux, tip[1] - head * uy];
    let half = 0.45 * head;
    svg.line(&[from, back], false, "class=\"curve s0\"");
    let left = [back[0] - half * uy, back[1] + half * ux];
    let right = [back[0] + half * uy, back[1] - half * ux];
    svg.line(&[tip, left, right], true, "class=\"f0\"");
}
