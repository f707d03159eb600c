//! The transport against closed forms and identities that it does not compute itself.

use super::bench_setup::{ACRYLIC, block, cone, cylinder, element, setup, sphere};
use super::*;
use crate::geometry::mesh::TriangleMesh;
use crate::geometry::{Crossing, HeightField, MeshSurface, Ray, Shape, Sheet, Vec3};
use proptest::prelude::*;
use std::sync::Arc;

const MIRROR: Matter = Matter::Mirror { reflectance: [0.95; 3] };

fn formed(setup: &Setup, uv: [f64; 2]) -> (Option<[f64; 2]>, Path) {
    let mut path = Path::new();
    let end = setup.transport(uv, &mut path);
    (end.st(), path)
}

/// The ray that leaves the last element before the plate.
fn before_plate(setup: &Setup, uv: [f64; 2], path: &[Step]) -> Ray {
    let mut ray = setup.ray(uv);
    for step in path.iter().take_while(|s| s.action != Action::Plate) {
        ray = setup.advance(&ray, step);
    }
    ray
}

#[test]
fn with_no_element_every_pixel_shows_the_image_point_at_its_place() {
    let setup = setup(40.0, vec![]);
    for uv in [[0.0, 0.0], [0.3, 0.8], [1.0, 0.5]] {
        let st = formed(&setup, uv).0.expect("the plate is in the way");
        // Coordinates of a metre in double precision: 1e-13 mm, on 40 mm.
        assert!((st[0] - uv[0]).hypot(st[1] - uv[1]) < 1e-13, "{uv:?} {st:?}");
    }
}

/// A plane-parallel slab shifts a ray by t sin(a) (1 - cos(a) / (n cos(b))), n sin b = sin a (Hecht, Optics).
#[test]
fn a_slab_shifts_the_ray_by_the_textbook_amount() {
    let thickness = 50.0;
    let setup = setup(
        10.0,
        vec![element(block(200.0, 200.0, thickness), ACRYLIC, [0.0; 3], [0.0, 15.8, 0.0], 0)],
    );
    let (st, path) = formed(&setup, [0.5, 0.5]);
    assert_eq!(path.len(), 3);
    let angle = 15.8f64.to_radians();
    let refracted = (angle.sin() / 1.49).asin();
    let shift = thickness * (angle - refracted).sin() / refracted.cos();
    let seen = (st.expect("reaches the display")[0] - 0.5) * 10.0;
    assert!((seen.abs() - shift).abs() < 1e-12, "{seen} {shift}");
    // The shift by a plane-parallel slab of 50 mm and 1.49 at 15.8 degrees.
    assert!((shift - 4.67).abs() < 0.005);
}

/// Through a ball a ray at impact parameter b is deflected by 2 (i - r), sin i = b / R = n sin r.
#[test]
fn a_ball_deflects_by_twice_the_difference_of_the_angles() {
    let setup = setup(20.0, vec![element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 0)]);
    for u in [0.55, 0.8, 0.99] {
        let uv = [u, 0.5];
        let (_, path) = formed(&setup, uv);
        let ray = setup.ray(uv);
        let exit = before_plate(&setup, uv, &path);
        let along = ray.origin.dot(ray.direction);
        let impact = (ray.origin - ray.direction * along).length();
        let i = (impact / 25.0).asin();
        let r = (impact / 25.0 / 1.49).asin();
        let deflection = exit.direction.dot(ray.direction).acos();
        // acos loses half the digits near 1.
        assert!((deflection - 2.0 * (i - r)).abs() < 1e-7, "{u}");
        // The line keeps its distance from the centre.
        let along = exit.origin.dot(exit.direction);
        assert!(((exit.origin - exit.direction * along).length() - impact).abs() < 1e-12);
    }
}

