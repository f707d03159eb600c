//! What the paper's evaluation yields, as data: likeness of views, displacement over azimuth, the paper's own figures beside.

use serde_json::{Value, json};

/// Likeness of a view to its reference (the same image without the object).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scores {
    /// SSIM, mean over colour channels; 1 is equal.
    pub ssim: f64,
    /// LPIPS; 0 is equal. None when its weights were not at hand.
    pub lpips: Option<f64>,
    /// SSIM after a 5 x 5 box blur of both.
    pub blurred_ssim: f64,
}

/// One image seen through (or on) one surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quality {
    /// Name of the surface: its rows are gathered by it.
    pub surface: String,
    /// Name of the image.
    pub image: String,
    /// With compensation.
    pub with: Scores,
    /// Without.
    pub without: Scores,
}

/// The lattice's mean displacement over the camera's azimuth, at one surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    /// Name of the surface.
    pub surface: String,
    /// One for each place of the camera.
    pub views: Vec<ShapeView>,
}

/// The lattice's mean displacement seen from one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapeView {
    /// Degrees; 0 is the viewpoint that is compensated for.
    pub azimuth: f64,
    /// Pixels, compensated for this place; None when too little of the lattice was found.
    pub with: Option<f64>,
    /// Pixels, with the compensation for azimuth 0 kept.
    pub kept: Option<f64>,
    /// Pixels, without.
    pub without: Option<f64>,
    /// Over how many intersections each of them is: those found under every condition that was measured.
    pub intersections: usize,
}

impl ShapeView {
    /// Compensated, with the compensation for azimuth 0 kept, and without, where all of them are known.
    pub fn complete(&self) -> Option<[f64; 3]> {
        Some([self.with?, self.kept?, self.without?])
    }
}

impl Shape {
    /// The means of the three conditions over the same azimuths, those at which all were measured, and how many azimuths
    /// and intersections that are.
    pub fn means(&self) -> ([Option<f64>; 3], usize, usize) {
        let complete: Vec<([f64; 3], usize)> = self
            .views
            .iter()
            .filter_map(|view| Some((view.complete()?, view.intersections)))
            .collect();
        let of = |condition: usize| mean(complete.iter().map(|(all, _)| Some(all[condition])));
        (
            [of(0), of(1), of(2)],
            complete.len(),
            complete.iter().map(|(_, intersections)| intersections).sum(),
        )
    }

    /// What a mean is over, in words.
    pub fn extent(&self) -> String {
        let (_, azimuths, intersections) = self.means();
        format!("{azimuths} of {} azimuths, {intersections} intersections", self.views.len())
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
    /// Table 1.
    pub quality: Vec<Quality>,
    /// Figure 7, a surface each.
    pub shapes: Vec<Shape>,
    /// What was assumed: camera distance, aperture, crop, exposure.
    pub assumptions: Vec<String>,
    /// Where ours differ from the paper's, and why.
    pub differences: Vec<String>,
    /// What could not be measured, and why.
    pub notes: Vec<String>,
}

impl Evaluation {
    /// The numbers as JSON: `quality`, `shapes`, `published`, `assumptions`, `differences`.
    pub fn to_json(&self) -> Value {
        let scores = |scores: &Scores| {
            json!({
                "ssim": scores.ssim, "lpips": scores.lpips, "blurred_ssim": scores.blurred_ssim
            })
        };
        let quality = self.quality.iter().map(|row| {
            json!({
                "surface": row.surface, "image": row.image,
                "with": scores(&row.with), "without": scores(&row.without)
            })
        });
        let shapes = self.shapes.iter().map(|shape| {
            let views = shape.views.iter().map(|view| {
                json!({
                    "azimuth": view.azimuth, "with": view.with, "kept": view.kept,
                    "without": view.without, "intersections": view.intersections
                })
            });
            let (means, azimuths, intersections) = shape.means();
            json!({
                "surface": shape.surface, "views": views.collect::<Vec<_>>(),
                "mean": {
                    "with": means[0], "kept": means[1], "without": means[2],
                    "azimuths": azimuths, "intersections": intersections
                }
            })
        });
        let means = surfaces(&self.quality).into_iter().map(|surface| {
            let rows = || self.quality.iter().filter(|row| row.surface == surface);
            let of = MEASURES.iter().map(|(key, of, more)| {
                let (with, without) = (
                    mean(rows().map(|row| of(&row.with))),
                    mean(rows().map(|row| of(&row.without))),
                );
                let wins = |who: Winner| {
                    rows().filter(|r| winner(of(&r.with), of(&r.without), *more) == who).count()
                };
                let found = json!({
                    "with": with, "without": without,
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
        json!({
            "quality": quality.collect::<Vec<_>>(),
            "means": means.collect::<Vec<_>>(),
            "shapes": shapes.collect::<Vec<_>>(),
            "published": {
                "quality": published_quality.collect::<Vec<_>>(),
                "displacement": published_shapes.collect::<Vec<_>>(),
            },
            "assumptions": self.assumptions,
            "differences": self.differences,
            "notes": self.notes,
        })
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
        let evaluation = Evaluation { quality, ..Evaluation::default() };
        let json = evaluation.to_json();
        assert_eq!(json["quality"][2]["without"]["lpips"], 0.6);
        assert_eq!(json["quality"][1]["with"]["lpips"], Value::Null);
        assert_eq!(json["published"]["displacement"][0]["with"], 23.91);
    }
}
