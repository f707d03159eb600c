//! Brightness and colour of the mid-air image in figures: how even a white field is, how wide colour fringes are, with and without
//! what `midair compensate --gain` and `--per-channel` do.
//!
//! Both look at displays of few pixels, so that they cost little beside a map in full. Places whose display pixels straddle a jump of the
//! map, where no compensation can be right, are left out.

mod evenness;
mod fringes;
#[cfg(test)]
mod tests;

pub use evenness::{Evenness, evenness};
pub use fringes::{FringeWidth, Fringes, fringes};

use super::proof::displacement::interpolated;
use crate::map::Map;
use crate::transport::Setup;

/// The set-up with its display no finer than `most` pixels along a side, in the same proportions.
fn coarse(mut setup: Setup, most: usize) -> Setup {
    let longer = setup.resolution[0].max(setup.resolution[1]);
    if longer > most {
        setup.resolution =
            setup.resolution.map(|side| ((side * most + longer / 2) / longer).max(1));
    }
    setup
}

/// Whether the map shows at the display's place st what belongs at uv, to within `slack` of the image: no jump is straddled.
fn shows(map: &Map, st: [f64; 2], uv: [f64; 2], slack: f64) -> bool {
    interpolated(map, st).is_some_and(|shown| (0..2).all(|c| (shown[c] - uv[c]).abs() <= slack))
}
