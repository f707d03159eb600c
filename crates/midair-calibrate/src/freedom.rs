//! What may be other than assumed: each number that the fit may change, and how sure one was of it.

use crate::bench::Uncertainty;
use midair::Error;
use midair::scene::model::{Element, Index, Material, Scene, Shape};

/// A number that the fit may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    /// A camera's place along a world axis, mm.
    CameraShift {
        /// Which view.
        view: usize,
        /// Which axis.
        axis: usize,
    },
    /// A camera's turn about an axis of its own, degrees.
    CameraTurn {
        /// Which view.
        view: usize,
        /// Which axis: right, down, ahead.
        axis: usize,
    },
    /// A number of the lens.
    Lens {
        /// Which, as in [`LENS_NUMBERS`](crate::camera::LENS_NUMBERS).
        number: usize,
    },
    /// A body's place along a world axis, mm.
    Shift {
        /// Which body.
        body: usize,
        /// Which axis.
        axis: usize,
    },
    /// A body's turn about an axis of its own, degrees.
    Turn {
        /// Which body.
        body: usize,
        /// Which axis.
        axis: usize,
    },
    /// A refractive index.
    Ior {
        /// Of which element.
        element: usize,
    },
    /// A length of a shape, mm, or a mesh's scale.
    Size {
        /// Of which element.
        element: usize,
        /// Which of [`sizes`].
        size: usize,
    },
    /// The plate's place along a world axis, mm.
    PlateShift {
        /// Which axis.
        axis: usize,
    },
    /// The plate's turn about an axis of its own, degrees.
    PlateTurn {
        /// Which axis.
        axis: usize,
    },
}

impl Freedom {
    /// Whether it is of the camera of a view.
    pub fn is_of_view(self, which: usize) -> bool {
        match self {
            Self::CameraShift { view, .. } | Self::CameraTurn { view, .. } => view == which,
            _ => false,
        }
    }
}

/// A number that the fit may change, with what was known of it: one standard deviation, `None` where nothing was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Free {
    /// Which number.
    pub what: Freedom,
    /// One standard deviation before the photographs.
    pub prior: Option<f64>,
}

/// A length of a shape that can be fitted: its key, its value, and which of the shape's own axes it stretches.
#[derive(Clone, Debug, PartialEq)]
pub struct Size {
    /// Its key under `shape`.
    pub key: &'static str,
    /// Which number of the key's list.
    pub item: Option<usize>,
    /// Its value, mm; a factor for a mesh.
    pub value: f64,
    /// The axes that grow with it.
    pub axes: [bool; 3],
}

/// The lengths of a shape that can be fitted: those that are a stretch along its own axes.
pub fn sizes(element: &Element) -> Vec<Size> {
    let size = |key, item, value, axes| Size { key, item, value, axes };
    let [all, round, along] = [[true; 3], [true, false, true], [false, true, false]];
    let each = |key, values: &[f64; 3]| -> Vec<Size> {
        (0..3).map(|i| size(key, Some(i), values[i], std::array::from_fn(|k| k == i))).collect()
    };
    // A wall keeps its thickness whatever the size: no stretch.
    if element.hollow.is_some() {
        return Vec::new();
    }
    match &element.shape {
        Shape::Sphere { radius } | Shape::Hemisphere { radius } => {
            vec![size("radius", None, *radius, all)]
        }
        Shape::Ellipsoid { radii } => each("radii", radii),
        Shape::Box { size } => each("size", size),
        Shape::Cylinder { radius, height } => {
            vec![size("radius", None, *radius, round), size("height", None, *height, along)]
        }
        Shape::CylinderMirror { radius, .. } => vec![size("radius", None, *radius, round)],
        Shape::SphereMirror { radius, .. } => vec![size("radius", None, *radius, all)],
        Shape::Mesh { scale, .. } => vec![size("scale", None, *scale, all)],
        _ => Vec::new(),
    }
}

/// Elements that move as one: their places in the scene. The first one's frame is the body's.
pub type Body = Vec<usize>;

