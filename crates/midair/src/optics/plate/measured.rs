//! A plate whose image is as bright as it was measured.

use super::{LuminanceTable, Model, viewing_angles, viewing_direction};
use crate::geometry::{Frame, Vec3};

/// A plate model with a measured luminance of its mid-air image.
///
/// The table says how luminance goes with the direction in which light leaves the plate, as azimuth and
/// elevation in the image's frame; far outside of its grid ([`LuminanceTable::value`]) the image is dark. Its unit is unknown, so its brightest direction is
/// taken to be as bright as the model says there. Where light goes, and stray light, stay the model's.
#[derive(Clone, Debug)]
pub struct Measured {
    model: Model,
    table: LuminanceTable,
    /// The image's efficiency in the table's brightest direction, as the model has it.
    most: f64,
    /// Frames that directions are told in.
    image: Frame,
    plate: Frame,
}

impl Measured {
    /// A model with a table; the frames are the image's and the plate's.
    pub fn new(model: Model, table: LuminanceTable, image: &Frame, plate: &Frame) -> Self {
        let (image, plate) = (*image, *plate);
        let brightest = image.to_world_direction(viewing_direction(table.brightest()));
        let most = model.efficiency(plate.to_local_direction(brightest));
        Self { model, table, most, image, plate }
    }

    /// The model that it is based on.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Luminance of the image over the display's, for light that leaves the plate along `direction` (unit, in
    /// the plate's frame).
    pub fn efficiency(&self, direction: Vec3) -> f64 {
        let towards_viewer = self.plate.to_world_direction(direction);
        let angles = viewing_angles(self.image.to_local_direction(towards_viewer));
        self.table.relative(angles).unwrap_or(0.0) * self.most
    }

    /// What the model's weight of real light is multiplied by, so that on the average over the lattice the image is as
    /// bright as the table says. 0 where the model has no real light that could be scaled.
    pub(super) fn correction(&self, direction: Vec3) -> f64 {
        let modelled = self.model.efficiency(direction);
        if modelled > 0.0 { self.efficiency(direction) / modelled } else { 0.0 }
    }
}
