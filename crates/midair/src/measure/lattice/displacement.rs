//! How far intersections are from where they belong.

use nalgebra::{SMatrix, SVector};
use serde::ser::SerializeMap as _;
use serde::{Serialize, Serializer};

/// Distances between two sets of intersections, pixels; serialised, their mean, the greatest, and how many there are.
#[derive(Clone, Debug, PartialEq)]
pub struct Displacement {
    /// Mean over the points that both sets have.
    pub mean: f64,
    /// Greatest of them.
    pub max: f64,
    /// Per point, in the sets' order: None where either set has none.
    pub points: Vec<Option<f64>>,
}

impl Displacement {
    /// How many points both sets have.
    pub fn compared(&self) -> usize {
        self.points.iter().flatten().count()
    }
}

impl Serialize for Displacement {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3))?;
        map.serialize_entry("mean", &self.mean)?;
        map.serialize_entry("max", &self.max)?;
        map.serialize_entry("compared", &self.compared())?;
        map.end()
    }
}

/// Two sets that cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DisplacementError {
    /// Their sizes differ.
    #[error("{seen} intersections cannot be compared with {reference}")]
    CountsDiffer {
        /// Points seen.
        seen: usize,
        /// Points of the reference.
        reference: usize,
    },
    /// No point is in both.
    #[error("no intersection was found both in the view and in its reference")]
    NothingInCommon,
}

/// The distances between intersections as seen and where they belong, both in pixels and in the
/// same order ([`super::Lattice::points`]).
///
/// # Errors
/// When the counts differ or no point is in both.
pub fn displacement(
    seen: &[Option<[f64; 2]>],
    reference: &[Option<[f64; 2]>],
) -> Result<Displacement, DisplacementError> {
    if seen.len() != reference.len() {
        let (seen, reference) = (seen.len(), reference.len());
        return Err(DisplacementError::CountsDiffer { seen, reference });
    }
    let distance = |(a, b): (&Option<[f64; 2]>, &Option<[f64; 2]>)| {
        let (a, b) = ((*a)?, (*b)?);
        Some((a[0] - b[0]).hypot(a[1] - b[1]))
    };
    let points: Vec<Option<f64>> = seen.iter().zip(reference).map(distance).collect();
    let count = points.iter().flatten().count();
    if count == 0 {
        return Err(DisplacementError::NothingInCommon);
    }
    let mean = points.iter().flatten().sum::<f64>() / count as f64;
    let max = points.iter().flatten().copied().fold(0.0, f64::max);
    Ok(Displacement { mean, max, points })
}

/// What is taken off before a displacement is measured: how the camera moved between two pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Alignment {
    /// Nothing: places are compared as they are, for a camera that stood still.
    #[default]
    None,
    /// The mean shift.
    Shift,
    /// The shift, turn and size that fit best.
    Similarity,
    /// The perspective that fits best: the camera stood elsewhere, or was turned. A lattice's own tilt goes with it.
    Perspective,
}

