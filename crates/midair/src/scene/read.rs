//! From a conforming tree to the model.

mod fields;

pub use fields::Fields;

use super::devices::{self, Fineness};
use super::grammar::{Block, Kind};
use super::model::*;
use super::tree::{Entry, Node, Value, millimetres};
use std::path::PathBuf;

/// The scene that a conforming table describes; `None` when the table does not conform.
/// `name` stands in where the scene has none.
pub(super) fn scene(block: &Block, table: &[Entry], name: &str) -> Option<Scene> {
    let fields = Fields { block, table };
    let elements = match fields.given("element") {
        None => Vec::new(),
        Some(Node { value: Value::List(list), .. }) => {
            let Kind::Blocks(block) = block.keys.iter().find(|k| k.name == "element")?.kind else {
                return None;
            };
            list.iter()
                .map(|node| match &node.value {
                    Value::Table(table) => element(&Fields { block, table }),
                    _ => None,
                })
                .collect::<Option<_>>()?
        }
        Some(_) => return None,
    };
    Some(Scene {
        name: fields.text("name").unwrap_or(name).to_owned(),
        max_interactions: fields.integer("max_interactions")?.try_into().ok()?,
        follow_total_reflection: fields.flag("follow_total_reflection")?,
        viewpoint: fields.block("viewpoint")?.numbers("position")?,
        image: fields.block("image")?.rectangle()?,
        plate: plate(&fields.block("plate")?)?,
        display: display(&fields)?,
        elements,
        tracker: match fields.given("tracker") {
            Some(_) => Some(tracker(&fields.block("tracker")?)?),
            None => None,
        },
    })
}

fn tracker(fields: &Fields<'_>) -> Option<Tracker> {
    Some(Tracker { pose: fields.pose()?, offset: fields.numbers("offset")? })
}

fn plate(fields: &Fields<'_>) -> Option<Plate> {
    let model = match fields.text("model")? {
        "ideal" => PlateModel::Ideal,
        "slit-mirror" => PlateModel::SlitMirror(SlitMirror {
            pitch: fields.number("pitch")?,
            layer_depth: fields.number("layer_depth")?,
            azimuth: fields.number("azimuth")?,
            reflectance: fields.colour("reflectance")?,
            ior: fields.number("ior")?,
            absorption: fields.colour("glass_absorption")?,
            cover_glass: fields.number("cover_glass")?,
            mirror_thickness: fields.number("mirror_thickness")?,
        }),
        _ => return None,
    };
    let luminance = fields.text("luminance").map(PathBuf::from);
    Some(Plate { rectangle: fields.rectangle()?, model, luminance })
}

fn display(scene: &Fields<'_>) -> Option<Display> {
    let kind = &scene.block.keys.iter().find(|k| k.name == "display")?.kind;
    let Kind::Block(block) = kind else { return None };
    let table = match scene.given("display") {
        Some(Node { value: Value::Table(table), .. }) => table.as_slice(),
        Some(_) => return None,
        None => &[],
    };
    let fields = Fields { block, table };
    let pose = match (fields.numbers("position"), fields.numbers("rotation")) {
        (None, None) => None,
        (position, rotation) => Some(Pose {
            position: position.unwrap_or_default(),
            rotation: rotation.unwrap_or_default(),
        }),
    };
    let response = match (fields.number("gamma"), fields.text("response")) {
        (Some(gamma), _) => ResponseSource::Gamma(gamma),
        (None, Some(file)) => ResponseSource::File(file.into()),
        (None, None) => ResponseSource::Srgb,
    };
    let (resolution, size) = pixels(&fields)?;
    Some(Display {
        resolution,
        pose,
        size,
        wavelengths: fields.numbers("wavelengths")?,
        response,
        emission: fields.text("emission").map(PathBuf::from),
        polarisation: fields.number("polarisation"),
        black: fields.colour("black"),
        bits: fields.integer("bits").and_then(|bits| bits.try_into().ok()),
    })
}

/// A display's pixels, and its width and height in mm where they are known: as given, else as its model, its pixels in an inch or its diagonal
/// say.
fn pixels(fields: &Fields<'_>) -> Option<([usize; 2], Option<[f64; 2]>)> {
    let upright = fields.flag("portrait");
    let turned = |sides: [usize; 2]| {
        upright.is_some_and(|upright| sides[0] != sides[1] && (sides[1] > sides[0]) != upright)
    };
    let model = fields.text("model").and_then(|name| devices::display(name).ok());
    let mut size = fields.numbers("size");
    let mut resolution = fields.sizes("resolution")?;
    if let Some(model) = model {
        let swap = turned(model.resolution);
        let as_held = |[a, b]: [f64; 2]| if swap { [b, a] } else { [a, b] };
        if fields.given("resolution").is_none() {
            resolution = model.resolution;
        }
        size = size.or_else(|| Some(as_held(model.size())));
    }
    if turned(resolution) {
        resolution.reverse();
    }
    let fineness = match (fields.number("ppi"), fields.number("diagonal_inches")) {
        (Some(count), _) => Some(Fineness::PerInch(count)),
        (None, diagonal) => diagonal.map(Fineness::Diagonal),
    };
    if let Some(fineness) = fineness {
        size = Some(fineness.size(resolution));
    }
    Some((resolution, size))
}

