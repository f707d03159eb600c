//! How a display's light goes with the direction in which it leaves.

use super::table::{Column, Source, TableError, interpolate};
use std::path::Path;
use std::sync::Arc;

/// A display's radiance by direction, over that along its normal.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Emission {
    /// The same in all directions (Lambert's law).
    #[default]
    Lambert,
    /// As measured.
    Measured(Arc<EmissionTable>),
}

impl Emission {
    /// Radiance in a direction whose angle with the display's normal has this cosine, over that along the normal; linear R, G, B.
    #[inline]
    pub fn relative(&self, cosine: f64) -> [f64; 3] {
        match self {
            Self::Lambert => [1.0; 3],
            Self::Measured(table) => table.relative(cosine),
        }
    }
}

/// A measured radiance by the angle with the display's normal: linear in the angle between its lines, the last one's going on beyond.
///
/// Read from CSV with a header line `angle,radiance` or `angle,red,green,blue`: degrees ascending from 0, radiance in any unit.
///
/// ```csv
/// angle,radiance
/// 0,410
/// 30,335
/// 60,150
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct EmissionTable {
    /// Degrees.
    angles: Vec<f64>,
    /// Over the radiance at 0 degrees.
    relative: [Vec<f64>; 3],
}

const ANGLE: Column = Column { name: "angle", range: [0.0, 90.0], allowed: "degrees from 0 to 90" };
const GREY: [Column; 2] = [ANGLE, Column::amount("radiance")];
const COLOUR: [Column; 4] =
    [ANGLE, Column::amount("red"), Column::amount("green"), Column::amount("blue")];

impl EmissionTable {
    /// Reads a table from CSV text; `file` is named in errors.
    ///
    /// # Errors
    /// [`TableError`] where a line is wrong.
    pub fn from_csv(csv: &[u8], file: &Path) -> Result<Self, TableError> {
        let source = source(file);
        let (form, rows) = source.rows(csv, &[&GREY, &COLOUR])?;
        let columns = if form == 0 { [1; 3] } else { [1, 2, 3] };
        let Some(first) = rows.first() else {
            return Err(source.unfit("it has no lines; at least the angle 0 is needed"));
        };
        if first.values[0] != 0.0 {
            let problem = format!("the first angle is {}; it must be 0", first.values[0]);
            return Err(source.wrong(first.line, problem));
        }
        if columns.iter().any(|&column| first.values[column] == 0.0) {
            return Err(
                source.wrong(first.line, "no light at 0 degrees; all else is relative to it")
            );
        }
        if let Some(pair) = rows.windows(2).find(|pair| pair[1].values[0] <= pair[0].values[0]) {
            let problem = format!(
                "angle {} does not come after {}; sort the table",
                pair[1].values[0], pair[0].values[0]
            );
            return Err(source.wrong(pair[1].line, problem));
        }
        let of_colour = |column: usize| {
            let ahead = first.values[column];
            rows.iter().map(|row| row.values[column] / ahead).collect::<Vec<f64>>()
        };
        Ok(Self {
            angles: rows.iter().map(|row| row.values[0]).collect(),
            relative: columns.map(of_colour),
        })
    }

    /// As [`Emission::relative`].
    pub fn relative(&self, cosine: f64) -> [f64; 3] {
        let angle = cosine.clamp(-1.0, 1.0).acos().to_degrees();
        self.relative.each_ref().map(|relative| interpolate(&self.angles, relative, angle))
    }
}

fn source(file: &Path) -> Source<'_> {
    Source { what: "emission table", file }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<EmissionTable, TableError> {
        midair_peers::corpus::keep("tables", &[&[3], text.as_bytes()]);
        EmissionTable::from_csv(text.as_bytes(), Path::new("bench.csv"))
    }

    #[test]
    fn a_table_of_a_power_of_the_cosine_is_that_power() {
        // cos^3 every degree: between lines it is off by h^2 / 8 times the second derivative, 3 at most: (pi / 180)^2 * 3 / 8.
        let mut text = String::from("# bench\nangle,radiance\n");
        for angle in 0..=90 {
            text += &format!(
                "{angle},{}\n",
                250.0 * f64::from(angle).to_radians().cos().powi(3).max(0.0)
            );
        }
        let emission = Emission::Measured(Arc::new(table(&text).unwrap()));
        for k in 0..=200 {
            let cosine = f64::from(k) / 200.0;
            for found in emission.relative(cosine) {
                assert!((found - cosine.powi(3)).abs() < 1.2e-4, "{cosine} {found}");
            }
        }
        assert_eq!(Emission::Lambert.relative(0.1), [1.0; 3]);
    }

    #[test]
    fn colours_have_columns_of_their_own_in_any_order() {
        let table = table("blue, angle, green, red\n4, 0, 2, 1\n2, 60, 2, 0.25\n").unwrap();
        let close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|c| (a[c] - b[c]).abs() < 1e-12);
        assert!(close(table.relative(0.5), [0.25, 1.0, 0.5]), "{:?}", table.relative(0.5));
        // Halfway between the lines, and beyond the last.
        assert!(close(table.relative(30f64.to_radians().cos()), [0.625, 1.0, 0.75]));
        assert!(close(table.relative(0.0), [0.25, 1.0, 0.5]));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, part) in [
            ("angle,lux\n0,1\n", "line 1: no column `radiance`"),
            ("angle,radiance\n", "no lines"),
            ("angle,radiance\n5,1\n", "line 2: the first angle is 5"),
            ("angle,radiance\n0,0\n", "line 2: no light"),
            ("angle,radiance\n0,1\n20,1\n20,1\n", "line 4: angle 20"),
            (
                "angle,radiance\n0,1\n95,1\n",
                "line 3: angle is `95`, but must be degrees from 0 to 90",
            ),
            ("angle,radiance\n0,1\n20,-1\n", "line 3: radiance is `-1`"),
        ] {
            let message = table(text).unwrap_err().to_string();
            assert!(message.contains(part) && message.contains("bench.csv"), "{message}");
        }
    }
}
