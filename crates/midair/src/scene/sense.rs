//! What a scene's description alone shows to make no sense, though each key conforms.

use super::error::{SceneError, SceneText};
use super::grammar::SLIT_MIRROR_KEYS;
use super::load::Asset;
use super::model::*;
use super::section;
use crate::geometry::Vec3;
use crate::optics::plate::SlitMirrorPlate;
use std::f64::consts::TAU;

/// Everything that makes no sense. `assets` are the elements' files, in their order; it may be
/// short: what was not loaded is not judged.
pub(super) fn faults(scene: &Scene, source: &SceneText, assets: &[Asset]) -> Vec<SceneError> {
    let mut faults = Vec::new();
    plate_keys(scene, source, &mut faults);
    for (i, element) in scene.elements.iter().enumerate() {
        let key = format!("element[{i}]");
        material(element, &key, source, &mut faults);
        shape(element, &key, source, assets.get(i), &mut faults);
        section::faults(element, &key, source, &mut faults);
    }
    display(source, &mut faults);
    sides(scene, source, &mut faults);
    faults.extend(viewpoint_faults(scene, Vec3::from_array(scene.viewpoint), source, assets));
    faults
}

/// What makes no sense of an eye there: inside an element, or behind what it is to look at.
pub(super) fn viewpoint_faults(
    scene: &Scene,
    eye: Vec3,
    source: &SceneText,
    assets: &[Asset],
) -> Vec<SceneError> {
    let mut faults = Vec::new();
    for (i, element) in scene.elements.iter().enumerate() {
        if contains(&element.shape, element.pose.frame().to_local(eye), assets.get(i)) {
            faults.push(source.error_at(
                "viewpoint.position",
                format!("the viewpoint lies inside the element `{}`", element.name),
                "move the viewpoint outside of every element, or the element away from it",
            ));
        }
    }
    let image = scene.image.pose.frame();
    // NaN is on no side.
    if !(image.normal().dot(eye - image.origin) > 0.0) {
        let key =
            if source.has("image.rotation") { "image.rotation" } else { "viewpoint.position" };
        faults.push(source.error_at(
            key,
            "the image faces away from the viewpoint",
            "its front is its local +z: turn the image, or move the viewpoint to that side",
        ));
    }
    let plate = scene.plate.rectangle.pose.frame();
    let behind = plate.normal().dot(eye - plate.origin) <= 0.0;
    if behind && !has_mirrors(scene) && plate_faces_image(scene) {
        faults.push(source.error_at(
            "viewpoint.position",
            "the viewpoint lies behind the plate, on the display's side",
            "move the viewpoint to the side that the plate's local +z points to",
        ));
    }
    faults
}

fn has_mirrors(scene: &Scene) -> bool {
    scene.elements.iter().any(|e| matches!(e.material, Material::Mirror { .. }))
}

/// Behind a mirror the plate forms the image's mirror image. Bent mirrors have no exact one, so a
/// scene with mirrors is wrong only if the image itself is also on the wrong side.
fn plate_faces_image(scene: &Scene) -> bool {
    let plate = scene.plate.rectangle.pose.frame();
    let before = |p: Vec3| plate.normal().dot(p - plate.origin) > 0.0;
    before(scene.image.pose.frame().origin)
        || has_mirrors(scene) && before(scene.virtual_image().origin)
}

fn plate_keys(scene: &Scene, source: &SceneText, faults: &mut Vec<SceneError>) {
    if let PlateModel::SlitMirror(slit) = scene.plate.model {
        if let Err(error) = SlitMirrorPlate::new(slit) {
            faults.push(source.error_at(
                &format!("plate.{}", error.key),
                error.to_string(),
                format!("give {}", error.allowed),
            ));
        }
        return;
    }
    for name in SLIT_MIRROR_KEYS {
        let key = format!("plate.{name}");
        if source.has(&key) {
            faults.push(source.error_at(
                &key,
                format!("`{name}` has no meaning for an ideal plate"),
                "set model = \"slit-mirror\" in the plate, or leave the key out",
            ));
        }
    }
}

