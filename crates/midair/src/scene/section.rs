//! The sections of solids that a profile sweeps, and what is inside of hollow ones.

use super::error::{SceneError, SceneText};
use super::model::{Element, Hollow, Index, Material, Shape};
use crate::geometry::profile::{Piece, Point, Profile, ProfileError, Sag, smooth};
use crate::geometry::{Sweep, Swept, Vec3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The solid of a shape that a profile sweeps; `None` for every other shape.
pub(crate) fn swept(shape: &Shape) -> Option<Result<Swept, ProfileError>> {
    let own = matches!(
        shape,
        Shape::Hemisphere { .. }
            | Shape::Torus { .. }
            | Shape::Lens { .. }
            | Shape::Lathe { .. }
            | Shape::Prism { .. }
    );
    own.then(|| section(shape).map(|section| section.map(|(p, sweep)| Swept::new(p, sweep))))?
}

/// What is inside of a hollow element, the outermost first; in the element's frame.
pub(crate) struct Inside {
    /// What people call it.
    pub name: String,
    /// Its form.
    pub solid: Swept,
    /// Its refractive index by wavelength.
    pub index: Index,
    /// Absorption per mm by linear R, G, B.
    pub absorption: [f64; 3],
}

/// What is inside of an element; nothing if it is solid.
///
/// # Errors
/// When no such inside can be made.
pub(crate) fn insides(element: &Element) -> Result<Vec<Inside>, ProfileError> {
    let Some(Hollow { wall, open, fill }) = &element.hollow else { return Ok(Vec::new()) };
    let Some(section) = section(&element.shape) else { return Ok(Vec::new()) };
    let (outer, sweep) = section?;
    let turned = !matches!(sweep, Sweep::AlongZ(_));
    let cavity = outer.inside(*wall, turned, *open)?;
    let sweep = match sweep {
        Sweep::AlongZ(half) if half <= *wall => {
            return Err(ProfileError::WallTooThick {
                wall: *wall,
                near: outer.pieces()[0].middle(),
            });
        }
        Sweep::AlongZ(half) => Sweep::AlongZ(half - wall),
        turned => turned,
    };
    let [low, high] = cavity.bounds();
    let liquid = match fill {
        Some(fill) => {
            let level = fill.height.map_or(high[1], |height| low[1] + height);
            Some((cavity.below(level)?, fill))
        }
        None => None,
    };
    let mut insides = vec![Inside {
        name: format!("{} (air inside)", element.name),
        solid: Swept::new(cavity, sweep),
        index: Index::Constant(1.0),
        absorption: [0.0; 3],
    }];
    if let Some((profile, fill)) = liquid {
        insides.push(Inside {
            name: format!("{} (fill)", element.name),
            solid: Swept::new(profile, sweep),
            index: fill.index.clone(),
            absorption: fill.absorption,
        });
    }
    Ok(insides)
}

/// The section of a shape that can be hollow; `None` for the others.
fn section(shape: &Shape) -> Option<Result<(Profile, Sweep), ProfileError>> {
    let about_y = |profile: Result<Profile, ProfileError>| profile.map(|p| (p, Sweep::AboutY));
    let line = |from: Point, to: Point| Piece::Line { from, to };
    let about =
        |centre: Point, radius: f64, from: f64, to: f64| Piece::Arc { centre, radius, from, to };
    Some(match shape {
        Shape::Sphere { radius } => {
            about_y(Profile::turned(vec![about([0.0; 2], *radius, -FRAC_PI_2, FRAC_PI_2)]))
        }
        Shape::Hemisphere { radius } => {
            about_y(Profile::turned(vec![about([0.0; 2], *radius, 0.0, FRAC_PI_2)]))
        }
        Shape::Torus { radius, tube } => {
            about_y(Profile::turned(vec![about([*radius, 0.0], *tube, 0.0, TAU)]))
        }
        Shape::Cylinder { radius, height } => {
            let h = 0.5 * height;
            about_y(Profile::turned(vec![line([*radius, -h], [*radius, h])]))
        }
        Shape::Cone { radius, top_radius, height } => {
            let h = 0.5 * height;
            about_y(Profile::turned(vec![line([*radius, -h], [*top_radius, h])]))
        }
        Shape::Box { size: [x, y, z] } => {
            let corners = [[-x, -y], [*x, -y], [*x, *y], [-x, *y]].map(|c| c.map(|c| 0.5 * c));
            Profile::new(closed(&corners)).map(|p| (p, Sweep::AlongZ(0.5 * z)))
        }
        Shape::Lens { .. } => lens(shape).map(|p| (p, Sweep::AboutZ)),
        Shape::Lathe { profile, smooth: true } => about_y(Profile::turned(smooth(profile, true))),
        Shape::Lathe { profile, smooth: false } => {
            let lines = profile.windows(2).map(|pair| line(pair[0], pair[1])).collect();
            about_y(Profile::turned(lines))
        }
        Shape::Prism { outline, depth, smooth: bent } => {
            let pieces = if *bent {
                let mut points = outline.clone();
                points.extend(outline.first().copied());
                smooth(&points, false)
            } else {
                closed(outline)
            };
            Profile::new(pieces).map(|p| (p, Sweep::AlongZ(0.5 * depth)))
        }
        _ => return None,
    })
}

/// Straight lines around.
fn closed(points: &[Point]) -> Vec<Piece> {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(&from, &to)| Piece::Line { from, to }).collect()
}

