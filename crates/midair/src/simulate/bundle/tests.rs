//! Bundles bring what their paths bring one by one.

use super::*;
use crate::geometry::Shape;
use crate::optics::plate::SlitMirror;
use crate::simulate::sequence::mix;
use crate::simulate::{Camera, Viewer};
use crate::transport::Matter;
use crate::transport::Setup;
use crate::transport::bench_setup::{block, cone, cylinder, element, setup, sphere};

/// Every path of a view by bundles and one by one; the share of paths that kept to their bundle's course.
fn compare(setup: &Setup) -> f64 {
    let stage = Stage { setup };
    let camera = Camera { window: 1.5, ..Camera::at_viewpoint(setup, [64, 64]) };
    let viewer = Viewer { camera, aperture: 8.0, focus: Some(700.0) };
    let lens = Lens::new(&viewer, setup);
    let straight = Straight::of(&stage, setup.viewpoint, 4.0).expect("one convex solid");
    let points = Points::new(3, 0, 4);
    let mut bundle = Bundle::new();
    let (mut kept, mut all, mut lit) = (0, 0, 0);
    for row in 0..64 {
        for column in 0..64 {
            let at = Places {
                column: [f64::from(column); LANES],
                pixel: std::array::from_fn(|i| mix(64 * row + column as u32 + ((i as u32) << 20))),
                row: f64::from(row),
                index: std::array::from_fn(|i| i as u32 % 4),
            };
            Straight::start(&mut bundle, &lens, &at, &points);
            let Some(faces) = straight.course(&bundle) else { continue };
            Straight::follow(&straight, &mut bundle, &stage, faces);
            for i in 0..LANES {
                let (ray, chance) = bundle.first(i);
                let alone = stage.follow(ray, chance);
                // To the last bit: the same functions over the same numbers.
                assert_eq!(straight.outcome(&bundle, &stage, i), alone, "{column} {row} {i}");
                kept += usize::from(bundle.kept[i]);
                let on_display = |c: &f64| (0.0..=1.0).contains(c);
                lit += usize::from(alone.is_some_and(|end| end.st.iter().all(on_display)));
                all += 1;
            }
        }
    }
    assert!(all > 10_000 && 20 * lit > all, "{lit} of {all}");
    kept as f64 / all as f64
}

#[test]
fn a_bundle_brings_what_its_paths_bring_one_by_one() {
    let thick = SlitMirror {
        mirror_thickness: 0.05,
        absorption: [0.0, 0.02, 0.1],
        ..SlitMirror::default()
    };
    let plates = [
        Model::Ideal,
        Model::from(SlitMirrorPlate::new(SlitMirror::default()).unwrap()),
        Model::from(SlitMirrorPlate::new(thick).unwrap()),
    ];
    let clear = Matter::Refractive { index: 1.49, absorption: [0.0; 3] };
    let tinted = Matter::Refractive { index: 1.7, absorption: [0.001, 0.01, 0.0] };
    let turned =
        |shape, matter| vec![element(shape, matter, [1.0, -2.0, 3.0], [10.0, 20.0, 5.0], 0)];
    for plate in &plates {
        assert_eq!(compare(&setup(30.0, vec![]).with_plate(plate.clone())), 1.0);
        for elements in [
            turned(Shape::Convex(Convex::Sphere { radius: 30.0 }), clear),
            turned(cylinder(30.0, 80.0), tinted),
            turned(cylinder(60.0, 20.0), clear),
            turned(block(50.0, 60.0, 40.0), tinted),
            turned(cone(40.0, 25.0, 60.0), clear),
            turned(Shape::Convex(Convex::Ellipsoid { radii: Vec3::new(30.0, 40.0, 20.0) }), tinted),
            turned(sphere(8.0), clear),
        ] {
            let kept = compare(&setup(30.0, elements).with_plate(plate.clone()));
            // About 8 % are reflected inside at these indices, and edges and rims take some more.
            assert!(kept > 0.3, "{kept}");
        }
    }
}

#[test]
fn what_is_no_lone_convex_solid_before_the_plate_goes_path_by_path() {
    let clear = Matter::Refractive { index: 1.49, absorption: [0.0; 3] };
    let mirror = Matter::Mirror { reflectance: [0.9; 3] };
    let ball = |matter, z: f64| element(sphere(25.0), matter, [0.0, 0.0, z], [0.0; 3], 0);
    let of = |elements: Vec<_>, pupil: f64| {
        let setup = setup(20.0, elements);
        let stage = Stage { setup: &setup };
        Straight::of(&stage, setup.viewpoint, pupil).is_some()
    };
    assert!(of(vec![], 4.0) && of(vec![ball(clear, 0.0)], 4.0));
    assert!(!of(vec![ball(mirror, 0.0)], 4.0));
    assert!(!of(vec![ball(clear, 0.0), ball(clear, 100.0)], 4.0));
    // Through the plate, which stands at z = -150 and leans by 45 degrees.
    assert!(!of(vec![ball(clear, -130.0)], 4.0));
    assert!(!of(vec![], 5000.0));
}
