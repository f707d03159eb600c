//! Vectors, frames, rectangles, shapes, meshes and their BVH.

mod frame;
pub mod mesh;
mod real;
mod vec3;

pub use frame::Frame;
pub use real::{Dual, Real};
pub use vec3::Vec3;
