//! Writing a scene.

use super::model::*;
use super::tree::UNITS;
use std::fmt::Write;

/// The scene as a TOML file that [`super::parse`] reads back as the same scene.
///
/// A mesh whose unit is none of the file's named ones is written in millimetres with the unit
/// multiplied into its scale.
pub fn to_toml(scene: &Scene) -> String {
    let mut out = String::new();
    write_scene(&mut out, scene).expect("writing to a string does not fail");
    out
}

fn write_scene(out: &mut String, scene: &Scene) -> std::fmt::Result {
    writeln!(out, "name = {}", text(&scene.name))?;
    writeln!(out, "max_interactions = {}", scene.max_interactions)?;
    writeln!(out, "follow_total_reflection = {}", scene.follow_total_reflection)?;
    writeln!(out, "\n[viewpoint]\nposition = {:?}", scene.viewpoint)?;
    writeln!(out, "\n[image]\n{}", rectangle(&scene.image))?;
    writeln!(out, "\n[plate]\n{}", rectangle(&scene.plate.rectangle))?;
    match scene.plate.model {
        PlateModel::Ideal => writeln!(out, "model = \"ideal\"")?,
        PlateModel::SlitMirror(slit) => writeln!(
            out,
            "model = \"slit-mirror\"\npitch = {:?}\nlayer_depth = {:?}\nazimuth = {:?}\n\
             reflectance = {:?}\nior = {:?}\ncover_glass = {:?}\nglass_absorption = {:?}\n\
             mirror_thickness = {:?}",
            slit.pitch,
            slit.layer_depth,
            slit.azimuth,
            slit.reflectance,
            slit.ior,
            slit.cover_glass,
            slit.absorption,
            slit.mirror_thickness,
        )?,
    }
    if let Some(file) = &scene.plate.luminance {
        writeln!(out, "luminance = {}", text(&file.to_string_lossy()))?;
    }
    writeln!(out, "\n[display]\nresolution = {:?}", scene.display.resolution)?;
    if let Some(pose) = scene.display.pose {
        writeln!(out, "{}", pose_keys(&pose))?;
    }
    if let Some(size) = scene.display.size {
        writeln!(out, "size = {size:?}")?;
    }
    writeln!(out, "wavelengths = {:?}", scene.display.wavelengths)?;
    match &scene.display.response {
        ResponseSource::Srgb => {}
        ResponseSource::Gamma(gamma) => writeln!(out, "gamma = {gamma:?}")?,
        ResponseSource::File(file) => {
            writeln!(out, "response = {}", text(&file.to_string_lossy()))?;
        }
    }
    if let Some(file) = &scene.display.emission {
        writeln!(out, "emission = {}", text(&file.to_string_lossy()))?;
    }
    if let Some(polarisation) = scene.display.polarisation {
        writeln!(out, "polarisation = {polarisation:?}")?;
    }
    if let Some(black) = scene.display.black {
        writeln!(out, "black = {black:?}")?;
    }
    if let Some(bits) = scene.display.bits {
        writeln!(out, "bits = {bits}")?;
    }
    if let Some(tracker) = &scene.tracker {
        writeln!(out, "\n[tracker]\n{}\noffset = {:?}", pose_keys(&tracker.pose), tracker.offset)?;
    }
    for element in &scene.elements {
        writeln!(out, "\n[[element]]\nname = {}", text(&element.name))?;
        writeln!(out, "shape = {{ {} }}", shape(&element.shape))?;
        writeln!(out, "{}", pose_keys(&element.pose))?;
        writeln!(out, "material = {{ {} }}", material(&element.material))?;
        if let Some(priority) = element.priority {
            writeln!(out, "priority = {priority}")?;
        }
        if let Some(hollow) = &element.hollow {
            write_hollow(out, hollow)?;
        }
    }
    Ok(())
}

fn write_hollow(out: &mut String, hollow: &Hollow) -> std::fmt::Result {
    writeln!(out, "wall = {:?}\nopen = {}", hollow.wall, hollow.open)?;
    let Some(fill) = &hollow.fill else { return Ok(()) };
    let height = fill.height.map_or(String::new(), |height| format!("height = {height:?}, "));
    let matter = index(&fill.index);
    writeln!(out, "fill = {{ {height}{matter}, absorption = {:?} }}", fill.absorption)
}

/// Debug formatting of floats is the shortest text that reads back as the same number, and is
/// TOML.
fn pose_keys(pose: &Pose) -> String {
    format!("position = {:?}\nrotation = {:?}", pose.position, pose.rotation)
}