/// A convex mirror's image: 1/a + 1/b = -2/R near the axis.
#[test]
fn bent_mirrors_focus_where_the_mirror_equation_says() {
    for (facing, sign) in [(-1.0, -1.0), (1.0, 1.0)] {
        for shape in [
            Sheet::Sphere { centre: facing * 300.0, rim: 40.0 },
            Sheet::Cylinder { centre: facing * 300.0, half_angle: 0.2, half_height: 40.0 },
        ] {
            let mirror = Shape::Sheet(shape);
            let source = Vec3::new(0.0, 0.0, 500.0);
            let height = 0.01;
            let direction = (Vec3::new(height, 0.0, 0.0) - source).normalized();
            let ray = Ray { origin: source, direction };
            let search = crate::geometry::Search { crossing: None, after: 0.0, standing_on: None };
            let hit = mirror.nearest(&ray, search).expect("hits the middle");
            let (t, normal) = mirror.cross(&ray, hit.face, hit.crossing);
            let d = crate::optics::interface::reflect(direction, normal);
            let p = ray.at(t);
            let image = p.z - p.x * d.z / d.x;
            let expected = 1.0 / (sign * 2.0 / 300.0 - 1.0 / 500.0);
            // Paraxial: the error is of the order of the squared height over the radius.
            assert!((image - expected).abs() < 1e-4 * expected.abs(), "{image} {expected}");
        }
    }
}

#[test]
fn a_bent_mirror_ends_at_its_arc_and_reflects_on_both_sides() {
    let mirror = Sheet::Cylinder { centre: -250.0, half_angle: 0.3, half_height: 50.0 };
    let hit = |x: f64, y: f64, from: f64| {
        let direction = Vec3::new(0.0, 0.0, -from.signum());
        let ray = Ray { origin: Vec3::new(x, y, from), direction };
        let search = crate::geometry::Search { crossing: None, after: 0.0, standing_on: None };
        mirror.nearest(&ray, search).map(|h| ray.at(h.t))
    };
    let edge = 250.0 * 0.3f64.sin();
    for from in [100.0, -100.0] {
        assert!(hit(0.0, 0.0, from).is_some_and(|p| p.z.abs() < 1e-12));
        assert!(hit(edge - 1e-6, 49.9, from).is_some());
        assert!(hit(edge + 1e-6, 0.0, from).is_none());
        assert!(hit(0.0, 50.1, from).is_none());
    }
}

/// Light that runs inside a hollow mirror meets it again and again.
#[test]
fn a_hollow_mirror_reflects_more_than_once() {
    let mirror = Shape::Sheet(Sheet::Sphere { centre: 100.0, rim: 99.0 });
    let mut ray = Ray { origin: Vec3::new(-95.0, 0.0, 99.0), direction: Vec3::new(0.0, 0.0, -1.0) };
    let mut standing = None;
    let mut count = 0;
    loop {
        let search =
            crate::geometry::Search { crossing: None, after: -1e-9, standing_on: standing };
        let Some(hit) = mirror.nearest(&ray, search) else { break };
        let (t, normal) = mirror.cross(&ray, hit.face, hit.crossing);
        assert!(((ray.at(t) - Vec3::new(0.0, 0.0, 100.0)).length() - 100.0).abs() < 1e-10);
        ray = Ray {
            origin: ray.at(t),
            direction: crate::optics::interface::reflect(ray.direction, normal),
        };
        standing = Some(hit.face);
        count += 1;
        assert!(count < 20);
    }
    // At impact parameter 95 of 100 the angle of incidence is 71.8 degrees, and each meeting lies 180 - 2 * 71.8 = 36.4
    // degrees on from the last: -71.8, -35.4, 1, 37.4, 73.8, and the next one beyond the rim at 81.9.
    assert_eq!(count, 5);
}

fn arbitrary_solid() -> impl Strategy<Value = Shape> {
    prop_oneof![
        (15.0..40.0).prop_map(sphere),
        (20.0..60.0, 20.0..60.0, 20.0..60.0).prop_map(|(x, y, z)| block(x, y, z)),
        (15.0..40.0, 30.0..80.0).prop_map(|(r, h)| cylinder(r, h)),
        (15.0..40.0, 0.0..40.0, 30.0..80.0).prop_map(|(r, top, h)| cone(r, top, h)),
        (15.0..40.0, 15.0..40.0, 15.0..40.0).prop_map(|(x, y, z)| Shape::Convex(
            crate::geometry::Convex::Ellipsoid { radii: Vec3::new(x, y, z) }
        )),
    ]
}

