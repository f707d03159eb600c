//! The scene as it really is, from the points of photographs.

use crate::arrays::{contiguous, numpy, shaped};
use crate::error::{raised, refused};
use crate::scene::Scene;
use crate::setting::data;
use crate::threads::interruptible;
use midair::scene::SceneError;
use midair_calibrate::correspondences::USUAL_SIGMA;
use midair_calibrate::{
    Correspondence, Finding, Lens, Options, Uncertainty, ViewPoints, scene_file,
};
use numpy::PyUntypedArrayMethods as _;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// What a fit found.
#[pyclass(module = "midair._core", frozen)]
pub struct Calibration {
    scene: Py<Scene>,
    finding: Finding,
}

#[pymethods]
impl Calibration {
    /// The fitted scene: the assumed one's text with the fitted values.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<Scene> {
        self.scene.clone_ref(py)
    }

    /// Each number that was fitted: name, value, sigma, start, determined.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Py<PyAny>> {
        data(py, &serde_json::json!(self.finding.parameters))
    }

    /// The covariance (n, n) of the free numbers in the order of names: shifts in mm along the world's axes, turns in degrees about a part's own.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let matrix = &self.finding.covariance;
        // Symmetric: rows and columns are the same.
        shaped(py, matrix.as_slice().to_vec(), &[matrix.nrows(), matrix.ncols()])
    }

    /// What the rows of covariance are of.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.finding.names.clone()
    }

    /// All that was found, as calibration.json of `midair calibrate fit` has it.
    #[getter]
    fn data(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        data(py, &serde_json::json!(self.finding))
    }

    fn __repr__(&self) -> String {
        let told = self.finding.parameters.iter().filter(|p| p.determined).count();
        let (all, left) = (self.finding.parameters.len(), self.finding.residual.rms);
        format!("<midair.Calibration: {told} of {all} numbers determined, {left:.3} px rms left>")
    }
}

/// Fits a scene to what cameras saw of its display: where each part really stands, how it is turned, its index.
///
/// views: for each view's name a pair of arrays, without the object and with it, of rows x, y, s, t or x, y, s, t, sigma: camera pixels from the upper left
/// corner (centres at half-integers), display coordinates, one standard deviation in display pixels. focal and centre in pixels and distortion (k1, k2, p1,
/// p2, k3) describe the lens; left out, it is found from three views or more. position, rotation, ior and size are one standard deviation of what was assumed.
/// free and fix name what is fitted besides the usual and what is not; together has lists of elements that move as one.
#[pyfunction]
#[pyo3(signature = (scene, views, *, focal=None, centre=None, distortion=[0.0; 5], position=3.0, rotation=3.0, ior=0.02, size=0.5, free=Vec::new(), fix=Vec::new(), together=Vec::new(), starts=8))]
pub fn fit<'py>(
    py: Python<'py>,
    scene: &Bound<'py, Scene>,
    views: &Bound<'py, PyDict>,
    focal: Option<[f64; 2]>,
    centre: Option<[f64; 2]>,
    distortion: [f64; 5],
    position: f64,
    rotation: f64,
    ior: f64,
    size: f64,
    free: Vec<String>,
    fix: Vec<String>,
    together: Vec<Vec<String>>,
    starts: u16,
) -> PyResult<Calibration> {
    numpy(py)?;
    let lens = match (focal, centre) {
        (Some(focal), Some(centre)) => Some(Lens { focal, centre, distortion }),
        (None, None) => None,
        _ => {
            let message = "focal and centre belong together";
            return Err(refused(py, message, "give both, or neither: the lens is then found"));
        }
    };
    let sure = [position, rotation, ior, size];
    if !sure.iter().all(|s| s.is_finite() && *s > 0.0) {
        let message = "a standard deviation must be above 0";
        return Err(refused(
            py,
            message,
            "give position, rotation, ior and size above 0; name what is certain in fix",
        ));
    }
    let mut seen = Vec::new();
    for (name, pair) in views {
        let name: String = name.extract()?;
        let pair = pair.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
        let Some(pair) = pair.cloned() else {
            let message = format!("view {name}: it is not a pair");
            return Err(refused(py, message, "give (points without the object, points with it)"));
        };
        let points = |k: usize| points(py, &pair.get_item(k)?, &name);
        seen.push(ViewPoints { empty: points(0)?, object: points(1)?, name });
    }
    if seen.is_empty() || (lens.is_none() && seen.len() < 3) {
        let message = format!("{} views do not tell the camera's lens", seen.len());
        return Err(refused(py, message, "give focal and centre, or three views or more"));
    }
    let uncertainty = Uncertainty { position, rotation, ior, size };
    let starts = usize::from(starts.clamp(1, 1000));
    let options = Options { uncertainty, lens, together, free, fix, starts, ..Options::default() };
    let assumed = scene.get().loaded();
    let finding =
        interruptible(py, |watch| midair_calibrate::fit(&assumed, &seen, &options, watch))?
            .map_err(|error| raised(py, error))?;
    let text = scene_file::fitted_text(&assumed, &finding, &std::path::Path::to_path_buf)
        .map_err(|error: SceneError| raised(py, error))?;
    let fitted = Py::new(py, scene.get().of_text(py, &text)?)?;
    Ok(Calibration { scene: fitted, finding })
}

/// Rows x, y, s, t or x, y, s, t, sigma.
fn points(py: Python<'_>, rows: &Bound<'_, PyAny>, view: &str) -> PyResult<Vec<Correspondence>> {
    let array = contiguous::<f64>(rows, "float64")?;
    let columns = match array.shape() {
        [_, columns @ (4 | 5)] => *columns,
        shape => {
            let message = format!("view {view}: points of shape {shape:?}");
            return Err(refused(py, message, "give rows of x, y, s, t or x, y, s, t, sigma"));
        }
    };
    // Contiguous, as it was made.
    let numbers = array.as_slice().unwrap_or_default();
    let mut points = Vec::with_capacity(numbers.len() / columns);
    for row in numbers.chunks_exact(columns) {
        let sigma = row.get(4).copied().unwrap_or(USUAL_SIGMA);
        if !row.iter().all(|n| n.is_finite()) || !(sigma > 0.0) {
            let message =
                format!("view {view}: point {} is not of numbers, sigma above 0", points.len());
            return Err(refused(py, message, "leave out what was not decoded"));
        }
        points.push(Correspondence { pixel: [row[0], row[1]], st: [row[2], row[3]], sigma });
    }
    Ok(points)
}
