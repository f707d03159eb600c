//! A set-up as it is drawn.

use crate::arrays::shaped;
use midair::evaluate::layout::{Body, Layout, View};
use midair::geometry::Vec3;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// The set-up's bodies with their contours and lines in both views, the light's courses, and what the views' axes are.
pub fn layout<'py>(py: Python<'py>, layout: &Layout) -> PyResult<Bound<'py, PyDict>> {
    let vectors = |points: &[Vec3]| {
        let numbers = points.iter().flat_map(|point| point.to_array()).collect();
        shaped(py, numbers, &[points.len(), 3])
    };
    let bodies = PyList::empty(py);
    for body in &layout.bodies {
        bodies.append(of_body(py, body, layout)?)?;
    }
    let courses = PyList::empty(py);
    for course in &layout.courses {
        courses.append(vectors(course)?)?;
    }
    let dict = PyDict::new(py);
    dict.set_item("bodies", bodies)?;
    dict.set_item("courses", courses)?;
    dict.set_item("eye", vectors(&[layout.eye])?.call_method1("reshape", (3,))?)?;
    dict.set_item("image", vectors(&[layout.image])?.call_method1("reshape", (3,))?)?;
    for (name, view) in [("side", layout.side()), ("top", layout.top())] {
        if let View::Parallel { right, up } = view {
            dict.set_item(format!("{name}_axes"), vectors(&[right, up])?)?;
        }
    }
    Ok(dict)
}

fn of_body<'py>(py: Python<'py>, body: &Body, layout: &Layout) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("role", body.role.name())?;
    dict.set_item("name", &body.name)?;
    dict.set_item("measures", &body.measures)?;
    for (name, view) in [("side", layout.side()), ("top", layout.top())] {
        let seen = body.seen(&view);
        let points =
            |points: &[[f64; 2]]| shaped(py, points.as_flattened().to_vec(), &[points.len(), 2]);
        let lines = PyList::empty(py);
        for line in &seen.lines {
            lines.append(points(line)?)?;
        }
        let shown = PyDict::new(py);
        shown.set_item("contour", points(&seen.contour)?)?;
        shown.set_item("lines", lines)?;
        dict.set_item(name, shown)?;
    }
    Ok(dict)
}
