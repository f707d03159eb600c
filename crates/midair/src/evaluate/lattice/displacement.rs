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

#[cfg(test)]
mod tests {
    use super::*;

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
