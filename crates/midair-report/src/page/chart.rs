//! Curves over an axis, as SVG that takes its colours from the page.

use super::html::{STYLE, escaped};
use crate::svg::Svg;

/// Curves over an axis, each point marked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineChart {
    /// Name and unit of the horizontal axis.
    pub x_label: String,
    /// Name and unit of the vertical axis, which starts at zero.
    pub y_label: String,
    /// The curves, at most four.
    pub series: Vec<Series>,
}

/// One curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Its name, shown above the chart.
    pub name: String,
    /// Points (x, y); where one is not finite the curve is interrupted.
    pub points: Vec<[f64; 2]>,
}

const WIDTH: f64 = 540.0;
const HEIGHT: f64 = 370.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 62.0;
const BOTTOM: f64 = 56.0;

/// Places on an axis at a step of 1, 2 or 5 times a power of ten, about `count` of them, that
/// span [from, to].
pub(super) fn ticks(from: f64, to: f64, count: usize) -> Vec<f64> {
    let span = to - from;
    if !span.is_finite() || span <= 0.0 || !from.is_finite() {
        return vec![if from.is_finite() { from } else { 0.0 }];
    }
    let rough = span / count.max(1) as f64;
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= rough);
    let step = step.unwrap_or(10.0 * power);
    let (first, last) = ((from / step).floor() as i64, (to / step - 1e-9).ceil() as i64);
    (first..=last).map(|i| i as f64 * step).collect()
}

/// A number with as many decimals as its axis' step needs.
pub(super) fn label(value: f64, step: f64) -> String {
    let decimals = (-(step.abs().log10() + 1e-9).floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}").replace('-', "−")
}