prop_compose! {
    pub(crate) fn arbitrary_setup()(
        shape in arbitrary_solid(),
        index in 1.2..1.9f64,
        position in prop::array::uniform3(-5.0..5.0f64),
        rotation in prop::array::uniform3(-180.0..180.0f64),
    ) -> Setup {
        let matter = Matter::Refractive { index, absorption: [0.0; 3] };
        setup(20.0, vec![element(shape, matter, position, rotation, 0)])
    }
}

proptest! {
    // Of so many more set-ups that are drawn, as many as are compared must form the point: half of all.
    #![proptest_config(ProptestConfig { max_global_rejects: 256, ..ProptestConfig::default() })]

    /// The line identity: with an ideal plate and the display at the image's mirror place, F(uv) is where the line of the
    /// ray that left the last element meets the image's plane.
    #[test]
    fn line_identity(setup in arbitrary_setup(), u in 0.0..1.0f64, v in 0.0..1.0f64) {
        let (st, path) = formed(&setup, [u, v]);
        prop_assume!(st.is_some());
        let st = st.unwrap();
        let exit = before_plate(&setup, [u, v], &path);
        let at = setup.image.coordinates(exit.at(setup.image.plane_distance(&exit)));
        // Rounding grows with the distance along a grazing exit: relative to st itself.
        let scale = 1.0 + st[0].abs() + st[1].abs();
        prop_assert!((st[0] - at[0]).hypot(st[1] - at[1]) < 1e-11 * scale * scale, "{st:?} {at:?}");
    }

    /// A solid is entered once and left once, and walked backwards the path arrives where it began.
    #[test]
    fn paths_are_reciprocal(setup in arbitrary_setup(), u in 0.0..1.0f64, v in 0.0..1.0f64) {
        let (st, path) = formed(&setup, [u, v]);
        prop_assume!(st.is_some());
        let forth: Vec<Ray> = path.iter().scan(setup.ray([u, v]), |ray, step| {
            *ray = setup.advance(ray, step);
            Some(*ray)
        }).collect();
        let last = forth.last().expect("a path has a plate");
        let mut ray = Ray { origin: last.at(10.0), direction: -last.direction };
        for step in path.iter().rev() {
            let crossing = match step.crossing {
                Crossing::Enter => Crossing::Leave,
                Crossing::Leave => Crossing::Enter,
            };
            let action = match step.action {
                Action::Refract { eta } => Action::Refract { eta: 1.0 / eta },
                other => other,
            };
            ray = setup.advance(&ray, &Step { crossing, action, ..*step });
        }
        let miss = setup.viewpoint - ray.origin;
        let across = miss - ray.direction * miss.dot(ray.direction);
        // Over a metre and two refractions, grazing ones magnified.
        prop_assert!(across.length() < 1e-6, "{across:?}");
    }

    /// Dual numbers against central differences.
    #[test]
    fn derivatives_are_right(setup in arbitrary_setup(), u in 0.05..0.95f64, v in 0.05..0.95f64) {
        let (st, mut path) = formed(&setup, [u, v]);
        prop_assume!(st.is_some());
        let st = st.unwrap();
        let (at, jacobian) = setup.follow_with_jacobian([u, v], &mut path);
        prop_assert!((at[0] - st[0]).hypot(at[1] - st[1]) < 1e-12 * (1.0 + st[0].abs() + st[1].abs()));
        let h = 1e-5;
        for axis in 0..2 {
            let mut step = [0.0; 2];
            step[axis] = h;
            let plus = setup.follow([u + step[0], v + step[1]], &mut path.clone());
            let minus = setup.follow([u - step[0], v - step[1]], &mut path.clone());
            for c in 0..2 {
                let difference = (plus[c] - minus[c]) / (2.0 * h);
                // Error of central differences: h^2 times the third derivative, which near the rim of a ball is
                // the derivative to the fifth power.
                let steepest = jacobian.as_flattened().iter().fold(0.0f64, |m, d| m.max(d.abs()));
                let allowed = 1e-5 * (1.0 + steepest.powi(5));
                // A step may lead past an edge.
                prop_assume!(difference.is_finite());
                prop_assert!((difference - jacobian[c][axis]).abs() < allowed, "{difference} {}", jacobian[c][axis]);
            }
        }
    }

    /// Water in its glass, the two touching: the same as Snell's law at each surface in turn with the gap left out,
    /// and the limit of a vanishing gap that is filled with glass.
    #[test]
    fn coinciding_surfaces_are_met_in_order(u in 0.0..1.0f64, v in 0.2..0.8f64, swap in any::<bool>()) {
        let water = Matter::Refractive { index: 1.333, absorption: [0.0; 3] };
        let glass = element(cylinder(30.0, 100.0), ACRYLIC, [0.0; 3], [0.0; 3], 0);
        let inner = |radius: f64| element(cylinder(radius, 90.0), water, [0.0, 5.0, 0.0], [0.0; 3], 1);
        let build = |radius: f64| {
            let mut elements = vec![glass.clone(), inner(radius)];
            if swap { elements.reverse(); }
            setup(40.0, elements)
        };
        // Touching from outside: a second solid that begins exactly where the first ends.
        let (touching, _) = formed(&build(30.0), [u, v]);
        let (gap, _) = formed(&build(30.0 - 1e-7), [u, v]);
        prop_assume!(touching.is_some() || gap.is_some());
        match (touching, gap) {
            (Some(a), Some(b)) => prop_assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-5, "{a:?} {b:?}"),
            (a, b) => prop_assert_eq!(a.is_some(), b.is_some()),
        }
    }

    /// Two blocks face to face are one block.
    #[test]
    fn a_block_cut_in_two_is_still_one(u in 0.0..1.0f64, v in 0.0..1.0f64, turn in -40.0..40.0f64) {
        let whole = setup(20.0, vec![element(block(40.0, 60.0, 50.0), ACRYLIC, [0.0; 3], [0.0, turn, 0.0], 0)]);
        let halves = {
            let frame = crate::geometry::Frame::new(Vec3::ZERO, [0.0, turn, 0.0]);
            let at = |z: f64| frame.to_world(Vec3::new(0.0, 0.0, z)).to_array();
            setup(20.0, vec![
                element(block(40.0, 60.0, 25.0), ACRYLIC, at(12.5), [0.0, turn, 0.0], 0),
                element(block(40.0, 60.0, 25.0), ACRYLIC, at(-12.5), [0.0, turn, 0.0], 1),
            ])
        };
        let (a, path_a) = formed(&whole, [u, v]);
        let (b, path_b) = formed(&halves, [u, v]);
        // Where a path leaves through the seam's own rim either answer is right.
        prop_assume!(path_a.len() + 2 == path_b.len());
        let (a, b) = (a.expect("three steps and the display"), b.expect("five steps and the display"));
        prop_assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9, "{:?} {:?}", a, b);
    }

    /// A height field sampled from a ball's cap bends light as the ball does.
    #[test]
    fn a_sampled_cap_is_a_ball(x in -6.0..6.0f64, y in -6.0..6.0f64, dx in -0.2..0.2f64, dy in -0.2..0.2f64) {
        let radius = 40.0;
        let n = 101;
        let place = |k: usize| (k as f64 / (n - 1) as f64 - 0.5) * 20.0;
        let heights: Vec<Vec<f64>> = (0..n)
            .map(|row| (0..n).map(|column| {
                let (x, y) = (place(column), -place(row));
                (radius * radius - x * x - y * y).sqrt() - radius
            }).collect())
            .collect();
        let field = HeightField::new(&heights, [20.0, 20.0], Some(30.0));
        let ball = crate::geometry::Convex::Sphere { radius };
        let direction = Vec3::new(dx, dy, -1.0).normalized();
        let ray = Ray { origin: Vec3::new(x, y, 10.0), direction };
        let lifted = Ray { origin: Vec3::new(x, y, 10.0 + radius), direction };
        let search = crate::geometry::Search { crossing: Some(Crossing::Enter), after: 0.0, standing_on: None };
        let hit = field.nearest(&ray, search);
        let truth = ball.nearest(&lifted, search);
        // x and y reach 6 and lean by 2 at most on their way: inside the cap, away from its rim.
        let (hit, truth) = (hit.expect("a cap"), truth.expect("a ball"));
        prop_assert!(hit.face == 0 && ray.at(hit.t).x.abs() < 9.0 && ray.at(hit.t).y.abs() < 9.0);
        let (_, normal) = field.cross(&ray, hit.face, hit.crossing);
        let (_, expected) = ball.cross(&lifted, truth.face, truth.crossing);
        // A cubic spline at 0.2 mm errs by 5/384 h^4 f'''' = 1e-9 mm here, its slope by about 1e-7; the natural
        // ends disturb the outermost samples, which are left out.
        prop_assert!((hit.t - truth.t).abs() < 1e-8, "{} {}", hit.t, truth.t);
        prop_assert!((normal - expected).length() < 1e-6);
    }
}

