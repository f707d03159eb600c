//! A walk around a set-up: its chart, its strips of views, its page.

use crate::page::{
    Block, Cell, Figure, FigureError, Image, LineChart, Page, Section, Series, SummaryRow, Table,
};
use crate::paper::strip;
use midair::evaluate::orbit::{Seen, Settings, Station};
use midair::picture::Picture;
use midair::transport::Setup;

type Pick = fn(&Station) -> &Seen;

fn fixed(station: &Station) -> &Seen {
    &station.fixed
}

fn tracked(station: &Station) -> &Seen {
    &station.tracked
}

/// The views of all stations side by side: with the fixed map, and with the one that follows.
pub fn strips(stations: &[Station]) -> Vec<(&'static str, Picture)> {
    let of = |pick: Pick| {
        let views: Vec<&Picture> = stations.iter().map(|station| &pick(station).view).collect();
        // Views are of one height.
        strip(&views, 6).ok().or_else(|| views.first().map(|&first| first.clone()))
    };
    let named = [("fixed", of(fixed)), ("tracked", of(tracked))];
    named.into_iter().filter_map(|(name, strip)| Some((name, strip?))).collect()
}

/// The width of a view pixel on the image's plane, mm.
pub fn pixel_mm(setup: &Setup, settings: &Settings) -> f64 {
    setup.image.size[0] * settings.window / settings.view[0] as f64
}

/// The lattice's mean displacement over the azimuth.
pub fn chart(stations: &[Station], settings: &Settings, setup: &Setup) -> LineChart {
    let mm = pixel_mm(setup, settings);
    let series = |name: &str, pick: Pick| Series {
        name: name.to_owned(),
        points: stations.iter().map(|s| [s.azimuth, pick(s).exact.mean * mm]).collect(),
    };
    LineChart {
        x_label: "azimuth, degrees".to_owned(),
        y_label: "mean displacement of the lattice, mm".to_owned(),
        series: vec![series("fixed map", fixed), series("map that follows", tracked)],
    }
}

/// orbit.html: a page that stands on its own. `strips` are those of [`strips`].
///
/// # Errors
/// [`FigureError`] where a strip is too large for a page.
pub fn page(
    name: &str,
    stations: &[Station],
    settings: &Settings,
    setup: &Setup,
    strips: &[(&str, Picture)],
    notes: &[String],
) -> Result<Page, FigureError> {
    let mm = pixel_mm(setup, settings);
    let worst =
        |pick: Pick| stations.iter().map(|s| pick(s).exact.mean * mm).fold(f64::NAN, f64::max);
    let row = |label: &str, value: f64, note: &str| SummaryRow {
        label: label.to_owned(),
        value: if value.is_finite() { format!("{value:.3} mm") } else { "–".to_owned() },
        note: note.to_owned(),
    };
    let figure = |(name, picture): &(&str, Picture)| -> Result<Block, FigureError> {
        let caption = match *name {
            "fixed" => "The map of the scene's viewpoint, seen from each azimuth.",
            _ => "The map of each eye, seen from there.",
        };
        Ok(Block::Figures(vec![Figure::picture(picture, caption)?]))
    };
    let cells = |s: &Station| {
        let of = |seen: &Seen| {
            [
                Cell::number(Some(seen.exact.mean), 2),
                Cell::number(seen.measured.as_ref().ok().map(|d| d.mean), 2),
            ]
        };
        let mut row = vec![Cell::text(format!("{}°", s.azimuth))];
        row.extend(of(&s.fixed));
        row.extend(of(&s.tracked));
        row
    };
    let head = |texts: &[(&str, usize)]| {
        texts.iter().map(|(text, span)| ((*text).to_owned(), *span)).collect()
    };
    let table = Table {
        caption: format!("Mean displacement in view pixels of {mm:.4} mm"),
        head: vec![
            head(&[("azimuth", 1), ("fixed map", 2), ("map that follows", 2)]),
            head(&[
                ("", 1),
                ("calculated", 1),
                ("found in the view", 1),
                ("calculated", 1),
                ("found in the view", 1),
            ]),
        ],
        rows: stations.iter().map(cells).collect(),
        foot: Vec::new(),
    };
    let mut sections = vec![
        Section {
            heading: "Displacement".to_owned(),
            blocks: vec![
                Block::Figures(vec![Figure {
                    image: Image::Line(chart(stations, settings, setup)),
                    caption: "By calculation, on the image's plane.".to_owned(),
                }]),
                Block::Table(table),
            ],
        },
        Section {
            heading: "Views".to_owned(),
            blocks: strips.iter().map(figure).collect::<Result<_, _>>()?,
        },
    ];
    if !notes.is_empty() {
        sections.push(Section {
            heading: "Notes".to_owned(),
            blocks: vec![Block::Notes(notes.to_vec())],
        });
    }
    Ok(Page {
        title: format!("{name}: walking around"),
        lead: "What a viewer sees who walks around the set-up, with the map of one viewpoint and with a map that follows.".to_owned(),
        summary: vec![
            row("largest mean displacement, fixed map", worst(fixed), "one map for all places"),
            row("largest mean displacement, map that follows", worst(tracked), "a map for each place"),
        ],
        sections,
        colophon: format!("midair {}", env!("CARGO_PKG_VERSION")),
    })
}
