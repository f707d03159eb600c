//! What a report says of brightness, colour fringes and stray light.

use crate::commands::check::Stray;
use crate::failure::Failure;
use crate::report_page::figure;
use crate::summary::{number, percent};
use midair::clock::Laps;
use midair::evaluate::colour::{Evenness, FringeWidth, Fringes, evenness, fringes};
use midair::evaluate::proof::Settings;
use midair::files::Output;
use midair::map::{Gain, Map};
use midair::picture::{Depth, Picture, write_still};
use midair::scene::Loaded;
use midair::scene::model::{PlateModel, Scene};
use midair::transport::Setup;
use midair_report::page::{Block, Cell, Figure, FigureError, Section, SummaryRow, Table};
use serde_json::{Value, json};
use std::time::Duration;

/// Brightness, fringes where a material disperses, and stray light.
pub struct Colour {
    evenness: Evenness,
    fringes: Option<Fringes>,
    stray: Stray,
    /// How long each took.
    pub timings: Vec<(&'static str, Duration)>,
}

/// Width of the white field's views in pixels.
const FIELD: usize = 256;

impl Colour {
    /// Looks at a set-up: as `compensate --gain` and `--per-channel` and `check --stray` do.
    pub fn of(
        loaded: &Loaded,
        setup: &Setup,
        settings: &Settings,
        map: &Map,
    ) -> Result<Self, Failure> {
        let mut laps = Laps::start();
        let evenness = evenness(setup, setup.view_size(FIELD));
        laps.lap("brightness");
        let fringes = match setup.disperses() {
            true => Some(fringes(setup, map, &settings.lattice, settings.view[0])?),
            false => None,
        };
        laps.lap("fringes");
        let stray = Stray::at_least_usual(&loaded.scene.plate.model, setup, map)?;
        laps.lap("stray");
        Ok(Self { evenness, fringes, stray, timings: laps.into_all() })
    }

    /// For report.json.
    pub fn brightness_json(&self) -> Value {
        let found = &self.evenness;
        let range = found.gain.range();
        json!({
            "gain": {
                "least": range.map(|[least, _]| least),
                "most": range.map(|[_, most]| most),
                "size": [found.gain.width, found.gain.height],
            },
            "white_field": {
                "uncompensated": number(found.plain),
                "compensated": number(found.even),
            },
            "fit": { "level": found.fit_level, "clipped": 0.0 },
            "clip": { "level": found.clip_level, "clipped": found.clipped },
        })
    }

    /// For report.json; nothing if no material disperses.
    pub fn fringes_json(&self) -> Value {
        let Some(found) = &self.fringes else { return Value::Null };
        let told =
            |width: FringeWidth| json!({ "mean": number(width.mean), "max": number(width.max) });
        json!({
            "one_map": told(found.one_map),
            "per_channel": told(found.by_colour),
            "places": found.places,
            "resolution_per_channel": found.resolution,
        })
    }

    /// For report.json.
    pub fn stray_json(&self) -> Value {
        self.stray.json()
    }

    /// For people.
    pub fn lines(&self) -> String {
        let found = &self.evenness;
        let mut lines = format!(
            "uniformity of a white field (maximum over minimum): {} without correction, {} with --gain fit (white level {}); --gain clip: white level {}, {} clipped\n",
            ratio(found.plain),
            ratio(found.even),
            percent(found.fit_level),
            percent(found.clip_level),
            percent(found.clipped),
        );
        if let Some(fringes) = &self.fringes {
            lines += &format!(
                "colour fringes at the lattice's lines: {} with one map, {} with --per-channel\n",
                width_text(fringes.one_map),
                width_text(fringes.by_colour)
            );
        }
        lines + &self.stray.line()
    }

    /// Rows for the page's summary.
    pub fn summary(&self) -> Vec<SummaryRow> {
        let found = &self.evenness;
        let mut rows = vec![SummaryRow {
            label: "Uniformity of a white field, maximum over minimum".to_owned(),
            value: ratio(found.even),
            note: format!("with --gain fit; {} without correction", ratio(found.plain)),
        }];
        if let Some(fringes) = &self.fringes {
            rows.push(SummaryRow {
                label: "Colour fringes at the lattice's lines".to_owned(),
                value: width_text(fringes.by_colour),
                note: format!("with --per-channel; {} with one map", width_text(fringes.one_map)),
            });
        }
        rows
    }

    /// The page's section.
    pub fn section(&self, scene: &Scene) -> Result<Section, FigureError> {
        let found = &self.evenness;
        let [least, most] = found.gain.range().unwrap_or_default();
        let gain = format!(
            "The gain of each display pixel, from {:.1} (dark) to {:.1} % (white). Black: no answer.",
            100.0 * least,
            100.0 * most
        );
        let [plain, even] = fields(&found.views);
        let mut blocks = vec![
            Block::Figures(vec![
                figure(&gain_picture(&found.gain), &gain)?,
                figure(
                    &plain,
                    "View of a white field, contrast stretched. Black: not formed, or at the edge.",
                )?,
                figure(
                    &even,
                    "The same with uniformity correction (--gain fit), stretched alike.",
                )?,
            ]),
            Block::Table(self.brightness_table()),
        ];
        if let Some(fringes) = &self.fringes {
            blocks.push(Block::Table(fringe_table(fringes)));
            let [plain, by_colour] = &fringes.close_ups;
            blocks.push(Block::Figures(vec![
                figure(
                    plain,
                    "A white lattice where its fringes are widest, one map for all colours.",
                )?,
                figure(by_colour, "The same with a map for each colour (--per-channel).")?,
            ]));
        }
        let of_plate = match scene.plate.model {
            PlateModel::SlitMirror(_) => "The scene's slit-mirror plate",
            PlateModel::Ideal => "A typical slit-mirror plate instead of the ideal one",
        };
        blocks
            .push(Block::Text(format!("Stray light. {of_plate}, with its lattice averaged over:")));
        blocks.push(Block::Figures(self.stray_figures()?));
        blocks.push(Block::Notes(self.stray.lines().lines().map(str::to_owned).collect()));
        Ok(Section { heading: "Brightness and colour".to_owned(), blocks })
    }

