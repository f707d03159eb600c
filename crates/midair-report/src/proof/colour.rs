//! What a report says of brightness, colour fringes and stray light.

use super::page::figure;
use crate::page::{Block, Cell, Figure, FigureError, Section, SummaryRow, Table};
use crate::{percent, stray};
use midair::evaluate::colour::{Colour, Evenness, FringeWidth, Fringes};
use midair::evaluate::stray::Stray;
use midair::map::Gain;
use midair::picture::Picture;
use midair::scene::model::{PlateModel, Scene};

/// For people.
pub(super) fn lines(colour: &Colour) -> String {
    let found = &colour.evenness;
    let mut lines = format!(
        "uniformity of a white field (maximum over minimum): {} without correction, {} with --gain fit (white level {}); --gain clip: white level {}, {} clipped\n",
        ratio(found.plain),
        ratio(found.even),
        percent(found.fit_level),
        percent(found.clip_level),
        percent(found.clipped),
    );
    if let Some(fringes) = &colour.fringes {
        lines += &format!(
            "colour fringes at the lattice's lines: {} with one map, {} with --per-channel\n",
            width_text(fringes.one_map),
            width_text(fringes.by_colour)
        );
    }
    lines + &stray::line(&colour.stray)
}

/// Rows for the page's summary.
pub(super) fn summary(colour: &Colour) -> Vec<SummaryRow> {
    let found = &colour.evenness;
    let mut rows = vec![SummaryRow {
        label: "Uniformity of a white field, maximum over minimum".to_owned(),
        value: ratio(found.even),
        note: format!("with --gain fit; {} without correction", ratio(found.plain)),
    }];
    if let Some(fringes) = &colour.fringes {
        rows.push(SummaryRow {
            label: "Colour fringes at the lattice's lines".to_owned(),
            value: width_text(fringes.by_colour),
            note: format!("with --per-channel; {} with one map", width_text(fringes.one_map)),
        });
    }
    rows
}

/// The page's section.
pub(super) fn section(colour: &Colour, scene: &Scene) -> Result<Section, FigureError> {
    let found = &colour.evenness;
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
            figure(&even, "The same with uniformity correction (--gain fit), stretched alike.")?,
        ]),
        Block::Table(brightness_table(found)),
    ];
    if let Some(fringes) = &colour.fringes {
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
    blocks.push(Block::Text(format!("Stray light. {of_plate}, with its lattice averaged over:")));
    blocks.push(Block::Figures(stray_figures(&colour.stray)?));
    blocks.push(Block::Notes(stray::lines(&colour.stray).lines().map(str::to_owned).collect()));
    Ok(Section { heading: "Brightness and colour".to_owned(), blocks })
}

fn stray_figures(found: &Stray) -> Result<Vec<Figure>, FigureError> {
    Ok(vec![
        figure(
            &stray::picture(&found.wide),
            "Four times as wide as the image: the image white, the two stray images orange and blue, the display seen through the plate green.",
        )?,
        figure(&stray::picture(&found.near), "The same, the image alone.")?,
    ])
}

fn brightness_table(found: &Evenness) -> Table {
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

/// The pictures with the names of their files.
pub fn pictures(colour: &Colour) -> Vec<(&'static str, Picture)> {
    let [plain, even] = fields(&colour.evenness.views);
    let mut pictures = vec![
        ("gain.png", gain_picture(&colour.evenness.gain)),
        ("white-uncompensated.png", plain),
        ("white-compensated.png", even),
    ];
    if let Some(fringes) = &colour.fringes {
        let [plain, by_colour] = fringes.close_ups.clone();
        pictures.extend([("fringes-one-map.png", plain), ("fringes-per-channel.png", by_colour)]);
    }
    pictures.push(("stray.png", stray::picture(&colour.stray.wide)));
    pictures
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
    let least = least_share(plain);
    [plain, even].map(|view| toned(view, least))
}

/// A view of a white field over its brightest, stretched so that its least and its largest light differ; black where nothing is seen.
pub fn field_picture(view: &Picture) -> Picture {
    toned(view, least_share(view))
}

/// The least light over the largest; 0 where nothing is seen.
fn least_share(view: &Picture) -> f32 {
    let [least, most] = range(view);
    if least.is_finite() { least / most } else { 0.0 }
}

/// The least and the largest light where something is seen.
fn range(view: &Picture) -> [f32; 2] {
    let lit = view.pixels.iter().filter(|pixel| pixel[3] > 0.0).flat_map(|pixel| &pixel[..3]);
    lit.fold([f32::INFINITY, 0.0], |[least, most], &v| [v.min(least), v.max(most)])
}

/// A view from this share of its brightest light, dark grey, to the brightest, white.
fn toned(view: &Picture, least: f32) -> Picture {
    let brightest = range(view)[1].max(f32::MIN_POSITIVE);
    let tone = Tone::of([least * brightest, brightest]);
    let pixel = |&[r, g, b, a]: &[f32; 4]| tone.pixel((a > 0.0).then_some([r, g, b]));
    let pixels = view.pixels.iter().map(pixel).collect();
    Picture { width: view.width, height: view.height, pixels }
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
