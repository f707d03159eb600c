//! Pictures that hold no whole lattice, or none.

use super::*;

#[test]
fn what_is_no_whole_lattice_is_an_error_that_says_why() {
    let seen = Plane::luma(&draw_lattice(500, 500, &LatticeStyle::default()).unwrap());
    let half = Plane::from_fn(300, 500, |x, y| seen.at(x, y));
    let error = detect(&half, 7).unwrap_err();
    assert!(matches!(error, LatticeError::Partial { seen: Count { rows: 7, .. }, .. }), "{error}");
    let error = detect(&seen, 5).unwrap_err();
    assert_eq!(error, LatticeError::TooMany { seen: 7.into(), count: 5.into() });
    assert_eq!(detect(&Plane::filled(200, 200, 0.4), 7), Err(LatticeError::NoLattice));
    let mut uniform = noise(7);
    let grain = Plane {
        values: (0..90_000).map(|_| uniform() as f32).collect(),
        ..Plane::filled(300, 300, 0.0)
    };
    assert!(detect(&grain, 7).is_err());
    assert!(matches!(detect(&seen, 1), Err(LatticeError::TooFewLines { .. })));
    assert!(matches!(detect(&Plane::filled(30, 900, 0.0), 7), Err(LatticeError::TooSmall { .. })));
    let mut holed = seen.clone();
    holed.values[3] = f32::INFINITY;
    assert_eq!(detect(&holed, 7), Err(LatticeError::NotFinite { column: 3, row: 0 }));
    // So much of it as is seen, by its own count.
    let part = detect_part(&half, 7).unwrap();
    assert_eq!((part.count.rows, part.found()), (7, part.count.intersections()));
    // Dark lines on white are found once inverted.
    let dark = seen.inverted();
    assert!(detect(&dark, 7).is_err());
    assert_eq!(detect(&dark.inverted(), 7).unwrap().found(), 49);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Whatever the picture, the answer is an answer.
    #[test]
    fn no_picture_makes_it_fail_otherwise(
        width in 0_usize..90,
        height in 0_usize..90,
        lines in 0_usize..9,
        stripes in 1_usize..12,
        seed in any::<u64>(),
    ) {
        let mut uniform = noise(seed);
        let mut picture = Plane::from_fn(width, height, |x, y| {
            f32::from(x % stripes == 0 || y % (stripes + 1) == 0)
        });
        picture.values.iter_mut().for_each(|value| *value += uniform() as f32);
        if let Ok(found) = detect(&picture, lines) {
            prop_assert_eq!(found.intersections.len(), lines * lines);
            prop_assert!(found.points().iter().flatten().flatten().all(|x| x.is_finite()));
        }
    }
}
