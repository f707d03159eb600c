//! Through meshes: media that touch, a ball of triangles, no ray between two of them.

use super::*;

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
