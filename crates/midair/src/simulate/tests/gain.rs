//! The gain is what light by light is left: measured tables, displays that emit unevenly, several displays.

use super::*;

#[test]
fn the_gain_is_what_light_by_light_is_left() {
    // A tinted ball and a tinted block, without the plate's losses and with losses that differ by colour.
    let matter = Matter::Refractive { index: 1.49, absorption: [0.002, 0.005, 0.01] };
    let solids = [
        element(sphere(25.0), matter, [0.0; 3], [0.0; 3], 0),
        element(block(50.0, 50.0, 50.0), matter, [0.0; 3], [10.0, 25.0, 0.0], 0),
    ];
    let plates = [Model::Ideal, Model::from(fine([0.9, 0.8, 0.7], [0.0, 0.01, 0.02]))];
    const SAMPLES: u32 = 1 << 15;
    for (solid, plate) in solids.iter().flat_map(|solid| plates.iter().map(move |p| (solid, p))) {
        let setup = furnace(20.0, vec![solid.clone()]).with_plate(plate.clone());
        // A pixel of the view is 4 mm wide: the gain is averaged over it.
        let (pixels, parts) = (5, 32);
        let across = pixels * parts;
        let closed = gain(&setup, &crate::map::Map::identity(across, across));
        let found = shoot(&setup, &white(), &pinhole(&setup, [pixels; 2]), SAMPLES);
        let mut expected = vec![[0.0; 3]; pixels * pixels];
        for (index, share) in closed.rgb.iter().enumerate() {
            let (column, row) = (index % across / parts, index / across / parts);
            for c in 0..3 {
                expected[row * pixels + column][c] += f64::from(share[c]) / (parts * parts) as f64;
            }
        }
        for (expected, real) in expected.iter().zip(&found.layers.real.pixels) {
            for c in 0..3 {
                let off = (f64::from(real[c]) - expected[c]).abs() / expected[c];
                // What two more reflections bring: (4 %)^2, seen 0.0015.
                let mut allowed = 0.002;
                if matches!(plate, Model::SlitMirror(_)) {
                    // A path is the image's or it is not, whichever slits it meets: at least a third are. Five standard errors.
                    allowed += 5.0 * (2.0 / f64::from(SAMPLES)).sqrt();
                }
                assert!(off < allowed, "{off} {allowed} {expected:?} {real:?}");
            }
        }
    }
}

/// Against each point's own path.
#[test]
fn the_gain_over_the_image_is_that_of_each_of_its_points() {
    let matter = Matter::Refractive { index: 1.49, absorption: [0.002, 0.005, 0.01] };
    let ball = element(sphere(25.0), matter, [0.0; 3], [0.0; 3], 0);
    let points = crate::map::Map::identity(151, 151);
    let off = |image: f64, plate: &Model| -> Vec<f32> {
        let setup = furnace(image, vec![ball.clone()]).with_plate(plate.clone());
        let (exact, over) = (gain(&setup, &points), image_gain(&setup));
        let pairs = exact.rgb.iter().zip(&points.uv).filter(|(rgb, _)| rgb[0].is_finite());
        let off = pairs.flat_map(|(rgb, &uv)| {
            let found = over.at(uv);
            [0, 1, 2].map(|c| (found[c] - rgb[c]).abs() / rgb[c])
        });
        off.collect()
    };
    // Smooth: the bound that is promised.
    let smooth = off(20.0, &Model::Ideal);
    assert_eq!(smooth.len(), 3 * 151 * 151);
    assert!(smooth.iter().all(|&off| off < 1e-3), "{:?}", smooth.iter().copied().reduce(f32::max));
    // An image wider than the ball, cut by its outline (towards which Fresnel's share falls as a root does), and a plate whose efficiency
    // has kinks: there the grid is finer, without a bound. A band of two fine cells along the outline, 2 pi 25 / 60 * 256 = 670 cells
    // long, is 4 % of the ball's 35700 cells.
    let plate = Model::from(fine([0.9, 0.8, 0.7], [0.0, 0.01, 0.02]));
    // Both at once, where the ball bends most, are beyond this grid: there a tenth of the points was found to be off by more (10.5 %),
    // a limit that is known and watched here.
    for (rough, most) in
        [(off(60.0, &Model::Ideal), 0.04), (off(20.0, &plate), 0.01), (off(60.0, &plate), 0.11)]
    {
        assert!(rough.iter().all(|off| off.is_finite()));
        let far = rough.iter().filter(|&&off| off > 2e-3).count();
        assert!((far as f64) < most * rough.len() as f64, "{far} of {}", rough.len());
    }
}

