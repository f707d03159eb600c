//! The simulator against closed forms. What is random is held to its standard error: 5 of them, with
//! a fixed seed, so that a correct program never fails and a wrong one by more does.

use super::*;
use crate::geometry::{Frame, Ray, Rectangle, Vec3};
use crate::map::{Accuracy, invert};
use crate::monitor::Monitor;
use crate::optics::emission::{Emission, EmissionTable};
use crate::optics::plate::{Model, Plate, SlitMirror, SlitMirrorPlate};
use crate::picture::{Picture, optimal::view_through};
use crate::transport::bench_setup::{ACRYLIC, block, element, setup, sphere};
use crate::transport::{Element, Matter, Setup};
use std::sync::atomic::{AtomicBool, Ordering};

mod gain;
mod polarisation;
mod work;

fn white() -> Picture {
    Picture::filled(1, 1, [1.0; 4])
}

/// A set-up whose display is all that there is behind the plate.
fn furnace(image: f64, elements: Vec<Element>) -> Setup {
    let mut setup = setup(image, elements);
    let plate = setup.plate.rectangle.frame;
    let frame = Frame { origin: plate.origin - plate.normal() * 500.0, axes: plate.axes };
    setup.display = Rectangle { frame, size: [1e6; 2] };
    setup
}

fn shoot(setup: &Setup, display: &Picture, viewer: &Viewer, samples_per_pixel: u32) -> Render {
    let settings = Settings { samples_per_pixel, seed: 7 };
    render(setup, display, viewer, &settings, &(), &mut |_| ()).expect("sound arguments")
}

fn pinhole(setup: &Setup, size: [usize; 2]) -> Viewer {
    Viewer::pinhole(Camera::at_viewpoint(setup, size))
}

fn mean(picture: &Picture) -> [f64; 3] {
    std::array::from_fn(|c| {
        let sum: f64 = picture.pixels.iter().map(|p| f64::from(p[c])).sum();
        sum / picture.pixels.len() as f64
    })
}

/// Mean place and standard deviations of a picture's light, in pixels from the top-left corner.
fn moments(picture: &Picture) -> ([f64; 2], [f64; 2]) {
    let (mut sum, mut first, mut second) = (0.0, [0.0; 2], [0.0; 2]);
    for (index, pixel) in picture.pixels.iter().enumerate() {
        let at = [index % picture.width, index / picture.width].map(|i| i as f64 + 0.5);
        let light = f64::from(pixel[1]);
        sum += light;
        for axis in 0..2 {
            first[axis] += light * at[axis];
            second[axis] += light * at[axis] * at[axis];
        }
    }
    assert!(sum > 0.0, "no light");
    let centre = first.map(|f| f / sum);
    (centre, [0, 1].map(|i| (second[i] / sum - centre[i] * centre[i]).sqrt()))
}

/// A display of `size` pixels, black but for one at this column and row.
fn dot(size: usize, column: usize, row: usize) -> Picture {
    let mut picture = Picture::filled(size, size, [0.0, 0.0, 0.0, 1.0]);
    picture.pixels[row * size + column] = [1.0; 4];
    picture
}

/// A plate whose lattice is so fine that every pixel sees all of it.
fn fine(reflectance: [f64; 3], absorption: [f64; 3]) -> SlitMirrorPlate {
    SlitMirrorPlate::new(SlitMirror {
        pitch: 0.01,
        layer_depth: 0.025,
        cover_glass: 0.0,
        reflectance,
        absorption,
        ..SlitMirror::default()
    })
    .expect("a plate")
}

