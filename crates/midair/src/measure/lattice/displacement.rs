//! How far intersections are from where they belong.

/// Distances between two sets of intersections, pixels.
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
}

/// The points seen, moved to where they fit the reference best by least squares over the points that both sets
/// have (Umeyama 1991, "Least-squares estimation of transformation parameters between two point patterns", in the plane; not
/// mirrored). Where fewer than two are in common, nothing is turned.
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
        Alignment::Similarity if size > 0.0 => [real / size, imaginary / size],
        _ => [1.0, 0.0],
    };
    let moved = |p: [f64; 2]| {
        let [x, y] = [p[0] - from[0], p[1] - from[1]];
        [to[0] + c * x - s * y, to[1] + s * x + c * y]
    };
    seen.iter().map(|point| point.map(moved)).collect()
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