fn material(element: &Element, key: &str, source: &SceneText, faults: &mut Vec<SceneError>) {
    let outer = format!("{key}.absorption");
    let inner = format!("{key}.material.absorption");
    let reflectance = format!("{key}.material.reflectance");
    match &element.material {
        Material::Opaque => {
            for key in [&outer, &inner, &reflectance] {
                if source.has(key) {
                    let name = key.rsplit('.').next().unwrap_or_default();
                    faults.push(source.error_at(
                        key,
                        format!("`{name}` has no meaning for an opaque part"),
                        "leave the key out",
                    ));
                }
            }
        }
        Material::Mirror { .. } => {
            for key in [&outer, &inner] {
                if source.has(key) {
                    faults.push(source.error_at(
                        key,
                        "a mirror absorbs nothing per mm",
                        "leave `absorption` out; what a mirror loses is its `reflectance`",
                    ));
                }
            }
        }
        Material::Refractive { index, .. } => {
            if source.has(&outer) && source.has(&inner) {
                faults.push(source.error_at(
                    &outer,
                    "the absorption is given twice",
                    "keep it in the element or in its material",
                ));
            }
            if source.has(&reflectance) {
                faults.push(source.error_at(
                    &reflectance,
                    "`reflectance` has no meaning for a refractive solid",
                    "add mirror = true to the material, or leave the key out",
                ));
            }
            if let Index::Cauchy(a, b) = *index {
                // The ends of the visible, in micrometres; n is monotonous between them.
                let ends = [0.38, 0.78].map(|l: f64| a + b / (l * l));
                if ends.iter().any(|n| !(1.0..=5.0).contains(n)) {
                    faults.push(source.error_at(
                        &format!("{key}.material.cauchy"),
                        format!(
                            "`cauchy` gives indices of {:.3} to {:.3} over the visible",
                            ends[0], ends[1]
                        ),
                        "they lie between 1 and 5; B is in square micrometres, such as 0.004",
                    ));
                }
            }
            if is_sheet(&element.shape) {
                faults.push(source.error_at(
                    &format!("{key}.material"),
                    "a sheet has no inside that could refract",
                    "give it material = { mirror = true }, or a solid shape such as a box",
                ));
            }
        }
    }
}

/// Whether a shape is a reflective surface without an inside.
fn is_sheet(shape: &Shape) -> bool {
    matches!(shape, Shape::Plane { .. } | Shape::CylinderMirror { .. } | Shape::SphereMirror { .. })
}

fn shape(
    element: &Element,
    key: &str,
    source: &SceneText,
    asset: Option<&Asset>,
    faults: &mut Vec<SceneError>,
) {
    match &element.shape {
        Shape::CylinderMirror { radius, size, .. } if size[0] > TAU * radius => {
            faults.push(source.error_at(
                &format!("{key}.shape.size"),
                format!(
                    "an arc of {} mm goes more than once round a radius of {radius} mm",
                    size[0]
                ),
                format!("size[0] is the arc length: at most {:.3}", TAU * radius),
            ));
        }
        Shape::SphereMirror { radius, diameter, .. } if *diameter > 2.0 * radius => {
            faults.push(source.error_at(
                &format!("{key}.shape.diameter"),
                format!("a cap of a sphere of radius {radius} mm cannot be {diameter} mm wide"),
                format!("the diameter is at most {}", 2.0 * radius),
            ));
        }
        Shape::HeightField { source: samples, amplitude, depth, .. }
            if matches!(element.material, Material::Refractive { .. }) =>
        {
            let lowest = heights(samples, asset)
                .map(|rows| rows.iter().flatten().fold(f64::INFINITY, |l, &s| l.min(s)));
            if let Some(lowest) = lowest
                && lowest * amplitude <= -depth
            {
                faults.push(source.error_at(
                    &format!("{key}.shape.depth"),
                    format!(
                        "the surface reaches down to {} mm, the solid's bottom lies at -{depth} mm",
                        lowest * amplitude
                    ),
                    format!("give a depth of more than {}", -lowest * amplitude),
                ));
            }
        }
        _ => {}
    }
}

fn heights<'a>(source: &'a HeightSource, asset: Option<&'a Asset>) -> Option<&'a [Vec<f64>]> {
    match (source, asset) {
        (HeightSource::Samples(rows), _) => Some(rows),
        (HeightSource::File(_), Some(Asset::Heights(heights))) => Some(heights.rows()),
        _ => None,
    }
}

