//! Packets bring what their rays bring one by one.

use super::*;
use crate::geometry::Shape;
use crate::optics::plate::{Model, SlitMirror, SlitMirrorPlate};
use crate::transport::Matter;
use crate::transport::bench_setup::{ACRYLIC, block, cone, cylinder, element, setup, sphere};

/// Every image point of a grid by packets and one by one, in rows and scattered; the share of points that kept to their packet's course.
fn compare(setup: &Setup, eye: Vec3) -> f64 {
    let in_rows =
        (0..9000).map(|i| [f64::from(i % 97) / 80.0 - 0.1, f64::from(i / 97) / 80.0 - 0.1]);
    let mut random = fastrand::Rng::with_seed(5);
    let scattered = (0..1001).map(|_| [random.f64(), random.f64()]);
    let uv: Vec<[f64; 2]> = in_rows.chain(scattered).collect();
    let mut packets = Packets::new(setup, eye);
    let mut path = Path::new();
    let (mut next, mut ended) = (0, 0);
    packets.ends(&uv, |i, end| {
        assert_eq!(i, next);
        next += 1;
        let alone = setup.trace(setup.ray_from(eye, uv[i]), &mut path);
        // To the last bit: the same functions over the same numbers.
        assert_eq!(end, alone, "{:?} of {:?}", uv[i], setup.elements);
        ended += usize::from(end.formed().is_some());
    });
    assert_eq!(next, uv.len());
    assert!(20 * ended > uv.len(), "{ended} of {}", uv.len());
    let Some(lone) = LoneSolid::before_plate(setup, eye, 0.0, 0.0) else { return 0.0 };
    let mut kept = 0;
    for uv in uv.chunks_exact(LANES) {
        let points = [0, 1].map(|axis| std::array::from_fn(|i| uv[i][axis]));
        set_out(&mut packets.packet.lanes, setup, eye, &points);
        let first = packets.packet.lanes.ray(0);
        let course = lone.as_ref().map_or(Some([0; 2]), |lone| lone.course(&first));
        let Some(faces) = course else { continue };
        follow(&mut packets.packet, setup, &lone, faces);
        kept += packets.packet.kept.iter().filter(|&&kept| kept).count();
    }
    kept as f64 / uv.len() as f64
}

#[test]
fn a_packet_brings_what_its_rays_bring_one_by_one() {
    let layered = Model::from(SlitMirrorPlate::new(SlitMirror::default()).unwrap());
    let ellipsoid = Shape::Convex(Convex::Ellipsoid { radii: Vec3::new(30.0, 40.0, 20.0) });
    let shapes = [
        sphere(30.0),
        sphere(8.0),
        cylinder(30.0, 80.0),
        cylinder(60.0, 20.0),
        block(50.0, 60.0, 40.0),
        cone(40.0, 25.0, 60.0),
        ellipsoid,
    ];
    let mut compared = 0;
    for plate in [Model::Ideal, layered] {
        assert!(
            compare(&setup(30.0, vec![]).with_plate(plate.clone()), Vec3::new(5.0, 9.0, 700.0))
                > 0.9
        );
        for (number, shape) in shapes.iter().enumerate() {
            for (index, follow_total_reflection) in [(1.49, true), (1.8, false)] {
                let matter = Matter::Refractive { index, absorption: [0.0; 3] };
                let solid = element(shape.clone(), matter, [1.0, -2.0, 3.0], [10.0, 20.0, 5.0], 0);
                let mut setup = setup(30.0, vec![solid]).with_plate(plate.clone());
                setup.follow_total_reflection = follow_total_reflection;
                let kept = compare(&setup, setup.viewpoint);
                // Past a ball of 8 mm goes most of what looks at an image of 30 mm.
                assert!(number == 1 || kept > 0.3, "{kept} {shape:?}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 28);
}

#[test]
fn what_is_more_than_a_lone_solid_goes_ray_by_ray() {
    let ball = |matter, z: f64| element(sphere(25.0), matter, [0.0, 0.0, z], [0.0; 3], 0);
    let pair = setup(20.0, vec![ball(ACRYLIC, 0.0), ball(ACRYLIC, 60.0)]);
    assert!(LoneSolid::before_plate(&pair, pair.viewpoint, 0.0, 0.0).is_none());
    assert_eq!(compare(&pair, pair.viewpoint), 0.0);
}
