//! What a proof found, as a page.

use super::{Report, colour, likeness_text, shape_notes};
use crate::page::{
    Block, Cell, Figure, FigureError, Image, Page, Section, SummaryRow, Table, VectorChart,
};
use crate::{counts_line, percent};
use midair::evaluate::proof::{Likeness, Shape};
use midair::map::Map;
use midair::measure::lattice::Displacement;
use midair::picture::{Picture, display_image};

/// Pixels of a picture's longer side on the page; the files beside it have all.
const SHOWN: usize = 640;

impl Report<'_> {
    /// report.html: a page that stands on its own.
    ///
    /// # Errors
    /// [`FigureError`] where a picture is too large for a page.
    pub fn page(&self) -> Result<Page, FigureError> {
        let Self { loaded, setup, proof, .. } = self;
        Ok(Page {
            title: loaded.scene.name.clone(),
            lead: format!(
                "What the display must show so that the mid-air image looks undistorted from ({}), and what the viewer then sees.",
                setup.viewpoint.to_array().map(|c| format!("{c}")).join(", ")
            ),
            summary: self.summary(),
            sections: vec![
                self.pictures()?,
                self.shape()?,
                self.likeness(),
                colour::section(self.colour, &loaded.scene)?,
                self.map_section(),
                Section {
                    heading: "What was assumed".to_owned(),
                    blocks: vec![Block::Notes(self.assumptions())],
                },
            ],
            colophon: format!(
                "Made by midair {} from the scene \"{}\"; all figures are in report.json beside this page, the pictures in full size in its folder. The map took {:.1} ms.",
                env!("CARGO_PKG_VERSION"),
                loaded.scene.name,
                proof.map_time.as_secs_f64() * 1e3
            ),
        })
    }

    fn summary(&self) -> Vec<SummaryRow> {
        let proof = self.proof;
        let row = |label: &str, value: String, note: String| SummaryRow {
            label: label.to_owned(),
            value,
            note,
        };
        let exact = |shape: &Shape| match shape.exact.mean.is_finite() {
            true => format!("{:.3} px", shape.exact.mean),
            false => "not formed".to_owned(),
        };
        let measured = |shape: &Shape| match &shape.measured {
            Ok(measured) => format!(
                "measured on the view {:.3} px over {} of {}",
                measured.mean,
                measured.compared(),
                shape.exact.compared()
            ),
            Err(_) => "not measurable on the view".to_owned(),
        };
        let (ssim, _) = likeness_text(proof.compensated.likeness);
        let (before, _) = likeness_text(proof.uncompensated.likeness);
        let mut rows = vec![
            row(
                "Lattice displacement",
                exact(&proof.lattice.compensated),
                format!(
                    "{}; {} without compensation ({})",
                    measured(&proof.lattice.compensated),
                    exact(&proof.lattice.uncompensated),
                    measured(&proof.lattice.uncompensated)
                ),
            ),
            row("Likeness to the reference (SSIM)", ssim, format!("{before} without compensation")),
            row(
                "Image that is formed",
                percent(proof.formation.formed()),
                format!("compared over {} of the view", percent(proof.region.share)),
            ),
            row(
                "The map",
                format!("{:.1} ms", proof.map_time.as_secs_f64() * 1e3),
                format!(
                    "every ok pixel within {:.0e} pixels of a 1024-pixel image",
                    proof.map.error_bound * 1024.0
                ),
            ),
        ];
        rows.extend(colour::summary(self.colour));
        if let Some(splat) = &proof.splat {
            rows.push(row(
                "The paper's method",
                format!("{:.1} s", splat.time.as_secs_f64()),
                format!(
                    "{} samples a pixel, {} holes, {:.3} pixels off (rms)",
                    splat.spp,
                    splat.holes,
                    splat.rms_error * 1024.0
                ),
            ));
        }
        rows
    }

    fn pictures(&self) -> Result<Section, FigureError> {
        let proof = self.proof;
        Ok(Section {
            heading: "What the viewer sees".to_owned(),
            blocks: vec![
                Block::Figures(vec![
                    figure(
                        &proof.compensated.view,
                        "Compensated: the display shows the picture through the map.",
                    )?,
                    figure(
                        &proof.uncompensated.view,
                        "Uncompensated: the display shows the picture as it is.",
                    )?,
                    figure(&proof.reference, "Reference: no object in the way.")?,
                ]),
                Block::Text("What the display shows:".to_owned()),
                Block::Figures(vec![
                    figure(
                        &proof.compensated.display,
                        "The compensated display image (display.png). Black: pixels that show nothing of the image.",
                    )?,
                    figure(
                        &proof.optimal.display,
                        "The best display image (display-optimal.png): bounded least squares through the display's pixels.",
                    )?,
                ]),
            ],
        })
    }

    fn shape(&self) -> Result<Section, FigureError> {
        let lattice = &self.proof.lattice;
        let cells = |name: &str, shape: &Shape| {
            let measured = shape.measured.as_ref().ok();
            let count = |d: Option<&Displacement>| {
                Cell::text(d.map_or("0".to_owned(), |d| {
                    format!("{} of {}", d.compared(), shape.belongs.len())
                }))
            };
            vec![
                Cell::text(name),
                Cell::number(measured.map(|d| d.mean), 4),
                Cell::number(measured.map(|d| d.max), 4),
                count(measured),
                Cell::number(Some(shape.exact.mean), 4),
                Cell::number(Some(shape.exact.max), 4),
                count(Some(&shape.exact)),
            ]
        };
        let table = Table {
            caption: "Displacement of the lattice's intersections, view pixels".to_owned(),
            head: vec![
                vec![
                    (String::new(), 1),
                    ("measured on the view".to_owned(), 3),
                    ("exactly, from the transport".to_owned(), 3),
                ],
                ["", "mean", "largest", "found", "mean", "largest", "formed"]
                    .map(|text| (text.to_owned(), 1))
                    .into(),
            ],
            rows: vec![
                cells("compensated", &lattice.compensated),
                cells("uncompensated", &lattice.uncompensated),
            ],
            foot: Vec::new(),
        };
        let mut blocks = vec![
            Block::Figures(vec![
                figure(&lattice.compensated.view, "Compensated.")?,
                figure(&lattice.uncompensated.view, "Uncompensated.")?,
                figure(&lattice.reference, "Reference.")?,
            ]),
            Block::Table(table),
        ];
        let notes: Vec<String> =
            [("compensated", &lattice.compensated), ("uncompensated", &lattice.uncompensated)]
                .into_iter()
                .flat_map(|(name, shape)| shape_notes(name, shape))
                .collect();
        if !notes.is_empty() {
            blocks.push(Block::Notes(notes));
        }
        blocks.push(Block::Figures(vec![
            self.arrows(
                &lattice.compensated,
                "Compensated: from where each intersection belongs to where it is seen.",
            ),
            self.arrows(&lattice.uncompensated, "Uncompensated."),
        ]));
        Ok(Section { heading: "Shape".to_owned(), blocks })
    }

    fn arrows(&self, shape: &Shape, caption: &str) -> Figure {
        let chart = VectorChart {
            size: self.proof.settings.view.map(|side| side as f64),
            lines: self.proof.settings.lattice.lines,
            reference: shape.belongs.iter().copied().map(Some).collect(),
            seen: shape.seen.clone(),
        };
        Figure { image: Image::Vectors(chart), caption: caption.to_owned() }
    }

    fn likeness(&self) -> Section {
        let ways = self.ways();
        let best = |value: fn(&Likeness) -> f64| {
            let all = ways.iter().filter_map(|(_, _, shown)| shown.likeness.as_ref().map(value));
            all.fold(f64::NEG_INFINITY, f64::max)
        };
        let (best_ssim, best_psnr) = (best(|l| l.ssim), best(|l| l.psnr));
        let rows = ways
            .iter()
            .map(|(_, name, shown)| {
                let mark = |value: Option<f64>, best: f64, decimals: usize| {
                    let cell = Cell::number(value, decimals);
                    if value == Some(best) { cell.best() } else { cell }
                };
                vec![
                    Cell::text(name.clone()),
                    mark(shown.likeness.map(|l| l.ssim), best_ssim, 4),
                    mark(shown.likeness.map(|l| l.psnr), best_psnr, 2),
                    Cell::number(Some(shown.time.as_secs_f64() * 1e3), 1),
                ]
            })
            .collect();
        let table = Table {
            caption: "Likeness of the view to the reference".to_owned(),
            head: vec![
                ["the display image", "SSIM", "PSNR, dB", "time, ms"]
                    .map(|t| (t.to_owned(), 1))
                    .into(),
            ],
            rows,
            foot: Vec::new(),
        };
        Section { heading: "Likeness".to_owned(), blocks: vec![Block::Table(table)] }
    }

    fn map_section(&self) -> Section {
        let Self { setup, proof, .. } = self;
        let counts = proof.map.counts();
        let mut rows = vec![vec![
            Cell::text("inverse (ours)"),
            Cell::number(Some(proof.map_time.as_secs_f64() * 1e3), 1),
            Cell::text(proof.effort.rays.to_string()),
            Cell::text("0"),
            Cell::text(format!("at most {:.1e}", proof.map.error_bound * 1024.0)),
        ]];
        if let Some(splat) = &proof.splat {
            rows.push(vec![
                Cell::text(format!("splat (the paper's), {} samples a pixel", splat.spp)),
                Cell::number(Some(splat.time.as_secs_f64() * 1e3), 1),
                Cell::text(splat.rays.to_string()),
                Cell::text(format!("{} of {}", splat.holes, splat.reached)),
                Cell::text(format!(
                    "{:.3} rms, {:.2} at most",
                    splat.rms_error * 1024.0,
                    splat.max_error * 1024.0
                )),
            ]);
        }
        let table = Table {
            caption: "Two ways to the map, on the same machine in the same run".to_owned(),
            head: vec![
                ["method", "time, ms", "rays", "holes", "error, pixels of a 1024-pixel image"]
                    .map(|text| (text.to_owned(), 1))
                    .into(),
            ],
            rows,
            foot: Vec::new(),
        };
        let text = format!(
            "Of {} x {} pixels: {}.",
            setup.resolution[0],
            setup.resolution[1],
            counts_line(&counts)
        );
        let mut blocks = vec![Block::Text(text), Block::Table(table)];
        if !self.notes.is_empty() {
            blocks.push(Block::Notes(self.notes.to_vec()));
        }
        Section { heading: "The map".to_owned(), blocks }
    }
}

/// A picture for the page, reduced where it is larger than the page shows it.
pub(super) fn figure(picture: &Picture, caption: &str) -> Result<Figure, FigureError> {
    let longer = picture.width.max(picture.height);
    if longer <= SHOWN {
        return Figure::picture(picture, caption);
    }
    let side = |length: usize| ((length * SHOWN + longer / 2) / longer).max(1);
    let reduced = Map::identity(side(picture.width), side(picture.height));
    Figure::picture(&display_image(picture, &reduced), caption)
}
