//! A set-up as SVG: a dimensioned drawing to build by, and a picture in perspective to see what it is.

mod picture;
mod sheet;
#[cfg(test)]
mod tests;

pub use picture::picture;
pub use sheet::drawing;

use super::vector::{INK, Vector};
use midair::evaluate::layout::{Body, Layout, Role, View};

/// The line of a body: its colour.
fn ink(role: Role) -> &'static str {
    match role {
        Role::Display => "#1f2933",
        Role::Plate => "#0072b2",
        Role::Image => "#009e73",
        Role::Solid => "#6b5b95",
        Role::Mirror => "#8a6d00",
        Role::Opaque => "#4a4a4a",
    }
}

/// Its inside: a lighter colour, that is drawn translucent.
fn fill(role: Role) -> &'static str {
    match role {
        Role::Display => "#5f6b76",
        Role::Plate => "#7fb8dd",
        Role::Image => "#8fd9c0",
        Role::Solid => "#c3bbdd",
        Role::Mirror => "#e3d39a",
        Role::Opaque => "#8c8c8c",
    }
}

/// Light's colour.
const LIGHT: &str = "#d55e00";

/// A rectangle: least and largest x and y.
#[derive(Clone, Copy)]
struct Bounds([[f64; 2]; 2]);

impl Bounds {
    fn of(points: impl Iterator<Item = [f64; 2]>) -> Self {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        Self(points.fold([none; 2], |bounds, p| {
            [0, 1].map(|axis| [bounds[axis][0].min(p[axis]), bounds[axis][1].max(p[axis])])
        }))
    }

    fn side(&self, axis: usize) -> f64 {
        self.0[axis][1] - self.0[axis][0]
    }
}

/// How strongly a body is drawn: its inside's opacity, and widths of its contour and its lines, mm.
#[derive(Clone, Copy)]
struct Pens {
    opacity: f64,
    contour: f64,
    lines: f64,
}

/// The bodies in the order of painting.
fn farthest_first<'a>(layout: &'a Layout, view: &View) -> Vec<&'a Body> {
    let mut bodies: Vec<&Body> = layout.bodies.iter().collect();
    bodies.sort_by(|a, b| view.depth(b.centre).total_cmp(&view.depth(a.centre)));
    bodies
}

/// Paints a body; `at` takes places of the view to the paper.
fn paint(
    vector: &mut Vector,
    body: &Body,
    view: &View,
    at: &dyn Fn([f64; 2]) -> [f64; 2],
    pens: Pens,
) {
    let seen = body.seen(view);
    let Pens { opacity, contour: width, lines } = pens;
    let ink = ink(body.role);
    let style = format!(
        "fill=\"{}\" fill-opacity=\"{opacity}\" stroke=\"{ink}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"",
        fill(body.role)
    );
    let contour: Vec<_> = seen.contour.iter().map(|&p| at(p)).collect();
    vector.path(&contour, true, &style);
    let style = format!("fill=\"none\" stroke=\"{ink}\" stroke-width=\"{lines}\"");
    for line in &seen.lines {
        let line: Vec<_> = line.iter().map(|&p| at(p)).collect();
        vector.path(&line, false, &style);
    }
}