    fn stray_figures(&self) -> Result<Vec<Figure>, FigureError> {
        Ok(vec![
            figure(
                &self.stray.picture(),
                "Four times as wide as the image: the image white, the two stray images orange and blue, the display seen through the plate green.",
            )?,
            figure(&self.stray.close_up(), "The same, the image alone.")?,
        ])
    }

    fn brightness_table(&self) -> Table {
        let found = &self.evenness;
        let share = |value: f64| Cell::text(percent(value));
        Table {
            caption: "A white field: the worst of red, green and blue".to_owned(),
            head: vec![
                ["", "maximum over minimum", "white level", "clipped"]
                    .map(|text| (text.to_owned(), 1))
                    .into(),
            ],
            rows: vec![
                vec![
                    Cell::text("without correction"),
                    Cell::number(Some(found.plain), 4),
                    Cell::text("-"),
                    share(0.0),
                ],
                vec![
                    Cell::text("--gain fit"),
                    Cell::number(Some(found.even), 4),
                    share(found.fit_level),
                    share(0.0),
                ],
                vec![
                    Cell::text("--gain clip"),
                    Cell::text("-"),
                    share(found.clip_level),
                    share(found.clipped),
                ],
            ],
            foot: Vec::new(),
        }
    }

    /// Writes the pictures.
    pub fn write(&self, output: &mut Output) -> Result<(), Failure> {
        let mut picture = |name: &str, picture: &Picture| -> Result<(), Failure> {
            Ok(output.write(name, |path| write_still(path, picture, Depth::Eight))?)
        };
        picture("gain.png", &gain_picture(&self.evenness.gain))?;
        let [plain, even] = fields(&self.evenness.views);
        picture("white-uncompensated.png", &plain)?;
        picture("white-compensated.png", &even)?;
        if let Some(fringes) = &self.fringes {
            let [plain, by_colour] = &fringes.close_ups;
            picture("fringes-one-map.png", plain)?;
            picture("fringes-per-channel.png", by_colour)?;
        }
        picture("stray.png", &self.stray.picture())
    }
}

fn fringe_table(fringes: &Fringes) -> Table {
    let row = |name: &str, width: FringeWidth| {
        vec![Cell::text(name), Cell::number(Some(width.mean), 4), Cell::number(Some(width.max), 4)]
    };
    Table {
        caption: format!(
            "Colour fringes across the lattice's lines at {} places, view pixels",
            fringes.places
        ),
        head: vec![["", "mean", "largest"].map(|text| (text.to_owned(), 1)).into()],
        rows: vec![
            row("one map", fringes.one_map),
            row("a map for each colour", fringes.by_colour),
        ],
        foot: Vec::new(),
    }
}

/// The gain as a picture, stretched so that its least and its largest share differ; black where there is no answer.
fn gain_picture(gain: &Gain) -> Picture {
    let tone = Tone::of(gain.range().unwrap_or_default());
    let pixel = |rgb: &[f32; 3]| tone.pixel(Gain::is_answered(rgb).then_some(*rgb));
    Picture { width: gain.width, height: gain.height, pixels: gain.rgb.iter().map(pixel).collect() }
}

/// The white field before and after, each over its brightest, stretched alike; black where nothing is seen.
fn fields([plain, even]: &[Picture; 2]) -> [Picture; 2] {
    let range = |view: &Picture| {
        let lit = view.pixels.iter().filter(|pixel| pixel[3] > 0.0).flat_map(|pixel| &pixel[..3]);
        lit.fold([f32::INFINITY, 0.0], |[least, most], &v| [v.min(least), v.max(most)])
    };
    let [least, most] = range(plain);
    let least = if least.is_finite() { least / most } else { 0.0 };
    [plain, even].map(|view| {
        let brightest = range(view)[1].max(f32::MIN_POSITIVE);
        let tone = Tone::of([least * brightest, brightest]);
        let pixel = |&[r, g, b, a]: &[f32; 4]| tone.pixel((a > 0.0).then_some([r, g, b]));
        let pixels = view.pixels.iter().map(pixel).collect();
        Picture { width: view.width, height: view.height, pixels }
    })
}

/// How small differences of brightness are shown: from a dark grey to white, the brightest; what is even is white.
struct Tone {
    least: f32,
    span: f32,
}

impl Tone {
    fn of([least, most]: [f32; 2]) -> Self {
        // Less than a hundredth is not blown up: it stays near white.
        let span = (most - least).max(0.01 * most).max(f32::MIN_POSITIVE);
        Self { least: most - span, span }
    }

    fn pixel(&self, rgb: Option<[f32; 3]>) -> [f32; 4] {
        let Some(rgb) = rgb else { return [0.0, 0.0, 0.0, 1.0] };
        let [r, g, b] = rgb.map(|v| 0.05 + 0.95 * ((v - self.least) / self.span).clamp(0.0, 1.0));
        [r, g, b, 1.0]
    }
}

/// A ratio in words; a dash where there is none.
fn ratio(value: f64) -> String {
    if value.is_finite() { format!("{value:.3}") } else { "-".to_owned() }
}

fn width_text(width: FringeWidth) -> String {
    match width.mean.is_finite() {
        true => format!("{:.3} px ({:.3} at most)", width.mean, width.max),
        false => "not measurable".to_owned(),
    }
}
