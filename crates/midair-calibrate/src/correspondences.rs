//! Which display point each camera pixel sees: in memory, and as CSV.

use midair::map::format::FileError;
use std::fmt::Write as _;
use std::path::Path;

/// A camera pixel and the display point that it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correspondence {
    /// Place in the photograph from its upper left corner, px; pixel centres are at half-integers.
    pub pixel: [f64; 2],
    /// The display point.
    pub st: [f64; 2],
    /// One standard deviation of st, display pixels.
    pub sigma: f64,
}

/// The standard deviation of a point whose file says none, display pixels.
pub const USUAL_SIGMA: f64 = 0.3;

const HEADER: &str = "the header x,y,s,t or x,y,s,t,sigma: camera pixels, display coordinates from 0 to 1, display pixels";

/// Reads correspondences: a header that names the columns in any order, then numbers; `#` begins a line of comment. A file cannot have more
/// points than there are pixels in any camera.
///
/// # Errors
/// A file that cannot be read, and a line that is not what it should be, with its number.
pub fn read(path: &Path) -> Result<Vec<Correspondence>, FileError> {
    let bytes = std::fs::read(path).map_err(|error| FileError::io(path, "read", error))?;
    parse(path, &bytes)
}

/// As [`read`], of a file's content.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Vec<Correspondence>, FileError> {
    let wrong = |line: u64, problem: String, remedy: &str| {
        Err(FileError::malformed(path, format!("line {line}"), problem, remedy))
    };
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(bytes);
    let remedy = format!("correspondences are CSV with {HEADER}");
    let header = match reader.headers() {
        Ok(header) => header.clone(),
        Err(error) => return wrong(1, error.to_string(), &remedy),
    };
    let named = |name: &str| {
        header.iter().position(|h| h.trim_start_matches('\u{feff}').eq_ignore_ascii_case(name))
    };
    let mut columns = [0; 4];
    for (column, name) in columns.iter_mut().zip(["x", "y", "s", "t"]) {
        match named(name) {
            Some(place) => *column = place,
            None => return wrong(1, format!("no column `{name}`"), &remedy),
        }
    }
    let sigma = named("sigma");
    let mut points = Vec::new();
    for record in reader.records() {
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                let line = error.position().map_or(0, csv::Position::line);
                return wrong(
                    line,
                    error.to_string(),
                    "give every line as many values as the header",
                );
            }
        };
        let line = record.position().map_or(0, csv::Position::line);
        let value = |place: usize, name: &str, range: [f64; 2]| {
            let text = record.get(place).unwrap_or_default();
            match text.parse::<f64>() {
                Ok(value) if (range[0]..=range[1]).contains(&value) => Ok(value),
                _ => Err(FileError::malformed(
                    path,
                    format!("line {line}"),
                    format!("`{name}` cannot be `{}`", text.chars().take(40).collect::<String>()),
                    format!("give a number from {} to {}", range[0], range[1]),
                )),
            }
        };
        let place = [-1e5, 1e5];
        // A little beyond the display's edge: where a decoder interpolates.
        let on_display = [-0.1, 1.1];
        points.push(Correspondence {
            pixel: [value(columns[0], "x", place)?, value(columns[1], "y", place)?],
            st: [value(columns[2], "s", on_display)?, value(columns[3], "t", on_display)?],
            sigma: match sigma {
                Some(column) => value(column, "sigma", [1e-6, 1e4])?,
                None => USUAL_SIGMA,
            },
        });
    }
    if points.is_empty() {
        return wrong(
            1,
            "no points".to_owned(),
            "give a line for each camera pixel that was decoded",
        );
    }
    Ok(points)
}

/// The points as CSV.
pub fn to_csv(points: &[Correspondence]) -> String {
    let mut csv = String::from("x,y,s,t,sigma\n");
    for Correspondence { pixel: [x, y], st: [s, t], sigma } in points {
        // A string takes all that is written to it.
        let _ = writeln!(csv, "{x:.3},{y:.3},{s:.8},{t:.8},{sigma:.4}");
    }
    csv
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(text: &str) -> String {
        match parse("front.csv".as_ref(), text.as_bytes()) {
            Ok(points) => format!("{points:?}"),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn points_are_read_in_any_order_of_columns() {
        let text = "# decoded elsewhere\nt,s,y,x\n0.25, 0.5, 10.5, 20.5\n";
        let points = parse("a.csv".as_ref(), text.as_bytes()).expect("points");
        let wanted = Correspondence { pixel: [20.5, 10.5], st: [0.5, 0.25], sigma: USUAL_SIGMA };
        assert_eq!(points, [wanted]);
        assert_eq!(parse("a.csv".as_ref(), to_csv(&points).as_bytes()).expect("points"), [wanted]);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (text, wanted) in [
            ("x,y,s\n1,2,0.5\n", "front.csv: line 1: no column `t`"),
            ("x,y,s,t\n1,2,0.5,0.5\n1,2,0.5,oops\n", "line 3: `t` cannot be `oops`"),
            ("x,y,s,t\n1,2,0.5,nan\n", "line 2: `t` cannot be `nan`"),
            ("x,y,s,t\n1,2,512,0.5\n", "`s` cannot be `512`"),
            ("x,y,s,t,sigma\n1,2,0.5,0.5,0\n", "`sigma` cannot be `0`"),
            ("x,y,s,t\n1,2,0.5\n", "line 2"),
            ("x,y,s,t\n", "no points"),
            ("", "no column `x`"),
        ] {
            let told = fault(text);
            assert!(told.contains(wanted), "{told}");
        }
    }
}
