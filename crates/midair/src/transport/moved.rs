//! F along a known path through parts that may stand elsewhere, with derivatives by whatever moves them.
//!
//! Shapes stay plain numbers. A part's place, its turn and its size are an affine map between the world and its own coordinates, over any
//! [`Real`]: a line stays a line under it, and normals go by its inverse transposed.
//!
//! ```
//! use midair::Setup;
//! use midair::geometry::{Dual, Real};
//! use midair::transport::Path;
//!
//! # fn main() -> Result<(), midair::Error> {
//! let setup = Setup::new(&midair::scene::load("../../scenes/ball.toml".as_ref())?)?;
//! let mut path = Path::new();
//! let end = setup.transport([0.3, 0.6], &mut path);
//! // How does the display point go with the ball's index?
//! let mut parts = setup.moved::<Dual<1>>();
//! parts.elements[0].index = Dual::variable(1.49, 0);
//! let ray = setup.ray([0.3, 0.6].map(Dual::constant));
//! let [s, t] = setup.follow_moved(ray, &mut path, &parts);
//! assert!((s.re - end.st().unwrap()[0]).abs() < 1e-12 && s.d[0] != 0.0 && t.d[0] != 0.0);
//! # Ok(())
//! # }
//! ```

use super::path::{Action, Step};
use super::setup::{Element, Matter, Setup};
use crate::geometry::{Frame, Ray, Real, Vec3};
use crate::optics::interface::{reflect, refract};
use crate::optics::plate::pass_ideal;

/// A place and an orthonormal orientation over any number.
#[derive(Clone, Copy, Debug)]
pub struct Placing<T> {
    /// Where the origin is, mm.
    pub origin: Vec3<T>,
    /// The x, y and z axes in the world, unit length.
    pub axes: [Vec3<T>; 3],
}

impl<T: Real> Placing<T> {
    /// A frame that does not move.
    pub fn constant(frame: &Frame) -> Self {
        Self { origin: Vec3::constant(frame.origin), axes: frame.axes.map(Vec3::constant) }
    }

    fn local_direction(&self, d: Vec3<T>) -> Vec3<T> {
        let [x, y, z] = self.axes;
        Vec3::new(d.dot(x), d.dot(y), d.dot(z))
    }

    fn world_direction(&self, d: Vec3<T>) -> Vec3<T> {
        let [x, y, z] = self.axes;
        x.scaled(d.x) + y.scaled(d.y) + z.scaled(d.z)
    }

    /// Distance along a ray to the plane z = 0.
    fn plane_distance(&self, ray: &Ray<T>) -> T {
        let n = self.axes[2];
        (self.origin - ray.origin).dot(n) / ray.direction.dot(n)
    }
}

/// An element that may stand elsewhere, be of another size, or have another index.
#[derive(Clone, Copy, Debug)]
pub struct MovedElement<T> {
    /// Where it stands.
    pub frame: Placing<T>,
    /// How many times as large it is as its shape says, along its own axes.
    pub stretch: Vec3<T>,
    /// A refractive solid's index.
    pub index: T,
}

/// All that may be moved of a set-up.
#[derive(Clone, Debug)]
pub struct Moved<T> {
    /// The elements, as the set-up has them.
    pub elements: Vec<MovedElement<T>>,
    /// The plate.
    pub plate: Placing<T>,
    /// The display.
    pub display: Placing<T>,
}

impl<T: Real> MovedElement<T> {
    /// Where a ray crosses a step's surface, and the unit normal there in the world, on the side that the ray comes from; `None` where a
    /// smooth mesh ends.
    fn facet(&self, element: &Element, ray: &Ray<T>, step: &mut Step) -> Option<(T, Vec3<T>)> {
        let stretch = self.stretch;
        let shrunk = |v: Vec3<T>| Vec3::new(v.x / stretch.x, v.y / stretch.y, v.z / stretch.z);
        let origin = shrunk(self.frame.local_direction(ray.origin - self.frame.origin));
        let direction = shrunk(self.frame.local_direction(ray.direction));
        let length = direction.length();
        let local = Ray { origin, direction: direction.scaled(length.recip()) };
        if step.seamless {
            let mesh = element.shape.bent_mesh()?;
            step.face = mesh.settle(&local.value(), step.face, step.crossing)?;
        }
        let (t, normal) = element.shape.cross(&local, step.face, step.crossing);
        let normal = self.frame.world_direction(shrunk(normal)).normalized();
        let faces_away = ray.direction.dot(normal).value() > 0.0;
        Some((t / length, if faces_away { -normal } else { normal }))
    }
}