impl LineChart {
    /// The chart as an SVG file that stands on its own, in the page's light colours.
    pub fn to_svg_file(&self) -> String {
        let size = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" "
        );
        let mut svg = self.to_svg().replacen("<svg ", &size, 1);
        if let Some(end) = svg.find('>') {
            let ground = "<rect width=\"100%\" height=\"100%\" fill=\"var(--ground)\"/>";
            svg.insert_str(end + 1, &with_colours(&format!("<style>{}</style>{ground}", rules())));
        }
        svg
    }

    /// The chart as an SVG element for a page of [`super::Page`].
    pub(super) fn to_svg(&self) -> String {
        let points = || {
            let all = self.series.iter().flat_map(|series| &series.points);
            all.copied().filter(|point| point.iter().all(|value| value.is_finite()))
        };
        let bound = |axis: usize, start: f64, pick: fn(f64, f64) -> f64| {
            points().map(|point| point[axis]).fold(start, pick)
        };
        let (x_from, x_to) =
            (bound(0, f64::INFINITY, f64::min), bound(0, f64::NEG_INFINITY, f64::max));
        let (y_from, y_to) = (bound(1, 0.0, f64::min), bound(1, 0.0, f64::max));
        let (x_from, x_to) = if x_from < x_to { (x_from, x_to) } else { (0.0, 1.0) };
        let y_to = if y_from < y_to { y_to } else { 1.0 };
        let (xs, ys) = (ticks(x_from, x_to, 7), ticks(y_from, y_to, 5));
        let range = |ticks: &[f64]| (ticks[0], ticks[ticks.len() - 1]);
        let ((x0, x1), (y0, y1)) = (range(&xs), range(&ys));
        let x = |value: f64| LEFT + (value - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT);
        let y = |value: f64| HEIGHT - BOTTOM - (value - y0) / (y1 - y0) * (HEIGHT - TOP - BOTTOM);

        let mut svg = Svg::default();
        let middle = 0.5 * (LEFT + WIDTH - RIGHT);
        let faint = |anchor: &str| format!("class=\"faint\" text-anchor=\"{anchor}\"");
        if points().next().is_none() {
            let half = 0.5 * (TOP + HEIGHT - BOTTOM);
            svg.text([middle, half], &faint("middle"), "nothing is known to be drawn here");
        }
        let step = |ticks: &[f64]| ticks[ticks.len() - 1] - ticks[ticks.len().saturating_sub(2)];
        for &tick in &ys {
            svg.line(&[[LEFT, y(tick)], [WIDTH - RIGHT, y(tick)]], false, "class=\"rule\"");
            let place = [LEFT - 8.0, y(tick) + 4.5];
            svg.text(place, &faint("end"), &label(tick, step(&ys)));
        }
        let base = HEIGHT - BOTTOM;
        for &tick in &xs {
            svg.line(&[[x(tick), base], [x(tick), base + 5.0]], false, "class=\"axis\"");
            let place = [x(tick), base + 20.0];
            svg.text(place, &faint("middle"), &label(tick, step(&xs)));
        }
        svg.line(&[[LEFT, y(y0)], [WIDTH - RIGHT, y(y0)]], false, "class=\"axis\"");
        svg.text([middle, HEIGHT - 10.0], "text-anchor=\"middle\"", &self.x_label);
        svg.text([8.0, TOP - 14.0], "", &self.y_label);
        let mut legend = LEFT;
        for (index, series) in self.series.iter().enumerate() {
            let style = index % 4;
            let curve = format!("class=\"curve s{style}\"");
            let places: Vec<_> = series.points.iter().map(|&[px, py]| [x(px), y(py)]).collect();
            let is_known = |place: &[f64; 2]| place.iter().all(|c| c.is_finite());
            for piece in places.split(|place| !is_known(place)) {
                svg.line(piece, false, &curve);
            }
            places
                .iter()
                .filter(|place| is_known(place))
                .for_each(|&at| marker(&mut svg, style, at));
            svg.line(&[[legend, 15.0], [legend + 26.0, 15.0]], false, &curve);
            marker(&mut svg, style, [legend + 13.0, 15.0]);
            svg.text([legend + 33.0, 19.5], "", &series.name);
            // Letters are about 8 units wide at this size.
            legend += 55.0 + 8.0 * series.name.chars().count() as f64;
        }
        let title = escaped(&format!("{} over {}", self.y_label, self.x_label));
        svg.within([WIDTH, HEIGHT], &format!("role=\"img\" aria-label=\"{title}\""))
    }
}

/// The style sheet's rules for charts.
fn rules() -> String {
    STYLE
        .lines()
        .filter_map(|line| line.strip_prefix("svg "))
        .map(|rule| rule.replace(" svg ", " "))
        .collect()
}

/// Text with the style sheet's variables written out, as programs for drawing do not know them. Of a variable's values the first
/// is that of a light page.
fn with_colours(text: &str) -> String {
    let mut parts = text.split("var(");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once(')').unwrap_or((part, ""));
        let value =
            STYLE.split_once(&format!("{name}: ")).and_then(|(_, after)| after.split_once(';'));
        out += value.map_or("black", |(value, _)| value);
        out += rest;
    }
    out
}

/// A mark of its own for each curve, so that colour is not all that tells them apart.
fn marker(svg: &mut Svg, style: usize, [x, y]: [f64; 2]) {
    let filled = format!("class=\"f{style}\"");
    let around = |corners: &[[f64; 2]]| -> Vec<[f64; 2]> {
        corners.iter().map(|[dx, dy]| [x + dx, y + dy]).collect()
    };
    match style {
        0 => svg.circle([x, y], 4.0, &filled),
        1 => {
            let square = around(&[[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]]);
            svg.line(&square, true, &filled);
        }
        2 => svg.line(&around(&[[0.0, -5.5], [5.0, 3.5], [-5.0, 3.5]]), true, &filled),
        _ => {
            let diamond = around(&[[0.0, -5.0], [5.0, 0.0], [0.0, 5.0], [-5.0, 0.0]]);
            svg.line(&diamond, true, &filled);
        }
    }
}
