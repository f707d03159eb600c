//! SVG under way: the one place that writes its elements.

use crate::page::escaped;
use std::fmt::{self, Display, Write as _};

/// Elements, one after the other: x to the right and y down from the top left corner.
#[derive(Default)]
pub(crate) struct Svg(String);

/// A coordinate to a hundredth, which no screen and no print shows.
pub(crate) struct At(pub f64);

impl Display for At {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Never -0.
        write!(formatter, "{}", (self.0 * 100.0).round() / 100.0 + 0.0)
    }
}

impl Svg {
    /// A path by its commands; `attributes` say how it looks.
    pub fn path(&mut self, commands: impl Display, attributes: &str) {
        self.push(format_args!("<path d=\"{commands}\" {attributes}/>\n"));
    }

    /// A line or, `closed`, a polygon; nothing where a place is not finite.
    pub fn line(&mut self, points: &[[f64; 2]], closed: bool, attributes: &str) {
        if points.len() < 2 || !points.iter().flatten().all(|c| c.is_finite()) {
            return;
        }
        let mut commands = String::new();
        let mut last = String::new();
        for &[x, y] in points {
            let at = format!("{} {}", At(x), At(y));
            // Points that fall on one another at this precision say nothing.
            if at != last {
                commands.push(if last.is_empty() { 'M' } else { 'L' });
                commands.push_str(&at);
                last = at;
            }
        }
        if closed {
            commands.push('z');
        }
        self.path(commands, attributes);
    }

    /// Text at a place.
    pub fn text(&mut self, [x, y]: [f64; 2], attributes: &str, text: &str) {
        let (x, y, text) = (At(x), At(y), escaped(text));
        self.push(format_args!("<text x=\"{x}\" y=\"{y}\" {attributes}>{text}</text>\n"));
    }

    /// A circle about a place.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, attributes: &str) {
        let (x, y, radius) = (At(x), At(y), At(radius));
        self.push(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {attributes}/>\n"));
    }

    /// The elements in an `svg` element of this size; `attributes` are what else it has.
    pub fn within(&self, [width, height]: [f64; 2], attributes: &str) -> String {
        let (width, height) = (At(width), At(height));
        format!("<svg {attributes} viewBox=\"0 0 {width} {height}\">\n{}</svg>", self.0)
    }

    fn push(&mut self, element: fmt::Arguments<'_>) {
        // Text takes all that is written to it.
        let _ = self.0.write_fmt(element);
    }
}
