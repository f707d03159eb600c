//! What the rows work on.

use super::Outcome;
use midair::geometry::mesh::TriangleMesh;
use midair::geometry::{MeshSurface, Shape, Vec3};
use midair::picture::Picture;
use midair::scene;
use midair::transport::Setup;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The workspace's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A set-up of `scenes/`.
pub fn scene(name: &str) -> Outcome<Setup> {
    Ok(Setup::new(&scene::load(&root().join("scenes").join(name))?)?)
}

/// The paper's bunny set-up with a mesh file in place of the one that it names.
pub fn bunny_scene(mesh: &Path) -> Outcome<Setup> {
    let text = std::fs::read_to_string(root().join("scenes/paper/bunny.toml"))?;
    let mesh = mesh.canonicalize()?;
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("bunny.toml");
    std::fs::write(&file, text.replace("../meshes/bunny.ply", &mesh.to_string_lossy()))?;
    Ok(Setup::new(&scene::load(&file)?)?)
}

/// Squares along each edge of the cube that [`ball`] is blown up from: 12 n^2 triangles.
const SQUARES: i32 = 77;
/// Triangles of [`ball`].
pub const BALL_TRIANGLES: usize = (12 * SQUARES * SQUARES) as usize;

/// The paper's sphere as a mesh with smooth normals.
pub fn ball() -> Outcome<Setup> {
    let mut setup = scene("paper/sphere.toml")?;
    let (positions, triangles) = tessellate(25.0);
    let normal = |v: u32| positions[v as usize].normalized();
    let normals = Some(triangles.iter().map(|t| t.map(normal)).collect());
    let mesh = TriangleMesh { positions, triangles, normals, ..TriangleMesh::default() };
    let mesh = MeshSurface::new(&mesh);
    setup.elements[0].shape = Shape::Mesh(Arc::new(mesh));
    Ok(setup)
}

/// A sphere from a cube whose squares are spread evenly by angle.
fn tessellate(radius: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut known: HashMap<[i32; 3], u32> = HashMap::new();
    let mut positions = Vec::new();
    let mut vertex = |at: [i32; 3]| {
        *known.entry(at).or_insert_with(|| {
            let spread = |k: i32| {
                let share = 2.0 * f64::from(k) / f64::from(SQUARES) - 1.0;
                (share * std::f64::consts::FRAC_PI_4).tan()
            };
            let p = Vec3::new(spread(at[0]), spread(at[1]), spread(at[2]));
            positions.push(p.normalized() * radius);
            positions.len() as u32 - 1
        })
    };
    let mut triangles = Vec::with_capacity(BALL_TRIANGLES);
    for axis in 0..3 {
        for level in [0, SQUARES] {
            for i in 0..SQUARES {
                for j in 0..SQUARES {
                    let mut corner = |di: i32, dj: i32| {
                        let mut at = [0; 3];
                        (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) =
                            (level, i + di, j + dj);
                        vertex(at)
                    };
                    let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    // Counter-clockwise seen from outside: the lower side looks the other way.
                    triangles.extend(if level == 0 {
                        [[a, c, b], [a, d, c]]
                    } else {
                        [[a, b, c], [a, c, d]]
                    });
                }
            }
        }
    }
    (positions, triangles)
}

/// A picture with edges, gradients and fine texture, the same each time.
pub fn picture(size: usize) -> Picture {
    let mut random = fastrand::Rng::with_seed(7);
    let pixels = (0..size * size)
        .map(|index| {
            let (x, y) = ((index % size) as f32 / size as f32, (index / size) as f32 / size as f32);
            let rings = 0.5 + 0.5 * (400.0 * (x * x + y * y)).sin();
            let checks = if ((8.0 * x) as i32 + (8.0 * y) as i32) % 2 == 0 { 0.2 } else { 0.7 };
            let noise = 0.05 * random.f32();
            [0.7 * rings + noise, checks + noise, 0.5 * x + 0.4 * y + noise, 1.0]
        })
        .collect();
    Picture { width: size, height: size, pixels }
}