#[test]
fn a_measured_table_gives_the_image_its_brightness() {
    let setup = furnace(60.0, vec![]);
    let csv = "azimuth,elevation,value\n-9,-9,1\n9,-9,2\n-9,9,3\n9,9,4\n";
    let table = crate::optics::plate::LuminanceTable::from_csv(
        csv.as_bytes(),
        std::path::Path::new("bench.csv"),
    )
    .unwrap();
    let viewer = pinhole(&setup, [16, 16]);
    let model = fine([0.9; 3], [0.0; 3]);
    for (plate, efficiency) in [
        (Model::Ideal, 1.0),
        // The table is brightest at 9 degrees to the right and upwards.
        (Model::from(model.clone()), {
            let d = crate::optics::plate::viewing_direction([9.0, 9.0]);
            model.efficiency(setup.plate.rectangle.frame.to_local_direction(d))
        }),
    ] {
        let mut setup = setup.with_plate(plate);
        let without = shoot(&setup, &white(), &viewer, 256);
        setup.plate = setup.plate.with_luminance(table.clone(), &setup.image.frame);
        let got = shoot(&setup, &white(), &viewer, 256);
        for (x, y) in [(2, 13), (13, 2), (8, 8)] {
            let ray = viewer.camera.ray(&setup, f64::from(x) + 0.5, f64::from(y) + 0.5);
            // The image's frame is the world's here.
            let [a, e] = crate::optics::plate::viewing_angles(-ray.direction);
            let expected = (2.5 + a / 18.0 + e / 9.0) / 4.0 * efficiency;
            let pixel = got.layers.real.pixels[y as usize * 16 + x as usize];
            // 256 paths, most of which are real: their share is sure to 3 %, and 5 of that.
            assert!((f64::from(pixel[1]) / expected - 1.0).abs() < 0.15, "{pixel:?} {expected}");
        }
        // All pixels together are 16 times as sure; the table rises linearly, so its middle is the mean.
        let expected = 2.5 / 4.0 * efficiency;
        let seen = mean(&got.layers.real)[1];
        assert!((seen / expected - 1.0).abs() < 0.01, "{seen} {expected}");
        assert_eq!(got.layers.stray, without.layers.stray);
        assert_eq!(got.layers.through, without.layers.through);
    }
}

#[test]
fn a_display_that_emits_less_aslant_is_seen_as_its_gain_says() {
    // cos^4 of the angle, every two degrees.
    let mut text = String::from("angle,red,green,blue\n");
    for angle in (0..=90).step_by(2) {
        let cosine = f64::from(angle).to_radians().cos().max(0.0);
        text += &format!("{angle},{},{},{}\n", cosine.powi(4), cosine, 1.0);
    }
    let table = EmissionTable::from_csv(text.as_bytes(), std::path::Path::new("x.csv")).unwrap();
    let mut setup = setup(60.0, Vec::new());
    // Nearer to the display rays meet it more aslant.
    setup.viewpoint = Vec3::new(0.0, 0.0, 150.0);
    setup.emission = Emission::Measured(std::sync::Arc::new(table));
    let (pixels, parts) = (5, 16);
    let across = pixels * parts;
    let closed = gain(&setup, &crate::map::Map::identity(across, across));
    let found = shoot(&setup, &white(), &pinhole(&setup, [pixels; 2]), 1 << 12);
    for (index, share) in closed.rgb.iter().enumerate() {
        let uv = crate::map::pixel_centre(index % across, index / across, across, across);
        let d = setup.ray(uv).direction;
        // Through an ideal plate and no element the angle with the display's normal is the one with the image's.
        let cosine = -d.z;
        for (c, expected) in [cosine.powi(4), cosine, 1.0].into_iter().enumerate() {
            // Linear between lines: (2 pi / 180)^2 / 8 times a second derivative of 4.
            assert!((f64::from(share[c]) - expected).abs() < 7e-4, "{share:?} {cosine}");
        }
    }
    let mut mean = vec![[0.0; 3]; pixels * pixels];
    for (index, share) in closed.rgb.iter().enumerate() {
        let (column, row) = (index % across / parts, index / across / parts);
        for c in 0..3 {
            mean[row * pixels + column][c] += f64::from(share[c]) / (parts * parts) as f64;
        }
    }
    assert!(mean[0][0] < 0.93 * mean[pixels * pixels / 2][0]);
    for (seen, expected) in found.layers.real.pixels.iter().zip(&mean) {
        for c in 0..3 {
            // No chance is involved but where in the pixel a path goes: both are means of a smooth function over it.
            assert!((f64::from(seen[c]) - expected[c]).abs() < 1e-3, "{seen:?} {expected:?}");
        }
    }
}

/// Paths do not depend on what a display shows: followed once, they show every display as it is shown by itself.
#[test]
fn several_displays_are_seen_as_each_by_itself() {
    let ball = element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 0);
    let setup = setup(20.0, vec![ball]);
    let camera = Camera { size: [9, 7], ..Camera::at_viewpoint(&setup, [9, 7]) };
    let viewer = Viewer { camera, aperture: 3.0, focus: None };
    let settings = Settings { samples_per_pixel: 24, seed: 4 };
    let stripes = |step: usize| {
        let pixels = (0..64 * 64).map(|i| [(i % step) as f32 / step as f32, 0.5, 0.1, 1.0]);
        Picture { width: 64, height: 64, pixels: pixels.collect() }
    };
    let displays = [stripes(3), stripes(7), Picture::filled(2, 5, [0.3, 0.6, 0.9, 1.0])];
    let all =
        render_all(&setup, &displays.each_ref(), &viewer, &settings, &(), &mut |_| ()).unwrap();
    assert_eq!(all.len(), 3);
    for (together, display) in all.iter().zip(&displays) {
        let alone = render(&setup, display, &viewer, &settings, &(), &mut |_| ()).unwrap();
        assert!(alone.mean_luminance > 0.1 && *together == alone);
    }
    assert!(render_all(&setup, &[], &viewer, &settings, &(), &mut |_| ()).unwrap().is_empty());
}