/// Where water and air touch light goes from one to the other at once: no glass comes between, in whichever order they are listed
/// and ranked, and whatever rounding says.
#[test]
fn media_that_touch_have_nothing_between() {
    let solid = |index: f64| Matter::Refractive { index, absorption: [0.0; 3] };
    let mut crossings = 0;
    for k in 0..4000 {
        let share = |factor: f64| (k as f64 * factor).fract();
        let (listed, ranked) = (k % 2 == 0, k / 2 % 2 == 0);
        let surface = 10.0 + 10.0 * share(0.819_172_5);
        let ranks = if ranked { [1, 2] } else { [2, 1] };
        let solid_of = |index, low: f64, high: f64, rank| {
            let middle = [0.0, 0.5 * (low + high), 0.0];
            element(cylinder(34.0, high - low), solid(index), middle, [0.0; 3], rank)
        };
        let mut elements = vec![
            element(cylinder(36.0, 100.0), solid(1.5), [0.0; 3], [0.0; 3], 0),
            solid_of(1.333, -40.0, surface, ranks[0]),
            solid_of(1.0, surface, 60.0, ranks[1]),
        ];
        if listed {
            elements.reverse();
        }
        let mut setup = setup(60.0, elements);
        setup.viewpoint.y = 200.0;
        let mut path = Path::new();
        setup.transport([share(0.754_877_7), share(0.569_840_3)], &mut path);
        let at_surface = |step: &Step| {
            let index = match setup.elements[usize::from(step.element)].matter {
                Matter::Refractive { index, .. } => index,
                Matter::Mirror { .. } | Matter::Opaque => 0.0,
            };
            // The water's upper end and the lower end of the air on it; their other ends touch nothing of the other.
            let face = if index > 1.3 { 4 } else { 3 };
            step.action != Action::Plate && index < 1.5 && step.face == face
        };
        for pair in path.windows(2) {
            if pair.iter().all(at_surface) && pair[0].element != pair[1].element {
                let bends = pair.iter().filter_map(|step| match step.action {
                    Action::Refract { eta } => Some(eta),
                    _ => None,
                });
                let bends: Vec<f64> = bends.collect();
                assert!(
                    bends.len() == 1 && (bends[0] * 1.333 - 1.0).abs() < 1e-12,
                    "air over water, once: {path:?}"
                );
                assert!(pair.iter().any(|step| step.action == Action::Pass), "{path:?}");
                crossings += 1;
            }
        }
    }
    assert!(crossings > 500, "{crossings}");
}