/// The points seen, moved to where they fit the reference best by least squares over the points that both sets
/// have (Umeyama 1991, "Least-squares estimation of transformation parameters between two point patterns", in the plane; not
/// mirrored). Where fewer than two are in common, nothing is turned, and where fewer than four are, perspective is left.
pub fn aligned(
    seen: &[Option<[f64; 2]>],
    reference: &[Option<[f64; 2]>],
    alignment: Alignment,
) -> Vec<Option<[f64; 2]>> {
    let pairs: Vec<([f64; 2], [f64; 2])> =
        seen.iter().zip(reference).filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect();
    if alignment == Alignment::None || pairs.is_empty() {
        return seen.to_vec();
    }
    let count = pairs.len() as f64;
    let mean = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        points.fold([0.0; 2], |[x, y], p| [x + p[0] / count, y + p[1] / count])
    };
    let from = mean(&mut pairs.iter().map(|pair| pair.0));
    let to = mean(&mut pairs.iter().map(|pair| pair.1));
    // As complex numbers about the means: b = z a, so z = sum(conj(a) b) / sum(|a|^2).
    let (mut real, mut imaginary, mut size) = (0.0, 0.0, 0.0);
    for (a, b) in &pairs {
        let [ax, ay] = [a[0] - from[0], a[1] - from[1]];
        let [bx, by] = [b[0] - to[0], b[1] - to[1]];
        real += ax * bx + ay * by;
        imaginary += ax * by - ay * bx;
        size += ax * ax + ay * ay;
    }
    let [c, s] = match alignment {
        Alignment::Similarity | Alignment::Perspective if size > 0.0 => {
            [real / size, imaginary / size]
        }
        _ => [1.0, 0.0],
    };
    let moved = |p: [f64; 2]| {
        let [x, y] = [p[0] - from[0], p[1] - from[1]];
        [to[0] + c * x - s * y, to[1] + s * x + c * y]
    };
    let placed: Vec<Option<[f64; 2]>> = seen.iter().map(|point| point.map(moved)).collect();
    let pairs: Vec<([f64; 2], [f64; 2])> =
        placed.iter().zip(reference).filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect();
    // Numbers about 1, so that all parameters of a homography weigh alike.
    let unit = (pairs.iter().map(|(_, b)| squared(*b, to)).sum::<f64>() / count).sqrt();
    if alignment != Alignment::Perspective || pairs.len() < 4 || unit == 0.0 {
        return placed;
    }
    let local = |p: [f64; 2]| [0, 1].map(|axis| (p[axis] - to[axis]) / unit);
    let pairs: Vec<_> = pairs.into_iter().map(|(a, b)| (local(a), local(b))).collect();
    match homography(&pairs) {
        Some(h) => {
            let through = |p: [f64; 2]| {
                let [x, y] = h.at(local(p));
                [to[0] + unit * x, to[1] + unit * y]
            };
            placed.iter().map(|point| point.map(through)).collect()
        }
        None => placed,
    }
}

fn squared(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)
}

/// A homography of the plane that leaves the origin's scale: rows (a, b, c), (d, e, f), (g, h, 1).
#[derive(Clone, Copy)]
struct Homography([f64; 8]);

impl Homography {
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [a, b, c, d, e, f, g, h] = self.0;
        let w = g * x + h * y + 1.0;
        [(a * x + b * y + c) / w, (d * x + e * y + f) / w]
    }
}

