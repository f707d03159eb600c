//! The paper's layout: its table 1 (likeness), figure 7 (displacement over azimuth) and figure 8 (picture strips), its figures
//! beside ours. Nothing is measured here: what was measured is set into tables and charts.

mod ways;

use crate::page::{
    Block, Cell, Figure, Image, LineChart, Page, Section, Series, SummaryRow, Table,
};
use midair::evaluate::paper::{
    Displacements, Evaluation, MEASURES, PUBLISHED_DISPLACEMENT, PUBLISHED_QUALITY, Quality, Shape,
    ShapeView, Winner, mean, published, surfaces, winner,
};
use midair::picture::Picture;

/// Headings of [`MEASURES`].
const HEADINGS: [&str; 3] = ["SSIM ↑", "LPIPS ↓", "SSIM after 5 × 5 blur ↑"];

fn pair(
    with: Option<f64>,
    without: Option<f64>,
    more_is_better: bool,
    decimals: usize,
) -> [Cell; 2] {
    let (a, b) = (Cell::number(with, decimals), Cell::number(without, decimals));
    match winner(with, without, more_is_better) {
        Winner::With => [a.best(), b],
        Winner::Without => [a, b.best()],
        Winner::Neither => [a, b],
    }
}

/// Table 1 for one surface: a row for each image, then means, wins, and the paper's means if they are to stand beside.
pub fn quality_table(surface: &str, rows: &[Quality], beside: bool) -> Table {
    let rows: Vec<&Quality> = rows.iter().filter(|row| row.surface == surface).collect();
    let measured = |row: &Quality| {
        MEASURES
            .iter()
            .flat_map(|(_, of, more)| {
                let floor = Cell::number(of(&row.floor), 3);
                pair(of(&row.with), of(&row.without), *more, 3).into_iter().chain([floor])
            })
            .collect::<Vec<_>>()
    };
    let line = |name: String, cells: Vec<Cell>| -> Vec<Cell> {
        std::iter::once(Cell::text(name)).chain(cells).collect()
    };
    let mut foot = Vec::new();
    let means = MEASURES.iter().flat_map(|(_, of, more)| {
        let with = mean(rows.iter().map(|row| of(&row.with)));
        let without = mean(rows.iter().map(|row| of(&row.without)));
        let floor = Cell::number(mean(rows.iter().map(|row| of(&row.floor))), 3);
        pair(with, without, *more, 3).into_iter().chain([floor])
    });
    foot.push(line("Mean".to_owned(), means.collect()));
    let wins = MEASURES.iter().flat_map(|(_, of, more)| {
        let wins = |who: Winner| {
            rows.iter().filter(|row| winner(of(&row.with), of(&row.without), *more) == who).count()
        };
        // Where it was not computed nothing was better.
        let known = rows.iter().filter(|row| of(&row.with).is_some() && of(&row.without).is_some());
        let known = known.count();
        let counts = [Winner::With, Winner::Without].map(|who| match known {
            0 => Cell::number(None, 0),
            _ => Cell::text(format!("{} of {known}", wins(who))),
        });
        counts.into_iter().chain([Cell::text("")])
    });
    foot.push(line("Better on".to_owned(), wins.collect()));
    if let Some(paper) = published(&PUBLISHED_QUALITY, surface).filter(|_| beside) {
        let cells = MEASURES.iter().flat_map(|(_, of, more)| {
            let cells = pair(of(&paper.with), of(&paper.without), *more, 3);
            cells.into_iter().chain([Cell::number(None, 3)])
        });
        foot.push(line("The paper, simulated mean".to_owned(), cells.collect()));
    }
    let mut top = vec![("Image".to_owned(), 1)];
    let mut below = vec![(String::new(), 1)];
    for name in HEADINGS {
        top.push((name.to_owned(), 3));
        below.extend(["with", "without", "noise alone"].map(|name| (name.to_owned(), 1)));
    }
    Table {
        caption: format!(
            "{surface}: likeness to the view without object, with and without compensation; noise alone: that view against itself, rendered with other random numbers"
        ),
        head: vec![top, below],
        rows: rows.iter().map(|row| line(row.image.clone(), measured(row))).collect(),
        foot,
    }
}

