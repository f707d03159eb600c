//! The closed set of forms that an element can have.

use super::{Convex, Crossing, Hit, Ray, Real, Search, Sheet, Vec3};

/// An element's form in its own frame.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A convex solid in closed form.
    Convex(Convex),
    /// An open sheet in closed form.
    Sheet(Sheet),
}

impl Shape {
    /// The first hit along a ray (in the shape's frame) that fits the search.
    pub fn nearest(&self, ray: &Ray, search: Search) -> Option<Hit> {
        match self {
            Self::Convex(convex) => convex.nearest(ray, search),
            Self::Sheet(sheet) => sheet.nearest(ray, search),
        }
    }

    /// Distance to a known face along a ray, and the unit normal there (outward for a solid, on the +z
    /// side for a sheet). The face is continued beyond its edges, smoothly.
    pub fn cross<T: Real>(&self, ray: &Ray<T>, face: u32, crossing: Crossing) -> (T, Vec3<T>) {
        match self {
            Self::Convex(convex) => convex.cross(ray, face, crossing),
            Self::Sheet(sheet) => sheet.cross(ray, crossing),
        }
    }

    /// Whether it encloses a volume.
    pub fn is_solid(&self) -> bool {
        match self {
            Self::Convex(_) => true,
            Self::Sheet(_) => false,
        }
    }

    /// Volume, mm^3; 0 for a sheet.
    pub fn volume(&self) -> f64 {
        match self {
            Self::Convex(convex) => convex.volume(),
            Self::Sheet(_) => 0.0,
        }
    }
}