/// The bodies of a scene: those that are told to be together, and every other element by itself.
///
/// # Errors
/// A name that no element has, or one that is named twice.
pub fn bodies(scene: &Scene, together: &[Vec<String>]) -> Result<Vec<Body>, Error> {
    let mut bodies: Vec<Body> = Vec::new();
    for names in together {
        let mut body = Body::new();
        for name in names {
            let place = scene.elements.iter().position(|e| &e.name == name).ok_or_else(|| {
                let known: Vec<_> = scene.elements.iter().map(|e| e.name.as_str()).collect();
                Error::request(
                    format!("[[together]] names `{name}`, which no element of the scene is called"),
                    format!("the scene has {}", known.join(", ")),
                )
            })?;
            if body.contains(&place) || bodies.iter().any(|other| other.contains(&place)) {
                return Err(Error::request(
                    format!("[[together]] names `{name}` twice"),
                    "name each element once",
                ));
            }
            body.push(place);
        }
        bodies.push(body);
    }
    for place in 0..scene.elements.len() {
        if !bodies.iter().any(|body| body.contains(&place)) {
            bodies.push(vec![place]);
        }
    }
    Ok(bodies)
}

/// The own axes about which a turn changes nothing that light could tell.
fn symmetric(element: &Element) -> [bool; 3] {
    match element.shape {
        Shape::Sphere { .. } => [true; 3],
        Shape::Cylinder { .. }
        | Shape::Cone { .. }
        | Shape::Hemisphere { .. }
        | Shape::Torus { .. }
        | Shape::Lathe { .. } => [false, true, false],
        Shape::Lens { .. } | Shape::SphereMirror { .. } => [false, false, true],
        _ => [false; 3],
    }
}

/// Whether all elements of a body are turned alike and stand on the one axis of their symmetry.
fn coaxial(scene: &Scene, body: &Body, axis: usize) -> bool {
    let first = scene.elements[body[0]].pose.frame();
    body.iter().all(|&place| {
        let frame = scene.elements[place].pose.frame();
        let off = first.to_local(frame.origin).to_array();
        let turned = (frame.axes[axis] - first.axes[axis]).length();
        turned < 1e-9 && (0..3).all(|k| k == axis || off[k].abs() < 1e-9)
    })
}

/// Names by which parameters are freed and fixed.
const GROUPS: &str = "NAME, NAME.position, NAME.rotation, NAME.ior, NAME.shape, NAME.shape.radius and the like, plate";

/// The numbers of the scene that the fit changes: by default each body's pose less its symmetries and each index that is a number; with `free` more
/// of them, without those of `fix`.
///
/// # Errors
/// A name of `free` or `fix` that means nothing in this scene.
pub fn freedoms(
    scene: &Scene,
    bodies: &[Body],
    uncertainty: &Uncertainty,
    free: &[String],
    fix: &[String],
) -> Result<Vec<Free>, Error> {
    let mut all: Vec<(Free, bool)> = Vec::new();
    let mut add = |what, prior, by_default| {
        all.push((Free { what, prior: Some(prior) }, by_default));
    };
    for (body, places) in bodies.iter().enumerate() {
        let opaque = places.iter().all(|&e| matches!(scene.elements[e].material, Material::Opaque));
        // What stops light shows only by its shadow: points that are not seen tell nothing here.
        let moves = !opaque;
        (0..3).for_each(|axis| add(Freedom::Shift { body, axis }, uncertainty.position, moves));
        for axis in 0..3 {
            let round = places.iter().all(|&e| symmetric(&scene.elements[e])[axis]);
            if !(round && coaxial(scene, places, axis)) {
                add(Freedom::Turn { body, axis }, uncertainty.rotation, moves);
            }
        }
    }
    for (element, described) in scene.elements.iter().enumerate() {
        let Material::Refractive { index, .. } = &described.material else { continue };
        // Air in a solid is air.
        if let Index::Constant(n) = index
            && *n != 1.0
        {
            add(Freedom::Ior { element }, uncertainty.ior, true);
        }
    }
    for (element, described) in scene.elements.iter().enumerate() {
        for (size, length) in sizes(described).iter().enumerate() {
            let prior = match length.key {
                // A mesh's scale has no unit: as much as the same length is of 100 mm.
                "scale" => uncertainty.size / 100.0 * length.value,
                _ => uncertainty.size,
            };
            add(Freedom::Size { element, size }, prior, false);
        }
    }
    for axis in 0..3 {
        add(Freedom::PlateShift { axis }, uncertainty.position, false);
        add(Freedom::PlateTurn { axis }, uncertainty.rotation, false);
    }
    for name in free.iter().chain(fix) {
        if !all.iter().any(|(free, _)| matches(name, free.what, scene, bodies)) {
            let named = scene.elements.iter().map(|e| e.name.as_str());
            let known: Vec<_> = named.chain(["plate"]).collect();
            return Err(Error::request(
                format!("`{name}` names nothing that can be fitted in this scene"),
                format!("names are {GROUPS}, with NAME one of {}", known.join(", ")),
            ));
        }
    }
    let named = |names: &[String], what| names.iter().any(|n| matches(n, what, scene, bodies));
    let chosen = all.into_iter().filter(|(candidate, by_default)| {
        (*by_default || named(free, candidate.what)) && !named(fix, candidate.what)
    });
    Ok(chosen.map(|(candidate, _)| candidate).collect())
}

