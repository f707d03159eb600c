//! Whole lattices, seen as cameras see them.

use super::*;
use crate::measure::gaussian_blur;

#[test]
fn clean_views_are_measured_to_a_hundredth_of_a_pixel() {
    let style = LatticeStyle { line_width: 0.008, ..LatticeStyle::default() };
    for warp in sample(8, warps(1024)) {
        let (picture, truth) = (warp.picture(&style), warp.truth(&style));
        let found = detect(&picture, 7).unwrap();
        let error = root_mean_square(&found, &truth);
        assert!(error <= 0.01, "{error} {warp:?}");
        // In perspective the middle of a line's two edges is not its middle: for lines of 8 px and
        // magnification that changes by 0.4 across 1024 px, by 8^2 / 8 * 0.4 / 1024 = 0.003 px; the
        // picture's 256 samples a pixel leave about as much.
        let worst = worst(&found, &truth);
        assert!(worst.is_some_and(|worst| worst <= 0.02), "{worst:?} {warp:?}");
    }
}

#[test]
fn blurred_noisy_unevenly_lit_views_are_measured_to_a_twentieth_of_a_pixel() {
    for (seed, warp) in sample(6, warps(1024)).into_iter().enumerate() {
        let style = LatticeStyle { line_width: 0.008 + 0.001 * seed as f64, ..Default::default() };
        let (picture, truth) = (warp.picture(&style), warp.truth(&style));
        for sigma in [1.0, 2.0, 3.0] {
            let photograph = photographed(&gaussian_blur(&picture, sigma), 0.4, 0.02, seed as u64);
            let found = detect(&photograph, 7).unwrap();
            let error = root_mean_square(&found, &truth);
            assert!(error <= 0.05, "{error} at blur {sigma} of {warp:?}");
            assert!(found.found() >= 47, "{:?} at blur {sigma} of {warp:?}", found.intersections);
        }
    }
}

#[test]
fn a_closed_frame_without_overhang_is_found_whole() {
    let style = LatticeStyle { overhang: 0.0, ..LatticeStyle::default() };
    for warp in sample(4, warps(700)) {
        let (picture, truth) = (warp.picture(&style), warp.truth(&style));
        let found = detect(&picture, 7).unwrap();
        // At the frame a crossing is extrapolated from one side.
        let worst = worst(&found, &truth);
        assert!(worst.is_some_and(|worst| worst <= 0.05), "{worst:?} {warp:?}");
    }
}

#[test]
fn other_counts_of_lines_and_small_pictures_are_found() {
    for (lines, size) in [(2, 200), (3, 160), (5, 256), (11, 400)] {
        let style = LatticeStyle { lines, line_width: 0.012, ..LatticeStyle::default() };
        let drawn = draw_lattice(size, size, &style).unwrap();
        // Lines are 2 to 5 pixels wide: where in a pixel an edge lies is half lost, and the sRGB
        // encoding brightens the partly covered ones.
        for (picture, tolerance) in [(Plane::luminance(&drawn), 0.06), (Plane::luma(&drawn), 0.1)] {
            let found = detect(&picture, lines).unwrap();
            for (point, [u, v]) in found.points().iter().zip(style.intersections_uv()) {
                let [x, y] = point.unwrap();
                let (dx, dy) = (x - u * size as f64, y - (1.0 - v) * size as f64);
                assert!(dx.hypot(dy) < tolerance, "{lines} lines, {size} pixels: {dx} {dy}");
            }
        }
    }
}

#[test]
fn a_covered_crossing_is_missing_and_its_neighbours_are_not() {
    let style = LatticeStyle::default();
    let mut picture = Plane::luma(&draw_lattice(700, 700, &style).unwrap());
    let [u, v] = style.intersections_uv()[24];
    let (x, y) = (u * 700.0, (1.0 - v) * 700.0);
    for (at, value) in picture.values.iter_mut().enumerate() {
        let (dx, dy) = ((at % 700) as f64 + 0.5 - x, (at / 700) as f64 + 0.5 - y);
        if dx.hypot(dy) < 25.0 {
            *value = 0.0;
        }
    }
    let found = detect(&picture, 7).unwrap();
    assert_eq!(found.intersections[24], Err(Missing::NotSeen));
    assert_eq!(found.found(), 48);
}

/// What a JPEG file loses costs no more than noise.
#[test]
fn a_jpeg_photograph_is_measured_to_a_twentieth_of_a_pixel() {
    use crate::picture::{decode_still, srgb};
    let style = LatticeStyle { line_width: 0.01, ..Default::default() };
    for (seed, warp) in sample(4, warps(800)).into_iter().enumerate() {
        let (picture, truth) = (warp.picture(&style), warp.truth(&style));
        let photograph = photographed(&gaussian_blur(&picture, 1.5), 0.4, 0.01, seed as u64);
        let yellow = |light: &f32| {
            let code = srgb::encode_8(light.clamp(0.0, 1.0));
            [code, code, srgb::encode_8(0.02)]
        };
        let codes: Vec<[u8; 3]> = photograph.values.iter().map(yellow).collect();
        let mut bytes = Vec::new();
        image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 85)
            .encode(codes.as_flattened(), 800, 800, image::ExtendedColorType::Rgb8)
            .unwrap();
        let read = decode_still("photo.jpg".as_ref(), &bytes).unwrap();
        let found = detect(&Plane::luminance(&read.picture), 7).unwrap();
        let error = root_mean_square(&found, &truth);
        assert!(error <= 0.05, "{error} {warp:?}");
        assert!(found.found() >= 45, "{} {warp:?}", found.found());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]
    /// Any smooth view with blur and noise: a twentieth of a pixel, and none misnamed (a period is 40 pixels at least).
    #[test]
    fn a_smooth_view_with_blur_and_noise_is_measured_and_named(
        warp in warps(600),
        line_width in 0.008_f64..0.014,
        sigma in 0.7_f64..2.0,
        seed in any::<u64>(),
    ) {
        let style = LatticeStyle { line_width, ..Default::default() };
        let blurred = gaussian_blur(&warp.picture(&style), sigma);
        let found = detect(&photographed(&blurred, 0.3, 0.015, seed), 7).unwrap();
        let truth = warp.truth(&style);
        let error = root_mean_square(&found, &truth);
        prop_assert!(error <= 0.05, "{error}");
        // Outer crossings are seen from one side but for an overhang of a few pixels: in doubt when noise is strong.
        prop_assert!(found.found() >= 45, "{:?}", found.intersections);
        for (point, truth) in found.points().iter().zip(&truth) {
            let Some([x, y]) = point else { continue };
            prop_assert!((x - truth[0]).hypot(y - truth[1]) < 0.2, "{point:?} {truth:?}");
        }
    }
}
