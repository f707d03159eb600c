//! Which of the display's pixels the image gets, and of what shape they are.

use super::finding::{Finding, Kind, Severity, millimetres};
use crate::map::Map;
use crate::scene::model::Scene;
use crate::transport::Setup;
use serde::Serialize;

/// Which of the display's pixels the image gets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Pixels {
    /// Width and height of one, mm.
    pub pitch: [f64; 2],
    /// How many show a point of the image.
    pub lit: usize,
    /// The first and the last column of them, from the left, from 0; `None` where there are none.
    pub columns: Option<[usize; 2]>,
    /// The first and the last row of them, from the top, from 0.
    pub rows: Option<[usize; 2]>,
}

/// Pixels that differ by less in width and height count as square: what a data sheet's rounding leaves.
pub(super) const SQUARE: f64 = 0.01;
/// An image across fewer pixels looks coarse: five letters have so many.
const FEW: usize = 50;

impl Pixels {
    pub(super) fn of(setup: &Setup, map: &Map) -> Self {
        let mut pixels = Self { pitch: setup.pixel_pitch(), lit: 0, columns: None, rows: None };
        for index in 0..map.width * map.height {
            if map.status[index].is_answered() {
                pixels.lit += 1;
                let widen = |span: &mut Option<[usize; 2]>, at: usize| {
                    let [first, last] = span.get_or_insert([at; 2]);
                    (*first, *last) = ((*first).min(at), (*last).max(at));
                };
                widen(&mut pixels.columns, index % map.width);
                widen(&mut pixels.rows, index / map.width);
            }
        }
        pixels
    }

    /// Height over width of a pixel.
    pub fn aspect(&self) -> f64 {
        self.pitch[1] / self.pitch[0]
    }

    /// Whether they are square but for a data sheet's rounding.
    pub fn are_square(&self) -> bool {
        (self.aspect() - 1.0).abs() <= SQUARE
    }

    pub(super) fn findings(&self, setup: &Setup, scene: &Scene) -> Vec<Finding> {
        let mut findings = Vec::new();
        findings.extend(self.shape(setup, scene));
        let [columns, rows] = setup.resolution;
        findings.push(match (self.columns, self.rows) {
            (Some([left, right]), Some([top, bottom])) => {
                let (across, down) = (right + 1 - left, bottom + 1 - top);
                let sentence = format!(
                    "the image gets {across} x {down} of the display's {columns} x {rows} pixels: columns {left} to {right}, rows {top} to {bottom}"
                );
                if across.min(down) < FEW {
                    Finding::new(Kind::PixelCount, Severity::Warning, sentence)
                        .remedy("it will look coarse: take a display with finer pixels, or a larger image")
                } else {
                    Finding::new(Kind::PixelCount, Severity::Note, sentence)
                }
            }
            _ => Finding::new(Kind::PixelCount, Severity::Fault, "no display pixel shows a point of the image")
                .remedy("mend what is not formed first"),
        });
        findings
    }

    fn shape(&self, setup: &Setup, scene: &Scene) -> Option<Finding> {
        if self.are_square() {
            return None;
        }
        let [x, y] = self.pitch;
        let [w, h] = setup.display.size;
        let [columns, rows] = setup.resolution;
        let finding = Finding::new(
            Kind::PixelShape,
            Severity::Warning,
            format!(
                "display pixels are not square: {x:.4} mm wide, {y:.4} mm high ({columns} x {rows} pixels on {w} x {h} mm)"
            ),
        );
        let turned = (h / columns as f64) / (w / rows as f64);
        if (turned - 1.0).abs() <= SQUARE && w != h {
            return Some(
                finding
                    .remedy("width and height of the display look swapped")
                    .line("display.size", [h, w]),
            );
        }
        let remedy = "real displays have square pixels: give the size of the lit area, and its own resolution";
        Some(match scene.display.size {
            // A size that was given is measured; what is left out follows the image.
            Some(_) => {
                finding.remedy(format!("{remedy}; with this size they are square for")).line(
                    "display.resolution",
                    [columns as i64, ((columns as f64 * h / w).round() as i64).max(1)],
                )
            }
            None => {
                finding.remedy(format!("{remedy}; with this resolution they are square for")).line(
                    "display.size",
                    millimetres([
                        w.max(h * columns as f64 / rows as f64),
                        h.max(w * rows as f64 / columns as f64),
                    ]),
                )
            }
        })
    }
}
