//! A guess of the whole bench: the scene, the cameras and the lens; how it changes, and how it goes with each number.

use crate::camera::Lens;
use crate::freedom::{Body, Free, Freedom, sizes};
use midair::geometry::{Dual, Frame, Real, Vec3};
use midair::scene::model::{self, Index, Material, Scene, Shape};
use midair::scene::{Asset, Loaded};
use midair::transport::{Moved, Placing, Setup, SetupError};
use nalgebra::DVector;

/// A guess of the whole bench.
#[derive(Clone, Debug)]
pub struct State {
    /// The scene, with its files.
    pub loaded: Loaded,
    /// Each view's camera: its axes are right, down and ahead.
    pub cameras: Vec<Frame>,
    /// The lens.
    pub lens: Lens,
    /// How far each free number is from where it was assumed.
    pub offset: DVector<f64>,
}

/// How far a rotation by degrees about an axis turns a direction, to first order.
const RADIANS: f64 = std::f64::consts::PI / 180.0;

/// A direction turned about a unit axis by an angle in radians (Rodrigues).
fn turned(v: Vec3, axis: Vec3, angle: f64) -> Vec3 {
    let (sin, cos) = angle.sin_cos();
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}

/// Axes turned by degrees about each of three axes: one rotation about their sum.
fn turned_axes(axes: [Vec3; 3], about: [Vec3; 3], degrees: [f64; 3]) -> ([Vec3; 3], Vec3, f64) {
    let sum = about[0] * degrees[0] + about[1] * degrees[1] + about[2] * degrees[2];
    let angle = sum.length();
    if angle == 0.0 {
        return (axes, Vec3::new(0.0, 1.0, 0.0), 0.0);
    }
    let axis = sum * (1.0 / angle);
    (axes.map(|a| turned(a, axis, angle * RADIANS)), axis, angle * RADIANS)
}

fn pose(frame: &Frame) -> model::Pose {
    model::Pose { position: frame.origin.to_array(), rotation: frame.rotation() }
}

fn unit(axis: usize) -> Vec3 {
    let mut unit = [0.0; 3];
    unit[axis] = 1.0;
    Vec3::from_array(unit)
}

impl State {
    /// The scene as it is guessed.
    pub fn scene(&self) -> &Scene {
        &self.loaded.scene
    }

    /// The set-up, ready for tracing.
    ///
    /// # Errors
    /// Where the guess cannot be traced.
    pub fn setup(&self) -> Result<Setup, SetupError> {
        Setup::new(&self.loaded)
    }

    /// The guess after a step of each free number.
    pub fn stepped(&self, free: &[Free], bodies: &[Body], step: &DVector<f64>) -> Self {
        let mut next = self.clone();
        next.offset += step;
        let mut camera_turns = vec![[0.0; 3]; self.cameras.len()];
        let mut turns = vec![[0.0; 3]; bodies.len()];
        let mut plate_turn = [0.0; 3];
        let scene = &mut next.loaded.scene;
        for (free, &by) in free.iter().zip(step.iter()) {
            match free.what {
                Freedom::CameraShift { view, axis } => {
                    let camera = &mut next.cameras[view];
                    camera.origin = camera.origin + unit(axis) * by;
                }
                Freedom::CameraTurn { view, axis } => camera_turns[view][axis] += by,
                Freedom::Lens { number } => {
                    let mut numbers = next.lens.numbers();
                    numbers[number] += by;
                    next.lens = Lens::from_numbers(numbers);
                }
                Freedom::Shift { body, axis } => {
                    bodies[body].iter().for_each(|&e| scene.elements[e].pose.position[axis] += by);
                }
                Freedom::Turn { body, axis } => turns[body][axis] += by,
                Freedom::Ior { element } => {
                    if let Material::Refractive { index: Index::Constant(n), .. } =
                        &mut scene.elements[element].material
                    {
                        *n = (*n + by).max(1.0);
                    }
                }
                Freedom::Size { element, size } => {
                    grow(&mut scene.elements[element], &mut next.loaded.assets[element], size, by);
                }
                Freedom::PlateShift { axis } => {
                    scene.plate.rectangle.pose.position[axis] += by;
                }
                Freedom::PlateTurn { axis } => plate_turn[axis] += by,
            }
        }
        for (camera, degrees) in next.cameras.iter_mut().zip(camera_turns) {
            camera.axes = turned_axes(camera.axes, camera.axes, degrees).0;
        }
        // A pose that is not turned keeps the angles that people wrote: there are several for each orientation.
        for (body, degrees) in bodies.iter().zip(turns) {
            if degrees == [0.0; 3] {
                continue;
            }
            let first = scene.elements[body[0]].pose.frame();
            for &e in body {
                let frame = scene.elements[e].pose.frame();
                let (axes, axis, angle) = turned_axes(frame.axes, first.axes, degrees);
                let arm = turned(frame.origin - first.origin, axis, angle);
                scene.elements[e].pose = pose(&Frame { origin: first.origin + arm, axes });
            }
        }
        if plate_turn != [0.0; 3] {
            let frame = scene.plate.rectangle.pose.frame();
            let (axes, ..) = turned_axes(frame.axes, frame.axes, plate_turn);
            scene.plate.rectangle.pose = pose(&Frame { axes, ..frame });
        }
        next
    }

