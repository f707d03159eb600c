//! The paper's tables, charts and page.

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
        ["bikes", "*0.200", "0.100", "0.900", "0.500", "*0.400", "–", "*0.700", "0.600", "0.950"]
    );
    // By hand: (0.2 + 0.4) / 2, (0.1 + 0.2) / 2, (0.5 + 0.3) / 2, (0.4 + 0.6) / 2, ...
    assert_eq!(
        texts(&table.foot[0]),
        ["Mean", "*0.300", "0.150", "0.900", "*0.400", "0.500", "–", "0.600", "*0.700", "0.950"]
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
