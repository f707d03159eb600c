//! A measured luminance by viewing direction, in place of the model's efficiency.

use crate::geometry::Vec3;
use crate::optics::table::{Column, Source, TableError};
use std::path::Path;

/// Azimuth and elevation, in degrees, of a direction in some frame: azimuth about +y from +z
/// towards +x, in -180 to 180; elevation above the plane of x and z, in -90 to 90.
///
/// So (0, 0) looks along the frame's normal +z, and an elevation of 90 along +y.
pub fn viewing_angles(direction: Vec3) -> [f64; 2] {
    let d = direction;
    [d.x.atan2(d.z).to_degrees(), d.y.atan2(d.x.hypot(d.z)).to_degrees()]
}

/// The unit vector of an azimuth and an elevation in degrees: the inverse of [`viewing_angles`].
pub fn viewing_direction([azimuth, elevation]: [f64; 2]) -> Vec3 {
    let (sa, ca) = azimuth.to_radians().sin_cos();
    let (se, ce) = elevation.to_radians().sin_cos();
    Vec3::new(sa * ce, se, ca * ce)
}

/// Luminance over a grid of viewing directions, as measured on the bench: bilinear between its
/// points; up to `BEYOND` degrees outside the outermost ones as there, further out no value.
///
/// Read from CSV with a header line naming `azimuth`, `elevation` (degrees) and `value` (any
/// unit), one line per grid point in any order, and every pair of an azimuth and an elevation once:
///
/// ```csv
/// azimuth,elevation,value
/// -10,0,0.71
/// 10,0,0.74
/// -10,20,0.64
/// 10,20,0.66
/// ```
///
/// The angles are those of the direction from the image towards the viewer
/// ([`viewing_angles`]), in the frame in which they were measured: the table does not know it.
#[derive(Clone, Debug, PartialEq)]
pub struct LuminanceTable {
    azimuth: Vec<f64>,
    elevation: Vec<f64>,
    /// A row of azimuths for each elevation.
    value: Vec<f64>,
}

impl LuminanceTable {
    /// Reads CSV; `file` is what error messages call it.
    ///
    /// # Errors
    /// [`TableError`] where a line is wrong.
    pub fn from_csv(csv: &[u8], file: &Path) -> Result<Self, TableError> {
        let source = source(file);
        let (_, rows) = source.rows(csv, &[&COLUMNS])?;
        let points: Vec<[f64; 3]> =
            rows.iter().map(|row| [row.values[0], row.values[1], row.values[2]]).collect();
        Self::from_points(&points).map_err(|problem| source.unfit(problem))
    }

    /// Sorts points into a grid; the error says what the points lack.
    fn from_points(points: &[[f64; 3]]) -> Result<Self, String> {
        let axis = |i: usize| {
            let mut values: Vec<f64> = points.iter().map(|p| p[i]).collect();
            values.sort_by(f64::total_cmp);
            // -0 and 0 are one angle.
            values.dedup_by(|a, b| *a == *b);
            values
        };
        let (azimuth, elevation) = (axis(0), axis(1));
        if azimuth.len() < 2 || elevation.len() < 2 {
            return Err(format!(
                "it has {} azimuths and {} elevations; at least 2 of each are needed",
                azimuth.len(),
                elevation.len()
            ));
        }
        let mut value = vec![f64::NAN; azimuth.len() * elevation.len()];
        for &[a, e, v] in points {
            let slot = elevation.partition_point(|&x| x < e) * azimuth.len()
                + azimuth.partition_point(|&x| x < a);
            if !value[slot].is_nan() {
                return Err(format!("azimuth {a}, elevation {e} is given twice; keep one of them"));
            }
            value[slot] = v;
        }
        if let Some(slot) = value.iter().position(|v| v.is_nan()) {
            return Err(format!(
                "azimuth {}, elevation {} is missing: every pair of an azimuth and an elevation \
                 must be given",
                azimuth[slot % azimuth.len()],
                elevation[slot / azimuth.len()]
            ));
        }
        Ok(Self { azimuth, elevation, value })
    }

    /// The luminance in a direction in degrees, in the file's unit; `None` more than `BEYOND` degrees outside the grid.
    pub fn value(&self, [azimuth, elevation]: [f64; 2]) -> Option<f64> {
        let (i, s) = place(&self.azimuth, azimuth)?;
        let (j, t) = place(&self.elevation, elevation)?;
        let width = self.azimuth.len();
        let at = |i: usize, j: usize| self.value[j * width + i];
        let row = |j: usize| (1.0 - s) * at(i, j) + s * at(i + 1, j);
        Some((1.0 - t) * row(j) + t * row(j + 1))
    }

    /// Azimuth and elevation of the largest value, degrees; the first of several.
    pub fn brightest(&self) -> [f64; 2] {
        let mut best = 0;
        for (slot, &value) in self.value.iter().enumerate() {
            if value > self.value[best] {
                best = slot;
            }
        }
        let width = self.azimuth.len();
        [self.azimuth[best % width], self.elevation[best / width]]
    }

    /// [`Self::value`] over the largest value in the table: a relative efficiency from 0 to 1.
    ///
    /// 0 everywhere for a table of zeros.
    pub fn relative(&self, angles: [f64; 2]) -> Option<f64> {
        let most = self.value.iter().fold(0.0, |a: f64, &b| a.max(b));
        self.value(angles).map(|v| if most > 0.0 { v / most } else { 0.0 })
    }
}

/// How far the outermost values hold, degrees. A table tells from where the image was looked at; its points are then seen in directions on either side of
/// its centre's, up to ten degrees apart in all, and half of it must not be dark because the eye stands at the last angle.
pub const BEYOND: f64 = 5.0;

