//! The paper's layout: its table 1 (likeness), figure 7 (displacement over azimuth) and figure 8 (picture strips), its figures
//! beside ours. Nothing is measured here: what was measured is set into tables and charts.

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
mod tests {
    use super::*;
    use midair::evaluate::paper::Scores;

    fn rows() -> Vec<Quality> {
        let scores = |ssim, lpips, blurred_ssim| Scores { ssim, lpips, blurred_ssim };
        let row = |surface: &str, image: &str, with, without| Quality {
            surface: surface.to_owned(),
            image: image.to_owned(),
            with,
            without,
            floor: Scores { ssim: 0.9, lpips: None, blurred_ssim: 0.95 },
        };
        vec![
            row("cylinder", "bikes", scores(0.2, Some(0.5), 0.7), scores(0.1, Some(0.4), 0.6)),
            row("bent mirror", "bikes", scores(0.5, None, 0.9), scores(0.4, None, 0.9)),
            row("cylinder", "caps", scores(0.4, Some(0.3), 0.5), scores(0.2, Some(0.6), 0.8)),
        ]
    }

    fn texts(row: &[Cell]) -> Vec<String> {
        row.iter()
            .map(|cell| if cell.best { format!("*{}", cell.text) } else { cell.text.clone() })
            .collect()
    }

    #[test]
    fn the_table_has_means_wins_and_the_papers_figures() {
        let table = quality_table("cylinder", &rows(), true);
        let width: usize = table.head[0].iter().map(|(_, span)| span).sum();
        assert!(table.rows.iter().chain(&table.foot).all(|row| row.len() == width));
        assert_eq!(table.head[1].len(), width);
        assert_eq!(
            texts(&table.rows[0]),
            [
                "bikes", "*0.200", "0.100", "0.900", "0.500", "*0.400", "–", "*0.700", "0.600",
                "0.950"
            ]
        );
        // By hand: (0.2 + 0.4) / 2, (0.1 + 0.2) / 2, (0.5 + 0.3) / 2, (0.4 + 0.6) / 2, ...
        assert_eq!(
            texts(&table.foot[0]),
            [
                "Mean", "*0.300", "0.150", "0.900", "*0.400", "0.500", "–", "0.600", "*0.700",
                "0.950"
            ]
        );
        let wins =
            ["Better on", "2 of 2", "0 of 2", "", "1 of 2", "1 of 2", "", "1 of 2", "1 of 2", ""];
        assert_eq!(texts(&table.foot[1]), wins);
        assert_eq!(texts(&table.foot[2])[1..5], ["*0.156", "0.126", "–", "*0.550"]);
        let mirror = quality_table("bent mirror", &rows(), true);
        assert_eq!(texts(&mirror.foot[1])[4..6], ["–", "–"]);
        assert_eq!(texts(&mirror.rows[0])[4..], ["–", "–", "–", "0.900", "0.900", "0.950"]);
    }

    #[test]
    fn figure_seven_keeps_gaps_and_names_the_paper() {
        let all = |with, kept, without| Displacements {
            with: Some(with),
            kept: Some(kept),
            without: Some(without),
        };
        let shape = Shape {
            surface: "Bent-mirror".to_owned(),
            views: vec![
                ShapeView {
                    azimuth: -5.0,
                    exact: all(1.0, 2.0, 3.0),
                    measured: all(1.5, 2.5, 3.5),
                    exact_there: all(1.25, 2.25, 3.25),
                },
                ShapeView {
                    azimuth: 0.0,
                    exact: all(3.0, 4.0, 5.0),
                    measured: Displacements { with: Some(7.0), ..Displacements::default() },
                    exact_there: Displacements::default(),
                },
            ],
            intersections: 40,
            measured_intersections: 30,
            lattice: 49,
        };
        let chart = shape_chart(&shape);
        assert_eq!(chart.series[0].points[1], [0.0, 3.0]);
        let table = shape_table(&shape, true);
        assert!(table.caption.contains("2 azimuths, the same 40 of 49 intersections"));
        assert!(table.caption.contains("1 of 2 azimuths, the same 30 intersections"));
        assert_eq!(
            texts(&table.rows[0]),
            ["−5°", "*1.00", "2.00", "3.00", "*1.50", "2.50", "3.50", "1.25", "2.25", "3.25"]
        );
        // No azimuth drops out of the calculated mean; one that was measured under one condition only is none that was measured.
        assert_eq!(
            texts(&table.foot[0]),
            ["Mean", "*2.00", "3.00", "4.00", "*1.50", "2.50", "3.50", "1.25", "2.25", "3.25"]
        );
        assert_eq!(texts(&table.foot[1])[4..7], ["*30.53", "–", "138.68"]);
    }

    #[test]
    fn a_strip_holds_its_pictures_in_order() {
        let (red, blue) = ([1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]);
        let (a, b) = (Picture::filled(2, 3, red), Picture::filled(4, 3, blue));
        let found = strip(&[&a, &b], 1).unwrap();
        assert_eq!((found.width, found.height), (7, 3));
        assert_eq!(found.pixels[7..14], [red, red, [1.0; 4], blue, blue, blue, blue]);
        let tall = Picture::filled(1, 4, red);
        assert_eq!(strip(&[&a, &tall], 1), Err(StripError { first: 3, other: 4 }));
        assert!(strip(&[], 3).unwrap().pixels.is_empty());
    }

    #[test]
    fn the_page_shows_every_surface() {
        let evaluation = Evaluation {
            published: true,
            quality: rows(),
            shapes: vec![Shape {
                surface: "cube".to_owned(),
                views: vec![ShapeView::default()],
                ..Shape::default()
            }],
            assumptions: vec!["camera at 3.3 m".to_owned()],
            ..Evaluation::default()
        };
        let page = paper_page(&evaluation, &[], "");
        let labels: Vec<&str> = page.summary.iter().map(|row| row.label.as_str()).collect();
        assert_eq!(labels, ["cube: displacement", "cylinder: SSIM", "bent mirror: SSIM"]);
        let html = page.to_html();
        assert!(html.contains("camera at 3.3 m") && html.contains("78.87"));
        // Of one's own set-up, whatever it is called, the paper says nothing.
        let own = Evaluation { published: false, ..evaluation };
        let html = paper_page(&own, &[], "").to_html();
        assert!(
            html.contains("Evaluation: cube") && !html.contains("78.87") && !html.contains("paper")
        );
    }
}
