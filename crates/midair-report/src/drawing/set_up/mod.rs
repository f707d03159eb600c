//! A set-up as SVG: a dimensioned drawing to build by, and a picture in perspective to see what it is.

mod picture;
mod sheet;
#[cfg(test)]
mod tests;

pub use picture::picture;
pub use sheet::drawing;

use super::vector::INK;
use midair::evaluate::layout::Role;

/// The line of a body: its colour.
fn ink(role: Role) -> &'static str {
    match role {
        Role::Display => "#1f2933",
        Role::Plate => "#0072b2",
        Role::Image => "#009e73",
        Role::Solid => "#6b5b95",
        Role::Mirror => "#8a6d00",
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
    }
}

/// Light's colour.
const LIGHT: &str = "#d55e00";
