//! What the paper's evaluation yields, as data: likeness of views, displacement over azimuth, the paper's own figures beside.

use crate::evaluate::proof::Comparison;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Likeness of a view to its reference (the same image without the object).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scores {
    /// SSIM, mean over colour channels; 1 is equal.
    pub ssim: f64,
    /// LPIPS; 0 is equal. None when its weights were not at hand.
    pub lpips: Option<f64>,
    /// SSIM after a 5 x 5 box blur of both.
    pub blurred_ssim: f64,
}

/// One image seen through (or on) one surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Name of the surface: its rows are gathered by it.
    pub surface: String,
    /// Name of the image.
    pub image: String,
    /// With compensation.
    pub with: Scores,
    /// Without.
    pub without: Scores,
    /// The reference rendered once more with other random numbers: what noise alone takes off. No view can be known to be more like the
    /// reference than the reference itself.
    pub floor: Scores,
}

/// The lattice's mean displacement over the camera's azimuth, at one surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Name of the surface.
    pub surface: String,
    /// One for each place of the camera.
    pub views: Vec<ShapeView>,
    /// Intersections that calculated means are over, the same from every place: those that are formed from all.
    pub intersections: usize,
    /// Intersections that measured means are over, the same in every view in which any was found.
    pub measured_intersections: usize,
    /// Intersections of the lattice.
    pub lattice: usize,
}

/// Mean displacements under three conditions, pixels; `None` where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Displacements {
    /// Compensated for the place of the camera.
    pub with: Option<f64>,
    /// With the compensation for azimuth 0 kept.
    pub kept: Option<f64>,
    /// Without.
    pub without: Option<f64>,
}

impl Displacements {
    /// With, kept, without.
    pub fn all(self) -> [Option<f64>; 3] {
        [self.with, self.kept, self.without]
    }

    fn means(all: impl Iterator<Item = Self> + Clone) -> Self {
        let of = |pick: fn(Self) -> Option<f64>| mean(all.clone().map(pick));
        Self { with: of(|d| d.with), kept: of(|d| d.kept), without: of(|d| d.without) }
    }
}

/// The lattice's mean displacement seen from one place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShapeView {
    /// Degrees; 0 is the viewpoint that is compensated for.
    pub azimuth: f64,
    /// By calculation, over [`Shape::intersections`].
    pub exact: Displacements,
    /// Measured on views, over [`Shape::measured_intersections`].
    pub measured: Displacements,
    /// By calculation over the measured ones: what the measurement should give.
    pub exact_there: Displacements,
}

impl Shape {
    /// The calculated means over all azimuths.
    pub fn mean(&self) -> Displacements {
        Displacements::means(self.views.iter().map(|view| view.exact))
    }

    /// The measured means, over the azimuths at which all three were measured; how many those are; and what the
    /// calculation gives for the same azimuths and intersections.
    pub fn measured_mean(&self) -> (Displacements, usize, Displacements) {
        let complete =
            self.views.iter().filter(|view| view.measured.all().iter().all(Option::is_some));
        (
            Displacements::means(complete.clone().map(|view| view.measured)),
            complete.clone().count(),
            Displacements::means(complete.map(|view| view.exact_there)),
        )
    }

    /// What the calculated mean is over, in words.
    pub fn extent(&self) -> String {
        format!(
            "{} azimuths, the same {} of {} intersections at each",
            self.views.len(),
            self.intersections,
            self.lattice
        )
    }

    /// What the measured mean is over, in words.
    pub fn measured_extent(&self) -> String {
        let (_, azimuths, _) = self.measured_mean();
        format!(
            "{azimuths} of {} azimuths, the same {} intersections at each",
            self.views.len(),
            self.measured_intersections
        )
    }
}

/// What the paper reports for a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published<T> {
    /// Name of the surface, as in `scenes/paper/`.
    pub surface: &'static str,
    /// With compensation.
    pub with: T,
    /// Without.
    pub without: T,
}

/// The paper's table 1, simulated, means over its images.
pub const PUBLISHED_QUALITY: [Published<Scores>; 2] = [
    Published {
        surface: "cylinder",
        with: Scores { ssim: 0.156, lpips: Some(0.550), blurred_ssim: 0.742 },
        without: Scores { ssim: 0.126, lpips: Some(0.608), blurred_ssim: 0.616 },
    },
    Published {
        surface: "bent mirror",
        with: Scores { ssim: 0.478, lpips: Some(0.301), blurred_ssim: 0.903 },
        without: Scores { ssim: 0.374, lpips: Some(0.412), blurred_ssim: 0.735 },
    },
];

/// The paper's mean displacements over azimuth, measured on photographs of 6000 x 4000 pixels.
pub const PUBLISHED_DISPLACEMENT: [Published<f64>; 2] = [
    Published { surface: "cube", with: 23.91, without: 78.87 },
    Published { surface: "bent mirror", with: 30.53, without: 138.68 },
];

/// The paper's figures for a surface, by its name.
pub fn published<T: Copy>(all: &[Published<T>], surface: &str) -> Option<Published<T>> {
    let named = |name: &str| name.to_lowercase().replace(['-', '_'], " ");
    all.iter().copied().find(|one| named(surface).contains(one.surface))
}

