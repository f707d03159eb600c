//! What lies between two samples.

use super::cell::Sample;
use crate::transport::Setup;

/// Borders are closed in upon to this distance: a strip as thin beside a grazing ray, where F changes like the root of the
/// distance to the border, moves by a hundredth of a pixel at most.
const BORDER: f64 = 1e-9;
/// Between two samples of one branch whose light falls further apart than this share of the display, and around it, it is looked
/// where the light crosses the display.
const WIDE: f64 = 0.2;
/// A sample whose light falls further than this beside the display leads to no pixel.
const BESIDE: f64 = 0.05;
/// Samples between two at most: more branches than these find are noise (the vertex of a faceted crystal).
const MOST: usize = 300;

/// Looks for branches between samples.
pub(super) struct Between<'a> {
    setup: &'a Setup,
    /// Samples between those that were looked between, near the display: towards each border ever closer to it, so that some lie
    /// on the display even where light sweeps over it in a strip beside the border.
    pub found: Vec<Sample>,
}

impl<'a> Between<'a> {
    pub fn new(setup: &'a Setup) -> Self {
        Self { setup, found: Vec::new() }
    }

    /// Halves the way between two samples wherever its ends lie on different branches, down to the border between them: a branch in
    /// between is met however thin it is.
    pub fn look(&mut self, a: &Sample, b: &Sample) {
        let mut left = MOST;
        let mut open = vec![(a.clone(), b.clone())];
        while let Some((a, b)) = open.pop()
            && left > 0
        {
            let apart = (a.uv[0] - b.uv[0]).abs().max((a.uv[1] - b.uv[1]).abs());
            if apart < BORDER || (a.same_branch(&b) && !crosses_display(&a, &b)) {
                continue;
            }
            left -= 1;
            let middle = Sample::take(self.setup, [0, 1].map(|k| 0.5 * (a.uv[k] + b.uv[k])));
            let near = |st: [f64; 2]| st.iter().all(|c| (-BESIDE..=1.0 + BESIDE).contains(c));
            if middle.arrives().is_some_and(|(st, _)| near(st)) {
                self.found.push(middle.clone());
            }
            open.push((a, middle.clone()));
            open.push((middle, b));
        }
    }
}

/// Whether light between two samples of one branch may cross the display while neither need fall on it.
fn crosses_display(a: &Sample, b: &Sample) -> bool {
    let (Some((a, _)), Some((b, _))) = (a.arrives(), b.arrives()) else { return false };
    let apart = [(a[0] - b[0]).abs(), (a[1] - b[1]).abs()];
    // Its way bends by a fraction of its length.
    let bend = 0.5 * apart[0].max(apart[1]);
    apart[0].max(apart[1]) > WIDE
        && (0..2).all(|k| a[k].min(b[k]) - bend < 1.0 && a[k].max(b[k]) + bend > 0.0)
}
