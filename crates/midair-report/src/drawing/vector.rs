//! An SVG under way.

use crate::page::escaped;
use std::fmt::Write as _;

/// Text's and measures' colour.
pub(super) const INK: &str = "#1e2024";

/// An SVG with a size of its own in millimetres, x to the right and y down from the top left corner.
pub(super) struct Vector {
    size: [f64; 2],
    body: String,
}

/// How text stands at its place.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Vector {
    pub fn new(size: [f64; 2]) -> Self {
        Self { size, body: String::new() }
    }

    /// A line or, `closed`, a polygon. `style` are attributes.
    pub fn path(&mut self, points: &[[f64; 2]], closed: bool, style: &str) {
        if points.len() < 2 || !points.iter().flatten().all(|c| c.is_finite()) {
            return;
        }
        self.body.push_str("<path d=\"");
        let mut last = [f64::NAN; 2];
        for (k, &[x, y]) in points.iter().enumerate() {
            let at = [x, y].map(|c| (c * 100.0).round() / 100.0 + 0.0);
            // Points that fall on one another at this precision say nothing.
            if k > 0 && at == last {
                continue;
            }
            last = at;
            let _ = write!(self.body, "{}{} {}", if k == 0 { 'M' } else { 'L' }, at[0], at[1]);
        }
        let _ = writeln!(self.body, "{}\" {style}/>", if closed { "z" } else { "" });
    }

    /// Text of a height in mm, turned by degrees (clockwise) about its place.
    pub fn text(&mut self, [x, y]: [f64; 2], height: f64, anchor: Anchor, turn: f64, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let turned = if turn == 0.0 {
            String::new()
        } else {
            format!(" transform=\"rotate({turn:.1} {x:.2} {y:.2})\"")
        };
        // A halo keeps text legible where lines cross it.
        let _ = writeln!(
            self.body,
            "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{height}\" text-anchor=\"{anchor}\"{turned} fill=\"{}\" stroke=\"#fff\" \
             stroke-width=\"{:.2}\" paint-order=\"stroke\">{}</text>",
            INK,
            0.25 * height,
            escaped(text)
        );
    }

    /// A filled dot.
    pub fn dot(&mut self, [x, y]: [f64; 2], radius: f64, colour: &str) {
        let _ = writeln!(
            self.body,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" fill=\"{colour}\"/>"
        );
    }

    /// The whole file. `title` is what programs show of it.
    pub fn finish(self, title: &str) -> String {
        let [w, h] = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n<title>{}</title>\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n{}</svg>\n",
            escaped(title),
            self.body
        )
    }
}