impl Setup {
    /// All parts as they stand: a beginning for those that move.
    pub fn moved<T: Real>(&self) -> Moved<T> {
        let one = T::constant(1.0);
        let element = |element: &Element| MovedElement {
            frame: Placing::constant(&element.frame),
            stretch: Vec3::new(one, one, one),
            index: match element.matter {
                Matter::Refractive { index, .. } => T::constant(index),
                Matter::Mirror { .. } | Matter::Opaque => one,
            },
        };
        Moved {
            elements: self.elements.iter().map(element).collect(),
            plate: Placing::constant(&self.plate.rectangle.frame),
            display: Placing::constant(&self.display.frame),
        }
    }

    /// [`follow`](Self::follow) of any ray that sets out in the open air, through parts that may have moved: st, NaN where it ceases to exist.
    ///
    /// The parts are the set-up's own, in number and kind. A refraction's indices are theirs, not those that the path was found with.
    pub fn follow_moved<T: Real>(
        &self,
        mut ray: Ray<T>,
        path: &mut [Step],
        parts: &Moved<T>,
    ) -> [T; 2] {
        let mut inside = 0u64;
        for step in path {
            if step.action == Action::Plate {
                ray = self.pass_moved_plate(&ray, &parts.plate);
                continue;
            }
            let index = usize::from(step.element);
            let element = &self.elements[index];
            let Some((t, normal)) = parts.elements[index].facet(element, &ray, step) else {
                return [T::constant(f64::NAN); 2];
            };
            let behind = match element.matter {
                Matter::Refractive { .. } => inside ^ 1 << element.rank,
                Matter::Mirror { .. } | Matter::Opaque => inside,
            };
            let direction = match step.action {
                Action::Reflect => reflect(ray.direction, normal),
                Action::Refract { .. } => {
                    let eta = self.moved_index(inside, parts) / self.moved_index(behind, parts);
                    refract(ray.direction, normal, eta)
                }
                Action::Pass | Action::Stop | Action::Plate => ray.direction,
            };
            if matches!(step.action, Action::Refract { .. } | Action::Pass) {
                inside = behind;
            }
            ray = Ray { origin: ray.at(t), direction };
        }
        let display = &parts.display;
        let at = ray.at(display.plane_distance(&ray)) - display.origin;
        let [x, y, _] = display.axes;
        let [width, height] = self.display.size;
        [at.dot(x) * width.recip() + 0.5, at.dot(y) * height.recip() + 0.5]
    }

    /// Refractive index inside these solids.
    fn moved_index<T: Real>(&self, inside: u64, parts: &Moved<T>) -> T {
        let medium = self.medium(inside).map(|medium| medium.rank);
        let place = medium.and_then(|rank| {
            self.elements
                .iter()
                .position(|e| e.rank == rank && matches!(e.matter, Matter::Refractive { .. }))
        });
        place.map_or_else(|| T::constant(1.0), |place| parts.elements[place].index)
    }

