//! The closed set of forms that an element can have.

use super::{
    Convex, Crossing, HeightField, Hit, MeshSurface, Part, Ray, Real, Search, Sheet, Swept, Vec3,
};
use std::sync::Arc;

/// An element's form in its own frame.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A convex solid in closed form.
    Convex(Convex),
    /// An open sheet in closed form.
    Sheet(Sheet),
    /// A solid of revolution or a prism.
    Swept(Arc<Swept>),
    /// Sampled heights.
    HeightField(Arc<HeightField>),
    /// A triangle mesh.
    Mesh(Arc<MeshSurface>),
}

impl Shape {
    /// The first hit along a ray (in the shape's frame) that fits the search.
    pub fn nearest(&self, ray: &Ray, search: Search) -> Option<Hit> {
        match self {
            Self::Convex(convex) => convex.nearest(ray, search),
            Self::Sheet(sheet) => sheet.nearest(ray, search),
            Self::Swept(swept) => swept.nearest(ray, search),
            Self::HeightField(field) => field.nearest(ray, search),
            Self::Mesh(mesh) => mesh.nearest(ray, search),
        }
    }

    /// Distance to a known face along a ray, and the unit normal there (outward for a solid, on the +z
    /// side for a sheet). A face in closed form is continued beyond its edges, smoothly.
    pub fn cross<T: Real>(&self, ray: &Ray<T>, face: u32, crossing: Crossing) -> (T, Vec3<T>) {
        match self {
            Self::Convex(convex) => convex.cross(ray, face, crossing),
            Self::Sheet(sheet) => sheet.cross(ray, crossing),
            Self::Swept(swept) => swept.cross(ray, face, crossing),
            Self::HeightField(field) => field.cross(ray, face, crossing),
            Self::Mesh(mesh) => mesh.cross(ray, face),
        }
    }

    /// Whether it encloses a volume.
    pub fn is_solid(&self) -> bool {
        match self {
            Self::Convex(_) | Self::Swept(_) => true,
            Self::Sheet(_) => false,
            Self::HeightField(field) => field.is_solid(),
            Self::Mesh(mesh) => mesh.is_closed(),
        }
    }

    /// The mesh, if light crosses from some of its faces to the next without a jump: the faces of a path may then change
    /// along one sheet of the transport.
    pub fn bent_mesh(&self) -> Option<&MeshSurface> {
        match self {
            Self::Mesh(mesh) if mesh.is_bent() => Some(mesh),
            _ => None,
        }
    }

    /// The part of the surface that a face belongs to, on which light crosses from face to face without a jump.
    pub fn part(&self, face: u32) -> Part {
        match self {
            Self::Mesh(mesh) => mesh.part(face),
            // Faces in closed form are continued beyond their edges.
            _ => Part { number: face, is_bent: false },
        }
    }

    /// Volume, mm^3; 0 for a sheet.
    pub fn volume(&self) -> f64 {
        match self {
            Self::Convex(convex) => convex.volume(),
            Self::Sheet(_) => 0.0,
            Self::Swept(swept) => swept.volume(),
            Self::HeightField(field) => field.volume(),
            Self::Mesh(mesh) => mesh.volume(),
        }
    }
}
