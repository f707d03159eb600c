//! What becomes of image points and display pixels, as a picture with its legend.

use super::Lettering;
use crate::percent;
use midair::evaluate::preflight::Part;
use midair::map::{Formation, ImagePoint, Map, Status};
use midair::picture::{Picture, srgb};

/// The longer side of a panel, pixels.
const PANEL: usize = 512;
const MARGIN: usize = 24;
const LINE: usize = 26;

// Okabe and Ito's colours (2008), which people of any colour vision tell apart.
const GREEN: [u8; 3] = [0, 158, 115];
const YELLOW: [u8; 3] = [240, 228, 66];
const VERMILION: [u8; 3] = [213, 94, 0];
const ORANGE: [u8; 3] = [230, 159, 0];
const PURPLE: [u8; 3] = [204, 121, 167];
const SKY: [u8; 3] = [86, 180, 233];
const BLUE: [u8; 3] = [0, 114, 178];
const GREY: [u8; 3] = [120, 120, 120];
const DARK: [u8; 3] = [70, 72, 76];
/// What pictures with text are drawn on.
pub const PAPER: [u8; 3] = [250, 250, 248];
/// What their text is drawn with.
pub const INK: [u8; 3] = [30, 32, 36];

fn point_colour(point: ImagePoint) -> [u8; 3] {
    match point {
        ImagePoint::Formed => GREEN,
        ImagePoint::Folded => YELLOW,
        ImagePoint::TotalReflection(element) => {
            [VERMILION, ORANGE, PURPLE][usize::from(element) % 3]
        }
        ImagePoint::MissedPlate => SKY,
        ImagePoint::PlateBehind => GREY,
        ImagePoint::MissedDisplay => BLUE,
        ImagePoint::TooManyInteractions => INK,
    }
}

const STATUSES: [(Status, [u8; 3], &str); 4] = [
    (Status::Ok, GREEN, "ok: shows one image point"),
    (Status::Folded, YELLOW, "folded: seen at several image points"),
    (Status::Outside, DARK, "outside: no image point asks for it"),
    (Status::Blocked, SKY, "blocked: its light goes past the plate"),
];

/// Draws both sides. `parts` names the formation's kinds.
pub fn draw(title: &str, formation: &Formation, parts: &[Part], map: &Map) -> Picture {
    let image =
        panel([formation.width, formation.height], |index| point_colour(formation.points[index]));
    let display = panel([map.width, map.height], |index| STATUSES[map.status[index] as usize].1);
    let image_legend: Vec<([u8; 3], String)> = parts
        .iter()
        .map(|part| (point_colour(part.point), format!("{}  {}", percent(part.share), part.name)))
        .collect();
    let display_legend: Vec<([u8; 3], String)> = STATUSES
        .iter()
        .map(|&(status, colour, name)| {
            let count = map.status.iter().filter(|&&s| s == status).count();
            (colour, format!("{}  {name}", percent(count as f64 / map.status.len().max(1) as f64)))
        })
        .collect();
    let text = Lettering::small(linear(INK));
    let legend_width = |legend: &[([u8; 3], String)]| {
        legend.iter().map(|(_, line)| text.width(line) + LINE).max().unwrap_or(0)
    };
    let left_width = image.width.max(legend_width(&image_legend)).max(360);
    let right_width = display.width.max(legend_width(&display_legend)).max(360);
    let tall = image.height.max(display.height);
    let lines = image_legend.len().max(display_legend.len());
    let heading = Lettering::medium(linear(INK));
    let top = MARGIN + 32 + MARGIN / 2;
    let panel_top = top + heading.height() + 10;
    let width = (3 * MARGIN + left_width + right_width)
        .max(2 * MARGIN + Lettering::large(linear(INK)).width(title).min(1600));
    let height = panel_top + tall + 18 + lines * LINE + MARGIN;
    let [r, g, b] = linear(PAPER);
    let mut sheet = Picture::filled(width, height, [r, g, b, 1.0]);
    Lettering::large(linear(INK)).write(&mut sheet, title, [MARGIN, MARGIN / 2]);
    let columns = [
        (MARGIN, "The image, as the viewer sees it", &image, &image_legend),
        (2 * MARGIN + left_width, "The display's pixels", &display, &display_legend),
    ];
    for (left, name, panel, legend) in columns {
        heading.write(&mut sheet, name, [left, top]);
        paste(&mut sheet, panel, [left, panel_top]);
        for (index, (colour, line)) in legend.iter().enumerate() {
            let row = panel_top + tall + 18 + index * LINE;
            fill(&mut sheet, [left, row + 1], [16, 16], *colour);
            text.write(&mut sheet, line, [left + LINE, row]);
        }
    }
    sheet
}

