//! Curves over an axis, as SVG that takes its colours from the page.

use super::html::{STYLE, escaped, push};

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

        let title = format!("{} over {}", self.y_label, self.x_label);
        let mut out = format!(
            "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">",
            escaped(&title)
        );
        if points().next().is_none() {
            let (x, y) = (0.5 * (LEFT + WIDTH - RIGHT), 0.5 * (TOP + HEIGHT - BOTTOM));
            push(
                &mut out,
                format_args!(
                    "<text class=\"faint\" x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">nothing is known to be drawn here</text>"
                ),
            );
        }
        for &tick in &ys {
            let at = y(tick);
            push(
                &mut out,
                format_args!("<path class=\"rule\" d=\"M{LEFT} {at:.1}H{}\"/>", WIDTH - RIGHT),
            );
            push(
                &mut out,
                format_args!(
                    "<text class=\"faint\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                    LEFT - 8.0,
                    at + 4.5,
                    label(tick, ys[ys.len() - 1] - ys[ys.len().saturating_sub(2)])
                ),
            );
        }
        for &tick in &xs {
            let at = x(tick);
            let base = HEIGHT - BOTTOM;
            push(&mut out, format_args!("<path class=\"axis\" d=\"M{at:.1} {base}v5\"/>"));
            push(
                &mut out,
                format_args!(
                    "<text class=\"faint\" x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                    base + 20.0,
                    label(tick, xs[xs.len() - 1] - xs[xs.len().saturating_sub(2)])
                ),
            );
        }
        push(
            &mut out,
            format_args!("<path class=\"axis\" d=\"M{LEFT} {:.1}H{}\"/>", y(y0), WIDTH - RIGHT),
        );
        push(
            &mut out,
            format_args!(
                "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                0.5 * (LEFT + WIDTH - RIGHT),
                HEIGHT - 10.0,
                escaped(&self.x_label)
            ),
        );
        push(
            &mut out,
            format_args!("<text x=\"8\" y=\"{}\">{}</text>", TOP - 14.0, escaped(&self.y_label)),
        );
        let mut legend = LEFT;
        for (index, series) in self.series.iter().enumerate() {
            let style = index % 4;
            let mut path = String::new();
            let mut pen = 'M';
            for &[px, py] in &series.points {
                if px.is_finite() && py.is_finite() {
                    push(&mut path, format_args!("{pen}{:.1} {:.1}", x(px), y(py)));
                    pen = 'L';
                } else {
                    pen = 'M';
                }
            }
            push(&mut out, format_args!("<path class=\"curve s{style}\" d=\"{path}\"/>"));
            for &[px, py] in &series.points {
                if px.is_finite() && py.is_finite() {
                    marker(&mut out, style, x(px), y(py));
                }
            }
            push(
                &mut out,
                format_args!("<path class=\"curve s{style}\" d=\"M{legend:.1} 15h26\"/>"),
            );
            marker(&mut out, style, legend + 13.0, 15.0);
            let name = escaped(&series.name);
            push(
                &mut out,
                format_args!("<text x=\"{:.1}\" y=\"19.5\">{name}</text>", legend + 33.0),
            );
            // Letters are about 8 units wide at this size.
            legend += 55.0 + 8.0 * series.name.chars().count() as f64;
        }
        out.push_str("</svg>");
        out
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
fn marker(out: &mut String, style: usize, x: f64, y: f64) {
    let shape = match style {
        0 => format!("<circle class=\"f0\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>"),
        1 => format!("<path class=\"f1\" d=\"M{:.1} {:.1}h8v8h-8z\"/>", x - 4.0, y - 4.0),
        2 => format!("<path class=\"f2\" d=\"M{x:.1} {:.1}l5 9h-10z\"/>", y - 5.5),
        _ => format!("<path class=\"f3\" d=\"M{x:.1} {:.1}l5 5-5 5-5-5z\"/>", y - 5.0),
    };
    out.push_str(&shape);
}
