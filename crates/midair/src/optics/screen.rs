//! A display's response: which light its codes stand for.

use super::srgb;
use super::table::{Column, Source, TableError, interpolate};
use std::path::Path;

/// How a display turns codes into light. Codes and light are from 0 to 1; light of 1 is the display's white.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Screen {
    /// The curve between black and white.
    pub response: Response,
    /// Light that code 0 still emits, by R, G, B, as a share of white.
    pub black: [f64; 3],
    /// Bits of a code: codes are rounded to 2^bits - 1 steps. `None`: as finely as the file that holds them.
    pub bits: Option<u32>,
}

/// A display's curve, without its black.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Response {
    /// IEC 61966-2-1.
    #[default]
    Srgb,
    /// Light is code to this power.
    Gamma(f64),
    /// As measured.
    Measured(Box<ResponseTable>),
}

/// A measured response: light at some codes for each of R, G, B, linear between them.
///
/// Read from CSV with a header line `code,light` or `code,red,green,blue`, at least two lines, codes ascending from 0 to the
/// highest (255, 1023, 1: the last one counts as 1), light in any unit and nowhere falling:
///
/// ```csv
/// code,light
/// 0,0.4
/// 128,82.1
/// 255,380.0
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseTable {
    codes: Vec<f64>,
    /// Light at each code over black, as a share of what white has over black.
    light: [Vec<f64>; 3],
    /// Light at code 0 as a share of white's.
    black: [f64; 3],
}

const CODE: Column = Column::amount("code");
const GREY: [Column; 2] = [CODE, Column::amount("light")];
const COLOUR: [Column; 4] =
    [CODE, Column::amount("red"), Column::amount("green"), Column::amount("blue")];

impl Screen {
    /// Light of a code of colour `c` (0, 1, 2: R, G, B), black included.
    pub fn light(&self, c: usize, code: f64) -> f64 {
        let over_black = match &self.response {
            Response::Srgb => srgb::decode(code),
            Response::Gamma(gamma) => code.powf(*gamma),
            Response::Measured(table) => interpolate(&table.codes, &table.light[c], code),
        };
        self.black[c] + (1.0 - self.black[c]) * over_black
    }

    /// The code, rounded to the display's bits, that comes nearest to a light of colour `c`: 0 for what is darker than black.
    pub fn code(&self, c: usize, light: f64) -> f64 {
        let over_black = ((light - self.black[c]) / (1.0 - self.black[c])).clamp(0.0, 1.0);
        let code = match &self.response {
            Response::Srgb => srgb::encode(over_black),
            Response::Gamma(gamma) => over_black.powf(1.0 / gamma),
            Response::Measured(table) => interpolate(&table.light[c], &table.codes, over_black),
        };
        match self.bits {
            Some(bits) => {
                let steps = f64::from((1u32 << bits) - 1);
                (code * steps).round() / steps
            }
            None => code,
        }
    }

    /// Whether codes stand for light as in an sRGB file, so that there is nothing to convert.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }
}

impl ResponseTable {
    /// Reads a table from CSV text; `file` is named in errors.
    ///
    /// # Errors
    /// [`TableError`] where a line is wrong.
    pub fn from_csv(csv: &[u8], file: &Path) -> Result<Self, TableError> {
        let source = source(file);
        let (form, rows) = source.rows(csv, &[&GREY, &COLOUR])?;
        let columns: [usize; 3] = if form == 0 { [1; 3] } else { [1, 2, 3] };
        let mut codes: Vec<f64> = Vec::new();
        let mut light: [Vec<f64>; 3] = Default::default();
        let mut last = 1;
        for row in rows {
            let (line, code) = (row.line, row.values[0]);
            last = line;
            match codes.last() {
                None if code != 0.0 => {
                    return Err(
                        source.wrong(line, format!("the first code is {code}; it must be 0"))
                    );
                }
                Some(&before) if code <= before => {
                    return Err(
                        source.wrong(line, format!("code {code} does not come after {before}"))
                    );
                }
                _ => {}
            }
            for (c, light) in light.iter_mut().enumerate() {
                let value = row.values[columns[c]];
                if light.last().is_some_and(|&before| value < before) {
                    let problem = format!("light falls to {value}: codes above must be as bright");
                    return Err(source.wrong(line, problem));
                }
                light.push(value);
            }
            codes.push(code);
        }
        let (Some(&highest), true) = (codes.last(), codes.len() >= 2) else {
            return Err(source.wrong(last, "at least two codes must be measured"));
        };
        codes.iter_mut().for_each(|code| *code /= highest);
        let mut black = [0.0; 3];
        for (c, light) in light.iter_mut().enumerate() {
            let (dark, white) = (light[0], light[light.len() - 1]);
            if white <= dark {
                return Err(source.wrong(last, "white is no brighter than black"));
            }
            black[c] = dark / white;
            light.iter_mut().for_each(|value| *value = (*value - dark) / (white - dark));
        }
        Ok(Self { codes, light, black })
    }