#[test]
fn before_a_white_display_each_layer_has_its_share() {
    let setup = furnace(60.0, vec![]);
    let viewer = Viewer { aperture: 6.0, ..pinhole(&setup, [16, 16]) };
    for model in [fine([1.0; 3], [0.0; 3]), fine([0.9, 0.8, 0.6], [0.0, 2.0, 5.0])] {
        let got = shoot(&setup.with_plate(Model::from(model.clone())), &white(), &viewer, 256);
        let mut expected = [[0.0; 3]; 3];
        for row in 0..16 {
            for column in 0..16 {
                let centre = [column, row].map(|i| f64::from(i) + 0.5);
                let ray = viewer.camera.ray(&setup, centre[0], centre[1]);
                let shares =
                    model.shares(setup.plate.rectangle.frame.to_local_direction(ray.direction));
                for (sum, share) in
                    expected.iter_mut().zip([shares.real, shares.stray, shares.through])
                {
                    for c in 0..3 {
                        sum[c] += share[c] / 256.0;
                    }
                }
            }
        }
        let layers = [&got.layers.real, &got.layers.stray, &got.layers.through];
        for (layer, expected) in layers.into_iter().zip(expected) {
            let got = mean(layer);
            for c in 0..3 {
                // 65536 paths of weight at most 1 that are in the layer or not; low discrepancy is no worse.
                let error = (expected[c] * (1.0 - expected[c]) / 65536.0).sqrt();
                // Shares bend over a pixel's angle: its centre stands for it to 1e-4.
                assert!((got[c] - expected[c]).abs() < 5.0 * error + 1e-4, "{got:?} {expected:?}");
            }
        }
        assert!(expected[0][0] > 0.3 && expected[1][0] > 0.02);
    }
}

/// With Fresnel's reflectance R and one passage's transmittance a, all bounces together pass
/// (1 - R)^2 a / (1 - R^2 a^2); without absorption (1 - R) / (1 + R).
#[test]
fn a_slab_passes_the_sum_of_all_its_bounces() {
    let absorption = [0.0, 0.01, 0.05];
    let matter = Matter::Refractive { index: 1.49, absorption };
    let slab = element(block(200.0, 200.0, 20.0), matter, [0.0, 0.0, 50.0], [0.0; 3], 0);
    // An image so small that all light comes at right angles, to 1e-5 of its energy.
    let setup = furnace(1.0, vec![slab]);
    let got = shoot(&setup, &white(), &pinhole(&setup, [16, 16]), 256);
    let r = (0.49f64 / 2.49).powi(2);
    let seen = mean(&got.layers.real);
    for c in 0..3 {
        let a = (-absorption[c] * 20.0).exp();
        let expected = (1.0 - r).powi(2) * a / (1.0 - r * r * a * a);
        assert!((seen[c] - expected).abs() < 5.0 * got.error.of_mean + 1e-5, "{c} {seen:?}");
    }
    assert!((seen[0] - (1.0 - r) / (1.0 + r)).abs() < 5.0 * got.error.of_mean + 1e-5);
    // The estimate is worth something: chance alone would be at sqrt(T (1 - T) / 65536) = 0.001.
    assert!(got.error.of_mean < 0.0005, "{}", got.error.of_mean);
    // Nothing but the mid-air image passes an ideal plate.
    assert_eq!(mean(&got.layers.stray), [0.0; 3]);
    assert_eq!(mean(&got.layers.through), [0.0; 3]);
}

#[test]
fn total_reflection_loses_nothing() {
    // A square prism turned by 30 degrees, seen so far aside that all light meets a side wall, at 90 - 19.6 = 70.4
    // degrees (more than the critical 42.2): however often it bounces, it meets the front and the back at 30
    // degrees and the walls totally. So it passes as much as a slab does at 30 degrees.
    let place = [-10.2, 0.0, 0.0];
    let cube = element(block(20.0, 2000.0, 20.0), ACRYLIC, place, [0.0, 30.0, 0.0], 0);
    let mut setup = furnace(4.0, vec![cube]);
    // After a wall light leaves to the side.
    setup.plate.rectangle.size = [1e5; 2];
    let got = shoot(&setup, &white(), &pinhole(&setup, [16, 16]), 256);
    let f = crate::optics::interface::fresnel(30f64.to_radians().cos(), 1.0 / 1.49);
    let r = f.reflectance();
    // Unpolarised light at each surface, as everywhere in the simulator.
    let expected = (1.0 - r) / (1.0 + r);
    let seen = mean(&got.layers.real)[0];
    // Angles vary by 0.15 degrees over the image.
    assert!((seen - expected).abs() < 5.0 * got.error.of_mean + 5e-4, "{seen} {expected}");
}

