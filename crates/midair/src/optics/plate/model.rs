//! The plate in its place: where it stands and how it treats light.

use super::{Class, LayerPlanes, LuminanceTable, Measured, SlitMirrorPlate, pass_ideal};
use crate::geometry::{Frame, Ray, Rectangle, Vec3};
use crate::optics::interface::{attenuate, fresnel, reflect, refract};
use crate::optics::polarisation::Analysed;

/// A plate in its place.
#[derive(Clone, Debug)]
pub struct Plate {
    /// Where it stands; its normal is on the viewer's side.
    pub rectangle: Rectangle,
    model: Model,
    layers: Option<LayerPlanes>,
}

impl Plate {
    /// A plate of this model at a place.
    pub fn new(rectangle: Rectangle, model: Model) -> Self {
        let layers = model.layers();
        Self { rectangle, model, layers }
    }

    /// The plane-symmetric plate, of no thickness and without loss.
    pub fn ideal(rectangle: Rectangle) -> Self {
        Self::new(rectangle, Model::Ideal)
    }

    /// How it treats light.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The planes of symmetry of its two layers; `None` for a plate that has one.
    #[inline]
    pub fn layers(&self) -> Option<&LayerPlanes> {
        self.layers.as_ref()
    }

    /// The same plate, its image as bright as a table says over the directions from `image`.
    pub fn with_luminance(self, table: LuminanceTable, image: &Frame) -> Self {
        let measured = Measured::new(self.model, table, image, &self.rectangle.frame);
        Self { model: Model::Measured(Box::new(measured)), ..self }
    }

    /// Through the plate at a crossing of its plane: how, the ray behind it, and the share of light left. `None`: it is lost.
    #[inline]
    pub fn pass(&self, ray: &Ray, crossing: Vec3) -> Option<(Class, Ray, [f64; 3])> {
        self.model.pass(&self.rectangle.frame, ray, crossing)
    }

    /// See [`Model::faces`]; a direction in the world.
    pub fn faces(&self, direction: Vec3) -> f64 {
        self.model.faces(self.rectangle.frame.to_local_direction(direction))
    }

    /// See [`Model::real_share`].
    pub fn real_share(&self, direction: Vec3) -> [f64; 3] {
        self.model.real_share(direction)
    }
}

/// How the plate treats light.
#[derive(Clone, Debug)]
pub enum Model {
    /// Plane symmetry without loss, of no thickness.
    Ideal,
    /// Slit mirrors, ray by ray.
    SlitMirror(Box<SlitMirrorPlate>),
    /// Either, its image as bright as it was measured.
    Measured(Box<Measured>),
}

impl Model {
    /// Where its two layers are symmetric; `None` where plane and layers are one.
    pub fn layers(&self) -> Option<LayerPlanes> {
        match self {
            Self::Ideal => None,
            Self::SlitMirror(plate) => Some(LayerPlanes::new(plate.parameters())),
            Self::Measured(measured) => measured.model().layers(),
        }
    }

    /// Luminance of the mid-air image over the display's, for light that leaves the plate along a unit vector in the
    /// plate's frame, averaged over the lattice.
    pub fn efficiency(&self, direction: Vec3) -> f64 {
        match self {
            Self::Ideal => 1.0,
            Self::SlitMirror(plate) => plate.efficiency(direction),
            Self::Measured(measured) => measured.efficiency(direction),
        }
    }

    /// What the faces of the plate pass of unpolarised light that travels along a unit vector in its frame, both together.
    pub fn faces(&self, direction: Vec3) -> f64 {
        match self {
            Self::Ideal => 1.0,
            Self::SlitMirror(plate) => {
                fresnel(direction.z.abs(), 1.0 / plate.parameters().ior).transmittance().powi(2)
            }
            Self::Measured(measured) => measured.model().faces(direction),
        }
    }

    /// Polarised light through a plate at `frame`, from one unit direction to another (world): in by one face, turned by the mirrors of the layers
    /// in which its direction was, out by the other. Only what the faces take is taken; see [`Self::faces`].
    pub fn turn(&self, field: &mut Analysed, frame: &Frame, before: Vec3, behind: Vec3) {
        let plate = match self {
            Self::Ideal => return field.pass_ideal(frame.normal()),
            Self::SlitMirror(plate) => plate,
            Self::Measured(measured) => return measured.model().turn(field, frame, before, behind),
        };
        let n = if before.dot(frame.normal()) < 0.0 { frame.normal() } else { -frame.normal() };
        let eta = 1.0 / plate.parameters().ior;
        let mut inside = refract(before, n, eta);
        field.refract(before, n, eta, inside);
        let across = |d: Vec3| {
            let local = frame.to_local_direction(d);
            plate.across([local.x, local.y])
        };
        let (came, left) = (across(before), across(behind));
        for (layer, unit) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
            if came[layer] * left[layer] < 0.0 {
                let [x, y] = plate.across_inverse(unit);
                let mirror = frame.axes[0] * x + frame.axes[1] * y;
                field.mirror(mirror);
                inside = reflect(inside, mirror);
            }
        }
        field.refract(inside, n, 1.0 / eta, behind);
    }

    /// Through a plate at `frame`: how, the ray behind it, and the share of light left. `None`: it is lost.
    #[inline]
    pub(super) fn pass(
        &self,
        frame: &Frame,
        ray: &Ray,
        crossing: Vec3,
    ) -> Option<(Class, Ray, [f64; 3])> {
        match self {
            Self::Ideal => {
                let direction = pass_ideal(ray.direction, frame.normal());
                Some((Class::Real, Ray { origin: crossing, direction }, [1.0; 3]))
            }
            Self::SlitMirror(plate) => {
                let point = frame.to_local(crossing);
                let passage = plate.pass(point, frame.to_local_direction(ray.direction))?;
                let behind = Ray {
                    origin: frame.to_world(passage.exit_point),
                    direction: frame.to_world_direction(passage.direction),
                };
                Some((passage.class, behind, passage.weight))
            }
            Self::Measured(measured) => {
                let (class, behind, mut weight) = measured.model().pass(frame, ray, crossing)?;
                if class == Class::Real {
                    // Light goes the other way than the path.
                    let towards_viewer = frame.to_local_direction(-ray.direction);
                    attenuate(&mut weight, [measured.correction(towards_viewer); 3]);
                }
                Some((class, behind, weight))
            }
        }
    }

    /// Share of the light that leaves the plate along a unit vector in its frame, from the display, that forms the mid-air
    /// image: by linear R, G, B, averaged over the lattice.
    pub fn real_share(&self, direction: Vec3) -> [f64; 3] {
        match self {
            Self::Ideal => [1.0; 3],
            Self::SlitMirror(plate) => plate.shares(direction).real,
            Self::Measured(measured) => {
                let correction = measured.correction(direction);
                measured.model().real_share(direction).map(|share| share * correction)
            }
        }
    }
}

impl From<SlitMirrorPlate> for Model {
    fn from(plate: SlitMirrorPlate) -> Self {
        Self::SlitMirror(Box::new(plate))
    }
}
