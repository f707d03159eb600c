//! What midair finds, in words, pictures and pages for people: nothing is computed here but how it looks.
//!
//! [`page`] is a page that stands on its own, with charts, tables and pictures; [`drawing`] makes pictures with legends and
//! scales; [`proof`], [`orbit`] and [`paper`] set into pages what those evaluations found, [`character`] draws a plate's, [`stray`] its stray light, [`explore`] an exploration.

pub mod character;
pub mod drawing;
pub mod explore;
pub mod orbit;
pub mod page;
pub mod paper;
pub mod proof;
pub mod stray;
mod svg;

pub use midair::evaluate::percent;

use midair::compensate::ImageReport;
use midair::map::Counts;

/// What there is to say where too little of the image is formed for a viewer to recognise it.
pub fn image_warning(image: &ImageReport) -> Option<String> {
    image.is_little().then(|| {
        format!(
            "only {} of the image is formed, {} is folded: a viewer will hardly recognise it; midair check tells why, midair explore \
             finds set-ups that form more",
            percent(image.formed),
            percent(image.folded)
        )
    })
}

/// A map's pixels by status, in fractions of all of them.
pub fn counts_line(counts: &Counts) -> String {
    let share = |count: usize| percent(count as f64 / counts.all().max(1) as f64);
    format!(
        "{} of the display's pixels are ok, {} folded, {} outside, {} blocked",
        share(counts.ok),
        share(counts.folded),
        share(counts.outside),
        share(counts.blocked)
    )
}
