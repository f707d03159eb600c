//! Where things stand: poses as frames, and the display's place when the file leaves it out.

use super::model::{Material, PlateModel, Pose, Rectangle, Scene};
use crate::geometry::{self, Frame, Vec3};
use crate::optics::plate::{LayerPlanes, display_place, virtual_image};

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
    /// were flat and the solids absent (see [`display_place`]). Its size, left out, is the image's.
    pub fn display_rectangle(&self) -> geometry::Rectangle {
        let size = self.display.size.unwrap_or(self.image.size);
        if let Some(pose) = self.display.pose {
            return geometry::Rectangle { frame: pose.frame(), size };
        }
        let plate = self.plate.rectangle.pose.frame();
        let layers = match &self.plate.model {
            PlateModel::Ideal => None,
            PlateModel::SlitMirror(plate) => Some(LayerPlanes::new(plate)),
        };
        let (image, mirrors) = (self.image.pose.frame(), self.mirrors());
        display_place(image, &mirrors, &plate, layers.as_ref(), self.eye(), size)
    }

    /// What the plate would have to form if the mirrors were flat.
    pub(super) fn virtual_image(&self) -> Frame {
        virtual_image(self.image.pose.frame(), &self.mirrors(), self.eye())
    }

    fn eye(&self) -> Vec3 {
        Vec3::from_array(self.viewpoint)
    }

    fn mirrors(&self) -> Vec<Frame> {
        let mirrors =
            self.elements.iter().filter(|e| matches!(e.material, Material::Mirror { .. }));
        mirrors.map(|e| e.pose.frame()).collect()
    }
}