/// Whether a name from the command line means this number.
fn matches(name: &str, what: Freedom, scene: &Scene, bodies: &[Body]) -> bool {
    let name = name.strip_prefix("element.").unwrap_or(name);
    let of_element = |element: usize, part: &str| {
        let own = &scene.elements[element].name;
        match name.strip_prefix(own.as_str()) {
            Some("") => true,
            Some(rest) => rest.strip_prefix('.').is_some_and(|rest| {
                part == rest || part.strip_prefix(rest).is_some_and(|tail| tail.starts_with('.'))
            }),
            None => false,
        }
    };
    match what {
        Freedom::Shift { body, axis } => {
            bodies[body].iter().any(|&e| of_element(e, &format!("position.{}", AXES[axis])))
        }
        Freedom::Turn { body, axis } => {
            bodies[body].iter().any(|&e| of_element(e, &format!("rotation.{}", AXES[axis])))
        }
        Freedom::Ior { element } => of_element(element, "ior"),
        Freedom::Size { element, size } => {
            sizes(&scene.elements[element]).get(size).is_some_and(|length| {
                let item = length.item.map(|item| format!(".{}", AXES[item])).unwrap_or_default();
                of_element(element, &format!("shape.{}{item}", length.key))
            })
        }
        Freedom::PlateShift { .. } => ["plate", "plate.position"].contains(&name),
        Freedom::PlateTurn { .. } => ["plate", "plate.rotation"].contains(&name),
        Freedom::CameraShift { .. } | Freedom::CameraTurn { .. } | Freedom::Lens { .. } => false,
    }
}

/// Names of axes.
pub const AXES: [&str; 3] = ["x", "y", "z"];

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(name: &str) -> Scene {
        let path = format!("../../scenes/{name}.toml");
        midair::scene::load(path.as_ref()).expect("an example scene").scene
    }

    fn count(name: &str, together: &[&[&str]], free: &[&str], fix: &[&str]) -> usize {
        let scene = scene(name);
        let owned = |names: &[&str]| names.iter().map(ToString::to_string).collect::<Vec<_>>();
        let together: Vec<Vec<String>> = together.iter().map(|names| owned(names)).collect();
        let bodies = bodies(&scene, &together).expect("known names");
        let usual = Uncertainty::default();
        freedoms(&scene, &bodies, &usual, &owned(free), &owned(fix)).expect("known names").len()
    }

    #[test]
    fn a_pose_less_its_symmetries_and_the_index_are_free() {
        // A ball's place; a cube's pose; each with an index.
        assert_eq!(count("ball", &[], &[], &[]), 4);
        assert_eq!(count("paper/cube", &[], &[], &[]), 7);
        assert_eq!(count("paper/cylinder", &[], &[], &[]), 6);
        assert_eq!(count("paper/bent-mirror-convex", &[], &[], &[]), 6);
        // A glass of water is one thing, round about its axis; its indices are the catalogue's.
        let glass: &[&[&str]] = &[&["glass", "water", "air above the water"]];
        assert_eq!(count("glass-of-water", glass, &[], &[]), 5);
        assert_eq!(count("glass-of-water", &[], &[], &[]), 15);
    }

    #[test]
    fn numbers_are_freed_and_fixed_by_name() {
        assert_eq!(count("paper/cube", &[], &["cube.shape"], &[]), 10);
        assert_eq!(count("paper/cube", &[], &["element.cube.shape.size.x"], &["cube.ior"]), 7);
        assert_eq!(count("paper/cube", &[], &["plate"], &["cube.position", "cube.rotation.y"]), 9);
        assert_eq!(count("paper/bent-mirror-convex", &[], &["bent mirror.shape.radius"], &[]), 7);
        let scene = scene("ball");
        let bodies = bodies(&scene, &[]).expect("no names");
        let error =
            freedoms(&scene, &bodies, &Uncertainty::default(), &["bal.ior".to_owned()], &[])
                .expect_err("no element is called so");
        assert!(error.to_string().contains("bal.ior"), "{error}");
        assert!(error.remedy().is_some_and(|remedy| remedy.contains("ball")), "{error:?}");
        assert!(super::bodies(&scene, &[vec!["cube".to_owned()]]).is_err());
    }
}