    /// Camera, lens and parts over numbers that carry the derivatives by those of `free` that are named, in their order.
    pub fn lifted<const N: usize>(
        &self,
        setup: &Setup,
        view: usize,
        free: &[Free],
        bodies: &[Body],
        named: &[usize],
    ) -> Lifted<Dual<N>> {
        let mut lifted = Lifted {
            camera: Placing::<Dual<N>>::constant(&self.cameras[view]),
            lens: Lens::from_numbers(self.lens.numbers().map(Dual::constant)),
            parts: setup.moved(),
        };
        for (place, &index) in named.iter().enumerate() {
            self.lift(&mut lifted, setup, free[index].what, bodies, place);
        }
        lifted
    }

    fn lift<const N: usize>(
        &self,
        lifted: &mut Lifted<Dual<N>>,
        setup: &Setup,
        what: Freedom,
        bodies: &[Body],
        place: usize,
    ) {
        // Elements of the set-up that move with an element of the scene: itself and what is inside of it.
        let of = |element: usize| {
            (0..setup.elements.len())
                .filter(move |&e| e == element || setup.elements[e].inside_of == Some(element))
        };
        match what {
            // The derivative of a view's own camera; other views' are not asked for.
            Freedom::CameraShift { axis, .. } => {
                slope(&mut lifted.camera.origin, unit(axis), place);
            }
            Freedom::CameraTurn { axis, .. } => {
                let about = lifted.camera.axes[axis].value() * RADIANS;
                turn(&mut lifted.camera, about, None, place);
            }
            Freedom::Lens { number } => {
                let mut numbers = lifted.lens.numbers();
                numbers[number].d[place] += 1.0;
                lifted.lens = Lens::from_numbers(numbers);
            }
            Freedom::Shift { body, axis } => {
                for e in bodies[body].iter().flat_map(|&e| of(e)) {
                    slope(&mut lifted.parts.elements[e].frame.origin, unit(axis), place);
                }
            }
            Freedom::Turn { body, axis } => {
                let first = self.scene().elements[bodies[body][0]].pose.frame();
                let about = first.axes[axis] * RADIANS;
                for e in bodies[body].iter().flat_map(|&e| of(e)) {
                    let frame = &mut lifted.parts.elements[e].frame;
                    turn(frame, about, Some(first.origin), place);
                }
            }
            Freedom::Ior { element } => lifted.parts.elements[element].index.d[place] += 1.0,
            Freedom::Size { element, size } => {
                if let Some(length) = sizes(&self.scene().elements[element]).get(size) {
                    let stretch = &mut lifted.parts.elements[element].stretch;
                    let by = length.axes.map(|grows| f64::from(u8::from(grows)) / length.value);
                    slope(stretch, Vec3::from_array(by), place);
                }
            }
            Freedom::PlateShift { axis } => {
                slope(&mut lifted.parts.plate.origin, unit(axis), place)
            }
            Freedom::PlateTurn { axis } => {
                let about = lifted.parts.plate.axes[axis].value() * RADIANS;
                turn(&mut lifted.parts.plate, about, None, place);
            }
        }
    }
}

/// Camera, lens and parts, over any number.
#[derive(Clone, Debug)]
pub struct Lifted<T> {
    /// The camera's place: its axes are right, down and ahead.
    pub camera: Placing<T>,
    /// Its lens.
    pub lens: Lens<T>,
    /// The set-up's parts.
    pub parts: Moved<T>,
}

/// The same without derivatives.
pub fn plain(state: &State, setup: &Setup, view: usize) -> Lifted<f64> {
    Lifted {
        camera: Placing::constant(&state.cameras[view]),
        lens: state.lens,
        parts: setup.moved(),
    }
}

/// Adds to a vector's derivative.
fn slope<const N: usize>(v: &mut Vec3<Dual<N>>, by: Vec3, place: usize) {
    v.x.d[place] += by.x;
    v.y.d[place] += by.y;
    v.z.d[place] += by.z;
}

/// Adds to a placing's derivative that of a turn: about an axis (its length the angle) through its own origin or a pivot.
fn turn<const N: usize>(
    placing: &mut Placing<Dual<N>>,
    about: Vec3,
    pivot: Option<Vec3>,
    place: usize,
) {
    if let Some(pivot) = pivot {
        let arm = placing.origin.value() - pivot;
        slope(&mut placing.origin, about.cross(arm), place);
    }
    for axis in &mut placing.axes {
        let by = about.cross(axis.value());
        slope(axis, by, place);
    }
}

/// Changes a length of an element.
fn grow(element: &mut model::Element, asset: &mut Asset, size: usize, by: f64) {
    let Some(length) = sizes(element).into_iter().nth(size) else { return };
    // No step turns a shape inside out.
    let grown = (length.value + by).max(0.01 * length.value);
    match &mut element.shape {
        Shape::Sphere { radius }
        | Shape::Hemisphere { radius }
        | Shape::CylinderMirror { radius, .. }
        | Shape::SphereMirror { radius, .. } => *radius = grown,
        Shape::Ellipsoid { radii: sides } | Shape::Box { size: sides } => {
            sides[length.item.unwrap_or(0)] = grown;
        }
        Shape::Cylinder { radius, height } => match length.key {
            "radius" => *radius = grown,
            _ => *height = grown,
        },
        Shape::Mesh { scale, .. } => {
            *scale = grown;
            if let Asset::Mesh { mesh, .. } = asset {
                *asset = Asset::mesh((**mesh).clone().scaled(grown / length.value));
            }
        }
        _ => {}
    }
}