#[test]
fn an_ideal_plate_shows_a_dot_where_the_transport_does() {
    for (elements, column, row) in
        [(vec![], 20, 12), (vec![element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 0)], 30, 35)]
    {
        let setup = setup(20.0, elements);
        let display = dot(64, column, row);
        let viewer = pinhole(&setup, [48, 48]);
        let got = shoot(&setup, &display, &viewer, 64);
        let mut camera = viewer.camera;
        camera.supersampling = 8;
        let ideal = view_through(&camera.rays(&setup), &display).expect("sizes fit");
        let (a, b) = (moments(&got.layers.real).0, moments(&ideal).0);
        // A dot is a pixel wide; a few hundred paths reach it, so its centre is sure to some hundredths of a
        // pixel. Light that was reflected inside the ball is spread widely: 1e-3 of it, over 24 pixels.
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 0.1, "{a:?} {b:?}");
        if setup.elements.is_empty() {
            // Plane symmetry itself: st is uv.
            let expected = [column, row].map(|i| (i as f64 + 0.5) * 0.75);
            assert!((a[0] - expected[0]).hypot(a[1] - expected[1]) < 0.05, "{a:?}");
        }
    }
}

#[test]
fn a_fine_slit_mirror_plate_images_at_the_plane_symmetric_place() {
    let plate = Model::from(fine([1.0; 3], [0.0; 3]));
    let setup = setup(20.0, vec![]).with_plate(plate);
    let viewer = Viewer { aperture: 20.0, ..pinhole(&setup, [40, 40]) };
    let got = shoot(&setup, &dot(40, 25, 11), &viewer, 256);
    let (centre, spread) = moments(&got.layers.real);
    // The plate is 0.05 mm thick, and its two layers focus h / n = 0.02 mm apart; pixels are 0.5 mm.
    assert!((centre[0] - 25.5).hypot(centre[1] - 11.5) < 0.15, "{centre:?}");
    // And sharp there: a bilinear dot is as wide as a pixel, sqrt(1/6), and the box of the view adds 1/12.
    assert!(spread.iter().all(|s| (s - 0.5).abs() < 0.1), "{spread:?}");
}

#[test]
fn out_of_focus_a_point_is_a_disc_of_the_lens_formulas_size() {
    let setup = setup(20.0, vec![]);
    // 24 of the display's 60 pixels, as wide as the view's.
    let camera = Camera { window: 0.4, ..Camera::at_viewpoint(&setup, [24, 24]) };
    let display = dot(60, 30, 30);
    for focus in [600.0, 1000.0] {
        let viewer = Viewer { camera, aperture: 12.0, focus: Some(focus) };
        let got = shoot(&setup, &display, &viewer, 2048);
        // Rays that cross at the distance f are spread over A |s - f| / f at the distance s; a view
        // pixel names the place where the eye's own ray meets the image's plane.
        let disc = 12.0 * (800.0 - focus).abs() / focus / 20.0 * 60.0;
        // A disc's standard deviation is a quarter of its diameter; the dot and the pixel add 1/6 + 1/12.
        let expected = ((disc / 4.0).powi(2) + 0.25).sqrt();
        let (_, spread) = moments(&got.layers.real);
        // About 2048 paths meet the dot: their deviation is sure to 1 / sqrt(4096) = 1.6 %.
        assert!(spread.iter().all(|s| (s / expected - 1.0).abs() < 0.05), "{spread:?} {expected}");
    }
}

