//! The micro-mirror array plate: what turns light from the display into an image in mid-air.
//!
//! A plate's own frame: its mid-plane is local z = 0, its normal local +z. Light may come from
//! either side.

mod belongs;
pub mod character;
mod ideal;
mod layer_planes;
mod luminance_table;
mod measured;
mod model;
mod shares;
pub mod slit_mirror;

pub use belongs::{display_place, floating_place, virtual_image};
pub use ideal::pass_ideal;
pub use layer_planes::LayerPlanes;
pub use luminance_table::{LuminanceTable, viewing_angles, viewing_direction};
pub use measured::Measured;
pub use model::{Model, Plate};
pub use shares::{Shares, luminance};
pub use slit_mirror::{Class, Passage, PlateError, SlitMirror, SlitMirrorPlate};
