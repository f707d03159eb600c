//! From a scene's description to a set-up ready for tracing.

use super::setup::{Element, MAX_SOLIDS, Matter, Setup};
use crate::geometry::{Convex, HeightField, MeshSurface, Shape, Sheet, Vec3};
use crate::optics::glass::{self, DESIGN_WAVELENGTH};
use crate::optics::glass_file::GlassFile;
use crate::optics::plate::LayerPlanes;
use crate::scene::model::{self, Facing, HeightSource, Index, Material, PlateModel};
use crate::scene::{Asset, Loaded};
use std::sync::Arc;

/// Why a scene cannot be traced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// More refractive solids than can be kept apart.
    #[error("the scene has {0} refractive solids; at most {MAX_SOLIDS} can be traced")]
    TooManySolids(usize),
    /// A glass that is not in the catalogue.
    #[error("the glass \"{0}\" is not in the catalogue")]
    UnknownGlass(String),
    /// An element whose file was not loaded.
    #[error("element \"{0}\": its file was not loaded")]
    NoAsset(String),
}

impl Setup {
    /// The set-up of a scene at the design wavelength.
    ///
    /// # Errors
    /// [`SetupError`] where the scene asks for what cannot be traced.
    pub fn new(loaded: &Loaded) -> Result<Self, SetupError> {
        Self::at_wavelength(loaded, DESIGN_WAVELENGTH)
    }

    /// The set-up of a scene with all indices at a wavelength in micrometres.
    ///
    /// # Errors
    /// As [`Setup::new`].
    pub fn at_wavelength(loaded: &Loaded, wavelength: f64) -> Result<Self, SetupError> {
        let scene = &loaded.scene;
        let mut elements = scene
            .elements
            .iter()
            .zip(&loaded.assets)
            .enumerate()
            .map(|(i, (element, asset))| {
                let glass = loaded.glasses.get(i).and_then(Option::as_deref);
                place(element, asset, glass, wavelength, scene.display.wavelengths)
            })
            .collect::<Result<Vec<_>, _>>()?;
        rank(&mut elements, &scene.elements)?;
        Ok(Self::around(scene, loaded, elements))
    }

    /// The set-ups of a scene for the display's red, green and blue, each at the wavelength that stands for it.
    ///
    /// # Errors
    /// As [`Setup::new`].
    pub fn by_colour(loaded: &Loaded) -> Result<[Self; 3], SetupError> {
        // A micrometre is 1000 nm.
        let [r, g, b] = loaded.scene.display.wavelengths.map(|nm| nm / 1000.0);
        Ok([
            Self::at_wavelength(loaded, r)?,
            Self::at_wavelength(loaded, g)?,
            Self::at_wavelength(loaded, b)?,
        ])
    }

    /// The same plate and display with no object between, the display where it shows the image undistorted by
    /// itself: the reference that views are compared with.
    pub fn without_elements(loaded: &Loaded) -> Self {
        let mut scene = loaded.scene.clone();
        scene.elements.clear();
        scene.display.pose = None;
        scene.display.size = None;
        Self::around(&scene, loaded, Vec::new())
    }

    /// The scene's viewpoint, image, plate and display around these elements; `loaded` has the display's files.
    fn around(scene: &model::Scene, loaded: &Loaded, elements: Vec<Element>) -> Self {
        Self {
            viewpoint: Vec3::from_array(scene.viewpoint),
            image: scene.image.placed(),
            plate: scene.plate.rectangle.placed(),
            layers: match &scene.plate.model {
                PlateModel::Ideal => None,
                PlateModel::SlitMirror(plate) => Some(LayerPlanes::new(plate)),
            },
            display: scene.display_rectangle(),
            emission: loaded.emission.clone(),
            resolution: scene.display.resolution,
            elements,
            max_interactions: scene.max_interactions,
            follow_total_reflection: scene.follow_total_reflection,
        }
    }
}

/// `wavelength` in micrometres, the display's `colours` in nm.
fn place(
    element: &model::Element,
    asset: &Asset,
    glass: Option<&GlassFile>,
    wavelength: f64,
    colours: [f64; 3],
) -> Result<Element, SetupError> {
    let matter = match &element.material {
        Material::Refractive { index, absorption } => {
            let index = index_at(index, glass, wavelength, &element.name)?;
            let of_glass = || glass.map(|glass| colours.map(|nm| glass.absorption(nm / 1000.0)));
            let absorption = absorption.or_else(of_glass).unwrap_or_default();
            Matter::Refractive { index, absorption }
        }
        Material::Mirror { reflectance } => Matter::Mirror { reflectance: *reflectance },
    };
    let refractive = matches!(matter, Matter::Refractive { .. });
    Ok(Element {
        name: element.name.clone(),
        frame: element.pose.frame(),
        shape: shape(element, asset, refractive)?,
        matter,
        rank: 0,
    })
}

