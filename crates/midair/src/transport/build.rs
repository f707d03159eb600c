//! From a scene's description to a set-up ready for tracing.

use super::setup::{Element, MAX_SOLIDS, Matter, Setup};
use crate::geometry::profile::ProfileError;
use crate::geometry::{Convex, Shape, Sheet, Vec3};
use crate::optics::Index;
use crate::optics::glass::{self, DESIGN_WAVELENGTH};
use crate::optics::glass_file::GlassFile;
use crate::optics::plate::{Model, Plate, PlateError, SlitMirrorPlate};
use crate::scene::heights::fit;
use crate::scene::model::{self, Facing, HeightSource, Material, PlateModel};
use crate::scene::{Asset, Loaded, section};
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
    /// A shape or its inside that cannot be made.
    #[error("element \"{0}\": {1}")]
    Profile(String, ProfileError),
    /// A value that no plate can have.
    #[error(transparent)]
    Plate(#[from] PlateError),
}

impl Setup {
    /// The set-up of a scene at the design wavelength.
    ///
    /// # Errors
    /// [`SetupError`] where the scene asks for what cannot be traced.
    pub fn new(loaded: &Loaded) -> Result<Self, SetupError> {
        let scene = &loaded.scene;
        let mut elements = scene
            .elements
            .iter()
            .zip(&loaded.assets)
            .enumerate()
            .map(|(i, (element, asset))| {
                let glass = loaded.glasses.get(i).and_then(Option::as_ref);
                place(element, asset, glass, scene.display.wavelengths)
            })
            .collect::<Result<Vec<_>, _>>()?;
        hollow_out(&mut elements, &scene.elements)?;
        rank(&mut elements, &scene.elements)?;
        Self::around(scene, loaded, elements)
    }

    /// The scene's viewpoint, image, plate and display around these elements; `loaded` has the display's files.
    fn around(
        scene: &model::Scene,
        loaded: &Loaded,
        elements: Vec<Element>,
    ) -> Result<Self, SetupError> {
        let image = scene.image.placed();
        let model = match &scene.plate.model {
            PlateModel::Ideal => Model::Ideal,
            PlateModel::SlitMirror(plate) => Model::from(SlitMirrorPlate::new(*plate)?),
        };
        let mut plate = Plate::new(scene.plate.rectangle.placed(), model);
        if let Some(table) = &loaded.luminance {
            plate = plate.with_luminance(table.clone(), &image.frame);
        }
        Ok(Self {
            viewpoint: Vec3::from_array(scene.viewpoint),
            image,
            plate,
            display: scene.display_rectangle(),
            emission: loaded.emission.clone(),
            polarisation: scene.display.polarisation,
            screen: loaded.screen.clone(),
            wavelengths: scene.display.wavelengths,
            resolution: scene.display.resolution,
            elements,
            max_interactions: scene.max_interactions,
            follow_total_reflection: scene.follow_total_reflection,
        })
    }
}

/// An element at the design wavelength; the display's `colours` in nm.
fn place(
    element: &model::Element,
    asset: &Asset,
    glass: Option<&Arc<GlassFile>>,
    colours: [f64; 3],
) -> Result<Element, SetupError> {
    let (matter, index) = match &element.material {
        Material::Refractive { index, absorption } => {
            let law = law(index, glass, &element.name)?;
            let of_glass = || glass.map(|glass| colours.map(|nm| glass.absorption(nm / 1000.0)));
            let absorption = absorption.or_else(of_glass).unwrap_or_default();
            let index = law.at(DESIGN_WAVELENGTH);
            (Matter::Refractive { index, absorption }, Some(law))
        }
        Material::Mirror { reflectance } => (Matter::Mirror { reflectance: *reflectance }, None),
        Material::Opaque => (Matter::Opaque, None),
    };
    let refractive = matches!(matter, Matter::Refractive { .. });
    Ok(Element {
        name: element.name.clone(),
        frame: element.pose.frame(),
        shape: shape(element, asset, refractive)?,
        matter,
        index,
        rank: 0,
        inside_of: None,
    })
}

/// Adds what is inside of hollow elements, after all of the scene's.
fn hollow_out(elements: &mut Vec<Element>, described: &[model::Element]) -> Result<(), SetupError> {
    for (i, outer) in described.iter().enumerate() {
        let refused = |error| SetupError::Profile(outer.name.clone(), error);
        for inside in section::insides(outer).map_err(refused)? {
            let law = law(&inside.index, None, &outer.name)?;
            let (index, absorption) = (law.at(DESIGN_WAVELENGTH), inside.absorption);
            elements.push(Element {
                name: inside.name,
                frame: elements[i].frame,
                shape: Shape::Swept(Arc::new(inside.solid)),
                matter: Matter::Refractive { index, absorption },
                index: Some(law),
                rank: 0,
                inside_of: Some(i),
            });
        }
    }
    Ok(())
}

/// A scene's index as a law of wavelength.
fn law(
    index: &model::Index,
    glass: Option<&Arc<GlassFile>>,
    name: &str,
) -> Result<Index, SetupError> {
    Ok(match index {
        model::Index::File(_) => {
            Index::File(glass.ok_or_else(|| SetupError::NoAsset(name.to_owned()))?.clone())
        }
        model::Index::Constant(n) => Index::Constant(*n),
        model::Index::Cauchy(a, b) => Index::Cauchy(*a, *b),
        model::Index::Glass(name) => {
            Index::Glass(glass::lookup(name).ok_or_else(|| SetupError::UnknownGlass(name.clone()))?)
        }
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
        model::Shape::Hemisphere { .. }
        | model::Shape::Torus { .. }
        | model::Shape::Lens { .. }
        | model::Shape::Lathe { .. }
        | model::Shape::Prism { .. } => {
            let solid = section::swept(&element.shape).unwrap_or(Err(ProfileError::Empty));
            let refused = |error| SetupError::Profile(element.name.clone(), error);
            Shape::Swept(Arc::new(solid.map_err(refused)?))
        }
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
            let depth = refractive.then_some(*depth);
            Shape::HeightField(match (source, asset) {
                (HeightSource::Samples(rows), _) => Arc::new(fit(rows, *size, *amplitude, depth)),
                (_, Asset::Heights(heights)) => heights.field(*size, *amplitude, depth),
                _ => return Err(SetupError::NoAsset(element.name.clone())),
            })
        }
        model::Shape::Mesh { .. } => {
            let Asset::Mesh { surface, .. } = asset else {
                return Err(SetupError::NoAsset(element.name.clone()));
            };
            Shape::Mesh(Arc::clone(surface))
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
        // What is inside of an element has its priority, and a smaller volume.
        let priority =
            |i: usize| described[elements[i].inside_of.unwrap_or(i)].priority.unwrap_or(0);
        let volume = |i: usize| elements[i].shape.volume();
        priority(a).cmp(&priority(b)).then(volume(b).total_cmp(&volume(a))).then(a.cmp(&b))
    });
    for (rank, index) in solids.into_iter().enumerate() {
        elements[index].rank = rank as u8;
    }
    Ok(())
}