fn rectangle(rectangle: &Rectangle) -> String {
    format!("{}\nsize = {:?}", pose_keys(&rectangle.pose), rectangle.size)
}

fn shape(shape: &Shape) -> String {
    match shape {
        Shape::Sphere { radius } => format!("kind = \"sphere\", radius = {radius:?}"),
        Shape::Ellipsoid { radii } => format!("kind = \"ellipsoid\", radii = {radii:?}"),
        Shape::Box { size } => format!("kind = \"box\", size = {size:?}"),
        Shape::Cylinder { radius, height } => {
            format!("kind = \"cylinder\", radius = {radius:?}, height = {height:?}")
        }
        Shape::Cone { radius, top_radius, height } => format!(
            "kind = \"cone\", radius = {radius:?}, top_radius = {top_radius:?}, \
             height = {height:?}"
        ),
        Shape::Hemisphere { radius } => format!("kind = \"hemisphere\", radius = {radius:?}"),
        Shape::Torus { radius, tube } => {
            format!("kind = \"torus\", radius = {radius:?}, tube = {tube:?}")
        }
        Shape::Lens { radii, thickness, diameter, conic, aspheric: [front, back] } => format!(
            "kind = \"lens\", radii = {radii:?}, thickness = {thickness:?}, diameter = {diameter:?}, \
             conic = {conic:?}, aspheric_front = {front:?}, aspheric_back = {back:?}"
        ),
        Shape::Lathe { profile, smooth } => {
            format!("kind = \"lathe\", profile = {profile:?}, smooth = {smooth}")
        }
        Shape::Prism { outline, depth, smooth } => {
            format!("kind = \"prism\", outline = {outline:?}, depth = {depth:?}, smooth = {smooth}")
        }
        Shape::Plane { size } => format!("kind = \"plane\", size = {size:?}"),
        Shape::CylinderMirror { radius, size, facing } => format!(
            "kind = \"cylinder-mirror\", radius = {radius:?}, size = {size:?}, facing = {}",
            facing_name(*facing)
        ),
        Shape::SphereMirror { radius, diameter, facing } => format!(
            "kind = \"sphere-mirror\", radius = {radius:?}, diameter = {diameter:?}, facing = {}",
            facing_name(*facing)
        ),
        Shape::HeightField { source, size, amplitude, depth } => {
            let source = match source {
                HeightSource::File(file) => format!("file = {}", text(&file.to_string_lossy())),
                HeightSource::Samples(rows) => format!("samples = {rows:?}"),
            };
            format!(
                "kind = \"height-field\", {source}, size = {size:?}, amplitude = {amplitude:?}, \
                 depth = {depth:?}"
            )
        }
        Shape::Mesh { file, scale, unit, smoothing, normals } => {
            let named = UNITS.iter().find(|(_, factor)| factor == unit);
            let (scale, unit) = named.map_or((scale * unit, "mm"), |(name, _)| (*scale, name));
            let normals = match normals {
                Normals::Auto { crease_angle } => {
                    format!("\"auto\", crease_angle = {crease_angle:?}")
                }
                Normals::Smooth => "\"smooth\"".to_owned(),
                Normals::Flat => "\"flat\"".to_owned(),
            };
            format!(
                "kind = \"mesh\", file = {}, scale = {scale:?}, unit = \"{unit}\", \
                 smoothing = {smoothing}, normals = {normals}",
                text(&file.to_string_lossy())
            )
        }
    }
}

fn facing_name(facing: Facing) -> &'static str {
    match facing {
        Facing::Convex => "\"convex\"",
        Facing::Concave => "\"concave\"",
    }
}

fn material(material: &Material) -> String {
    match material {
        Material::Opaque => "opaque = true".to_owned(),
        Material::Mirror { reflectance } => {
            format!("mirror = true, reflectance = {reflectance:?}")
        }
        Material::Refractive { index: law, absorption } => match absorption {
            Some(absorption) => format!("{}, absorption = {absorption:?}", index(law)),
            None => index(law),
        },
    }
}

fn index(index: &Index) -> String {
    match index {
        Index::Constant(ior) => format!("ior = {ior:?}"),
        Index::Cauchy(a, b) => format!("cauchy = [{a:?}, {b:?}]"),
        Index::Glass(name) => format!("glass = {}", text(name)),
        Index::File(file) => format!("file = {}", text(&file.to_string_lossy())),
    }
}

/// A TOML basic string.
fn text(value: &str) -> String {
    let mut out = String::from("\"");
    for c in value.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