const COLUMNS: [Column; 3] = [
    Column { name: "azimuth", range: [-180.0, 180.0], allowed: "degrees from -180 to 180" },
    Column { name: "elevation", range: [-90.0, 90.0], allowed: "degrees from -90 to 90" },
    Column::amount("value"),
];

fn source(file: &Path) -> Source<'_> {
    Source { what: "luminance table", file }
}

/// The interval of a sorted axis that `x` lies in, and how far into it (0 to 1); beside the axis its end.
fn place(axis: &[f64], x: f64) -> Option<(usize, f64)> {
    let (first, last) = (axis[0], axis[axis.len() - 1]);
    if !(first - BEYOND..=last + BEYOND).contains(&x) {
        return None;
    }
    let x = x.clamp(first, last);
    let i = (axis.partition_point(|&a| a <= x) - 1).min(axis.len() - 2);
    Some((i, (x - axis[i]) / (axis[i + 1] - axis[i])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parse(text: &str) -> Result<LuminanceTable, TableError> {
        midair_peers::corpus::keep("tables", &[&[1], text.as_bytes()]);
        LuminanceTable::from_csv(text.as_bytes(), Path::new("bench.csv"))
    }

    /// An uneven grid of a function that is linear in each angle, so bilinear values are exact.
    fn bilinear(a: f64, e: f64) -> f64 {
        50.0 + 0.3 * a - 0.2 * e + 0.01 * a * e
    }

    fn grid() -> String {
        let mut text = String::from("# measured 1 m away\nelevation, value, azimuth\n");
        for e in [60.0, -10.0, 0.0, 25.0] {
            for a in [10.0, -30.0, 30.0] {
                text += &format!("{e}, {}, {a}\n", bilinear(a, e));
            }
        }
        text
    }

    proptest! {
        #[test]
        fn values_between_the_points_are_bilinear(a in -30.0..=30.0f64, e in -10.0..=60.0f64) {
            let value = parse(&grid()).unwrap().value([a, e]).unwrap();
            prop_assert!((value - bilinear(a, e)).abs() < 1e-12);
        }

        #[test]
        fn angles_and_directions_are_inverse(a in -179.9..179.9f64, e in -89.9..89.9f64) {
            let d = viewing_direction([a, e]);
            prop_assert!((d.length() - 1.0).abs() < 1e-15);
            let back = viewing_angles(d);
            // Near the poles the azimuth's rounding grows by 1 / cos of the elevation: 573 at most.
            prop_assert!((back[0] - a).abs() < 1e-10 && (back[1] - e).abs() < 1e-10);
        }
    }

    #[test]
    fn angles_start_at_the_normal_and_rise_to_y() {
        let close = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-13;
        assert!(close(viewing_angles(Vec3::new(0.0, 0.0, 2.0)), [0.0, 0.0]));
        assert!(close(viewing_angles(Vec3::new(1.0, 0.0, 1.0)), [45.0, 0.0]));
        assert!(close(viewing_angles(Vec3::new(0.0, 1.0, 1.0)), [0.0, 45.0]));
    }

    #[test]
    fn beside_the_grid_its_edge_holds_and_far_outside_there_is_no_value() {
        let table = parse(&grid()).unwrap();
        for outside in [[-35.1, 0.0], [35.1, 0.0], [0.0, 65.1], [0.0, -15.1], [f64::NAN, 0.0]] {
            assert_eq!(table.value(outside), None);
        }
        for (beside, edge) in [
            ([-34.9, 5.0], [-30.0, 5.0]),
            ([7.0, 64.0], [7.0, 60.0]),
            ([33.0, -12.0], [30.0, -10.0]),
        ] {
            assert_eq!(table.value(beside), table.value(edge));
        }
        assert_eq!(table.value([30.0, 60.0]), Some(bilinear(30.0, 60.0)));
        let most = bilinear(30.0, 60.0);
        assert_eq!(table.brightest(), [30.0, 60.0]);
        assert_eq!(table.relative([30.0, 60.0]), Some(1.0));
        let middle = table.relative([0.0, 0.0]).unwrap();
        assert!((middle - bilinear(0.0, 0.0) / most).abs() < 1e-15);
    }

    #[test]
    fn errors_name_the_file_the_place_and_the_remedy() {
        let head = "azimuth,elevation,value\n";
        let cases = [
            (format!("{head}0,0,1\n0,x,1\n"), "bench.csv, line 3: elevation is `x`"),
            (format!("{head}0,0,-1\n"), "line 2: value is `-1`, but must be 0 or more"),
            (format!("{head}0,0,NaN\n"), "line 2: value is `NaN`"),
            (format!("{head}0,95,1\n"), "line 2: elevation is `95`, but must be degrees from -90"),
            (format!("{head}0,0,1,2\n"), "line 2"),
            ("azimuth,value\n0,1\n".to_owned(), "line 1: no column `elevation`"),
            (String::new(), "line 1: no column `azimuth`"),
            (head.to_owned(), "0 azimuths and 0 elevations"),
            (format!("{head}0,0,1\n1,0,1\n0,1,1\n"), "azimuth 1, elevation 1 is missing"),
            (format!("{head}0,0,1\n1,0,1\n0,1,1\n1,1,1\n-0,1,2\n"), "given twice"),
        ];
        for (text, part) in cases {
            let message = parse(&text).unwrap_err().to_string();
            assert!(message.contains(part), "{message:?} lacks {part:?}");
        }
    }

    #[test]
    fn a_file_with_a_byte_order_mark_is_read() {
        let text = "\u{feff}azimuth,elevation,value\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n";
        assert_eq!(parse(text).unwrap().value([0.5, 0.5]), Some(2.5));
    }
}
