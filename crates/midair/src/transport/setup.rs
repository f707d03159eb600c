//! A set-up ready for tracing.

use super::path::{Action, End, Path, Step};
use super::walk::Walk;
use crate::geometry::{Crossing, Dual, Frame, Ray, Real, Rectangle, Shape, Vec3};
use crate::optics::Index;
use crate::optics::emission::Emission;
use crate::optics::interface::{reflect, refract};
use crate::optics::plate::{Model, Plate, PlateError, SlitMirrorPlate, display_place, pass_ideal};
use crate::optics::polarisation::polariser_field;
use crate::optics::screen::Screen;
use crate::scene::model::PlateModel;

/// What an element is made of, at one wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Matter {
    /// A transparent solid.
    Refractive {
        /// Refractive index.
        index: f64,
        /// Absorption per mm by linear R, G, B.
        absorption: [f64; 3],
    },
    /// A mirror on either side.
    Mirror {
        /// Reflectance by linear R, G, B.
        reflectance: [f64; 3],
    },
    /// It stops all light.
    Opaque,
}

/// A distortive object in its place.
#[derive(Clone, Debug)]
pub struct Element {
    /// What people call it.
    pub name: String,
    /// Where it stands.
    pub frame: Frame,
    /// Its form.
    pub shape: Shape,
    /// What it is made of, at the set-up's wavelength.
    pub matter: Matter,
    /// A refractive solid's index by wavelength; `None`: as `matter` says for all.
    pub index: Option<Index>,
    /// For a refractive solid: its place in the order of priority, unique among the solids, the higher one
    /// fills where several overlap.
    pub rank: u8,
    /// The element whose inside it is, by its index in the set-up; it stands after the elements that the scene describes.
    pub inside_of: Option<usize>,
}

impl Element {
    /// Whether a point of the world lies within it; never in a sheet.
    pub fn holds(&self, point: Vec3) -> bool {
        self.shape.contains(self.frame.to_local(point))
    }
}

/// A set-up ready for tracing: everything placed in the world, indices taken at one wavelength.
///
/// It is complete: light is followed, weighed and shown by what it holds. A changed one is made by its `with_` methods, which share what
/// they do not change.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Setup {
    /// The eye.
    pub viewpoint: Vec3,
    /// The undistorted mid-air image.
    pub image: Rectangle,
    /// The plate; its normal is on the viewer's side.
    pub plate: Plate,
    /// The display; its normal is on the plate's side.
    pub display: Rectangle,
    /// How the display's light goes with the direction.
    pub emission: Emission,
    /// Direction of the electric field of the display's light from its x axis towards its y axis, degrees; `None`: unpolarised.
    pub polarisation: Option<f64>,
    /// How the display's codes become light.
    pub screen: Screen,
    /// Wavelengths in nm that stand for its red, green and blue.
    pub wavelengths: [f64; 3],
    /// Display pixels: width, height.
    pub resolution: [usize; 2],
    /// The distortive objects.
    pub elements: Vec<Element>,
    /// The most interactions that one path may have, the plate included.
    pub max_interactions: usize,
    /// Whether paths are followed through total internal reflection.
    pub follow_total_reflection: bool,
}

/// The most refractive solids in a set-up: one bit each.
pub const MAX_SOLIDS: usize = 64;

impl Setup {
    /// The same, seen from another place.
    pub fn with_viewpoint(&self, viewpoint: Vec3) -> Self {
        Self { viewpoint, ..self.clone() }
    }

    /// The same with a display of another resolution.
    pub fn with_resolution(&self, resolution: [usize; 2]) -> Self {
        Self { resolution, ..self.clone() }
    }

    /// The same with a plate of another model in the plate's place.
    pub fn with_plate(&self, model: Model) -> Self {
        Self { plate: Plate::new(self.plate.rectangle, model), ..self.clone() }
    }

    /// The same with a plate of the model that is wanted, where the scene's `own` is another. A measured luminance is of the scene's own plate.
    ///
    /// # Errors
    /// [`PlateError`] where no plate has such dimensions.
    pub fn with_plate_model(
        &self,
        own: &PlateModel,
        wanted: &PlateModel,
    ) -> Result<Self, PlateError> {
        Ok(match wanted {
            _ if wanted == own => self.clone(),
            PlateModel::Ideal => self.with_plate(Model::Ideal),
            PlateModel::SlitMirror(parameters) => {
                self.with_plate(SlitMirrorPlate::new(*parameters)?.into())
            }
        })
    }

    /// The same plate and display with no object between, the display where it belongs for this plate: what the plate by itself shows.
    pub fn unobstructed(&self) -> Self {
        let mut setup = Self { elements: Vec::new(), ..self.clone() };
        setup.display = setup.display_place();
        setup
    }

