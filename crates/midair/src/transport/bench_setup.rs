//! Set-ups for tests: the paper's plate and display around any elements.

use super::{Element, Matter, Setup};
use crate::geometry::{Convex, Frame, Rectangle, Shape, Vec3};
use crate::optics::emission::Emission;
use crate::optics::plate::Plate;
use crate::optics::screen::Screen;

pub(crate) const ACRYLIC: Matter = Matter::Refractive { index: 1.49, absorption: [0.0; 3] };

/// An image of `size` mm at the origin, a plate at 45 degrees 150 mm behind it, a viewer at 800 mm, and the display
/// where the image's mirror image lies.
pub(crate) fn setup(size: f64, elements: Vec<Element>) -> Setup {
    let plate = Rectangle {
        frame: Frame::new(Vec3::new(0.0, 0.0, -150.0), [-45.0, 0.0, 0.0]),
        size: [488.0; 2],
    };
    let image = Rectangle { frame: Frame::WORLD, size: [size; 2] };
    let origin = plate.mirrored(Vec3::ZERO);
    let up = plate.mirrored_direction(Vec3::new(0.0, 1.0, 0.0));
    let normal = -plate.mirrored_direction(Vec3::new(0.0, 0.0, 1.0));
    let normal = if (plate.frame.origin - origin).dot(normal) < 0.0 { -normal } else { normal };
    let frame = Frame { origin, axes: [up.cross(normal), up, normal] };
    Setup {
        viewpoint: Vec3::new(0.0, 0.0, 800.0),
        image,
        plate: Plate::ideal(plate),
        display: Rectangle { frame, size: [size; 2] },
        emission: Emission::Lambert,
        polarisation: None,
        screen: Screen::default(),
        wavelengths: [611.0, 549.0, 465.0],
        resolution: [256; 2],
        elements,
        max_interactions: 32,
        follow_total_reflection: false,
    }
}

/// A solid or sheet at a pose; ranks follow the order of the calls' `rank`.
pub(crate) fn element(
    shape: Shape,
    matter: Matter,
    position: [f64; 3],
    rotation: [f64; 3],
    rank: u8,
) -> Element {
    let frame = Frame::new(Vec3::from_array(position), rotation);
    Element {
        name: format!("element {rank}"),
        frame,
        shape,
        matter,
        index: None,
        rank,
        inside_of: None,
    }
}

pub(crate) fn sphere(radius: f64) -> Shape {
    Shape::Convex(Convex::Sphere { radius })
}

pub(crate) fn block(x: f64, y: f64, z: f64) -> Shape {
    Shape::Convex(Convex::Box { half: Vec3::new(0.5 * x, 0.5 * y, 0.5 * z) })
}

pub(crate) fn cylinder(radius: f64, height: f64) -> Shape {
    Shape::Convex(Convex::Frustum { middle_radius: radius, slope: 0.0, half_height: 0.5 * height })
}

pub(crate) fn cone(radius: f64, top_radius: f64, height: f64) -> Shape {
    Shape::Convex(Convex::Frustum {
        middle_radius: 0.5 * (radius + top_radius),
        slope: (top_radius - radius) / height,
        half_height: 0.5 * height,
    })
}