/// The homography that brings the first of each pair nearest to the second, by least squares of distances: Gauss's and Newton's
/// method from the identity (Hartley and Zisserman, Multiple View Geometry, 2nd ed., 4.2.3). `None` where the points leave it open.
fn homography(pairs: &[([f64; 2], [f64; 2])]) -> Option<Homography> {
    let mut found = Homography([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    for _ in 0..50 {
        let mut normal = SMatrix::<f64, 8, 8>::zeros();
        let mut right = SVector::<f64, 8>::zeros();
        for &([x, y], target) in pairs {
            let w = found.0[6] * x + found.0[7] * y + 1.0;
            // What lies at the horizon or beyond it has no place in a photograph.
            if !(w > 1e-3) {
                return None;
            }
            let at = found.at([x, y]);
            let slopes = [
                [x / w, y / w, 1.0 / w, 0.0, 0.0, 0.0, -at[0] * x / w, -at[0] * y / w],
                [0.0, 0.0, 0.0, x / w, y / w, 1.0 / w, -at[1] * x / w, -at[1] * y / w],
            ];
            for (axis, slopes) in slopes.into_iter().enumerate() {
                let slopes = SVector::from(slopes);
                right += slopes * (target[axis] - at[axis]);
                normal += slopes * slopes.transpose();
            }
        }
        let solver = normal.full_piv_lu();
        let (most, least) = solver
            .u()
            .diagonal()
            .abs()
            .iter()
            .fold((0.0_f64, f64::INFINITY), |(most, least), &pivot| {
                (most.max(pivot), least.min(pivot))
            });
        // Written so that what is not a number is open as well.
        if !(least > 1e-9 * most) {
            return None;
        }
        let step = solver.solve(&right)?;
        for (value, step) in found.0.iter_mut().zip(&step) {
            *value += step;
        }
        if step.iter().all(|step| step.abs() < 1e-13) {
            break;
        }
    }
    found.0.iter().all(|value| value.is_finite()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A camera's shift, turn and size are taken off, and nothing else is: a bump of one point remains.
        #[test]
        fn what_a_camera_did_is_taken_off(
            (dx, dy) in (-90.0_f64..90.0, -90.0_f64..90.0),
            (turn, size) in (-0.5_f64..0.5, 0.5_f64..2.0),
            missing in 0_usize..9,
        ) {
            let reference: Vec<_> =
                (0..9).map(|i| Some([(i % 3) as f64 * 40.0, (i / 3) as f64 * 40.0])).collect();
            let (sin, cos) = turn.sin_cos();
            let moved = |p: [f64; 2]| {
                let [x, y] = p;
                [size * (cos * x - sin * y) + dx, size * (sin * x + cos * y) + dy]
            };
            let mut seen: Vec<_> = reference.iter().map(|p| p.map(moved)).collect();
            seen[missing] = None;
            let left = |alignment| displacement(&aligned(&seen, &reference, alignment), &reference).unwrap();
            // Rounding of numbers up to a few hundred.
            prop_assert!(left(Alignment::Similarity).max < 1e-9);
            prop_assert_eq!(left(Alignment::None).points[missing], None);
            // The shift alone leaves the turn and size: the mean shift is gone.
            let shifted = aligned(&seen, &reference, Alignment::Shift);
            for axis in 0..2 {
                let sum: f64 = shifted.iter().zip(&reference)
                    .filter_map(|(a, b)| Some((*a)?[axis] - (*b)?[axis])).sum();
                prop_assert!(sum.abs() < 1e-9);
            }
            prop_assume!(turn.abs() > 0.01);
            prop_assert!(left(Alignment::Shift).max > 0.1);
        }
    }

    proptest! {
        /// Whatever perspective a camera saw a plane in, it is taken off to rounding, and a bump of one point is not.
        #[test]
        fn perspective_is_taken_off(
            (a, b, d, e) in (0.6_f64..1.6, -0.4_f64..0.4, -0.4_f64..0.4, 0.6_f64..1.6),
            (g, h) in (-0.25_f64..0.25, -0.25_f64..0.25),
            turn in -0.6_f64..0.6,
            bump in 0.0_f64..3.0,
        ) {
            let grid: Vec<[f64; 2]> =
                (0..25).map(|i| [f64::from(i % 5) * 0.5 - 1.0, f64::from(i / 5) * 0.5 - 1.0]).collect();
            let (sin, cos) = turn.sin_cos();
            let view = |[x, y]: [f64; 2]| {
                let (x, y) = (cos * x - sin * y, sin * x + cos * y);
                let w = g * x + h * y + 1.0;
                [500.0 + 200.0 * (a * x + b * y) / w, 400.0 + 200.0 * (d * x + e * y) / w]
            };
            let reference: Vec<_> =
                grid.iter().map(|p| Some([300.0 + 150.0 * p[0], 300.0 + 150.0 * p[1]])).collect();
            let seen: Vec<_> = grid.iter().map(|p| Some(view(*p))).collect();
            let left = |seen: &[Option<[f64; 2]>]| {
                displacement(&aligned(seen, &reference, Alignment::Perspective), &reference).unwrap()
            };
            // Rounding of numbers up to a thousand, through equations whose condition is some thousands.
            prop_assert!(left(&seen).max < 1e-8, "{}", left(&seen).max);
            let mut bumped = reference.clone();
            bumped[12] = bumped[12].map(|[x, y]| [x + bump, y]);
            // Eight numbers of fifty take a share of the bump, no more than a fifth at the middle.
            prop_assert!(left(&bumped).points[12].unwrap() >= 0.8 * bump - 1e-9);
            prop_assert!(left(&bumped).max <= bump + 1e-9);
        }
    }

    #[test]
    fn one_point_can_only_be_shifted() {
        let found =
            aligned(&[Some([1.0, 2.0]), None], &[Some([5.0, 5.0]), None], Alignment::Similarity);
        assert_eq!(found, [Some([5.0, 5.0]), None]);
        assert_eq!(aligned(&[None], &[None], Alignment::Shift), [None]);
    }

    #[test]
    fn mean_and_max_are_over_common_points() {
        let seen = [Some([3.0, 4.0]), None, Some([1.0, 1.0]), Some([0.0, 2.0])];
        let reference = [Some([0.0, 0.0]), Some([1.0, 1.0]), Some([1.0, 2.0]), None];
        let found = displacement(&seen, &reference).unwrap();
        assert_eq!(found.points, [Some(5.0), None, Some(1.0), None]);
        assert_eq!((found.mean, found.max, found.compared()), (3.0, 5.0, 2));
    }

    #[test]
    fn sets_without_common_points_are_an_error() {
        let error = displacement(&[None], &[Some([0.0, 0.0])]).unwrap_err();
        assert_eq!(error, DisplacementError::NothingInCommon);
        assert!(displacement(&[], &[None]).is_err());
    }
}
