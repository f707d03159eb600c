//! The forward simulator: what the viewpoint sees.

mod camera;

pub use camera::Camera;
