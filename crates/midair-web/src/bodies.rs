//! Where things stand, for a view in three dimensions.

use midair::evaluate::layout::Layout;
use midair::geometry::{Frame, Vec3};
use midair::scene::{Asset, Loaded};
use midair::transport::Setup;
use serde_json::{Value, json};
use wasm_bindgen::prelude::*;

/// A body's lines and faces in its own frame, mm: x, y and z of each point.
#[wasm_bindgen]
pub struct Lines {
    edges: Vec<f32>,
    hull: Vec<f32>,
    faces: Vec<f32>,
}

#[wasm_bindgen]
impl Lines {
    /// The pieces' two ends each.
    pub fn edges(&mut self) -> Vec<f32> {
        std::mem::take(&mut self.edges)
    }

    /// Points whose convex hull it is; empty where it is not convex.
    pub fn hull(&mut self) -> Vec<f32> {
        std::mem::take(&mut self.hull)
    }

    /// The three corners of each triangle, of a mesh.
    pub fn faces(&mut self) -> Vec<f32> {
        std::mem::take(&mut self.faces)
    }
}

/// How many bodies of a layout stand before the elements'.
const BEFORE: usize = 3;

/// The frame and, of a rectangle, the size of a layout's body.
fn place(setup: &Setup, index: usize) -> (Frame, Option<[f64; 2]>) {
    let rectangles = [&setup.display, &setup.plate.rectangle, &setup.image];
    match index.checked_sub(BEFORE) {
        None => (rectangles[index].frame, Some(rectangles[index].size)),
        Some(element) => (setup.elements[element].frame, None),
    }
}

/// The bodies as data.
pub fn described(layout: &Layout, setup: &Setup, elements: usize) -> Vec<Value> {
    let bodies = layout.bodies.iter().enumerate().map(|(index, body)| {
        let (frame, size) = place(setup, index);
        let element = index.checked_sub(BEFORE).filter(|&element| element < elements);
        json!({
            "role": body.role.name(),
            "name": body.name,
            "element": element,
            "measures": body.measures,
            "position": frame.origin.to_array(),
            "rotation": frame.rotation(),
            "size": size,
        })
    });
    bodies.collect()
}

impl Lines {
    /// Of a layout's body.
    pub(crate) fn of(layout: &Layout, loaded: &Loaded, setup: &Setup, index: usize) -> Self {
        let Some(body) = layout.bodies.get(index) else {
            return Self { edges: Vec::new(), hull: Vec::new(), faces: Vec::new() };
        };
        let frame = place(setup, index).0;
        let own = |point: Vec3| frame.to_local(point);
        let edges = body.outline.edges.iter().flat_map(|edge| edge.windows(2).flatten().copied());
        let mut lines = Self {
            edges: numbers(edges.map(own)),
            hull: numbers(body.outline.hull.iter().copied().map(own)),
            faces: Vec::new(),
        };
        let asset = index.checked_sub(BEFORE).and_then(|element| loaded.assets.get(element));
        if let Some(Asset::Mesh { mesh, .. }) = asset {
            let corners = mesh.triangles.iter().flatten();
            lines.faces = numbers(corners.map(|&v| mesh.positions[v as usize]));
        }
        lines
    }
}

fn numbers(points: impl Iterator<Item = Vec3>) -> Vec<f32> {
    points.flat_map(|point| point.to_array()).map(|c| c as f32).collect()
}