    /// Light at code 0 by R, G, B, as a share of white's.
    pub fn black(&self) -> [f64; 3] {
        self.black
    }
}

fn source(file: &Path) -> Source<'_> {
    Source { what: "response table", file }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<ResponseTable, TableError> {
        midair_peers::corpus::keep("tables", &[&[2], text.as_bytes()]);
        ResponseTable::from_csv(text.as_bytes(), Path::new("bench.csv"))
    }

    #[test]
    fn codes_come_back_from_their_light() {
        let measured =
            table("code,red,green,blue\n0,1,2,3\n100,30,20,10\n255,101,102,103\n").unwrap();
        let black = measured.black();
        assert_eq!(black, [1.0 / 101.0, 2.0 / 102.0, 3.0 / 103.0]);
        for response in
            [Response::Srgb, Response::Gamma(2.2), Response::Measured(Box::new(measured))]
        {
            let screen = Screen { response, black, bits: None };
            for c in 0..3 {
                assert!((screen.light(c, 0.0) - black[c]).abs() < 1e-15);
                assert!((screen.light(c, 1.0) - 1.0).abs() < 1e-15);
                for code in 0..=20 {
                    let code = f64::from(code) / 20.0;
                    let back = screen.code(c, screen.light(c, code));
                    // Rounding, steep near black.
                    assert!((back - code).abs() < 1e-9, "{screen:?} {code} {back}");
                }
                assert_eq!(screen.code(c, 0.5 * black[c]), 0.0);
            }
        }
    }

    #[test]
    fn a_measured_curve_is_straight_between_its_points() {
        let table = table("code, light\n0, 0\n51, 20\n255, 100\n").unwrap();
        let screen = Screen { response: Response::Measured(Box::new(table)), ..Screen::default() };
        // 10 of 100 at half of the way to 51.
        assert!((screen.light(1, 0.1) - 0.1).abs() < 1e-15);
        assert!((screen.light(1, 0.6) - 0.6).abs() < 1e-15);
    }

    #[test]
    fn few_bits_make_few_codes() {
        let screen = Screen { bits: Some(2), ..Screen::default() };
        let mut codes: Vec<f64> = (0..=100).map(|i| screen.code(0, f64::from(i) / 100.0)).collect();
        codes.dedup();
        assert_eq!(codes, [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, line, part) in [
            ("code,lux\n0,1\n", 1, "header"),
            ("code,light\n1,1\n", 2, "first code"),
            ("code,light\n0,1\n0,2\n", 3, "come after"),
            ("code,light\n0,1\n255,-3\n", 3, "-3"),
            ("code,light\n0,5\n255,3\n", 3, "falls"),
            ("code,light\n0,5\n", 2, "two codes"),
            ("code,light\n0,5\n255,5\n", 3, "no brighter"),
            ("code,light\n0,5\n255\n", 3, ""),
        ] {
            let error = table(text).unwrap_err().to_string();
            assert!(error.contains(&format!("line {line}")), "{error}");
            assert!(error.contains(part) && error.contains("bench.csv"), "{error}");
        }
    }
}