/// The surfaces of a lens of this half diameter, that on the +z side first.
fn sags(
    radii: [f64; 2],
    thickness: f64,
    rim: f64,
    conic: [f64; 2],
    aspheric: &[Vec<f64>; 2],
) -> [Sag; 2] {
    [(0, 1.0), (1, -1.0)].map(|(k, side)| Sag {
        vertex: side * 0.5 * thickness,
        side,
        curvature: if radii[k] == 0.0 { 0.0 } else { radii[k].recip() },
        conic: conic[k],
        terms: aspheric[k].clone(),
        reach: rim,
    })
}

fn lens(shape: &Shape) -> Result<Profile, ProfileError> {
    let Shape::Lens { radii, thickness, diameter, conic, aspheric } = shape else {
        return Err(ProfileError::Empty);
    };
    let rim = 0.5 * diameter;
    let [front, back] = sags(*radii, *thickness, rim, *conic, aspheric);
    let surface = |k: usize, sag: Sag| {
        let Sag { vertex, side, curvature, .. } = sag;
        let height = sag.height(rim);
        let spherical = conic[k] == 0.0 && aspheric[k].iter().all(|&a| a == 0.0);
        let (on_axis, at_rim) = ([0.0, vertex], [rim, height]);
        let (from, to) = if k == 0 { (at_rim, on_axis) } else { (on_axis, at_rim) };
        let piece = if !spherical {
            Piece::Sag(sag)
        } else if curvature == 0.0 {
            Piece::Line { from, to }
        } else {
            let centre = [0.0, vertex - side * radii[k]];
            Piece::arc(centre, radii[k].abs(), from, to, radii[k] > 0.0)
        };
        (piece, height)
    };
    let ((front, top), (back, bottom)) = (surface(0, front), surface(1, back));
    if !(top >= bottom) {
        return Err(ProfileError::Empty);
    }
    let edge = Piece::Line { from: [rim, bottom], to: [rim, top] };
    let axis = Piece::Line { from: [0.0, 0.5 * thickness], to: [0.0, -0.5 * thickness] };
    Profile::new(vec![back, edge, front, axis])
}

/// What makes no sense about a swept or hollow element.
pub(super) fn faults(
    element: &Element,
    key: &str,
    source: &SceneText,
    faults: &mut Vec<SceneError>,
) {
    let shape_key = |name: &str| format!("{key}.shape.{name}");
    match &element.shape {
        Shape::Torus { radius, tube } if tube >= radius => {
            faults.push(source.error_at(
                &shape_key("tube"),
                format!("a tube of {tube} mm about a ring of {radius} mm leaves no hole"),
                format!("give a tube of less than {radius}"),
            ));
            return;
        }
        Shape::Lens { .. } => {
            if let Some((name, message, help)) = lens_fault(&element.shape) {
                faults.push(source.error_at(&shape_key(name), message, help));
                return;
            }
        }
        Shape::Lathe { profile, .. } => {
            if let Some(p) = profile.iter().find(|p| p[0] < 0.0) {
                faults.push(source.error_at(
                    &shape_key("profile"),
                    format!("the profile's point {p:?} lies beyond the axis"),
                    "the first number of each point is its distance from the axis: 0 or more",
                ));
                return;
            }
        }
        _ => {}
    }
    if let Some(Err(error)) = swept(&element.shape) {
        let name = match element.shape {
            Shape::Lathe { .. } => "profile",
            Shape::Prism { .. } => "outline",
            _ => "kind",
        };
        let help = match error {
            ProfileError::CrossesAxis(_) => {
                "move the points near there away from the axis, or give one of them twice: a corner"
            }
            ProfileError::CrossesItself(_) => {
                "give its points in their order along it; with smooth = true also more of them where it bends most"
            }
            _ => "give points that lie not all on one line",
        };
        let whole = format!("the {name} makes no solid: {error}");
        faults.push(source.error_at(&shape_key(name), whole, help));
        return;
    }
    hollow_faults(element, key, source, faults);
}