    /// Where the display belongs if mirrors are flat and solids absent, in the image's size.
    pub fn display_place(&self) -> Rectangle {
        let mirrors: Vec<Frame> = self.mirrors().map(|mirror| mirror.frame).collect();
        let (plate, layers) = (&self.plate.rectangle.frame, self.plate.layers());
        display_place(self.image.frame, &mirrors, plate, layers, self.viewpoint, self.image.size)
    }

    /// The elements that reflect.
    pub fn mirrors(&self) -> impl Iterator<Item = &Element> {
        self.elements.iter().filter(|e| matches!(e.matter, Matter::Mirror { .. }))
    }

    /// The same with all indices at a wavelength in micrometres.
    pub fn at_wavelength(&self, wavelength: f64) -> Self {
        let mut setup = self.clone();
        for element in &mut setup.elements {
            if let (Matter::Refractive { index, .. }, Some(law)) =
                (&mut element.matter, &element.index)
            {
                *index = law.at(wavelength);
            }
        }
        setup
    }

    /// The set-ups of the display's red, green and blue, each at the wavelength that stands for it.
    pub fn by_colour(&self) -> [Self; 3] {
        // A micrometre is 1000 nm.
        self.wavelengths.map(|nm| self.at_wavelength(nm / 1000.0))
    }

    /// Whether an index goes with the wavelength.
    pub fn disperses(&self) -> bool {
        self.elements.iter().any(|e| e.index.as_ref().is_some_and(Index::disperses))
    }