fn element(fields: &Fields<'_>) -> Option<Element> {
    let shape_fields = fields.block("shape")?;
    let material = fields.block("material")?;
    let name = fields.text("name").or(shape_fields.text("kind"))?.to_owned();
    let absorption = material.colour("absorption").or(fields.colour("absorption"));
    let material = if material.flag("mirror") == Some(true) {
        Material::Mirror { reflectance: material.colour("reflectance")? }
    } else if material.flag("opaque") == Some(true) {
        Material::Opaque
    } else {
        Material::Refractive { index: index(&material)?, absorption }
    };
    let priority = match fields.integer("priority") {
        Some(priority) => Some(priority.try_into().ok()?),
        None => None,
    };
    Some(Element {
        name,
        shape: shape(&shape_fields)?,
        pose: fields.pose()?,
        material,
        priority,
        hollow: match fields.number("wall") {
            Some(wall) => Some(hollow(fields, wall)?),
            None => None,
        },
    })
}

fn index(fields: &Fields<'_>) -> Option<Index> {
    Some(if let Some(ior) = fields.number("ior") {
        Index::Constant(ior)
    } else if let Some([a, b]) = fields.numbers("cauchy") {
        Index::Cauchy(a, b)
    } else if let Some(file) = fields.text("file") {
        Index::File(file.into())
    } else {
        Index::Glass(fields.text("glass")?.to_owned())
    })
}

fn hollow(fields: &Fields<'_>, wall: f64) -> Option<Hollow> {
    let fill = match fields.block("fill") {
        Some(fill) => Some(Fill {
            height: fill.number("height"),
            index: index(&fill)?,
            absorption: fill.colour("absorption").unwrap_or_default(),
        }),
        None => None,
    };
    Some(Hollow { wall, open: fields.flag("open")?, fill })
}

fn shape(fields: &Fields<'_>) -> Option<Shape> {
    let facing = || match fields.text("facing")? {
        "convex" => Some(Facing::Convex),
        "concave" => Some(Facing::Concave),
        _ => None,
    };
    Some(match fields.text("kind")? {
        "sphere" => Shape::Sphere { radius: fields.number("radius")? },
        "ellipsoid" => Shape::Ellipsoid { radii: fields.numbers("radii")? },
        "box" => Shape::Box { size: fields.numbers("size")? },
        "cylinder" => {
            Shape::Cylinder { radius: fields.number("radius")?, height: fields.number("height")? }
        }
        "cone" => Shape::Cone {
            radius: fields.number("radius")?,
            top_radius: fields.number("top_radius")?,
            height: fields.number("height")?,
        },
        "hemisphere" => Shape::Hemisphere { radius: fields.number("radius")? },
        "torus" => Shape::Torus { radius: fields.number("radius")?, tube: fields.number("tube")? },
        "lens" => Shape::Lens {
            radii: fields.numbers("radii")?,
            thickness: fields.number("thickness")?,
            diameter: fields.number("diameter")?,
            conic: fields.numbers("conic")?,
            aspheric: [fields.list("aspheric_front")?, fields.list("aspheric_back")?],
        },
        "lathe" => {
            Shape::Lathe { profile: fields.points("profile")?, smooth: fields.flag("smooth")? }
        }
        "prism" => Shape::Prism {
            outline: fields.points("outline")?,
            depth: fields.number("depth")?,
            smooth: fields.flag("smooth")?,
        },
        "plane" => Shape::Plane { size: fields.numbers("size")? },
        "cylinder-mirror" => Shape::CylinderMirror {
            radius: fields.number("radius")?,
            size: fields.numbers("size")?,
            facing: facing()?,
        },
        "sphere-mirror" => Shape::SphereMirror {
            radius: fields.number("radius")?,
            diameter: fields.number("diameter")?,
            facing: facing()?,
        },
        "height-field" => {
            let amplitude = fields.number("amplitude")?;
            Shape::HeightField {
                source: match fields.text("file") {
                    Some(file) => HeightSource::File(PathBuf::from(file)),
                    None => HeightSource::Samples(fields.rows("samples")?),
                },
                size: fields.numbers("size")?,
                amplitude,
                depth: fields.number("depth").unwrap_or(amplitude),
            }
        }
        "mesh" => Shape::Mesh {
            file: PathBuf::from(fields.text("file")?),
            scale: fields.number("scale")?,
            unit: millimetres(fields.text("unit")?)?,
            smoothing: fields.integer("smoothing")?.try_into().ok()?,
            normals: match fields.text("normals")? {
                "auto" => Normals::Auto { crease_angle: fields.number("crease_angle")? },
                "smooth" => Normals::Smooth,
                "flat" => Normals::Flat,
                _ => return None,
            },
        },
        _ => return None,
    })
}