#[test]
fn stray_images_are_where_the_thin_plate_says() {
    let setup = setup(40.0, vec![]);
    let model = fine([1.0; 3], [0.0; 3]);
    // Seen over 400 mm of the image's plane, in pixels of 4 mm.
    let mut viewer = pinhole(&setup, [100, 100]);
    viewer.camera.window = 10.0;
    let (column, row) = (13, 8);
    let got =
        shoot(&setup.with_plate(Model::from(model.clone())), &dot(20, column, row), &viewer, 64);

    let to_plate = |point: Vec3| setup.plate.rectangle.frame.to_local(point);
    let st = [(column as f64 + 0.5) / 20.0, 1.0 - (row as f64 + 0.5) / 20.0];
    let (source, eye) = (to_plate(setup.display.point(st)), to_plate(setup.viewpoint));
    let position = |odd| {
        let [x, y] = model.thin_crossing(source, eye, odd).expect("apart");
        let crossing = setup.plate.rectangle.frame.to_world(Vec3::new(x, y, 0.0));
        let direction = (crossing - setup.viewpoint).normalized();
        let ray = Ray { origin: setup.viewpoint, direction };
        let point = ray.at(setup.image.plane_distance(&ray));
        viewer.camera.view_position(setup.image.coordinates(point))
    };
    let check = |layer: &Picture, places: &[[f64; 2]]| {
        let mut near = vec![0.0; places.len()];
        let mut total = 0.0;
        for (index, pixel) in layer.pixels.iter().enumerate() {
            let at = [index % 100, index / 100].map(|i| i as f64 + 0.5);
            total += f64::from(pixel[1]);
            for (near, place) in near.iter_mut().zip(places) {
                if (at[0] - place[0]).hypot(at[1] - place[1]) < 2.5 {
                    *near += f64::from(pixel[1]);
                }
            }
        }
        assert!(near.iter().all(|&n| n > 0.02 * total), "{near:?} of {total} at {places:?}");
        // All of it: the dot is at most a pixel wide, nothing shows anywhere else.
        assert!(near.iter().sum::<f64>() > 0.99 * total, "{near:?} of {total} at {places:?}");
    };
    check(&got.layers.real, &[position([true, true])]);
    check(&got.layers.stray, &[position([true, false]), position([false, true])]);
}

#[test]
fn with_dispersion_each_colour_goes_its_own_way() {
    let at = |index| {
        let matter = Matter::Refractive { index, absorption: [0.0; 3] };
        setup(20.0, vec![element(sphere(25.0), matter, [0.0; 3], [0.0; 3], 0)])
    };
    let setups = [at(1.45), at(1.49), at(1.53)];
    let display = dot(64, 24, 35);
    let viewer = pinhole(&setups[0], [32, 32]);
    let settings = Settings { samples_per_pixel: 32, seed: 7 };
    let refs = [&setups[0], &setups[1], &setups[2]];
    let got = render_by_colour(refs, &display, &viewer, &settings, &(), &mut |_| ()).unwrap();
    assert_eq!(got.paths, 3 * 32 * 32 * 32);
    for (c, setup) in setups.iter().enumerate() {
        // The same random numbers: each colour is that of the whole render at its own index.
        let alone = shoot(setup, &display, &viewer, 32);
        let channel = |r: &Render| r.layers.real.pixels.iter().map(|p| p[c]).collect::<Vec<_>>();
        assert_eq!(channel(&got), channel(&alone));
    }
    let [r, _, b, _] = got
        .layers
        .real
        .pixels
        .iter()
        .fold([0.0; 4], |sum, p| std::array::from_fn(|c| sum[c] + p[c]));
    assert!(r > 0.0 && b > 0.0 && r != b);
}

#[test]
fn a_mirror_keeps_its_reflectance_of_each_colour() {
    let matter = Matter::Mirror { reflectance: [0.9, 0.5, 0.1] };
    let shape = crate::geometry::Shape::Sheet(crate::geometry::Sheet::Plane { half: [50.0; 2] });
    let mut setup = furnace(4.0, vec![element(shape, matter, [0.0; 3], [0.0; 3], 0)]);
    // The plate is a ceiling, its front downwards, and above it all is white.
    let frame = Frame::new(Vec3::new(0.0, 500.0, 0.0), [90.0, 0.0, 0.0]);
    assert!(frame.normal().y < -0.99);
    setup.plate = Plate::ideal(Rectangle { frame, size: [1e4; 2] });
    let above = Frame { origin: Vec3::new(0.0, 1000.0, 0.0), ..frame };
    setup.display = Rectangle { frame: above, size: [1e6; 2] };
    // Tilted one way the mirror reflects the viewer's sight upwards, the other way down into the dark.
    let seen = [20.0, -20.0].map(|tilt| {
        setup.elements[0].frame = Frame::new(Vec3::ZERO, [tilt, 0.0, 0.0]);
        mean(&shoot(&setup, &white(), &pinhole(&setup, [4, 4]), 8).layers.real)
    });
    let bright = if seen[0] > seen[1] { seen[0] } else { seen[1] };
    let dark = if seen[0] > seen[1] { seen[1] } else { seen[0] };
    assert_eq!(dark, [0.0; 3]);
    for (got, expected) in bright.iter().zip([0.9, 0.5, 0.1]) {
        // The picture is single precision.
        assert!((got - expected).abs() < 1e-6, "{bright:?}");
    }
}
