//! The evaluation as tables for other programs.

use super::evaluation::{Displacements, Evaluation, MEASURES};
use crate::evaluate::csv::{Table, number};

impl Evaluation {
    /// Likeness, a row for each image on each surface: with compensation, without, and what noise alone leaves; a value that is not known is empty.
    pub fn likeness_csv(&self) -> String {
        let mut head = vec!["surface".to_owned(), "image".to_owned()];
        for (name, _, _) in MEASURES {
            head.extend(["with", "without", "noise_alone"].map(|of| format!("{name}_{of}")));
        }
        let mut table = Table::new(head);
        for row in &self.quality {
            let mut fields = vec![row.surface.clone(), row.image.clone()];
            for (_, of, _) in MEASURES {
                fields
                    .extend([&row.with, &row.without, &row.floor].map(|scores| number(of(scores))));
            }
            table.row(fields);
        }
        table.finish()
    }

    /// Displacements in the camera's pixels, a row for each azimuth: calculated, measured, and calculated over the measured intersections.
    pub fn displacement_csv(&self) -> String {
        let mut head = vec!["surface".to_owned(), "azimuth".to_owned()];
        for name in ["calculated", "measured", "calculated_there"] {
            head.extend(["with", "kept", "without"].map(|of| format!("{name}_{of}")));
        }
        head.extend(["intersections", "measured_intersections"].map(str::to_owned));
        let mut table = Table::new(head);
        for shape in &self.shapes {
            for view in &shape.views {
                let mut fields = vec![shape.surface.clone(), view.azimuth.to_string()];
                let all: [Displacements; 3] = [view.exact, view.measured, view.exact_there];
                fields.extend(all.into_iter().flat_map(Displacements::all).map(number));
                fields.extend(
                    [shape.intersections, shape.measured_intersections].map(|n| n.to_string()),
                );
                table.row(fields);
            }
        }
        table.finish()
    }

    /// Ways to fill the display, a row for each on each surface.
    pub fn ways_csv(&self) -> String {
        let head = [
            "surface",
            "way",
            "displacement",
            "largest",
            "intersections",
            "ssim",
            "psnr",
            "seconds",
        ];
        let mut table = Table::new(head.map(str::to_owned).into());
        for comparison in &self.ways {
            for way in &comparison.ways {
                let mut fields = vec![comparison.surface.clone(), way.name.clone()];
                fields.extend([way.displacement, way.largest].map(number));
                fields.push(way.intersections.to_string());
                fields.extend([way.ssim, way.psnr, Some(way.seconds)].map(number));
                table.row(fields);
            }
        }
        table.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::super::evaluation::{Quality, Scores, Shape, ShapeView};
    use super::*;
    use crate::evaluate::proof::{Compared, Comparison};

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
        let way = Compared {
            name: "as it is".to_owned(),
            displacement: Some(78.5),
            intersections: 49,
            ..Compared::default()
        };
        let comparison =
            Comparison { surface: "cube".to_owned(), ways: vec![way], ..Comparison::default() };
        let ways = Evaluation { ways: vec![comparison], ..Evaluation::default() }.ways_csv();
        let lines: Vec<&str> = ways.lines().collect();
        assert_eq!(lines[1], "cube,as it is,78.5,,49,,,0");
        assert_eq!(lines[0].split(',').count(), lines[1].split(',').count());
    }
}
