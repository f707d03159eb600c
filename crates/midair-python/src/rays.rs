//! Rays with what they meet: the data behind a picture of them.

use crate::arrays::{Points, shaped};
use crate::threads::work;
use midair::geometry::Vec3;
use midair::transport::{Action, Course, End, Setup, on_display};
use pyo3::prelude::*;

/// Paths of light with the places that they go through, from the eye on.
///
/// The first axes are those of the image points that were asked for; the next one counts places along the path, to the longest path's end.
#[pyclass(module = "midair._core", frozen, get_all)]
pub struct Rays {
    /// Places in mm (..., places, 3): the eye, where something is met, and the display; NaN beyond a path's end.
    points: Py<PyAny>,
    /// Unit vectors (..., places, 3): which way the path goes on from each place; NaN where it ends.
    directions: Py<PyAny>,
    /// What stands at each place (..., places), int16: an element's number, or a midair.Met.
    met: Py<PyAny>,
    /// What happens there (..., places), uint8: see midair.Action.
    action: Py<PyAny>,
    /// How each path ends (...), uint8: see midair.End.
    end: Py<PyAny>,
    /// Where each path meets the display's plane (..., 2): st; NaN where it does not get there.
    st: Py<PyAny>,
    /// The elements' names, by number.
    elements: Vec<String>,
}

#[pymethods]
impl Rays {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let shape = self.points.bind(py).getattr("shape")?.repr()?;
        Ok(format!("<midair.Rays, points {shape}>"))
    }
}

/// What is met, where it is no element.
const EYE: i16 = -1;
const PLATE: i16 = -2;
const DISPLAY: i16 = -3;
const NOTHING: i16 = -4;

/// Follows rays from an eye through image points.
pub fn trace<'py>(
    py: Python<'py>,
    setup: &Setup,
    uv: &Bound<'py, PyAny>,
    eye: Vec3,
) -> PyResult<Rays> {
    use numpy::PyUntypedArrayMethods as _;
    use rayon::prelude::*;

    crate::arrays::numpy(py)?;
    let points = Points::new(uv)?;
    let all = points.all();
    let courses: Vec<Course> =
        work(py, || all.par_iter().map(|&uv| setup.course(setup.ray_from(eye, uv))).collect())?;
    let axes = match &points {
        Points::Array(array) => array.shape()[..array.shape().len() - 1].to_vec(),
        Points::Bytes(points) => vec![points.len()],
    };
    let places = courses.iter().map(|course| course.points.len()).max().unwrap_or(0);
    let vectors = |of: &dyn Fn(&Course) -> &Vec<Vec3>| -> PyResult<Py<PyAny>> {
        let mut numbers = vec![[f64::NAN; 3]; courses.len() * places];
        for (course, row) in courses.iter().zip(numbers.chunks_mut(places.max(1))) {
            row.iter_mut().zip(of(course)).for_each(|(to, from)| *to = from.to_array());
        }
        let shape = [&axes[..], &[places, 3]].concat();
        Ok(shaped(py, numbers.into_flattened(), &shape)?.unbind())
    };
    let mut met = vec![NOTHING; courses.len() * places];
    let mut action = vec![0u8; courses.len() * places];
    for (course, (met, action)) in
        courses.iter().zip(met.chunks_mut(places.max(1)).zip(action.chunks_mut(places.max(1))))
    {
        met[0] = EYE;
        for (k, step) in course.steps.iter().enumerate() {
            (met[k + 1], action[k + 1]) = match step.action {
                Action::Refract { .. } => (step.element as i16, 1),
                Action::Reflect => (step.element as i16, 2),
                Action::Pass => (step.element as i16, 3),
                Action::Plate => (PLATE, 4),
            };
        }
        if matches!(course.end, End::Display { .. }) {
            met[course.points.len() - 1] = DISPLAY;
        }
    }
    let end = courses.iter().map(|course| end_code(course.end)).collect();
    let st =
        courses.iter().map(|course| course.end.st().unwrap_or([f64::NAN; 2])).collect::<Vec<_>>();
    let along = [&axes[..], &[places]].concat();
    Ok(Rays {
        points: vectors(&|course| &course.points)?,
        directions: vectors(&|course| &course.directions)?,
        met: shaped(py, met, &along)?.unbind(),
        action: shaped(py, action, &along)?.unbind(),
        end: shaped(py, end, &axes)?.unbind(),
        st: shaped(py, st.into_flattened(), &[&axes[..], &[2]].concat())?.unbind(),
        elements: setup.elements.iter().map(|element| element.name.clone()).collect(),
    })
}

/// `midair.End`.
fn end_code(end: End) -> u8 {
    match end {
        End::Display { st, through_plate: true } if on_display(st) => 0,
        End::TotalReflection { .. } => 1,
        End::Display { through_plate: false, .. } | End::MissedPlate => 2,
        End::PlateBehind => 3,
        End::Display { .. } | End::MissedDisplay => 4,
        End::TooManyInteractions => 5,
    }
}
