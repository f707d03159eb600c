//! Vectors, frames, rectangles, shapes, meshes and their BVH.

mod convex;
mod extent;
mod frame;
mod height_field;
pub mod mesh;
mod mesh_surface;
mod outline;
mod ray;
mod real;
mod rectangle;
mod shape;
mod sheet;
mod vec3;

pub use convex::Convex;
pub use frame::Frame;
pub use height_field::HeightField;
pub use mesh_surface::{MeshSurface, Part};
pub use outline::{Fold, Outline};
pub use ray::{Crossing, Hit, Ray, Search};
pub use real::{Dual, Real};
pub use rectangle::Rectangle;
pub use shape::Shape;
pub use sheet::Sheet;
pub use vec3::Vec3;