/// Figure 7's chart for one surface.
pub fn shape_chart(shape: &Shape) -> LineChart {
    let series = |name: &str, of: fn(&ShapeView) -> Option<f64>| Series {
        name: name.to_owned(),
        points: shape
            .views
            .iter()
            .map(|view| [view.azimuth, of(view).unwrap_or(f64::NAN)])
            .collect(),
    };
    LineChart {
        x_label: "camera azimuth, degrees".to_owned(),
        y_label: "mean displacement, pixels".to_owned(),
        series: vec![
            series("compensated", |view| view.exact.with),
            series("for 0° only", |view| view.exact.kept),
            series("without", |view| view.exact.without),
        ],
    }
}

/// Figure 7's numbers: a row for each azimuth, calculated and measured, then means and, if it is to stand beside, the paper's.
pub fn shape_table(shape: &Shape, beside: bool) -> Table {
    let cells = |values: Displacements| {
        let values = values.all();
        let least = values.iter().flatten().copied().fold(f64::INFINITY, f64::min);
        values.map(|value| {
            let cell = Cell::number(value, 2);
            if value == Some(least) { cell.best() } else { cell }
        })
    };
    let row =
        |name: String, exact: Displacements, measured: Displacements, there: Displacements| {
            let plain = there.all().map(|value| Cell::number(value, 2));
            [vec![Cell::text(name)], cells(exact).into(), cells(measured).into(), plain.into()]
                .concat()
        };
    let (measured, _, there) = shape.measured_mean();
    let mut foot = vec![row("Mean".to_owned(), shape.mean(), measured, there)];
    if let Some(paper) = published(&PUBLISHED_DISPLACEMENT, &shape.surface).filter(|_| beside) {
        let values =
            Displacements { with: Some(paper.with), kept: None, without: Some(paper.without) };
        let none = Displacements::default();
        foot.push(row("The paper, photographed".to_owned(), none, values, none));
    }
    let conditions = ["compensated", "for 0° only", "without"].map(|name| (name.to_owned(), 1));
    Table {
        caption: format!(
            "{}: mean displacement of the lattice's intersections, pixels of the camera. Calculated: {}. Measured on views: mean over {}; beside it what the calculation gives for those.",
            shape.surface,
            shape.extent(),
            shape.measured_extent()
        ),
        head: vec![
            vec![
                (String::new(), 1),
                ("calculated".to_owned(), 3),
                ("measured".to_owned(), 3),
                ("calculated for the measured ones".to_owned(), 3),
            ],
            std::iter::once(("Azimuth".to_owned(), 1))
                .chain(std::iter::repeat_n(conditions, 3).flatten())
                .collect(),
        ],
        rows: shape
            .views
            .iter()
            .map(|view| {
                let name = Cell::number(Some(view.azimuth), 0).text;
                row(format!("{name}°"), view.exact, view.measured, view.exact_there)
            })
            .collect(),
        foot,
    }
}

/// Pictures that cannot stand side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "pictures of {first} and {other} rows cannot stand side by side: render them at one height"
)]
pub struct StripError {
    /// Height of the first.
    pub first: usize,
    /// Height of the one that differs.
    pub other: usize,
}