fn index_at(
    index: &Index,
    glass: Option<&GlassFile>,
    wavelength: f64,
    name: &str,
) -> Result<f64, SetupError> {
    Ok(match index {
        Index::File(_) => {
            glass.ok_or_else(|| SetupError::NoAsset(name.to_owned()))?.index(wavelength)
        }
        Index::Constant(n) => *n,
        // Cauchy 1836, to its second term.
        Index::Cauchy(a, b) => a + b / (wavelength * wavelength),
        Index::Glass(name) => glass::lookup(name)
            .ok_or_else(|| SetupError::UnknownGlass(name.clone()))?
            .index(wavelength),
    })
}

fn shape(element: &model::Element, asset: &Asset, refractive: bool) -> Result<Shape, SetupError> {
    let sign = |facing: &Facing| match facing {
        Facing::Convex => -1.0,
        Facing::Concave => 1.0,
    };
    Ok(match &element.shape {
        model::Shape::Sphere { radius } => Shape::Convex(Convex::Sphere { radius: *radius }),
        model::Shape::Ellipsoid { radii } => {
            Shape::Convex(Convex::Ellipsoid { radii: Vec3::from_array(*radii) })
        }
        model::Shape::Box { size } => {
            Shape::Convex(Convex::Box { half: Vec3::from_array(*size) * 0.5 })
        }
        model::Shape::Cylinder { radius, height } => Shape::Convex(Convex::Frustum {
            middle_radius: *radius,
            slope: 0.0,
            half_height: 0.5 * height,
        }),
        model::Shape::Cone { radius, top_radius, height } => Shape::Convex(Convex::Frustum {
            middle_radius: 0.5 * (radius + top_radius),
            slope: (top_radius - radius) / height,
            half_height: 0.5 * height,
        }),
        model::Shape::Plane { size } => Shape::Sheet(Sheet::Plane { half: size.map(|s| 0.5 * s) }),
        model::Shape::CylinderMirror { radius, size, facing } => Shape::Sheet(Sheet::Cylinder {
            centre: sign(facing) * radius,
            half_angle: 0.5 * size[0] / radius,
            half_height: 0.5 * size[1],
        }),
        model::Shape::SphereMirror { radius, diameter, facing } => {
            Shape::Sheet(Sheet::Sphere { centre: sign(facing) * radius, rim: 0.5 * diameter })
        }
        model::Shape::HeightField { source, size, amplitude, depth } => {
            let samples = match (source, asset) {
                (HeightSource::Samples(samples), _) | (_, Asset::Heights(samples)) => samples,
                _ => return Err(SetupError::NoAsset(element.name.clone())),
            };
            let heights: Vec<Vec<f64>> =
                samples.iter().map(|row| row.iter().map(|h| h * amplitude).collect()).collect();
            let depth = refractive.then_some(*depth);
            Shape::HeightField(Arc::new(HeightField::new(&heights, *size, depth)))
        }
        model::Shape::Mesh { .. } => {
            let Asset::Mesh(mesh) = asset else {
                return Err(SetupError::NoAsset(element.name.clone()));
            };
            Shape::Mesh(Arc::new(MeshSurface::new(mesh)))
        }
    })
}

/// Orders the solids: by priority, then the smaller one over the larger, then the later one in the file.
fn rank(elements: &mut [Element], described: &[model::Element]) -> Result<(), SetupError> {
    let mut solids: Vec<usize> = (0..elements.len())
        .filter(|&i| matches!(elements[i].matter, Matter::Refractive { .. }))
        .collect();
    if solids.len() > MAX_SOLIDS {
        return Err(SetupError::TooManySolids(solids.len()));
    }
    solids.sort_by(|&a, &b| {
        let priority = |i: usize| described[i].priority.unwrap_or(0);
        let volume = |i: usize| elements[i].shape.volume();
        priority(a).cmp(&priority(b)).then(volume(b).total_cmp(&volume(a))).then(a.cmp(&b))
    });
    for (rank, index) in solids.into_iter().enumerate() {
        elements[index].rank = rank as u8;
    }
    Ok(())
}
