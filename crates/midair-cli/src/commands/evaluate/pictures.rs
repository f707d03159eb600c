//! Strips of views, as files and as figures of the page.

use super::pieces::Pieces;
use crate::failure::Failure;
use midair::evaluate::paper::{Quality, QualityView};
use midair::picture::{Depth, Picture, read_still, write_still};
use midair::simulate::tone::{Exposure, exposed};
use midair_report::page::Figure;
use midair_report::paper::strip;

/// A name that any file system takes.
fn part(text: &str) -> String {
    let dashed = text.chars().map(|c| if c.is_alphanumeric() { c } else { '-' });
    dashed.collect::<String>().replace("--", "-")
}

fn told(error: impl std::fmt::Display) -> Failure {
    Failure::Told { message: error.to_string(), help: None }
}

/// Writes the lattice's views from one azimuth: reference, compensated, compensated for 0 degrees, without; the reference's
/// exposure for all.
pub fn write_lattices(
    pieces: &Pieces,
    surface: &str,
    azimuth: f64,
    views: &[Picture; 4],
) -> Result<(), Failure> {
    let factor = Exposure::Auto.factor(&views[0]);
    let views = views.each_ref().map(|view| exposed(view, factor));
    let whole = strip(&views.each_ref(), 8).map_err(told)?;
    // As many decimals as it has: 2.5 and 2 are two places.
    let sign = if azimuth < 0.0 { "" } else { "+" };
    let name = format!("lattice-{}{sign}{azimuth}.png", part(surface));
    pieces.write(&name, |path| write_still(path, &whole, Depth::Eight))
}

fn strip_name(row: &Quality) -> String {
    format!("strip-{}-{}.png", part(&row.surface), part(&row.image))
}

/// Writes the strip of a row's views.
pub fn write_strip(pieces: &Pieces, view: &QualityView) -> Result<(), Failure> {
    let whole = strip(&[&view.reference, &view.with, &view.without], 8).map_err(told)?;
    pieces.write(&strip_name(&view.row), |path| write_still(path, &whole, Depth::Eight))
}

/// The strip of a row, at half its size, as a figure of the page.
pub fn strip_figure(pieces: &Pieces, row: &Quality) -> Result<Figure, Failure> {
    let whole = read_still(&pieces.found(&strip_name(row)))?.picture;
    let caption = format!(
        "{}, {}: reference, with compensation (SSIM {:.3}), without ({:.3}).",
        row.surface, row.image, row.with.ssim, row.without.ssim
    );
    Figure::picture(&halved(&whole), caption).map_err(told)
}

/// Each 2 x 2 pixels' mean.
fn halved(picture: &Picture) -> Picture {
    let (width, height) = ((picture.width / 2).max(1), (picture.height / 2).max(1));
    let at = |column: usize, row: usize| {
        picture.pixels[row.min(picture.height - 1) * picture.width + column.min(picture.width - 1)]
    };
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        for column in 0..width {
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .map(|(right, down)| at(2 * column + right, 2 * row + down));
            pixels.push(std::array::from_fn(|c| 0.25 * four.iter().map(|p| p[c]).sum::<f32>()));
        }
    }
    Picture { width, height, pixels }
}
