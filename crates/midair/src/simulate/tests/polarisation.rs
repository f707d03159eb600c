//! Polarised displays: Brewster's angle, the plate's faces.

use super::*;

/// Polarised light through a slab at Brewster's angle, with all reflections within: all of p, and (1 - R) / (1 + R) of s (the sum over
/// reflections to and fro; Hecht, Optics, 8.6).
#[test]
fn a_slab_at_brewsters_angle_polarises() {
    let n = 1.49f64;
    let slab = element(
        block(4000.0, 900.0, 0.01),
        ACRYLIC,
        [0.0; 3],
        [0.0, n.atan().to_degrees(), 0.0],
        0,
    );
    let mut setup = furnace(1.0, vec![slab]);
    let viewer = pinhole(&setup, [8, 8]);
    let r = ((n * n - 1.0) / (n * n + 1.0)).powi(2);
    let s = (1.0 - r) / (1.0 + r);
    // The display leans by 45 degrees, like the plate: a polariser at 45 degrees in its plane lets pass, aslant, what lies across both the ray and its absorbing axis,
    // (cos, cos, sin) of 45 degrees, of which a third is along x.
    for (angle, expected) in [(0.0, 1.0), (90.0, s), (45.0, (1.0 + 2.0 * s) / 3.0)] {
        setup.polarisation = Some(angle);
        let render = shoot(&setup, &white(), &viewer, 4096);
        let off = render.mean_luminance - expected;
        // Rays are parallel to a thousandth, which moves R_p at Brewster's angle by its square.
        let tolerance = 5.0 * render.error.of_mean + 1e-5;
        assert!(off.abs() < tolerance, "{angle}: {} {expected} {tolerance}", render.mean_luminance);
    }
}

/// A slit-mirror plate's faces take more of light that is polarised across the plane of incidence: the closed form's real share, its faces'
/// unpolarised transmittance replaced by that of s or p.
#[test]
fn a_plates_faces_polarise() {
    let parameters = SlitMirror::default();
    let plate = SlitMirrorPlate::new(parameters).unwrap();
    let mut setup = furnace(0.2, vec![]).with_plate(Model::from(plate.clone()));
    let viewer = Viewer { aperture: 30.0, ..pinhole(&setup, [6, 6]) };
    let local = setup.plate.rectangle.frame.to_local_direction(Vec3::new(0.0, 0.0, -1.0));
    let f = crate::optics::interface::fresnel(local.z.abs(), 1.0 / parameters.ior);
    let real = plate.shares(local).real[1] / f.transmittance().powi(2);
    // The plate leans about x: s lies along x, and stays there.
    for (angle, expected) in [(0.0, (1.0 - f.s).powi(2)), (90.0, (1.0 - f.p).powi(2))] {
        setup.polarisation = Some(angle);
        let render = shoot(&setup, &white(), &viewer, 16_384);
        let found = mean(&render.layers.real)[1];
        // Over a pupil of 30 mm at 800 directions differ by two degrees, and the share's change over them is even: its square, 1e-3.
        let tolerance = 5.0 * render.error.of_mean + 2e-3;
        assert!((found - real * expected).abs() < tolerance, "{angle}: {found} {real} {expected}");
        assert!(tolerance < 0.01, "{tolerance}");
    }
    // By the gain in closed form as well, on a display that the image fills.
    let mut setup = crate::transport::bench_setup::setup(0.2, vec![]).with_resolution([8, 8]);
    setup.plate = Plate::new(setup.plate.rectangle, Model::from(plate));
    setup.display = setup.display_place();
    setup.polarisation = Some(90.0);
    let (map, _) = invert(&setup, Accuracy::default());
    let gain = gain(&setup, &map);
    let answered = gain.rgb.iter().filter(|rgb| !rgb[1].is_nan());
    let mut compared = 0;
    for share in answered {
        assert!((f64::from(share[1]) - real * (1.0 - f.p).powi(2)).abs() < 1e-3, "{share:?}");
        compared += 1;
    }
    assert!(compared >= 36, "{compared}");
}