/// Which key, what is wrong, and what helps.
fn lens_fault(shape: &Shape) -> Option<(&'static str, String, String)> {
    let Shape::Lens { radii, thickness, diameter, conic, aspheric } = shape else { return None };
    let rim = 0.5 * diameter;
    let sags = sags(*radii, *thickness, rim, *conic, aspheric);
    for k in 0..2 {
        let limit = (1.0 + conic[k]) * sags[k].curvature.powi(2);
        if limit > 0.0 && limit * rim * rim > 1.0 {
            let most = 2.0 / limit.sqrt();
            return Some((
                "radii",
                format!("a surface of radius {} mm cannot be {diameter} mm wide", radii[k]),
                format!("give a diameter of at most {most:.3}, or a larger radius"),
            ));
        }
    }
    // How thick it is from the axis to the rim.
    let room = |r: f64| thickness - sags[0].at(r * r) - sags[1].at(r * r);
    const PLACES: usize = 64;
    let least = (0..=PLACES)
        .map(|k| rim * k as f64 / PLACES as f64)
        .map(|r| (r, room(r)))
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    (least.1 < 0.0).then(|| {
        (
            "thickness",
            format!(
                "its two surfaces meet: {:.3} mm from the axis the lens is {:.3} mm thick",
                least.0, least.1
            ),
            format!(
                "give a thickness of at least {:.3}, or a smaller diameter",
                thickness - least.1
            ),
        )
    })
}

fn hollow_faults(element: &Element, key: &str, source: &SceneText, faults: &mut Vec<SceneError>) {
    let at = |name: &str| format!("{key}.{name}");
    let Some(Hollow { wall, open, fill }) = &element.hollow else {
        for name in ["open", "fill"] {
            if source.has(&at(name)) {
                faults.push(source.error_at(
                    &at(name),
                    format!("`{name}` has no meaning for a solid element"),
                    "give its wall as well, such as wall = 2.0, or leave the key out",
                ));
            }
        }
        return;
    };
    let mut fault = |name: &str, message: String, help: &str| {
        faults.push(source.error_at(&at(name), message, help));
    };
    if !matches!(element.material, Material::Refractive { .. }) {
        return fault("wall", "it has no inside that light reaches".to_owned(), "leave `wall` out");
    }
    if section(&element.shape).is_none() {
        return fault(
            "wall",
            "the inside of this shape cannot be made at an even distance".to_owned(),
            "describe the inside as an element of its own (ior = 1.0 for air), with a higher priority",
        );
    }
    let upright = element.pose.frame().axes[1].y > 1.0 - 1e-9;
    if let Some(height) = fill.as_ref().and_then(|fill| fill.height)
        && (!upright || matches!(element.shape, Shape::Lens { .. }))
    {
        return fault(
            "fill.height",
            format!("a liquid {height} mm high stands level, this element does not stand upright"),
            "turn the element about its y axis only, or leave `height` out: the liquid then fills it",
        );
    }
    if *open && matches!(element.shape, Shape::Lens { .. }) {
        return fault("open", "a lens has no top".to_owned(), "leave `open` out");
    }
    if let Err(error) = insides(element) {
        let (name, help) = match error {
            ProfileError::NoTop => {
                ("open", "leave `open` out, or end the profile in a flat top".to_owned())
            }
            ProfileError::NoLiquid => ("fill.height", "give more than 0 mm".to_owned()),
            ProfileError::Aspheric => (
                "wall",
                "describe the inside as a lens of its own, with a higher priority".to_owned(),
            ),
            _ => ("wall", format!("give a wall of less than {wall} mm, or a rounder shape")),
        };
        fault(name, error.to_string(), &help);
    }
}

/// Whether a point in its own frame lies in a swept shape.
pub(super) fn contains(shape: &Shape, p: Vec3) -> bool {
    match swept(shape) {
        Some(Ok(solid)) => crate::geometry::Shape::Swept(solid.into()).contains(p),
        _ => false,
    }
}
