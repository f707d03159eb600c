//! The evaluation as tables for other programs.

use super::evaluation::{Displacements, Evaluation, MEASURES};
use std::fmt::Write as _;

impl Evaluation {
    /// Likeness, a row for each image on each surface: with compensation, without, and what noise alone leaves; a value that is not known is empty.
    pub fn likeness_csv(&self) -> String {
        let mut csv = "surface,image".to_owned();
        for (name, _, _) in MEASURES {
            let _ = write!(csv, ",{name}_with,{name}_without,{name}_noise_alone");
        }
        csv.push('\n');
        for row in &self.quality {
            csv += &format!("{},{}", field(&row.surface), field(&row.image));
            for (_, of, _) in MEASURES {
                for scores in [&row.with, &row.without, &row.floor] {
                    csv += &number(of(scores));
                }
            }
            csv.push('\n');
        }
        csv
    }

    /// Displacements in the camera's pixels, a row for each azimuth: calculated, measured, and calculated over the measured intersections.
    pub fn displacement_csv(&self) -> String {
        let mut csv = "surface,azimuth".to_owned();
        for name in ["calculated", "measured", "calculated_there"] {
            let _ = write!(csv, ",{name}_with,{name}_kept,{name}_without");
        }
        csv += ",intersections,measured_intersections\n";
        for shape in &self.shapes {
            for view in &shape.views {
                csv += &format!("{},{}", field(&shape.surface), view.azimuth);
                let all: [Displacements; 3] = [view.exact, view.measured, view.exact_there];
                for value in all.into_iter().flat_map(Displacements::all) {
                    csv += &number(value);
                }
                let _ = writeln!(csv, ",{},{}", shape.intersections, shape.measured_intersections);
            }
        }
        csv
    }
}

/// A number with the comma before it.
fn number(value: Option<f64>) -> String {
    value.filter(|value| value.is_finite()).map_or(",".to_owned(), |value| format!(",{value}"))
}

/// A text as RFC 4180 has it.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::super::evaluation::{Quality, Scores, Shape, ShapeView};
    use super::*;

    #[test]
    fn every_row_has_as_many_fields_as_the_head() {
        let row = Quality {
            surface: "a \"glass\", tall".to_owned(),
            image: "waves".to_owned(),
            with: Scores { ssim: 0.5, lpips: None, blurred_ssim: 0.25 },
            ..Quality::default()
        };
        let view = ShapeView {
            azimuth: -5.0,
            exact: Displacements { with: Some(0.125), ..Displacements::default() },
            ..ShapeView::default()
        };
        let shape = Shape {
            surface: "cube".to_owned(),
            views: vec![view],
            lattice: 49,
            ..Shape::default()
        };
        let evaluation =
            Evaluation { quality: vec![row], shapes: vec![shape], ..Evaluation::default() };
        let likeness = evaluation.likeness_csv();
        let lines: Vec<&str> = likeness.lines().collect();
        assert_eq!(lines[1], "\"a \"\"glass\"\", tall\",waves,0.5,0,0,,,,0.25,0,0");
        assert_eq!(lines[0].split(',').count(), 11);
        let displacement = evaluation.displacement_csv();
        let lines: Vec<&str> = displacement.lines().collect();
        assert_eq!(lines[1], "cube,-5,0.125,,,,,,,,,0,0");
        assert_eq!(lines[0].split(',').count(), lines[1].split(',').count());
    }
}