/// Whether a point in the shape's own frame lies in it or on its surface; false for sheets, and
/// for files that were not loaded.
fn contains(shape: &Shape, p: Vec3, asset: Option<&Asset>) -> bool {
    match shape {
        Shape::Sphere { radius } => p.length() <= *radius,
        Shape::Ellipsoid { radii: [a, b, c] } => {
            Vec3::new(p.x / a, p.y / b, p.z / c).length() <= 1.0
        }
        Shape::Box { size } => p.to_array().iter().zip(size).all(|(x, edge)| x.abs() <= edge / 2.0),
        Shape::Cylinder { radius, height } => {
            p.x.hypot(p.z) <= *radius && p.y.abs() <= height / 2.0
        }
        Shape::Cone { radius, top_radius, height } => {
            let up = p.y / height + 0.5;
            (0.0..=1.0).contains(&up) && p.x.hypot(p.z) <= radius + (top_radius - radius) * up
        }
        Shape::HeightField { source, size, amplitude, depth } => {
            let inside = p.x.abs() <= size[0] / 2.0 && p.y.abs() <= size[1] / 2.0;
            inside
                && p.z >= -depth
                && heights(source, asset).is_some_and(|rows| {
                    let [s, t] = [p.x / size[0] + 0.5, 0.5 - p.y / size[1]];
                    p.z <= amplitude * bilinear(rows, s, t)
                })
        }
        Shape::Mesh { .. } => match asset {
            Some(Asset::Mesh { mesh, .. }) => mesh.contains(p),
            _ => false,
        },
        Shape::Hemisphere { .. }
        | Shape::Torus { .. }
        | Shape::Lens { .. }
        | Shape::Lathe { .. }
        | Shape::Prism { .. } => section::contains(shape, p),
        Shape::Plane { .. } | Shape::CylinderMirror { .. } | Shape::SphereMirror { .. } => false,
    }
}

/// The sample at fractions s from the left and t from the top; outermost samples lie on the
/// rectangle's edges. NaN without samples.
fn bilinear(rows: &[Vec<f64>], s: f64, t: f64) -> f64 {
    let (Some(last_row), Some(last_column)) =
        (rows.len().checked_sub(1), rows.first().and_then(|r| r.len().checked_sub(1)))
    else {
        return f64::NAN;
    };
    let [x, y] = [s * last_column as f64, t * last_row as f64];
    let (column, row) = (x.floor() as usize, y.floor() as usize);
    let at = |r: usize, c: usize| rows[r.min(last_row)][c.min(last_column)];
    let [fx, fy] = [x - x.floor(), y - y.floor()];
    (at(row, column) * (1.0 - fx) + at(row, column + 1) * fx) * (1.0 - fy)
        + (at(row + 1, column) * (1.0 - fx) + at(row + 1, column + 1) * fx) * fy
}

/// What a display cannot be at once.
fn display(source: &SceneText, faults: &mut Vec<SceneError>) {
    let measures = ["display.size", "display.ppi", "display.diagonal_inches"];
    let mut given = measures.into_iter().filter(|key| source.has(key));
    if let (Some(first), Some(second)) = (given.next(), given.next()) {
        let name = |key: &str| key.trim_start_matches("display.").to_owned();
        faults.push(source.error_at(
            second,
            format!(
                "the display's size is given more than once: by `{}` and `{}`",
                name(first),
                name(second)
            ),
            "keep one of them: `size` if it was measured",
        ));
    }
    if source.has("display.gamma") && source.has("display.response") {
        faults.push(source.error_at(
            "display.gamma",
            "the display has both a gamma and a measured response",
            "keep the one that describes it",
        ));
    }
}

/// Who faces whom: the plate the image, the display behind the plate.
fn sides(scene: &Scene, source: &SceneText, faults: &mut Vec<SceneError>) {
    let plate = scene.plate.rectangle.pose.frame();
    let before_plate = |p: Vec3| plate.normal().dot(p - plate.origin);
    if !plate_faces_image(scene) {
        let [x, y, z] = scene.plate.rectangle.pose.rotation;
        let turned = if y == 0.0 && z == 0.0 {
            let x = if x > 0.0 { x - 180.0 } else { x + 180.0 };
            format!(", for instance rotation = [{x:?}, 0.0, 0.0]")
        } else {
            String::new()
        };
        faults.push(source.error_at(
            "plate.rotation",
            "the plate faces away from the image",
            format!(
                "its front is its local +z: turn the plate by 180 degrees{turned}, or move it \
                 behind the image"
            ),
        ));
        return;
    }
    if let Some(pose) = scene.display.pose
        && before_plate(Vec3::from_array(pose.position)) >= 0.0
    {
        faults.push(source.error_at(
            "display.position",
            "the display lies on the same side of the plate as the image",
            "move it behind the plate, or leave its position and rotation out: it then stands \
             where it belongs",
        ));
    }
}