    /// Width and height of a display pixel, mm.
    pub fn pixel_pitch(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.display.size[axis] / self.resolution[axis] as f64)
    }

    /// A view's size for a width in pixels: the height that gives square pixels on the image.
    pub fn view_size(&self, width: usize) -> [usize; 2] {
        let [w, h] = self.image.size;
        [width, ((width as f64 * h / w).round() as usize).max(1)]
    }

    /// The ray from the viewpoint through the image point uv.
    pub fn ray<T: Real>(&self, uv: [T; 2]) -> Ray<T> {
        self.ray_from(self.viewpoint, uv)
    }

    /// The ray from any eye through the image point uv.
    pub fn ray_from<T: Real>(&self, eye: Vec3, uv: [T; 2]) -> Ray<T> {
        ray_through(&self.image, eye, uv)
    }

    /// F at an image point, by searching what the path meets; the steps are left in `path`.
    pub fn transport(&self, uv: [f64; 2], path: &mut Path) -> End {
        self.trace(self.ray(uv), path)
    }

    /// Follows a ray to its end, finding at each step what it meets first.
    ///
    /// Solids that overlap are resolved by rank: see [`Setup::meet`].
    pub fn trace(&self, ray: Ray, path: &mut Path) -> End {
        path.clear();
        let mut walk = Walk::new(ray);
        let mut plate_passed = None;
        loop {
            if path.len() >= self.max_interactions {
                return End::TooManyInteractions;
            }
            let goal = match plate_passed {
                None => &self.plate.rectangle,
                Some(_) => &self.display,
            };
            let ray = walk.ray;
            let towards = ray.direction.dot(goal.frame.normal());
            let mut goal_distance = goal.plane_distance(&ray);
            // NaN (parallel within the plane) counts as no meeting.
            if !(goal_distance > 0.0) {
                goal_distance = f64::INFINITY;
            }
            if let Some(step) = self.meet(&walk, goal_distance) {
                if step.action == Action::Stop {
                    return End::Stopped { element: step.element };
                }
                let advanced = self.advance(&ray, &step);
                let (step, advanced) = if advanced.direction.x.is_nan() {
                    if !self.follow_total_reflection {
                        return End::TotalReflection { element: step.element };
                    }
                    let step = Step { action: Action::Reflect, ..step };
                    (step, self.advance(&ray, &step))
                } else {
                    (step, advanced)
                };
                self.take(&mut walk, step, advanced);
                path.push(step);
                continue;
            }
            if goal_distance == f64::INFINITY {
                return if plate_passed.is_none() { End::MissedPlate } else { End::MissedDisplay };
            }
            match plate_passed {
                None => {
                    if towards >= 0.0 {
                        return End::PlateBehind;
                    }
                    let step = Step {
                        element: 0,
                        crossing: Crossing::Enter,
                        face: 0,
                        part: 0,
                        seamless: false,
                        action: Action::Plate,
                    };
                    let at = self.plate.rectangle.coordinates(ray.at(goal_distance));
                    walk.leave_plate(self.advance(&ray, &step));
                    plate_passed = Some(at.iter().all(|c| (0.0..=1.0).contains(c)));
                    path.push(step);
                }
                Some(through_plate) => {
                    if towards >= 0.0 {
                        return End::MissedDisplay;
                    }
                    let st = self.display.coordinates(ray.at(goal_distance));
                    return End::Display { st, through_plate };
                }
            }
        }
    }

    /// The display's radiance against a ray that meets it with this direction (unit), over that along its normal; linear R, G, B.
    #[inline]
    pub fn emitted_against(&self, direction: Vec3) -> [f64; 3] {
        match &self.emission {
            Emission::Lambert => [1.0; 3],
            measured => measured.relative(-direction.dot(self.display.frame.normal())),
        }
    }

    /// The field of the display's light against a ray that meets it with this direction (unit): a unit vector across the ray; `None`: unpolarised.
    pub fn polarised_against(&self, direction: Vec3) -> Option<Vec3> {
        let (sin, cos) = self.polarisation?.to_radians().sin_cos();
        let [x, y, normal] = self.display.frame.axes;
        Some(polariser_field(direction, x * cos + y * sin, normal))
    }

    /// One step of a path whose course is known. NaN where the step is not possible.
    pub fn advance<T: Real>(&self, ray: &Ray<T>, step: &Step) -> Ray<T> {
        if step.action == Action::Plate {
            return self.pass_plate(ray);
        }
        let (t, direction, normal) = self.facet(ray, step);
        let origin = ray.at(t);
        let direction = match step.action {
            Action::Pass | Action::Stop | Action::Plate => {
                return Ray { origin, direction: ray.direction };
            }
            Action::Reflect => reflect(direction, normal),
            Action::Refract { eta } => refract(direction, normal, T::constant(eta)),
        };
        let frame = &self.elements[usize::from(step.element)].frame;
        Ray { origin, direction: frame.to_world_direction(direction) }
    }

    /// The plate: the ray behind it sets out from the plate's plane.
    #[inline]
    pub(super) fn pass_plate<T: Real>(&self, ray: &Ray<T>) -> Ray<T> {
        let frame = &self.plate.rectangle.frame;
        let mut origin = ray.at(self.plate.rectangle.plane_distance(ray));
        if let Some(layers) = self.plate.layers() {
            let [x, y] = layers.shift(frame.to_local_direction(ray.direction));
            let [right, up, _] = frame.axes.map(Vec3::constant);
            origin = origin + right.scaled(x) + up.scaled(y);
        }
        Ray { origin, direction: pass_ideal(ray.direction, Vec3::constant(frame.normal())) }
    }

    /// Where a ray crosses the surface of a step at an element: the distance, and in the element's frame
    /// the ray's direction and the unit normal on the side that the ray comes from.
    #[inline]
    pub fn facet<T: Real>(&self, ray: &Ray<T>, step: &Step) -> (T, Vec3<T>, Vec3<T>) {
        let element = &self.elements[usize::from(step.element)];
        let local = ray.to_local(&element.frame);
        let (t, normal) = element.shape.cross(&local, step.face, step.crossing);
        let against = if local.direction.dot(normal).value() > 0.0 { -normal } else { normal };
        (t, local.direction, against)
    }

    /// The unit normal of a step's surface on the side that the ray comes from, in the world.
    pub fn normal_against(&self, ray: &Ray, step: &Step) -> Vec3 {
        let (_, _, n) = self.facet(ray, step);
        self.elements[usize::from(step.element)].frame.to_world_direction(n)
    }

    /// F along a known path, continued smoothly beyond the path's own region; NaN where it ceases to exist.
    ///
    /// On smooth meshes the path's faces are brought up to date: from each face that the path is known to cross, a walk
    /// over the edges finds the one that it crosses at this image point.
    pub fn follow<T: Real>(&self, uv: [T; 2], path: &mut [Step]) -> [T; 2] {
        let mut ray = self.ray(uv);
        for step in path {
            if step.seamless && !self.settle(&ray.value(), step) {
                return [T::constant(f64::NAN); 2];
            }
            ray = self.advance(&ray, step);
        }
        let t = self.display.plane_distance(&ray);
        self.display.coordinates(ray.at(t))
    }

    fn settle(&self, ray: &Ray, step: &mut Step) -> bool {
        let element = &self.elements[usize::from(step.element)];
        let settled = element
            .shape
            .bent_mesh()
            .and_then(|mesh| mesh.settle(&ray.to_local(&element.frame), step.face, step.crossing));
        step.face = settled.unwrap_or(step.face);
        settled.is_some()
    }

    /// F along a known path with its derivatives: st, and the Jacobian rows d(s)/d(u, v) and d(t)/d(u, v).
    pub fn follow_with_jacobian(
        &self,
        uv: [f64; 2],
        path: &mut [Step],
    ) -> ([f64; 2], [[f64; 2]; 2]) {
        let [s, t] = self.follow([Dual::variable(uv[0], 0), Dual::variable(uv[1], 1)], path);
        ([s.re, t.re], [s.d, t.d])
    }
}

/// The ray from an eye through the image point uv.
#[inline(always)]
pub(super) fn ray_through<T: Real>(image: &Rectangle, eye: Vec3, uv: [T; 2]) -> Ray<T> {
    let origin = Vec3::constant(eye);
    Ray { origin, direction: (image.point(uv) - origin).normalized() }
}
