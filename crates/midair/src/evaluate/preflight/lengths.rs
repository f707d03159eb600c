//! Lengths that look as if they were measured in another unit.

use super::bodies::corners;
use super::finding::{Finding, Kind, Severity, element_key, millimetres};
use crate::scene::Setting;
use crate::scene::model::{Scene, Shape};
use crate::transport::Setup;

/// Units that people take for millimetres, and how many of those they have.
const UNITS: [(&str, f64); 3] = [("centimetres", 10.0), ("inches", 25.4), ("metres", 1000.0)];

/// Something that has a length.
struct Length {
    what: String,
    /// Its extents, mm.
    values: Vec<f64>,
    /// What such things measure, mm: the least and the most that are made or that people stand at.
    range: [f64; 2],
    /// The key that says so, with the values it has.
    key: Option<(String, Vec<f64>)>,
}

impl Length {
    fn fits(&self, factor: f64) -> bool {
        self.values.iter().all(|v| (self.range[0]..=self.range[1]).contains(&(v * factor)))
    }

    fn is_small(&self) -> bool {
        self.values.iter().any(|&v| v < self.range[0])
    }

    fn text(&self, factor: f64) -> String {
        let sides: Vec<String> = self
            .values
            .iter()
            .map(|v| format!("{}", (v * factor * 1000.0).round() / 1000.0))
            .collect();
        format!("{} mm", sides.join(" x "))
    }
}

pub(super) fn findings(setup: &Setup, scene: &Scene) -> Vec<Finding> {
    let lengths = lengths(setup, scene);
    let odd: Vec<&Length> = lengths.iter().filter(|length| !length.fits(1.0)).collect();
    // Where most of a scene is small by the same factor, it is one mistake.
    let common = UNITS
        .iter()
        .find(|(_, factor)| odd.iter().all(|length| length.is_small() && length.fits(*factor)));
    if let (true, Some((unit, factor))) = (odd.len() >= 3, common) {
        let names: Vec<String> =
            odd.iter().map(|length| format!("{} ({})", length.what, length.text(1.0))).collect();
        let sentence =
            format!("the scene looks as if it was measured in {unit}: {}", names.join(", "));
        return vec![
            Finding::new(Kind::Unit, Severity::Warning, sentence)
                .remedy(format!("lengths are in millimetres: multiply all of them by {factor}")),
        ];
    }
    odd.into_iter().map(finding).collect()
}

fn finding(length: &Length) -> Finding {
    let size = if length.is_small() { "smaller" } else { "larger" };
    let [least, most] = length.range;
    let sentence = format!(
        "{} measures {}, which is {size} than usual ({least} to {most} mm)",
        length.what,
        length.text(1.0)
    );
    let finding = Finding::new(Kind::Unit, Severity::Warning, sentence);
    let fitting: Vec<_> = UNITS.iter().filter(|(_, factor)| length.fits(*factor)).collect();
    let Some((_, factor)) = fitting.first() else {
        return finding.remedy("lengths are in millimetres: look it up again");
    };
    let units: Vec<String> =
        fitting.iter().map(|(unit, factor)| format!("{unit} ({})", length.text(*factor))).collect();
    let finding = finding.remedy(format!(
        "lengths are in millimetres; was it measured in {}?",
        units.join(" or in ")
    ));
    match &length.key {
        Some((key, _)) if key.ends_with(".unit") => finding.line(
            key.as_str(),
            match *factor {
                10.0 => "cm",
                1000.0 => "m",
                _ => "in",
            },
        ),
        Some((key, values)) => {
            let values = values.iter().map(|v| millimetres([v * factor])[0]).collect();
            finding.line(key.as_str(), Setting::Numbers(values))
        }
        None => finding,
    }
}

fn lengths(setup: &Setup, scene: &Scene) -> Vec<Length> {
    let rectangle = |what: &str, key: &str, size: [f64; 2], range| Length {
        what: what.to_owned(),
        values: size.to_vec(),
        range,
        key: Some((key.to_owned(), size.to_vec())),
    };
    let mut lengths = vec![
        // Smaller than a letter; larger than a door.
        rectangle("the image", "image.size", setup.image.size, [3.0, 2000.0]),
        // Modules of 50 mm to panels put together.
        rectangle("the plate", "plate.size", setup.plate.rectangle.size, [40.0, 3000.0]),
    ];
    if let Some(size) = scene.display.size {
        lengths.push(rectangle("the display", "display.size", size, [3.0, 3000.0]));
    }
    lengths.push(Length {
        what: "the way from the viewpoint to the image".to_owned(),
        values: vec![(setup.viewpoint - setup.image.frame.origin).length()],
        // Nearer than an eye can focus; farther than a hall.
        range: [100.0, 20_000.0],
        key: None,
    });
    for (element, described) in setup.elements.iter().zip(&scene.elements) {
        let all = corners(element);
        let largest = all
            .iter()
            .flat_map(|a| all.iter().map(move |b| (*a - *b).length()))
            .fold(0.0, f64::max);
        // A unit that the scene states is not doubted.
        let key = matches!(described.shape, Shape::Mesh { unit: 1.0, .. })
            .then(|| (element_key(&element.name, "shape.unit"), Vec::new()));
        lengths.push(Length {
            what: format!("\"{}\" from corner to corner", element.name),
            values: vec![largest],
            range: [5.0, 10_000.0],
            key,
        });
    }
    lengths
}
