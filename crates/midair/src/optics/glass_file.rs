//! A glass from a file of the refractiveindex.info database: YAML with tables or dispersion formulas.
//!
//! The formulas are those of the database's description (M. N. Polyanskiy, Scientific Data 11, 94 (2024)), wavelengths in micrometres.

mod yaml;

use super::table::interpolate;
use std::path::{Path, PathBuf};
use yaml::parse;

/// What a file says of a glass.
#[derive(Clone, Debug, PartialEq)]
pub struct GlassFile {
    index: Dispersion,
    /// Wavelengths that the index is given for, micrometres.
    range: [f64; 2],
    extinction: Option<Table>,
}

/// An index by wavelength.
#[derive(Clone, Debug, PartialEq)]
enum Dispersion {
    Formula { number: u8, coefficients: Vec<f64> },
    Table(Table),
}

/// Values at ascending wavelengths in micrometres, linear between them.
#[derive(Clone, Debug, Default, PartialEq)]
struct Table {
    wavelengths: Vec<f64>,
    values: Vec<f64>,
}

impl Table {
    fn range(&self) -> [f64; 2] {
        // Tables have at least one line.
        [self.wavelengths[0], self.wavelengths[self.wavelengths.len() - 1]]
    }
}

/// Why a glass file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum GlassFileError {
    /// A line is not what it should be.
    #[error("glass {}, line {line}: {problem}", file.display())]
    Line {
        /// Which file.
        file: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// What is wrong, and what helps.
        problem: String,
    },
}

/// The most coefficients of each formula, from number 1; and the least.
const COEFFICIENTS: [(usize, usize); 9] =
    [(3, 17), (3, 17), (3, 17), (5, 17), (3, 17), (3, 17), (2, 6), (4, 4), (6, 6)];

impl GlassFile {
    /// Reads YAML text in UTF-8; `file` is named in errors.
    ///
    /// # Errors
    /// [`GlassFileError::Line`] where a line is wrong, and where the file says nothing of an index that could be understood.
    pub fn from_yaml(yaml: &[u8], file: &Path) -> Result<Self, GlassFileError> {
        let text = std::str::from_utf8(yaml).map_err(|error| {
            let line = 1 + yaml[..error.valid_up_to()].iter().filter(|&&b| b == b'\n').count();
            (line, "it is not UTF-8 text; save it as UTF-8".to_owned())
        });
        text.and_then(parse).map_err(|(line, problem)| GlassFileError::Line {
            file: file.to_owned(),
            line,
            problem,
        })
    }

    /// Refractive index at a wavelength in micrometres; NaN outside of [`Self::range`].
    pub fn index(&self, wavelength: f64) -> f64 {
        if !(self.range[0]..=self.range[1]).contains(&wavelength) {
            return f64::NAN;
        }
        match &self.index {
            Dispersion::Table(table) => interpolate(&table.wavelengths, &table.values, wavelength),
            Dispersion::Formula { number, coefficients } => {
                formula(*number, coefficients, wavelength)
            }
        }
    }

    /// Absorption per mm at a wavelength in micrometres, from the extinction coefficient k: 4 pi k / lambda (Born and Wolf, Principles of Optics, 14.1).
    /// 0 where the file has no k; NaN outside of its table.
    pub fn absorption(&self, wavelength: f64) -> f64 {
        let Some(table) = &self.extinction else { return 0.0 };
        let [low, high] = table.range();
        if !(low..=high).contains(&wavelength) {
            return f64::NAN;
        }
        let k = interpolate(&table.wavelengths, &table.values, wavelength);
        // A wavelength of w micrometres is w / 1000 mm.
        4.0 * std::f64::consts::PI * k / (wavelength / 1000.0)
    }

    /// Wavelengths that the index is given for, micrometres.
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// Wavelengths that the absorption is given for, micrometres; `None` if there is none.
    pub fn absorption_range(&self) -> Option<[f64; 2]> {
        self.extinction.as_ref().map(Table::range)
    }
}

/// A formula's index; NaN where it gives none.
fn formula(number: u8, c: &[f64], w: f64) -> f64 {
    let at = |i: usize| c.get(i).copied().unwrap_or(0.0);
    let w2 = w * w;
    let pairs = || c[1..].chunks(2).map(|pair| (pair[0], pair.get(1).copied().unwrap_or(0.0)));
    match number {
        // Sellmeier, with lengths and with their squares.
        1 => (1.0 + c[0] + pairs().map(|(b, l)| b * w2 / (w2 - l * l)).sum::<f64>()).sqrt(),
        2 => (1.0 + c[0] + pairs().map(|(b, l)| b * w2 / (w2 - l)).sum::<f64>()).sqrt(),
        // Polynomial.
        3 => (c[0] + pairs().map(|(b, p)| b * w.powf(p)).sum::<f64>()).sqrt(),
        // RefractiveIndex.INFO: two poles, then powers.
        4 => {
            let pole = |i: usize| match at(i) {
                0.0 => 0.0,
                strength => strength * w.powf(at(i + 1)) / (w2 - at(i + 2).powf(at(i + 3))),
            };
            let powers: f64 = c
                .get(9..)
                .unwrap_or_default()
                .chunks(2)
                .map(|pair| pair[0] * w.powf(pair.get(1).copied().unwrap_or(0.0)))
                .sum();
            (c[0] + pole(1) + pole(5) + powers).sqrt()
        }
        // Cauchy.
        5 => c[0] + pairs().map(|(b, p)| b * w.powf(p)).sum::<f64>(),
        // Gases.
        6 => 1.0 + c[0] + pairs().map(|(b, l)| b / (l - 1.0 / w2)).sum::<f64>(),
        // Herzberger.
        7 => {
            let l = 1.0 / (w2 - 0.028);
            c[0] + at(1) * l + at(2) * l * l + at(3) * w2 + at(4) * w2 * w2 + at(5) * w2 * w2 * w2
        }
        // Retro: (n^2 - 1) / (n^2 + 2) is known.
        8 => {
            let x = c[0] + c[1] * w2 / (w2 - c[2]) + c[3] * w2;
            ((1.0 + 2.0 * x) / (1.0 - x)).sqrt()
        }
        // Exotic.
        _ => {
            let off = w - c[4];
            (c[0] + c[1] / (w2 - c[2]) + c[3] * off / (off * off + c[5])).sqrt()
        }
    }
}

#[cfg(test)]
mod tests;
