//! What a fit found, as a page.

use crate::finding::Finding;
use crate::parameters::Parameter;
use crate::patterns::Patterns;
use midair::scene::Loaded;
use midair_report::page::{Block, Cell, Page, Section, SummaryRow, Table};

fn row(label: &str, value: String, note: String) -> SummaryRow {
    SummaryRow { label: label.to_owned(), value, note }
}

fn head(columns: &[&str]) -> Vec<Vec<(String, usize)>> {
    vec![columns.iter().map(|column| (column.to_string(), 1)).collect()]
}

/// The page of a fit.
pub fn page(assumed: &Loaded, finding: &Finding, notes: &[String]) -> Page {
    let determined = finding.parameters.iter().filter(|p| p.determined).count();
    let summary = vec![
        row(
            "What is left",
            format!("{:.2} display pixels rms", finding.residual.rms),
            format!("{:.1} with the scene as it was assumed", finding.residual.before),
        ),
        row(
            "Determined",
            format!("{determined} of {} numbers", finding.parameters.len()),
            "their deviation is less than a third of what it was before".to_owned(),
        ),
        row(
            "Starts",
            format!("{} of {} agree", finding.starts.agree, finding.starts.tried),
            "over the uncertainty of the assumed scene".to_owned(),
        ),
    ];
    let of_scene = |p: &&Parameter| !p.name.starts_with("view.");
    let table = |caption: &str, parameters: Vec<&Parameter>| Table {
        caption: caption.to_owned(),
        head: head(&["Number", "Found", "± one deviation", "Assumed", "Determined"]),
        rows: parameters.into_iter().map(cells).collect(),
        foot: Vec::new(),
    };
    let views = Table {
        caption: "Points of the photographs: how many agree with the fitted scene, how many do not, and of how many the light does not come from the display. What is left, in display pixels".to_owned(),
        head: head(&["View", "Camera at, mm", "Empty", "Object", "Rejected", "Lost", "Left, rms"]),
        rows: finding
            .views
            .iter()
            .map(|view| {
                let [x, y, z] = view.position;
                let count = |n: usize| Cell::text(n.to_string());
                vec![
                    Cell::text(view.name.clone()),
                    Cell::text(format!("{x:.1}, {y:.1}, {z:.1}")),
                    count(view.empty.used),
                    count(view.object.used),
                    count(view.object.rejected),
                    count(view.object.lost),
                    Cell::number(Some(view.rms), 2),
                ]
            })
            .collect(),
        foot: Vec::new(),
    };
    let mut sections = vec![
        Section {
            heading: "The scene".to_owned(),
            blocks: vec![Block::Table(table(
                "Millimetres, degrees, and indices, by their keys in the scene file",
                finding.parameters.iter().filter(of_scene).collect(),
            ))],
        },
        Section { heading: "The photographs".to_owned(), blocks: vec![Block::Table(views)] },
    ];
    let mut untold: Vec<Block> = Vec::new();
    if finding.undetermined.is_empty() {
        untold.push(Block::Text("The photographs tell all that was asked for.".to_owned()));
    } else {
        untold.push(Block::Notes(finding.undetermined.clone()));
    }
    untold.extend(finding.advice.iter().map(|advice| Block::Text(advice.in_words())));
    untold.push(Block::Text(
        "All places are told in the frame of the display mirrored in the plate, which is what photographs see: plate and display were taken to stand where the scene has them."
            .to_owned(),
    ));
    sections.push(Section { heading: "What is not told".to_owned(), blocks: untold });
    let notes: Vec<String> = finding.notes.iter().chain(notes).cloned().collect();
    if !notes.is_empty() {
        let blocks = vec![Block::Notes(notes)];
        sections.push(Section { heading: "Notes".to_owned(), blocks });
    }
    let cameras: Vec<&Parameter> = finding.parameters.iter().filter(|p| !of_scene(p)).collect();
    sections.push(Section {
        heading: "The cameras".to_owned(),
        blocks: vec![Block::Table(table(
            "A camera's frame has +x right and +y up, and it looks along its −z; assumed is what the empty photographs said by themselves",
            cameras,
        ))],
    });
    Page {
        title: format!("{}, as it really is", assumed.scene.name),
        lead: "The set-up fitted to photographs of what its display shows.".to_owned(),
        summary,
        sections,
        colophon: format!("midair {}, from {}", env!("CARGO_PKG_VERSION"), assumed.text.name()),
    }
}

fn cells(parameter: &Parameter) -> Vec<Cell> {
    // As many decimals as the deviation has to say.
    let decimals = match parameter.sigma {
        sigma if sigma > 0.0 => (1.0 - sigma.log10()).ceil().clamp(1.0, 7.0) as usize,
        _ => 4,
    };
    vec![
        Cell::text(parameter.name.clone()),
        Cell::number(Some(parameter.value), decimals),
        Cell::number(Some(parameter.sigma), decimals),
        Cell::number(Some(parameter.start), decimals),
        Cell::text(if parameter.determined { "yes" } else { "no" }),
    ]
}

/// How the patterns are photographed, as a page.
pub fn instructions(loaded: &Loaded, patterns: &Patterns) -> Page {
    let list = |lines: &[&str]| Block::Notes(lines.iter().map(ToString::to_string).collect());
    let [width, height] = patterns.resolution;
    let count = patterns.list.len();
    Page {
        title: format!("Photographing {}", loaded.scene.name),
        lead: "A camera on a tripod, a dark room, and about ten minutes for each view.".to_owned(),
        summary: vec![
            row("Patterns", count.to_string(), format!("{width} x {height} pixels each")),
            row(
                "Views",
                "three or more".to_owned(),
                "one of them obliquely from above; one suffices for the map without a model"
                    .to_owned(),
            ),
            row("Photographs", (2 * count).to_string(), "for each view".to_owned()),
        ],
        sections: vec![
            Section {
                heading: "Before".to_owned(),
                blocks: vec![list(&[
                    "Show the patterns full screen, one to one: no scaling, no smoothing, no night colours. midair play SCENE patterns does so, and with --shutter it runs the camera.",
                    "Switch the room's light off. Cover what shines.",
                    "Camera on a tripod, manual exposure, manual focus on the floating picture, fixed white balance, no stabiliser. A remote release or the self-timer.",
                    "Frame the floating picture large, all of it in the frame, both of its marked corners in view.",
                    "Expose by the white pattern: just below full scale. At 1/30 s or longer no display flickers.",
                ])],
            },
            Section {
                heading: "For each view".to_owned(),
                blocks: vec![list(&[
                    "Without the object: show each pattern and take one photograph of it. The order does not matter; doubles do no harm.",
                    "Put the object in its place without touching the camera or the display. Take one photograph of each pattern again.",
                    "Copy the photographs of the two states into folders of their own, such as front-empty and front-object. JPEG as the camera makes it will do.",
                ])],
            },
            Section {
                heading: "Then".to_owned(),
                blocks: vec![list(&[
                    "Write bench.toml: the scene, and a [[view]] with name, empty and object for each view.",
                    "midair calibrate fit bench.toml --out fitted",
                ])],
            },
        ],
        colophon: format!("midair {}, for {}", env!("CARGO_PKG_VERSION"), loaded.text.name()),
    }
}
