//! Scenes: a set-up as it is described, and what light does in it. One block of methods, as PyO3 takes one for each class: whole in one file.

mod files;
mod source;

use crate::arrays::Points;
use crate::check::Check;
use crate::error::{raised, refused};
use crate::evaluation;
use crate::map::Map;
use crate::rays::{Rays, trace};
use crate::setting::{data, from_python, shown, to_python};
use crate::threads::work;
use crate::view::{Options, view};
use files::Files;
use midair::compensate::{self, Compensation, Method, uncompensated_map};
use midair::evaluate::character::Character;
use midair::evaluate::layout::Layout;
use midair::evaluate::{preflight, tolerance};
use midair::geometry::Vec3;
use midair::map::Accuracy;
use midair::picture::{Overflow, check_size};
use midair::scene::{Format, Loaded, SceneEdit, load_text, to_toml};
use midair::transport::{End, Matter, Setup};
use midair_report::drawing::set_up;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::path::PathBuf;
use std::sync::{Arc, PoisonError, RwLock};

/// A scene as it stands.
struct State {
    edit: SceneEdit,
    loaded: Loaded,
    setup: Setup,
}

impl State {
    /// As a text says it.
    fn read(
        py: Python<'_>,
        text: &str,
        name: &str,
        format: Format,
        files: &Files,
    ) -> PyResult<Self> {
        let read = work(py, || -> Result<Self, midair::Error> {
            let loaded = load_text(text, name, format, files)?;
            let edit = SceneEdit::new(text, name, format)?;
            let setup = Setup::new(&loaded)?;
            Ok(Self { edit, loaded, setup })
        })?;
        read.map_err(|error| raised(py, error))
    }

    /// With values at these paths.
    fn changed(&self, values: &Bound<'_, PyDict>, files: &Files) -> PyResult<Self> {
        let py = values.py();
        let mut edit = self.edit.clone();
        for (path, value) in values {
            let path: String = path.extract()?;
            edit.set(&path, from_python(&value)?).map_err(|error| raised(py, error))?;
        }
        let changed = work(py, || -> Result<Self, midair::Error> {
            let loaded = self.loaded.changed(&edit, files)?;
            let setup = Setup::new(&loaded)?;
            Ok(Self { edit, loaded, setup })
        })?;
        changed.map_err(|error| raised(py, error))
    }
}

/// A set-up: viewpoint, image, plate, display and elements, in millimetres and degrees.
///
/// Scene(source) takes the path of a scene file, a text of TOML or JSON, or a dict of the same shape. A text has a line break or begins with a
/// brace; any other str is a path. files, for a text or a dict: the folder of the files that it names, or a dict of their bytes by name.
#[pyclass(module = "midair._core", frozen)]
pub struct Scene {
    state: RwLock<Arc<State>>,
    files: Arc<Files>,
}

impl Scene {
    fn state(&self) -> Arc<State> {
        Arc::clone(&self.state.read().unwrap_or_else(PoisonError::into_inner))
    }

    fn with(state: State, files: Arc<Files>) -> Self {
        Self { state: RwLock::new(Arc::new(state)), files }
    }

    /// As it stands, with its files.
    pub(crate) fn loaded(&self) -> Loaded {
        self.state().loaded.clone()
    }

