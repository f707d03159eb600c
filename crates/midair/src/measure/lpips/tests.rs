//! LPIPS against the reference implementation's values, where weights and pictures are at hand.

use std::path::{Path, PathBuf};

use super::*;
use crate::picture::{Picture, read_still};

/// The folder of weights, example pictures and reference values, where it is there.
fn shared() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let there = folder.join("lpips/reference_values.json").is_file();
    if !there {
        println!("skipped: ../shared/data/lpips is not there");
    }
    there.then_some(folder)
}

fn channels(path: &Path) -> [Plane; 3] {
    Plane::channels(&read_still(path).unwrap().picture)
}

/// numpy.roll(picture, 3, axis=1).
fn rolled(planes: &[Plane; 3]) -> [Plane; 3] {
    planes.each_ref().map(|plane| {
        Plane::from_fn(plane.width, plane.height, |x, y| {
            plane.at((x + plane.width - 3) % plane.width, y)
        })
    })
}

fn mapped(planes: &[Plane; 3], of: fn(u8) -> u8) -> [Plane; 3] {
    planes.each_ref().map(|plane| {
        let code = |value: &f32| f32::from(of((value * 255.0).round() as u8)) / 255.0;
        Plane { values: plane.values.iter().map(code).collect(), ..plane.clone() }
    })
}

#[test]
fn equals_the_reference_implementation() {
    let Some(folder) = shared() else { return };
    let text = std::fs::read_to_string(folder.join("lpips/reference_values.json")).unwrap();
    let expected: serde_json::Value = serde_json::from_str(&text).unwrap();
    let example = |name: &str| channels(&folder.join(format!("lpips/{name}.png")));
    let photograph = |name: &str| channels(&folder.join(format!("live1/{name}.png")));
    let (caps, bikes, statue) = (photograph("caps"), photograph("bikes"), photograph("statue"));
    let pairs = [
        ("ex_ref|ex_p0", example("ex_ref"), example("ex_p0")),
        ("ex_ref|ex_p1", example("ex_ref"), example("ex_p1")),
        ("caps|np.roll(caps,3,axis=1)", caps.clone(), rolled(&caps)),
        ("parrots|caps", photograph("parrots"), caps),
        ("bikes|bikes//2", bikes.clone(), mapped(&bikes, |code| code / 2)),
        ("statue(480x720)|255-statue", statue.clone(), mapped(&statue, |code| 255 - code)),
    ];
    for (backbone, key) in [(Backbone::Alex, "lpips_alex"), (Backbone::Squeeze, "lpips_squeeze")] {
        let path = folder.join("lpips").join(format!("{key}.safetensors"));
        let lpips = Lpips::read(backbone, &path).unwrap();
        for (name, first, second) in &pairs {
            let expected = expected[*name][key].as_f64().unwrap();
            let found = lpips.compare(first, second).unwrap();
            // The promise is 1e-3; the values are given to 1e-6, sums are in single precision.
            assert!((found - expected).abs() < 1e-4, "{key} {name}: {found}, expected {expected}");
        }
    }
    for (name, first, second) in &pairs {
        let expected = expected[*name]["ssim_rgb"].as_f64().unwrap();
        let found = crate::measure::ssim_over_channels(first, second).unwrap();
        // The values are given to 1e-6; inputs are rounded to single precision.
        assert!((found - expected).abs() < 2e-6, "SSIM {name}: {found}, expected {expected}");
    }
}

#[test]
fn equal_pictures_have_no_distance_and_sizes_must_agree() {
    let Some(folder) = shared() else { return };
    let path = folder.join("lpips/lpips_squeeze.safetensors");
    let lpips = Lpips::read(Backbone::Squeeze, &path).unwrap();
    let grey = |w, h| Plane::channels(&Picture::filled(w, h, [0.2, 0.4, 0.1, 1.0]));
    let features = lpips.features(&grey(64, 70)).unwrap();
    assert_eq!(lpips.distance(&features, &features).unwrap(), 0.0);
    assert!(lpips.distance(&features, &lpips.features(&grey(70, 64)).unwrap()).is_err());
    assert!(lpips.features(&grey(62, 100)).is_err());
    let mut holed = grey(64, 64);
    holed[1].values[5] = f32::NAN;
    assert!(lpips.features(&holed).is_err());
    // One network's weights are not the other's.
    let error = Lpips::read(Backbone::Alex, &path).unwrap_err().to_string();
    assert!(error.contains("not those of LPIPS"), "{error}");
}

#[test]
fn files_that_are_no_weights_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lpips_alex.safetensors");
    assert!(matches!(Lpips::read(Backbone::Alex, &path), Err(LpipsError::Unreadable { .. })));
    let whole = br#"{"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}}"#;
    let mut file = (whole.len() as u64).to_le_bytes().to_vec();
    file.extend_from_slice(whole);
    file.extend_from_slice(&1.0_f32.to_le_bytes());
    let huge = u64::MAX.to_le_bytes();
    for bytes in [&file[..], &file[..20], &huge[..], b"", b"PNG"] {
        std::fs::write(&path, bytes).unwrap();
        let error = Lpips::read(Backbone::Alex, &path).unwrap_err();
        assert!(matches!(error, LpipsError::WrongWeights { .. }), "{error}");
    }
}