/// A finely tessellated ball, smooth normals: 0.5 degrees between vertices.
pub(crate) fn ball_mesh(radius: f64, smooth: bool) -> MeshSurface {
    ball_mesh_of(radius, smooth, 180, 360)
}

/// A ball of so many stacks from pole to pole and slices around.
pub(crate) fn ball_mesh_of(radius: f64, smooth: bool, stacks: usize, slices: usize) -> MeshSurface {
    let mut positions = vec![Vec3::new(0.0, radius, 0.0)];
    for i in 1..stacks {
        let polar = std::f64::consts::PI * i as f64 / stacks as f64;
        for j in 0..slices {
            let around = std::f64::consts::TAU * j as f64 / slices as f64;
            positions.push(Vec3::new(
                radius * polar.sin() * around.sin(),
                radius * polar.cos(),
                radius * polar.sin() * around.cos(),
            ));
        }
    }
    positions.push(Vec3::new(0.0, -radius, 0.0));
    let last = positions.len() as u32 - 1;
    let at = |i: usize, j: usize| (1 + (i - 1) * slices + j % slices) as u32;
    let mut triangles = Vec::new();
    for j in 0..slices {
        triangles.push([0, at(1, j), at(1, j + 1)]);
        triangles.push([last, at(stacks - 1, j + 1), at(stacks - 1, j)]);
        for i in 1..stacks - 1 {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let normal = |v: u32| positions[v as usize].normalized();
    let normals = smooth.then(|| triangles.iter().map(|t: &[u32; 3]| t.map(normal)).collect());
    MeshSurface::new(&TriangleMesh { positions, triangles, normals, ..TriangleMesh::default() })
}

#[test]
fn a_smooth_mesh_of_a_ball_is_the_ball_and_a_flat_one_is_not() {
    let ball = setup(20.0, vec![element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 0)]);
    let mesh = |smooth| {
        let shape = Shape::Mesh(Arc::new(ball_mesh(25.0, smooth)));
        setup(20.0, vec![element(shape, ACRYLIC, [0.0; 3], [10.0, 20.0, 30.0], 0)])
    };
    let worst = |other: &Setup| {
        let mut worst = 0.0f64;
        for k in 0..2000 {
            let uv = [(k as f64 * 0.754_877_666).fract(), (k as f64 * 0.569_840_291).fract()];
            let (a, b) = (formed(&ball, uv).0, formed(other, uv).0);
            let (a, b) = (a.expect("reaches"), b.expect("no ray slips through a mesh"));
            worst = worst.max((a[0] - b[0]).hypot(a[1] - b[1]));
        }
        worst
    };
    // Positions lie up to R (1 - cos(0.25 deg * 1.4)) = 0.5 um inside the ball: of the order of 1e-5 of the image.
    assert!(worst(&mesh(true)) < 1e-4);
    // Flat facets turn light by up to (n - 1) * 0.35 degrees, over 150 mm: percents of the image.
    assert!(worst(&mesh(false)) > 1e-3);
}

#[test]
fn no_ray_slips_between_triangles() {
    let mesh = ball_mesh(25.0, false);
    // Aimed exactly at vertices and at the middles of edges.
    for k in 0..5000 {
        let i = 1 + k % 179;
        let j = (k * 7) % 360;
        let polar = std::f64::consts::PI * i as f64 / 180.0;
        let around = std::f64::consts::TAU * (j as f64 + 0.5 * (k % 2) as f64) / 360.0;
        let target =
            Vec3::new(polar.sin() * around.sin(), polar.cos(), polar.sin() * around.cos()) * 24.0;
        let origin = target.normalized() * 500.0 + Vec3::new(20.0, -30.0, 10.0);
        let ray = Ray { origin, direction: (target - origin).normalized() };
        let enter = crate::geometry::Search {
            crossing: Some(Crossing::Enter),
            after: 0.0,
            standing_on: None,
        };
        let hit = mesh.nearest(&ray, enter).expect("the target lies inside");
        let inside = Ray { origin: ray.at(hit.t), direction: ray.direction };
        let leave = crate::geometry::Search {
            crossing: Some(Crossing::Leave),
            after: 0.0,
            standing_on: Some(hit.face),
        };
        assert!(mesh.nearest(&inside, leave).is_some(), "what goes in comes out");
    }
}

#[test]
fn ends_are_explained() {
    let block = |turn| {
        setup(60.0, vec![element(block(50.0, 50.0, 50.0), ACRYLIC, [0.0; 3], [0.0, turn, 0.0], 0)])
    };
    let mut path = Path::new();
    // Through a cube's edge region at 45 degrees: light that enters one face meets the next one at more than the critical
    // angle of 42.2 degrees.
    let end = block(45.0).transport([0.95, 0.5], &mut path);
    assert_eq!(end, End::TotalReflection { element: 0 });
    let mut followed = block(45.0);
    followed.follow_total_reflection = true;
    followed.transport([0.95, 0.5], &mut path);
    assert!(path.iter().any(|s| s.action == Action::Reflect));

    let mut away = setup(
        20.0,
        vec![element(
            Shape::Sheet(Sheet::Plane { half: [50.0; 2] }),
            MIRROR,
            [0.0; 3],
            [0.0; 3],
            0,
        )],
    );
    assert_eq!(away.transport([0.5, 0.5], &mut path), End::MissedPlate);
    away.elements.clear();
    away.plate.rectangle.size = [10.0, 10.0];
    let end = away.transport([0.99, 0.5], &mut path);
    assert!(matches!(end, End::Display { through_plate: false, .. }) && end.formed().is_none());
    away.max_interactions = 0;
    assert_eq!(away.transport([0.5, 0.5], &mut path), End::TooManyInteractions);
}