    /// The scene that a text describes, with the same files.
    pub(crate) fn of_text(&self, py: Python<'_>, text: &str) -> PyResult<Self> {
        let (format, loaded) = (self.state().edit.format(), self.loaded());
        let state = State::read(py, text, loaded.text.name(), format, &self.files)?;
        Ok(Self::with(state, Arc::clone(&self.files)))
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (source, *, files=None))]
    fn new(source: &Bound<'_, PyAny>, files: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let py = source.py();
        let found = source::Source::of(source, files)?;
        let state = State::read(py, &found.text, &found.name, found.format, &found.files)?;
        let state = match found.is_data {
            false => state,
            // Data have no text of their own.
            true => {
                let text = to_toml(&state.loaded.scene);
                State::read(py, &text, &found.name, Format::Toml, &found.files)?
            }
        };
        Ok(Self::with(state, Arc::new(found.files)))
    }

    /// What people call it.
    #[getter]
    fn name(&self) -> String {
        self.state().loaded.scene.name.clone()
    }

    /// The scene as TOML: the file's text with its comments, and what was changed since.
    #[getter]
    fn toml(&self) -> String {
        let state = self.state();
        match state.edit.format() {
            Format::Json => to_toml(&state.loaded.scene),
            Format::Toml => state.edit.text().to_owned(),
        }
    }

    /// The elements' names.
    #[getter]
    fn elements(&self) -> Vec<String> {
        self.state().loaded.scene.elements.iter().map(|element| element.name.clone()).collect()
    }

    /// The display as it stands, also where the scene leaves its place out: position (mm), rotation (degrees, Rx*Ry*Rz), size (mm), resolution.
    #[getter]
    fn display<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let state = self.state();
        let display = &state.setup.display;
        let dict = PyDict::new(py);
        dict.set_item("position", display.frame.origin.to_array().to_vec())?;
        dict.set_item("rotation", display.frame.rotation().to_vec())?;
        dict.set_item("size", display.size.to_vec())?;
        dict.set_item("resolution", state.setup.resolution.to_vec())?;
        Ok(dict)
    }

    /// The refractive index of an element, by its name or number, at the wavelength that maps are made for; None of a mirror.
    fn index(&self, py: Python<'_>, element: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
        let state = self.state();
        let elements = &state.setup.elements;
        let found = match (element.extract::<usize>(), element.extract::<String>()) {
            (Ok(number), _) => elements.get(number),
            (_, Ok(name)) => elements.iter().find(|element| element.name == name),
            _ => None,
        };
        match found.map(|element| element.matter) {
            Some(Matter::Refractive { index, .. }) => Ok(Some(index)),
            Some(Matter::Mirror { .. } | Matter::Opaque) => Ok(None),
            None => {
                let message = format!("there is no element {}", shown(element));
                let names: Vec<_> = elements.iter().map(|element| &element.name[..]).collect();
                let remedy = match names.len() {
                    0 => "the scene has no elements".to_owned(),
                    count => format!("the scene has {}, or 0 to {}", names.join(", "), count - 1),
                };
                Err(refused(py, message, remedy))
            }
        }
    }

    /// What was mended on meshes, and other things worth saying.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.state().loaded.notes.clone()
    }

    /// A value by its path, such as element.cube.rotation or viewpoint.position.x; None where the scene leaves the key out and it has no
    /// default.
    fn __getitem__(&self, py: Python<'_>, path: &str) -> PyResult<Option<Py<PyAny>>> {
        let found = self.state().edit.get(path).map_err(|error| raised(py, error))?;
        found.map(|setting| to_python(py, &setting)).transpose()
    }

    /// Sets a value by its path. What no set-up can be is refused, and the scene stays as it was.
    fn __setitem__(&self, path: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let values = PyDict::new(value.py());
        values.set_item(path, value)?;
        self.update(&values)
    }

    /// Sets several values by their paths, all or none.
    fn update(&self, values: &Bound<'_, PyDict>) -> PyResult<()> {
        let changed = self.state().changed(values, &self.files)?;
        *self.state.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(changed);
        Ok(())
    }

    /// A copy with other values at these paths.
    fn changed(&self, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let changed = self.state().changed(values, &self.files)?;
        Ok(Self::with(changed, Arc::clone(&self.files)))
    }

    /// The unit of a key's numbers: mm, degrees, nm and so on; None where they have none.
    fn unit(&self, py: Python<'_>, path: &str) -> PyResult<Option<&'static str>> {
        self.state().edit.unit(path).map_err(|error| raised(py, error))
    }

    /// Writes the scene file: TOML, with the comments that it was read with.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let text = match Format::of_name(&path.display().to_string()) {
            Format::Toml => self.toml(),
            Format::Json => {
                let message = format!("{}: scenes are written as TOML", path.display());
                return Err(refused(py, message, "let the name end in .toml"));
            }
        };
        midair::files::write_bytes_atomically(&path, text.as_bytes())
            .map_err(|error| raised(py, error))
    }

    /// The map: for each display pixel the image point that it must show.
    ///
    /// resolution: display pixels (width, height) instead of the scene's. method: "inverse", with an error bound of tolerance, or "splat", the
    /// paper's, with spp samples per view pixel (1000). gain: "fit", "clip" or "soft" has what Map.apply shows divided by the gain.
    /// per_channel: a map for each of the display's primaries.
    #[pyo3(signature = (*, resolution=None, method="inverse", spp=None, gain=None, per_channel=false, tolerance=1e-6))]
    fn map(
        &self,
        py: Python<'_>,
        resolution: Option<[usize; 2]>,
        method: &str,
        spp: Option<usize>,
        gain: Option<&str>,
        per_channel: bool,
        tolerance: f64,
    ) -> PyResult<Map> {
        let method = match (method, spp) {
            ("inverse", None) => Method::Inverse { accuracy: Accuracy { tolerance } },
            ("inverse", Some(_)) => {
                let message = "spp is an option of method=\"splat\"";
                return Err(refused(py, message, "leave spp out, or ask for that method"));
            }
            ("splat", spp) => Method::Splat { spp: spp.unwrap_or(1000).max(1) },
            (other, _) => {
                let message = format!("there is no method {other:?}");
                return Err(refused(py, message, "ask for \"inverse\" or \"splat\""));
            }
        };
        if !(1e-12..=1.0).contains(&tolerance) {
            let message = format!("a tolerance of {tolerance} cannot be met");
            return Err(refused(py, message, "give a share of the image's width from 1e-12 to 1"));
        }
        let overflow = match gain {
            None => None,
            Some(name) => Some(
                [Overflow::Fit, Overflow::Clip, Overflow::Soft]
                    .into_iter()
                    .find(|overflow| overflow.name() == name)
                    .ok_or_else(|| {
                        let message = format!("there is no way {name:?} to even out the gain");
                        refused(py, message, "ask for \"fit\", \"clip\" or \"soft\"")
                    })?,
            ),
        };
        let options =
            compensate::Options::new().method(method).by_colour(per_channel).gain(overflow);
        let setup = self.set_up(py, resolution)?;
        Ok(Map::of_compensation(work(py, || Compensation::of(&setup, &options, &()))?))
    }

    /// The map of a display that knows nothing of the object: the image in its true size, where it belongs if mirrors are flat and solids
    /// absent.
    #[pyo3(signature = (*, resolution=None))]
    fn uncompensated_map(&self, py: Python<'_>, resolution: Option<[usize; 2]>) -> PyResult<Map> {
        let setup = self.set_up(py, resolution)?;
        let map = work(py, || uncompensated_map(&setup))?;
        Ok(Map::uncompensated(setup, map))
    }

    /// What is seen of a display that shows a picture: an array of the picture's kind, height x width x 3.
    ///
    /// A view pixel is an image point, wherever the eye is: mm, or the scene's viewpoint. size is the view's (width, height); window the size
    /// of what is seen over the image's. By default each ray follows one path through an ideal plate, supersampling x supersampling rays a
    /// pixel. Any of spp (paths per pixel), plate ("ideal" or "slit-mirror"), aperture (of the pupil, mm), focus (mm), light ("real", "stray",
    /// "all"), exposure (a factor on light; left out, the 99th percentile becomes white) and seed has light followed by chance. A view in
    /// floats is light: the exposure is for codes alone.
    #[pyo3(signature = (display, *, eye=None, size=None, window=1.0, supersampling=2, spp=None, plate=None, aperture=None, focus=None, light=None, exposure=None, seed=None))]
    fn view<'py>(
        &self,
        py: Python<'py>,
        display: &Bound<'py, PyAny>,
        eye: Option<[f64; 3]>,
        size: Option<[usize; 2]>,
        window: f64,
        supersampling: u16,
        spp: Option<u32>,
        plate: Option<String>,
        aperture: Option<f64>,
        focus: Option<f64>,
        light: Option<String>,
        exposure: Option<f64>,
        seed: Option<u32>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = Options {
            eye: eye.map(|eye| point(py, eye)).transpose()?,
            size,
            window,
            supersampling,
            spp,
            plate,
            aperture,
            focus,
            light,
            exposure,
            seed,
        };
        let state = self.state();
        view(py, &state.loaded, &state.setup, display, &options)
    }

    /// Looks the set-up over before it is built: what is formed, what is not and why, and what helps.
    fn check(&self, py: Python<'_>) -> PyResult<Check> {
        let state = self.state();
        let check = work(py, || preflight::Check::of(&state.loaded))?;
        Ok(Check::new(check.map_err(|error| raised(py, error))?))
    }

    /// The paths of light through image points (..., 2), as arrays: the data behind a picture. eye: mm, or the scene's viewpoint.
    #[pyo3(signature = (uv, *, eye=None))]
    fn trace(
        &self,
        py: Python<'_>,
        uv: &Bound<'_, PyAny>,
        eye: Option<[f64; 3]>,
    ) -> PyResult<Rays> {
        let setup = &self.state().setup;
        let eye = match eye {
            Some(eye) => Vec3::from_array(point(py, eye)?),
            None => setup.viewpoint,
        };
        trace(py, setup, uv, eye)
    }

    /// F: for image points (..., 2) the display points st (..., 2) that they are shown by; NaN where they are not formed.
    ///
    /// beyond=True also tells where paths meet the display's plane that go past the plate's or the display's edges. Bytes of 64-bit floats in
    /// give bytes out.
    #[pyo3(signature = (uv, *, beyond=false))]
    fn forward<'py>(
        &self,
        py: Python<'py>,
        uv: &Bound<'py, PyAny>,
        beyond: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (state, points) = (self.state(), Points::new(uv)?);
        let all = points.all();
        let st = work(py, || state.setup.transport_all(all, chosen(beyond)))?;
        points.answer(py, st, &[2])
    }

    /// The derivatives of F at image points (..., 2): (..., 2, 2), rows d(s)/d(u, v) and d(t)/d(u, v); NaN where forward has none.
    #[pyo3(signature = (uv, *, beyond=false))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        uv: &Bound<'py, PyAny>,
        beyond: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (state, points) = (self.state(), Points::new(uv)?);
        let all = points.all();
        let found = work(py, || {
            let jacobians = state.setup.jacobians(all, chosen(beyond));
            jacobians.into_iter().map(|[[a, b], [c, d]]| [a, b, c, d]).collect::<Vec<_>>()
        })?;
        points.answer(py, found, &[2, 2])
    }

    /// Where image points (..., 2) are seen if the set-up is built as another scene says, while the display shows what was computed for this
    /// one: (..., 2), NaN where they are not seen in one of the two.
    fn seen<'py>(
        &self,
        py: Python<'py>,
        uv: &Bound<'py, PyAny>,
        built: &Bound<'py, Scene>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (state, built, points) = (self.state(), built.get().state(), Points::new(uv)?);
        let all = points.all();
        let seen = work(py, || tolerance::seen(&state.setup, &built.setup, all))?;
        points.answer(py, seen, &[2])
    }

    /// The paper's evaluation of this scene, as midair evaluate makes it, with the published figures.
    ///
    /// azimuths: of the camera about the image, degrees, from which the displacement of a lattice is calculated and measured. photographs:
    /// arrays by name, whose views are compared with and without compensation. plate: "slit-mirror" or "ideal". spp: paths per pixel. size:
    /// pixels of a view in a row. lpips: whether LPIPS is computed too, whose weights `midair weights` gets.
    #[pyo3(signature = (photographs=None, *, azimuths=vec![], plate="slit-mirror", spp=512, size=384, lpips=false))]
    fn evaluate(
        &self,
        py: Python<'_>,
        photographs: Option<&Bound<'_, PyDict>>,
        azimuths: Vec<f64>,
        plate: &str,
        spp: u32,
        size: usize,
        lpips: bool,
    ) -> PyResult<Py<PyAny>> {
        check_size([size, size]).map_err(|error| raised(py, error))?;
        let plate = plate.to_owned();
        let options = evaluation::Options { azimuths, plate, spp, size, lpips };
        let state = self.state();
        data(py, &evaluation::evaluate(py, &state.loaded, photographs, options)?)
    }

    /// The character of the scene's plate, as midair plate tells it: efficiency by direction, luminance by viewpoint, sharpness through a pupil
    /// of so many mm. Of the usual slit-mirror plate where the scene's is ideal.
    #[pyo3(signature = (*, aperture=4.0))]
    fn plate(&self, py: Python<'_>, aperture: f64) -> PyResult<Py<PyAny>> {
        if !(0.0..=1e6).contains(&aperture) {
            let message = format!("no pupil is {aperture} mm wide");
            return Err(refused(py, message, "give a length from 0 to 1000000 mm"));
        }
        let state = self.state();
        let found = work(py, || {
            let character = Character::of(&state.loaded, aperture)?;
            Ok(serde_json::json!(character))
        })?;
        data(py, &found.map_err(|error: midair::Error| raised(py, error))?)
    }

    /// The set-up as it is drawn: bodies with their contours and lines seen from the side and from above, courses of light.
    fn layout<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let layout = Layout::of(&self.state().setup);
        crate::set_up::layout(py, &layout)
    }

    /// The set-up to scale in two views with its measures, as midair draw makes it: SVG.
    fn drawing(&self) -> String {
        let state = self.state();
        set_up::drawing(&Layout::of(&state.setup), &state.loaded.scene.name)
    }

    /// The set-up as a picture, for notebooks.
    fn _repr_svg_(&self) -> String {
        let state = self.state();
        set_up::picture(&Layout::of(&state.setup), &state.loaded.scene.name)
    }

    fn __repr__(&self) -> String {
        let state = self.state();
        let scene = &state.loaded.scene;
        let [width, height] = scene.display.resolution;
        let elements = match &scene.elements[..] {
            [] => "no elements".to_owned(),
            all => all.iter().map(|element| &element.name[..]).collect::<Vec<_>>().join(", "),
        };
        format!("<midair.Scene {:?}: {elements}; {width} x {height} pixels>", scene.name)
    }

    fn __str__(&self) -> String {
        self.toml()
    }

    /// By the TOML text, with the bytes of the files that it names: other machines need not have them.
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let py = slf.py();
        let scene = slf.get();
        let state = scene.state();
        let arguments = (scene.toml(), state.loaded.text.name(), scene.files.held(py)?);
        Ok((slf.get_type().getattr("_restored")?, arguments.into_pyobject(py)?))
    }

    #[staticmethod]
    fn _restored(
        py: Python<'_>,
        text: &str,
        name: &str,
        files: &Bound<'_, PyDict>,
    ) -> PyResult<Self> {
        let files = Files::of_bytes(files)?;
        let state = State::read(py, text, name, Format::Toml, &files)?;
        Ok(Self::with(state, Arc::new(files)))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let other = other.cast::<Self>().map(|other| other.get().state());
        other.is_ok_and(|other| other.loaded.scene == self.state().loaded.scene)
    }
}

impl Scene {
    fn set_up(&self, py: Python<'_>, resolution: Option<[usize; 2]>) -> PyResult<Setup> {
        let state = self.state();
        let resolution = resolution.unwrap_or(state.setup.resolution);
        check_size(resolution).map_err(|error| raised(py, error))?;
        Ok(state.setup.with_resolution(resolution))
    }
}

/// What is taken of paths' ends.
fn chosen(beyond: bool) -> fn(&End) -> Option<[f64; 2]> {
    if beyond { End::st } else { End::formed }
}

/// A point that may be an eye's.
fn point(py: Python<'_>, eye: [f64; 3]) -> PyResult<[f64; 3]> {
    // As far out as a scene file may go.
    if eye.iter().all(|c| c.abs() <= 1e6) {
        return Ok(eye);
    }
    Err(refused(py, format!("no eye is at {eye:?}"), "each coordinate must lie within 1000000 mm"))
}
