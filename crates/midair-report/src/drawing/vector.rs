//! A drawing under way, in millimetres.

use crate::page::escaped;
use crate::svg::{At, Svg};

/// Text's and measures' colour.
pub(super) const INK: &str = "#1e2024";

/// An SVG with a size of its own in millimetres, x to the right and y down from the top left corner.
pub(super) struct Vector {
    size: [f64; 2],
    svg: Svg,
}

/// How text stands at its place.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Vector {
    /// Nothing drawn, on white.
    pub fn new(size: [f64; 2]) -> Self {
        let mut svg = Svg::default();
        svg.path(format_args!("M0 0h{}v{}H0z", At(size[0]), At(size[1])), "fill=\"#fff\"");
        Self { size, svg }
    }

    /// A line or, `closed`, a polygon. `style` are attributes.
    pub fn path(&mut self, points: &[[f64; 2]], closed: bool, style: &str) {
        self.svg.line(points, closed, style);
    }

    /// Text of a height in mm, turned by degrees (clockwise) about its place.
    pub fn text(&mut self, place: [f64; 2], height: f64, anchor: Anchor, turn: f64, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let turned = if turn == 0.0 {
            String::new()
        } else {
            format!(" transform=\"rotate({turn:.1} {} {})\"", At(place[0]), At(place[1]))
        };
        // A halo keeps text legible where lines cross it.
        let attributes = format!(
            "font-size=\"{height}\" text-anchor=\"{anchor}\"{turned} fill=\"{INK}\" stroke=\"#fff\" stroke-width=\"{}\" \
             paint-order=\"stroke\"",
            At(0.25 * height)
        );
        self.svg.text(place, &attributes, text);
    }

    /// A filled dot.
    pub fn dot(&mut self, place: [f64; 2], radius: f64, colour: &str) {
        self.svg.circle(place, radius, &format!("fill=\"{colour}\""));
    }

    /// The whole file. `title` is what programs show of it.
    pub fn finish(self, title: &str) -> String {
        let [w, h] = self.size.map(At);
        let about = format!(
            "xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" role=\"img\" aria-label=\"{}\" \
             font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\"",
            escaped(title)
        );
        self.svg.within(self.size, &about) + "\n"
    }
}