    fn pass_moved_plate<T: Real>(&self, ray: &Ray<T>, frame: &Placing<T>) -> Ray<T> {
        let mut origin = ray.at(frame.plane_distance(ray));
        if let Some(layers) = self.plate.layers() {
            let [x, y] = layers.shift(frame.local_direction(ray.direction));
            let [right, up, _] = frame.axes;
            origin = origin + right.scaled(x) + up.scaled(y);
        }
        Ray { origin, direction: pass_ideal(ray.direction, frame.axes[2]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Dual;
    use crate::scene::{Format, Loaded, load, model};
    use crate::transport::Path;

    /// Three variables: where the element stands along x, its turn about its own y, and its size.
    type Three = Dual<3>;

    fn variable(re: f64, axis: usize) -> Three {
        Dual::variable(re, axis)
    }

    fn formed(setup: &Setup, uv: [f64; 2]) -> ([f64; 2], Path) {
        let mut path = Path::new();
        (setup.transport(uv, &mut path).st().expect("this image point is formed"), path)
    }

    /// Against another way: scenes in which the part was moved and the search done anew.
    #[test]
    fn derivatives_are_those_of_scenes_that_are_built_anew() {
        let mut looked_at = 0;
        for name in ["ball", "paper/cube", "glass-of-water", "paper/bent-mirror-convex"] {
            let path = format!("../../scenes/{name}.toml");
            let loaded = load(path.as_ref()).expect("an example scene");
            for uv in [[0.3, 0.6], [0.55, 0.4], [0.7, 0.75]] {
                for plate in ["ideal", "slit-mirror"] {
                    let mut loaded = loaded.clone();
                    if plate == "slit-mirror" {
                        loaded.scene.plate.model =
                            model::PlateModel::SlitMirror(model::SlitMirror::default());
                    }
                    compare(&loaded, uv);
                    looked_at += 1;
                }
            }
        }
        assert_eq!(looked_at, 24);
    }

    fn compare(loaded: &Loaded, uv: [f64; 2]) {
        // The display would follow the elements where the scene leaves its place out.
        let setup = Setup::new(loaded).expect("the scene can be traced");
        let (st, mut path) = formed(&setup, uv);
        let mut parts = setup.moved::<Three>();
        let [x, y, z] = setup.elements[0].frame.axes;
        let lift = |a: Vec3, slope: Vec3| {
            let part = |re, slope| Dual { re, d: [0.0, slope, 0.0] };
            Vec3::new(part(a.x, slope.x), part(a.y, slope.y), part(a.z, slope.z))
        };
        // A turn about the own y: x goes towards -z, z towards x.
        parts.elements[0].frame.axes = [lift(x, -z), lift(y, Vec3::ZERO), lift(z, x)];
        parts.elements[0].frame.origin.x = variable(setup.elements[0].frame.origin.x, 0);
        if let Matter::Refractive { index, .. } = setup.elements[0].matter {
            parts.elements[0].index = variable(index, 2);
        }
        let ray = setup.ray(uv.map(Dual::constant));
        let followed = setup.follow_moved(ray, &mut path, &parts);
        for c in 0..2 {
            assert!((followed[c].re - st[c]).abs() < 1e-11, "{followed:?} {st:?}");
        }
        let step = 1e-4;
        for axis in 0..3 {
            let moved = |sign: f64| {
                let mut setup = setup.clone();
                let by = sign * step;
                let (sin, cos) = by.sin_cos();
                let element = &mut setup.elements[0];
                match axis {
                    0 => element.frame.origin.x += by,
                    1 => {
                        element.frame.axes = [x * cos - z * sin, y, z * cos + x * sin];
                    }
                    _ => {
                        if let Matter::Refractive { index, .. } = &mut element.matter {
                            *index += by;
                        }
                    }
                }
                formed(&setup, uv)
            };
            let ((plus, a), (minus, b)) = (moved(1.0), moved(-1.0));
            assert_eq!(a.len(), b.len());
            for c in 0..2 {
                let difference = (plus[c] - minus[c]) / (2.0 * step);
                let found = followed[c].d[axis];
                // Central differences: the square of the step times the third derivative, and rounding over the step.
                let allowed = 1e-6 * (1.0 + found.abs());
                assert!(
                    (difference - found).abs() < allowed,
                    "{uv:?} {axis}: {difference} {found}"
                );
            }
        }
    }

    /// Against a closed form: a ball twice as large is the ball of twice the radius.
    #[test]
    fn a_stretched_ball_is_a_larger_ball() {
        let scene = |radius: f64| {
            let text = include_str!("../../../../scenes/ball.toml")
                .replace("radius = 25.0", &format!("radius = {radius:?}"));
            let scene = crate::scene::parse(&text, "ball.toml", Format::Toml).expect("a scene");
            let mut loaded = load("../../scenes/ball.toml".as_ref()).expect("an example scene");
            loaded.scene = scene;
            Setup::new(&loaded).expect("it can be traced")
        };
        let (small, large) = (scene(20.0), scene(25.0));
        let (st, mut path) = formed(&large, [0.4, 0.55]);
        let mut parts = small.moved::<Dual<1>>();
        let by = Dual::variable(1.25, 0);
        parts.elements[0].stretch = Vec3::new(by, by, by);
        let ray = small.ray([0.4, 0.55].map(Dual::constant));
        let found = small.follow_moved(ray, &mut path, &parts);
        let step = 1e-3;
        let (plus, minus) = (scene(25.0 + step), scene(25.0 - step));
        for c in 0..2 {
            assert!((found[c].re - st[c]).abs() < 1e-12, "{found:?} {st:?}");
            // By the factor, whose unit is 20 mm of radius.
            let at = |setup: &Setup| formed(setup, [0.4, 0.55]).0[c];
            let difference = 20.0 * (at(&plus) - at(&minus)) / (2.0 * step);
            assert!((found[c].d[0] - difference).abs() < 1e-5, "{found:?} {difference}");
        }
    }
}
