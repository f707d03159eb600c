//! Where a plate's stray light falls, with what the colours mean.

use super::lettering::Lettering;
use super::status_picture::{INK, PAPER, fill, linear, paste};
use midair::picture::Picture;

const LINE: usize = 26;
const MARGIN: usize = 24;

/// The picture of the image and the stray light around it, a title, and a line for each colour.
pub fn draw(title: &str, view: &Picture, legend: &[([u8; 3], String)]) -> Picture {
    let (large, small) = (Lettering::medium(linear(INK)), Lettering::small(linear(INK)));
    let lines = legend.iter().map(|(_, line)| small.width(line) + LINE);
    let width = lines.chain([view.width, large.width(title)]).max().unwrap_or(0) + 2 * MARGIN;
    let top = MARGIN + large.height() + 10;
    let height = top + view.height + 18 + legend.len() * LINE + MARGIN;
    let [r, g, b] = linear(PAPER);
    let mut sheet = Picture::filled(width, height, [r, g, b, 1.0]);
    large.write(&mut sheet, title, [MARGIN, MARGIN]);
    paste(&mut sheet, view, [MARGIN, top]);
    for (index, (colour, line)) in legend.iter().enumerate() {
        let row = top + view.height + 18 + index * LINE;
        // A rim, for a white patch on white paper.
        fill(&mut sheet, [MARGIN, row + 1], [16, 16], INK);
        fill(&mut sheet, [MARGIN + 1, row + 2], [14, 14], *colour);
        small.write(&mut sheet, line, [MARGIN + LINE, row]);
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_and_a_patch_for_each_colour_are_on_the_sheet() {
        let view = Picture::filled(40, 30, [0.0, 0.0, 0.0, 1.0]);
        let (red, blue) = ([255, 0, 0], [0, 0, 255]);
        let legend = [(red, "one".to_owned()), (blue, "a longer line".to_owned())];
        let sheet = draw("Title", &view, &legend);
        let count = |colour: [u8; 3]| {
            let colour = linear(colour);
            let same = |p: &&[f32; 4]| (0..3).all(|c| (p[c] - colour[c]).abs() < 1e-6);
            sheet.pixels.iter().filter(same).count()
        };
        assert_eq!([count(red), count(blue)], [14 * 14; 2]);
        assert!(count([0, 0, 0]) >= 40 * 30);
        assert!(sheet.width >= 40 + 2 * MARGIN);
    }
}
