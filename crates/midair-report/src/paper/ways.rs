//! Ways to fill the display, side by side.

use crate::page::{Block, Cell, Table};
use midair::evaluate::proof::{Compared, Comparison};

/// What the tables are to be read by.
const NOTES: [&str; 4] = [
    "Views here are calculated, sharp and without stray light, over the part of the image that is formed; the reference is the view without the object. Displacement is in pixels of the camera. A way's holes are dark in its view.",
    "The homography is what somebody reaches at best who shifts, turns, stretches and tilts the picture as a whole. Structured light is the map without a model, decoded from simulated photographs (slit mirrors, stray light, lens, noise, JPEG) by a camera whose place and lens are known; its time is that of decoding, and taking the photographs comes to it.",
    "The best display image is what any descent on the display's pixels ends in: it has no map, and its time is for one picture, where a map serves all.",
    "Gradient descent by a differentiable renderer, of which there is only a figure: the paper's sphere, view and display of 256 x 256 pixels, 100 iterations on two processor cores: SSIM 0.981, 32.3 dB, about a second for one picture.",
];

/// The tables of all surfaces, and how they are read; nothing where no ways were compared.
pub(super) fn blocks(comparisons: &[Comparison]) -> Vec<Block> {
    if comparisons.is_empty() {
        return Vec::new();
    }
    let tables = comparisons.iter().map(|comparison| Block::Table(table(comparison)));
    tables.chain([Block::Notes(NOTES.map(str::to_owned).into())]).collect()
}

fn table(comparison: &Comparison) -> Table {
    let head =
        ["Way", "displacement, px", "largest", "intersections", "SSIM ↑", "PSNR, dB ↑", "time, s"];
    Table {
        caption: format!(
            "{}: {} of {} intersections are formed, and {:.0} % of the view is compared",
            comparison.surface,
            comparison.intersections,
            comparison.lattice,
            100.0 * comparison.share
        ),
        head: vec![head.map(|name| (name.to_owned(), 1)).into()],
        rows: comparison.ways.iter().map(row).collect(),
        foot: Vec::new(),
    }
}

fn row(way: &Compared) -> Vec<Cell> {
    // A way without a map answers for no intersection.
    let intersections = way.displacement.map(|_| way.intersections as f64);
    vec![
        Cell::text(way.name.clone()),
        Cell::number(way.displacement, 3),
        Cell::number(way.largest, 3),
        Cell::number(intersections, 0),
        Cell::number(way.ssim, 4),
        Cell::number(way.psnr, 1),
        Cell::number(Some(way.seconds), 3),
    ]
}
