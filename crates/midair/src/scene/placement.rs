//! Where things stand: poses as frames, and the display's place when the file leaves it out.

use super::model::{Material, Pose, Rectangle, Scene};
use crate::geometry::{self, Frame, Vec3};

impl Pose {
    /// The pose as a frame in the world.
    pub fn frame(&self) -> Frame {
        Frame::new(Vec3::from_array(self.position), self.rotation)
    }
}

impl Rectangle {
    /// The rectangle in the world.
    pub fn placed(&self) -> geometry::Rectangle {
        geometry::Rectangle { frame: self.pose.frame(), size: self.size }
    }
}

impl Scene {
    /// The display in the world: where the file says, else where it would belong if the mirrors
    /// were flat and the solids absent.
    ///
    /// That place is the image's centre and y axis mirrored in each reflective element's tangent
    /// plane at its position (local z = 0), nearest the viewer first, then in the plate; the
    /// normal likewise, turned to face the plate's centre; x = y cross normal. With no element
    /// every pixel st then shows at image uv = st. Its size, left out, is the image's.
    pub fn display_rectangle(&self) -> geometry::Rectangle {
        let size = self.display.size.unwrap_or(self.image.size);
        if let Some(pose) = self.display.pose {
            return geometry::Rectangle { frame: pose.frame(), size };
        }
        let plate = self.plate.rectangle.pose.frame();
        let image = mirrored(&plate, self.virtual_image());
        let [_, up, normal] = image.axes;
        let facing = normal.dot(plate.origin - image.origin);
        let normal = if facing < 0.0 { -normal } else { normal };
        geometry::Rectangle {
            frame: Frame { origin: image.origin, axes: [up.cross(normal), up, normal] },
            size,
        }
    }

    /// The image's frame mirrored in each reflective element's tangent plane, nearest the viewer
    /// first: what the plate would have to form if the mirrors were flat.
    ///
    /// The frame is left-handed after an odd number of mirrors.
    pub(super) fn virtual_image(&self) -> Frame {
        let viewpoint = Vec3::from_array(self.viewpoint);
        let mut mirrors: Vec<Frame> = self
            .elements
            .iter()
            .filter(|e| matches!(e.material, Material::Mirror { .. }))
            .map(|e| e.pose.frame())
            .collect();
        mirrors.sort_by(|a, b| {
            let [a, b] = [a, b].map(|m| (m.origin - viewpoint).squared_length());
            a.total_cmp(&b)
        });
        mirrors.iter().fold(self.image.pose.frame(), |image, mirror| mirrored(mirror, image))
    }
}

/// `frame` mirrored in the plane z = 0 of `mirror`.
fn mirrored(mirror: &Frame, frame: Frame) -> Frame {
    let normal = mirror.normal();
    let flip = |v: Vec3| v - normal * (2.0 * v.dot(normal));
    Frame { origin: mirror.origin + flip(frame.origin - mirror.origin), axes: frame.axes.map(flip) }
}