/// Figure 8: pictures side by side (reference, with, without), `gap` pixels of white between them.
///
/// # Errors
/// When their heights differ.
pub fn strip(pictures: &[&Picture], gap: usize) -> Result<Picture, StripError> {
    let height = pictures.first().map_or(0, |picture| picture.height);
    if let Some(odd) = pictures.iter().find(|picture| picture.height != height) {
        return Err(StripError { first: height, other: odd.height });
    }
    let gaps = gap * pictures.len().saturating_sub(1);
    let width = pictures.iter().map(|picture| picture.width).sum::<usize>() + gaps;
    let mut strip = Picture::filled(width, height, [1.0; 4]);
    for row in 0..height {
        let mut at = row * width;
        for picture in pictures {
            let from = &picture.pixels[row * picture.width..(row + 1) * picture.width];
            strip.pixels[at..at + picture.width].copy_from_slice(from);
            at += picture.width + gap;
        }
    }
    Ok(strip)
}

/// The evaluation as a page, with its picture strips (figure 8) and what made it.
pub fn paper_page(evaluation: &Evaluation, strips: &[Figure], colophon: &str) -> Page {
    let mut sections = Vec::new();
    let mut summary = Vec::new();
    for shape in &evaluation.shapes {
        let Displacements { with, without, .. } = shape.mean();
        let text = |value| Cell::number(value, 2).text;
        summary.push(SummaryRow {
            label: format!("{}: displacement", shape.surface),
            value: format!("{} px", text(with)),
            note: format!(
                "{} px without compensation; calculated over {}",
                text(without),
                shape.extent()
            ),
        });
    }
    for surface in surfaces(&evaluation.quality) {
        let rows: Vec<&Quality> =
            evaluation.quality.iter().filter(|row| row.surface == surface).collect();
        let of = |pick: fn(&Quality) -> f64| {
            Cell::number(mean(rows.iter().map(|row| Some(pick(row)))), 3).text
        };
        summary.push(SummaryRow {
            label: format!("{surface}: SSIM"),
            value: of(|row| row.with.ssim),
            note: format!(
                "{} without compensation; noise alone leaves {}",
                of(|row| row.without.ssim),
                of(|row| row.floor.ssim)
            ),
        });
    }
    let mut section = |heading: &str, blocks: Vec<Block>| {
        if !blocks.is_empty() {
            sections.push(Section { heading: heading.to_owned(), blocks });
        }
    };
    let charts: Vec<Figure> = evaluation
        .shapes
        .iter()
        .map(|shape| Figure {
            image: Image::Line(shape_chart(shape)),
            caption: format!("{}: displacement over the camera’s azimuth.", shape.surface),
        })
        .collect();
    let charts = (!charts.is_empty()).then_some(Block::Figures(charts));
    let tables = evaluation
        .shapes
        .iter()
        .map(|shape| Block::Table(shape_table(shape, evaluation.published)));
    section("Shape: the lattice over azimuth", charts.into_iter().chain(tables).collect());
    section("Other ways to fill the display", ways::blocks(&evaluation.ways));
    let tables = surfaces(&evaluation.quality).into_iter();
    section(
        "Likeness of the views",
        tables
            .map(|surface| {
                Block::Table(quality_table(surface, &evaluation.quality, evaluation.published))
            })
            .collect(),
    );
    // Strips are wide: one to a row.
    let strips = strips.iter().map(|figure| Block::Figures(vec![figure.clone()]));
    section("Views: reference, with, without compensation", strips.collect());
    let notes = |notes: &[String]| match notes {
        [] => Vec::new(),
        notes => vec![Block::Notes(notes.to_vec())],
    };
    section("Assumptions", notes(&evaluation.assumptions));
    section("Where this differs from the paper", notes(&evaluation.differences));
    section("Not measured", notes(&evaluation.notes));
    let (title, lead) = if evaluation.published {
        (
            "The paper’s evaluation, simulated".to_owned(),
            "What the viewer sees with and without compensation, beside the paper’s figures.",
        )
    } else {
        let names = evaluation.shapes.first().map_or("a set-up", |shape| &shape.surface);
        (format!("Evaluation: {names}"), "What the viewer sees with and without compensation.")
    };
    Page { title, lead: lead.to_owned(), summary, sections, colophon: colophon.to_owned() }
}

#[cfg(test)]
mod tests;