/// A panel of colours, each pixel the mean over the samples it covers; small grids are enlarged by whole factors.
fn panel([width, height]: [usize; 2], colour: impl Fn(usize) -> [u8; 3]) -> Picture {
    let longer = width.max(height).max(1);
    let scale =
        if longer <= PANEL { (PANEL / longer).max(1) as f64 } else { PANEL as f64 / longer as f64 };
    let side = |length: usize| ((length as f64 * scale).round() as usize).max(1);
    let (columns, rows) = (side(width), side(height));
    let mut picture = Picture::filled(columns, rows, [0.0, 0.0, 0.0, 1.0]);
    let span = |at: usize, of: usize, length: usize| {
        let first = at * length / of;
        first..((at + 1) * length / of).max(first + 1)
    };
    for row in 0..rows {
        for column in 0..columns {
            let mut sum = [0.0f32; 3];
            let mut count = 0.0;
            for y in span(row, rows, height) {
                for x in span(column, columns, width) {
                    let sample = linear(colour(y * width + x));
                    (0..3).for_each(|c| sum[c] += sample[c]);
                    count += 1.0;
                }
            }
            let [r, g, b] = sum.map(|total| total / count);
            picture.pixels[row * columns + column] = [r, g, b, 1.0];
        }
    }
    picture
}

/// Lays a picture into a sheet that has room for it, its top left corner at a pixel.
pub fn paste(sheet: &mut Picture, panel: &Picture, [left, top]: [usize; 2]) {
    for (row, line) in panel.pixels.chunks_exact(panel.width).enumerate() {
        let start = (top + row) * sheet.width + left;
        sheet.pixels[start..start + panel.width].copy_from_slice(line);
    }
}

/// Fills a box of a sheet; what reaches beyond is cut off.
pub fn fill(
    sheet: &mut Picture,
    [left, top]: [usize; 2],
    [width, height]: [usize; 2],
    colour: [u8; 3],
) {
    let [r, g, b] = linear(colour);
    for row in top..(top + height).min(sheet.height) {
        for column in left..(left + width).min(sheet.width) {
            sheet.pixels[row * sheet.width + column] = [r, g, b, 1.0];
        }
    }
}

/// Linear light of an sRGB colour.
pub fn linear(colour: [u8; 3]) -> [f32; 3] {
    colour.map(srgb::decode_8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statuses_are_listed_in_the_order_of_their_numbers() {
        for (index, (status, ..)) in STATUSES.iter().enumerate() {
            assert_eq!(*status as usize, index);
        }
    }

    #[test]
    fn the_panels_show_each_side_in_its_colours() {
        let formation = Formation {
            width: 2,
            height: 1,
            points: vec![ImagePoint::Formed, ImagePoint::MissedDisplay],
            wanted: None,
        };
        let part = |point, name: &str| Part { point, name: name.to_owned(), share: 0.5 };
        let parts = [part(ImagePoint::Formed, "formed"), part(ImagePoint::MissedDisplay, "past")];
        let picture = draw("Title", &formation, &parts, &Map::identity(1000, 1000));
        let green = linear(GREEN);
        let count = |colour: [f32; 3]| {
            let same = |pixel: &&[f32; 4]| (0..3).all(|c| (pixel[c] - colour[c]).abs() < 1e-6);
            picture.pixels.iter().filter(same).count()
        };
        // Half of a 512 x 256 panel and the legend's swatch are blue; the same and the whole display with two swatches green.
        assert_eq!(count(linear(BLUE)), 256 * 256 + 256);
        assert_eq!(count(green), 256 * 256 + 512 * 512 + 2 * 256);
    }
}
