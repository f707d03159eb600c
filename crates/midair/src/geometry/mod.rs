//! Vectors, frames, rectangles, shapes, meshes and their BVH.
//!
//! A shape answers two questions: what does a ray meet first, and where does it cross a known face?
//!
//! ```
//! use midair::geometry::{Convex, Crossing, Ray, Search, Shape, Vec3};
//!
//! let ball = Shape::Convex(Convex::Sphere { radius: 25.0 });
//! let ray = Ray { origin: Vec3::new(0.0, 0.0, 800.0), direction: Vec3::new(0.0, 0.0, -1.0) };
//! let outside = Search { crossing: Some(Crossing::Enter), after: 0.0, standing_on: None };
//! let hit = ball.nearest(&ray, outside).expect("the ball is in the way");
//! let (distance, normal) = ball.cross(&ray, hit.face, hit.crossing);
//! assert_eq!((distance, normal.z), (775.0, 1.0));
//! ```

mod convex;
mod extent;
mod frame;
mod height_field;
pub mod mesh;
mod mesh_surface;
mod outline;
pub mod profile;
mod ray;
mod real;
mod rectangle;
mod roots;
mod shape;
mod sheet;
mod swept;
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
pub use swept::{Sweep, Swept};
pub use vec3::Vec3;
