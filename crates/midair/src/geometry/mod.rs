//! Vectors, frames, rectangles, shapes, meshes and their BVH.

mod frame;
mod ray;
mod real;
mod rectangle;
mod vec3;

pub use frame::Frame;
pub use ray::{Crossing, Hit, Ray, Search};
pub use real::{Dual, Real};
pub use rectangle::Rectangle;
pub use vec3::Vec3;