/// A measure of likeness: its key in JSON, how to read it off some scores, and whether more is better.
pub type Measure = (&'static str, fn(&Scores) -> Option<f64>, bool);

/// The three measures of likeness.
pub const MEASURES: [Measure; 3] = [
    ("ssim", |scores| Some(scores.ssim), true),
    ("lpips", |scores| scores.lpips, false),
    ("blurred_ssim", |scores| Some(scores.blurred_ssim), true),
];

/// Which condition is the better one by a measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Winner {
    /// With compensation.
    With,
    /// Without.
    Without,
    /// Equal, or one of them is unknown.
    Neither,
}

/// Which of two values is the better one.
pub fn winner(with: Option<f64>, without: Option<f64>, more_is_better: bool) -> Winner {
    match (with, without) {
        (Some(a), Some(b)) if (a > b && more_is_better) || (a < b && !more_is_better) => {
            Winner::With
        }
        (Some(a), Some(b)) if (a < b && more_is_better) || (a > b && !more_is_better) => {
            Winner::Without
        }
        _ => Winner::Neither,
    }
}

/// Mean of the known values.
pub fn mean(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let known: Vec<f64> = values.flatten().filter(|value| value.is_finite()).collect();
    (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
}

/// The surfaces of some rows in the order in which they first appear.
pub fn surfaces(rows: &[Quality]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for row in rows {
        if !names.contains(&row.surface.as_str()) {
            names.push(&row.surface);
        }
    }
    names
}

/// All that the paper's evaluation yields.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluation {
    /// Whether the set-ups are the paper's: its figures then stand beside.
    pub published: bool,
    /// Table 1.
    pub quality: Vec<Quality>,
    /// Figure 7, a surface each.
    pub shapes: Vec<Shape>,
    /// Ways to fill the display, a surface each, if they were compared.
    pub ways: Vec<Comparison>,
    /// What was assumed: camera distance, aperture, crop, exposure.
    pub assumptions: Vec<String>,
    /// Where ours differ from the paper's, and why.
    pub differences: Vec<String>,
    /// What could not be measured, and why.
    pub notes: Vec<String>,
}

impl Evaluation {
    /// The numbers as JSON: `quality`, `shapes`, `published`, `assumptions`, `differences`; `ways` if they were compared.
    pub fn to_json(&self) -> Value {
        let scores = |scores: &Scores| {
            json!({
                "ssim": scores.ssim, "lpips": scores.lpips, "blurred_ssim": scores.blurred_ssim
            })
        };
        let quality = self.quality.iter().map(|row| {
            json!({
                "surface": row.surface, "image": row.image,
                "with": scores(&row.with), "without": scores(&row.without), "floor": scores(&row.floor)
            })
        });
        let shapes = self.shapes.iter().map(|shape| {
            let (measured, azimuths, exact_there) = shape.measured_mean();
            json!({
                "surface": shape.surface, "views": shape.views, "mean": shape.mean(),
                "intersections": shape.intersections,
                "measured": {
                    "mean": measured, "exact_there": exact_there, "azimuths": azimuths,
                    "intersections": shape.measured_intersections
                }
            })
        });
        let means = surfaces(&self.quality).into_iter().map(|surface| {
            let rows = || self.quality.iter().filter(|row| row.surface == surface);
            let of = MEASURES.iter().map(|(key, of, more)| {
                let [with, without, floor] = [
                    mean(rows().map(|row| of(&row.with))),
                    mean(rows().map(|row| of(&row.without))),
                    mean(rows().map(|row| of(&row.floor))),
                ];
                let wins = |who: Winner| {
                    rows().filter(|r| winner(of(&r.with), of(&r.without), *more) == who).count()
                };
                let found = json!({
                    "with": with, "without": without, "floor": floor,
                    "better_with": wins(Winner::With), "better_without": wins(Winner::Without)
                });
                ((*key).to_owned(), found)
            });
            let of: serde_json::Map<String, Value> = of.collect();
            json!({"surface": surface, "images": rows().count(), "mean": of})
        });
        let published_quality = PUBLISHED_QUALITY.iter().map(|one| {
            json!({
                "surface": one.surface, "with": scores(&one.with), "without": scores(&one.without)
            })
        });
        let published_shapes = PUBLISHED_DISPLACEMENT
            .iter()
            .map(|one| json!({"surface": one.surface, "with": one.with, "without": one.without}));
        let mut told = json!({
            "quality": quality.collect::<Vec<_>>(),
            "means": means.collect::<Vec<_>>(),
            "shapes": shapes.collect::<Vec<_>>(),
            "assumptions": self.assumptions,
            "differences": self.differences,
            "notes": self.notes,
        });
        if !self.ways.is_empty() {
            told["ways"] = json!(self.ways);
        }
        if self.published {
            told["published"] = json!({
                "quality": published_quality.collect::<Vec<_>>(),
                "displacement": published_shapes.collect::<Vec<_>>(),
            });
        }
        told
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_json_holds_every_number() {
        let without = Scores { lpips: Some(0.6), ..Scores::default() };
        let last = Quality { without, ..Quality::default() };
        let quality = vec![Quality::default(), Quality::default(), last];
        let evaluation = Evaluation { published: true, quality, ..Evaluation::default() };
        let json = evaluation.to_json();
        assert_eq!(json["quality"][2]["without"]["lpips"], 0.6);
        assert_eq!(json["quality"][1]["with"]["lpips"], Value::Null);
        assert_eq!(json["published"]["displacement"][0]["with"], 23.91);
    }
}
