//! Measured tables: how they are read, and their values between known places.

use std::path::{Path, PathBuf};

/// Why a table of measured values cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// A line is not what it should be.
    #[error("{what} {}, line {line}: {problem}", file.display())]
    Line {
        /// What it was to be.
        what: &'static str,
        /// Which file.
        file: PathBuf,
        /// Line in the file, from 1.
        line: u64,
        /// What is wrong, and what helps.
        problem: String,
    },
    /// The lines do not make a table together.
    #[error("{what} {}: {problem}", file.display())]
    Whole {
        /// What it was to be.
        what: &'static str,
        /// Which file.
        file: PathBuf,
        /// What is wrong, and what helps.
        problem: String,
    },
}

/// A column of a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column {
    /// Its name in the header, lower case.
    pub name: &'static str,
    /// Least and largest value.
    pub range: [f64; 2],
    /// The range in words, as in "must be ...".
    pub allowed: &'static str,
}

impl Column {
    /// A quantity that cannot be negative.
    pub(super) const fn amount(name: &'static str) -> Self {
        Self { name, range: [0.0, f64::MAX], allowed: "0 or more" }
    }
}

/// A line of a table: where it stands, and the values of the columns asked for, in their order.
pub(super) struct Row {
    pub line: u64,
    pub values: Vec<f64>,
}

/// A file that is read as a table.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    /// What it is to be, as in "response table".
    pub what: &'static str,
    /// What errors call it.
    pub file: &'a Path,
}

impl Source<'_> {
    /// The error of a line.
    pub(super) fn wrong(&self, line: u64, problem: impl Into<String>) -> TableError {
        let (what, file) = (self.what, self.file.to_owned());
        TableError::Line { what, file, line, problem: problem.into() }
    }

    /// The error of the table as a whole.
    pub(super) fn unfit(&self, problem: impl Into<String>) -> TableError {
        let (what, file) = (self.what, self.file.to_owned());
        TableError::Whole { what, file, problem: problem.into() }
    }

    /// Reads CSV: a header that names all columns of one of the `forms`, in any order and any case, then lines of numbers; `#` begins
    /// a line of comment. Returns which form it is, and the lines.
    pub(super) fn rows(
        &self,
        csv: &[u8],
        forms: &[&[Column]],
    ) -> Result<(usize, Vec<Row>), TableError> {
        let malformed = |error: csv::Error| {
            self.wrong(error.position().map_or(1, csv::Position::line), error.to_string())
        };
        let separator = separator(csv);
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .delimiter(separator)
            .from_reader(csv);
        let header = reader.headers().map_err(malformed)?.clone();
        let names: Vec<String> =
            header.iter().map(|name| name.trim_start_matches('\u{feff}').to_lowercase()).collect();
        let places = |form: &&[Column]| -> Result<Vec<usize>, &'static str> {
            form.iter()
                .map(|column| names.iter().position(|name| name == column.name).ok_or(column.name))
                .collect()
        };
        let found =
            forms.iter().map(places).enumerate().find_map(|(k, places)| Some((k, places.ok()?)));
        let Some((form, places)) = found else {
            let missing = forms.first().and_then(|form| places(form).err()).unwrap_or_default();
            let wanted: Vec<String> = forms
                .iter()
                .map(|form| form.iter().map(|column| column.name).collect::<Vec<_>>().join(","))
                .collect();
            let problem =
                format!("no column `{missing}`; the header must name {}", wanted.join(" or "));
            return Err(self.wrong(1, problem));
        };
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(malformed)?;
            let line = record.position().map_or(0, csv::Position::line);
            let value = |(column, &place): (&Column, &usize)| {
                let text = record.get(place).unwrap_or_default();
                let [low, high] = column.range;
                // Where semicolons separate, a comma may be the decimal sign.
                let value = match separator {
                    b',' => text.parse().ok(),
                    _ => text.replace(',', ".").parse().ok(),
                };
                value.filter(|v: &f64| v.is_finite() && (low..=high).contains(v)).ok_or_else(|| {
                    let Column { name, allowed, .. } = column;
                    self.wrong(line, format!("{name} is `{text}`, but must be {allowed}"))
                })
            };
            let values = forms[form].iter().zip(&places).map(value).collect::<Result<_, _>>()?;
            rows.push(Row { line, values });
        }
        Ok((form, rows))
    }
}

/// What separates the columns: what the header's names have between them, a comma, or the semicolon or tab of spreadsheets in countries where the
/// comma is the decimal sign.
fn separator(text: &[u8]) -> u8 {
    let mut lines = text.split(|&byte| byte == b'\n');
    let header = lines.find(|line| !line.starts_with(b"#") && !line.trim_ascii().is_empty());
    let count = |separator: u8| {
        header.map_or(0, |line| line.iter().filter(|&&byte| byte == separator).count())
    };
    [b';', b'\t'].into_iter().find(|&other| count(other) > count(b',')).unwrap_or(b',')
}

/// `ys` at `x` between the points of ascending `xs`, the first of equal ones; the outermost ones go on beyond.
pub(super) fn interpolate(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let above = xs.partition_point(|&known| known < x);
    match (above.checked_sub(1), xs.get(above)) {
        (None, _) => ys[0],
        (_, None) => ys[ys.len() - 1],
        (Some(below), Some(_)) => {
            let share = (x - xs[below]) / (xs[above] - xs[below]);
            ys[below] + share * (ys[above] - ys[below])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreadsheets_of_all_countries_are_read() {
        const FORM: &[Column] = &[Column::amount("angle"), Column::amount("radiance")];
        let source = Source { what: "table", file: Path::new("a.csv") };
        for text in [
            "angle,radiance\n0,1\n30.5,0.25\n",
            "# measured\n\u{feff}Angle;Radiance\r\n0;1\r\n30,5;0,25\r\n",
            "angle;radiance\n0;1\n30.5;0.25\n",
            "radiance\tangle\n1\t0\n0,25\t30,5\n",
        ] {
            let (_, rows) = source.rows(text.as_bytes(), &[FORM]).unwrap();
            let values: Vec<&[f64]> = rows.iter().map(|row| &row.values[..]).collect();
            assert_eq!(values, [[0.0, 1.0], [30.5, 0.25]], "{text:?}");
        }
        let wrong = source.rows(&b"angle,radiance\n0;1\n"[..], &[FORM]).err().unwrap();
        assert!(wrong.to_string().contains("line 2"), "{wrong}");
    }
}
