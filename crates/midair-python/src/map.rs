//! Maps: what each display pixel must show. One block of methods, as PyO3 takes one for each class: whole in one file.

use crate::arrays::{numpy, shaped, to_bytes};
use crate::error::{raised, refused};
use crate::picture;
use crate::threads::{interruptible, work};
use midair::compensate::Compensation;
use midair::map::format::{
    Format, LoadedMap, Reading, decode_map, remap_coordinates, stmap_pixels, write_map_and_gain,
};
use midair::map::{self, Gain};
use midair::picture::{display_image, drive};
use midair::simulate::gain;
use midair::transport::Setup;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// Where a map comes from.
enum Origin {
    /// The answer for a set-up, or one of its colours.
    Compensation { all: Arc<Compensation>, colour: usize },
    /// What a display shows that knows nothing of the object.
    Uncompensated { setup: Box<Setup>, map: map::Map },
    /// A file.
    File(LoadedMap),
}

impl Origin {
    fn map(&self) -> &map::Map {
        match self {
            Self::Compensation { all, colour } => &all.solved()[*colour].map,
            Self::Uncompensated { map, .. } => map,
            Self::File(loaded) => &loaded.map,
        }
    }

    fn setup(&self) -> Option<&Setup> {
        match self {
            Self::Compensation { all, colour } => Some(&all.solved()[*colour].setup),
            Self::Uncompensated { setup, .. } => Some(setup),
            Self::File(_) => None,
        }
    }
}

/// A map: for each display pixel the image point that it must show, with its status.
///
/// Made by Scene.map and load_map.
#[pyclass(module = "midair._core", frozen)]
pub struct Map {
    origin: Arc<Origin>,
    /// The same map with a continuation beyond its coverage.
    bled: Option<Arc<map::Map>>,
    /// Worked out when it is first asked for.
    gain: OnceLock<Arc<Gain>>,
}

impl Map {
    fn new(origin: Origin) -> Self {
        Self { origin: Arc::new(origin), bled: None, gain: OnceLock::new() }
    }

    pub fn of_compensation(all: Compensation) -> Self {
        let colour = all.solved().len() / 2;
        Self::new(Origin::Compensation { all: Arc::new(all), colour })
    }

    pub fn uncompensated(setup: Setup, map: map::Map) -> Self {
        Self::new(Origin::Uncompensated { setup: Box::new(setup), map })
    }

    fn map(&self) -> &map::Map {
        self.bled.as_deref().unwrap_or_else(|| self.origin.map())
    }

    fn held(&self) -> Held {
        match &self.bled {
            Some(map) => Held::Bled { _map: Arc::clone(map) },
            None => Held::Map { _map: Arc::clone(&self.origin) },
        }
    }

    /// The gain; `None` where a file says nothing of it.
    fn known_gain(&self, py: Python<'_>) -> PyResult<Option<Arc<Gain>>> {
        if let Some(gain) = self.gain.get() {
            return Ok(Some(Arc::clone(gain)));
        }
        let found = match &*self.origin {
            Origin::Compensation { all, colour } if all.gains().is_some() => {
                all.gains().map(|gains| gains[*colour].clone())
            }
            Origin::File(loaded) => loaded.gain.clone(),
            origin => {
                let setup = origin.setup();
                work(py, || setup.map(|setup| gain(setup, origin.map())))?
            }
        };
        Ok(found.map(|found| Arc::clone(self.gain.get_or_init(|| Arc::new(found)))))
    }

    /// The samples as a numpy array that looks into this very map.
    fn view<'py>(
        &self,
        py: Python<'py>,
        held: Held,
        kind: &'static str,
        address: usize,
        last: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let map = self.map();
        let mut shape = vec![map.height, map.width];
        shape.extend(last);
        let samples = Samples { _held: held, kind, address, shape };
        numpy(py)?.call_method1("asarray", (samples,))
    }

    /// Width and height of the pictures that a map is for, if nobody says: the image's proportions, as wide as the display.
    fn source(&self, given: Option<[usize; 2]>) -> [usize; 2] {
        let map = self.map();
        let usual = || match self.origin.setup() {
            Some(setup) => setup.view_size(map.width),
            None => [map.width, map.height],
        };
        given.unwrap_or_else(usual)
    }
}

#[pymethods]
impl Map {
    /// Image points (height x width x 2, float64): u to the right, v up, row 0 at the top; NaN where there is no answer.
    ///
    /// The array looks into the map itself and cannot be written to.
    #[getter]
    fn uv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let address = self.map().uv.as_ptr() as usize;
        self.view(py, self.held(), "f8", address, Some(2))
    }

    /// Each pixel's status (height x width, uint8): see midair.Status.
    #[getter]
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let address = self.map().status.as_ptr() as usize;
        self.view(py, self.held(), "u1", address, None)
    }

    /// The share of each pixel's light that arrives at the viewpoint (height x width x 3, float32, linear R, G, B); None where a file does
    /// not say.
    #[getter]
    fn gain<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(gain) = self.known_gain(py)? else { return Ok(None) };
        let address = gain.rgb.as_ptr() as usize;
        self.view(py, Held::Gain { _gain: gain }, "f4", address, Some(3)).map(Some)
    }

    /// Upper bound of |uv - exact| over the ok pixels; infinite where none is proved.
    #[getter]
    fn error_bound(&self) -> f64 {
        self.map().error_bound
    }

    /// Display pixels: width, height.
    #[getter]
    fn resolution(&self) -> (usize, usize) {
        (self.map().width, self.map().height)
    }

    /// How many pixels have which status: ok, folded, outside, blocked.
    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let counts = self.map().counts();
        let dict = PyDict::new(py);
        for (name, count) in [
            ("ok", counts.ok),
            ("folded", counts.folded),
            ("outside", counts.outside),
            ("blocked", counts.blocked),
        ] {
            dict.set_item(name, count)?;
        }
        Ok(dict)
    }

    /// The maps of the display's red, green and blue, if the map was made per_channel; None where one map serves all.
    #[getter]
    fn channels<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyTuple>>> {
        let Origin::Compensation { all, .. } = &*self.origin else { return Ok(None) };
        if !all.is_by_colour() {
            return Ok(None);
        }
        let maps = (0..3).map(|colour| {
            Self::new(Origin::Compensation { all: Arc::clone(all), colour }).into_pyobject(py)
        });
        Ok(Some(PyTuple::new(py, maps.collect::<PyResult<Vec<_>>>()?)?))
    }

    /// The report in figures, as report.json has it; None for a map that was not made by Scene.map.
    #[getter]
    fn report(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        let Origin::Compensation { all, .. } = &*self.origin else { return Ok(None) };
        crate::setting::data(py, &serde_json::json!(all.report())).map(Some)
    }

    /// What is to be known of a map from a file, a sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        match &*self.origin {
            Origin::File(loaded) => loaded.notes.clone(),
            _ => Vec::new(),
        }
    }

    /// uv as bytes of 64-bit floats, for programs without numpy.
    fn uv_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        to_bytes(py, self.map().uv.as_flattened())
    }

    /// The statuses as bytes, for programs without numpy.
    fn status_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let status = &self.map().status;
        PyBytes::new_with(py, status.len(), |bytes| {
            bytes.iter_mut().zip(status).for_each(|(byte, status)| *byte = *status as u8);
            Ok(())
        })
    }

    /// What the display must show of a picture: an array of the map's size and the picture's kind, height x width x 3.
    ///
    /// uint8 and uint16 are sRGB codes, floats linear light (premultiplied, if there is alpha). optimal=True finds the display image whose view
    /// is nearest to the picture, by least squares.
    #[pyo3(signature = (picture, *, optimal=false))]
    fn apply<'py>(
        &self,
        py: Python<'py>,
        picture: &Bound<'py, PyAny>,
        optimal: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (source, kind) = picture::read(picture)?;
        let needs_set_up = || {
            let remedy = "make the map by Scene.map";
            refused(
                py,
                "the best display image needs the set-up, which a file does not tell",
                remedy,
            )
        };
        let shown = match &*self.origin {
            Origin::Compensation { all, .. } if optimal => {
                let setup = all.setup();
                let view = setup.view_size(setup.resolution[0]);
                midair::simulate::check_view(view, 2).map_err(|error| raised(py, error))?;
                interruptible(py, |_| {
                    let light = all.light(&source);
                    Ok(all.shown(all.best_light(source, light)?).display)
                })?
                .map_err(|error: midair::picture::optimal::OptimalError| raised(py, error))?
            }
            Origin::Compensation { all, .. } => work(py, || all.display(&source).display)?,
            Origin::Uncompensated { .. } | Origin::File(_) if optimal => return Err(needs_set_up()),
            Origin::Uncompensated { setup, map } => work(py, || {
                let light = display_image(&source, map);
                if setup.screen.is_plain() { light } else { drive(&light, &setup.screen).picture }
            })?,
            Origin::File(loaded) => work(py, || display_image(&source, &loaded.map))?,
        };
        picture::write(py, &shown, kind)
    }

    /// The map continued by so many pixels beyond its coverage, for tools that interpolate between its pixels. The statuses, and what apply
    /// draws, stay as they are.
    fn bled(&self, py: Python<'_>, pixels: u16) -> PyResult<Self> {
        let map = self.map();
        let bled = work(py, || map::bleed(map, pixels.into()))?;
        let gain = self.gain.clone();
        Ok(Self { origin: Arc::clone(&self.origin), bled: Some(Arc::new(bled)), gain })
    }

    /// map1 and map2 for cv2.remap (height x width, float32), for pictures of a size (width, height); NaN where there is no answer.
    ///
    /// The size left out, it is as wide as the display, in the image's proportions.
    #[pyo3(signature = (*, source=None))]
    fn to_opencv<'py>(
        &self,
        py: Python<'py>,
        source: Option<[usize; 2]>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (map, source) = (self.map(), self.source(source));
        let [x, y] = work(py, || remap_coordinates(map, source))?;
        let shape = [map.height, map.width];
        Ok((shaped(py, x, &shape)?, shaped(py, y, &shape)?))
    }

    /// The map as an STMap's pixels (height x width x 4, float32): R = u, G = v, B = 0, A = 1 where the status is ok.
    fn to_stmap<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let map = self.map();
        let pixels = work(py, || stmap_pixels(map).into_flattened())?;
        shaped(py, pixels, &[map.height, map.width, 4])
    }

    /// Writes the map into a file, whole or not at all; returns the names of the files that were written.
    ///
    /// The name tells the format, or format does: exr, exr-half, npy, png16, blender, touchdesigner, touchdesigner-png, ffmpeg, opencv,
    /// opencv-yaml, mpcdi. source is the size (width, height) of the pictures that it is for, which formats of absolute pixels need. bleed
    /// continues the map by so many pixels beyond its coverage, for tools that interpolate.
    #[pyo3(signature = (path, *, format=None, source=None, bleed=0))]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        format: Option<&str>,
        source: Option<[usize; 2]>,
        bleed: u16,
    ) -> PyResult<Vec<PathBuf>> {
        let format = match known_format(py, format)?.or_else(|| Format::of_path(&path)) {
            Some(format) => format,
            None => {
                let message = format!("{}: its name tells no kind of map", path.display());
                return Err(refused(
                    py,
                    message,
                    "end it in .exr, .npy, .png, .yml or .mpcdi, or name the format",
                ));
            }
        };
        // As the program does: the gain is written where it was asked for.
        let gain = match &*self.origin {
            Origin::Compensation { all, colour } => all.gains().map(|gains| &gains[*colour]),
            Origin::File(loaded) => loaded.gain.as_ref(),
            Origin::Uncompensated { .. } => None,
        };
        let (map, source) = (self.map(), self.source(source));
        let written = work(py, || {
            let bled = (bleed > 0).then(|| map::bleed(map, usize::from(bleed)));
            write_map_and_gain(bled.as_ref().unwrap_or(map), gain, source, format, &path)
        })?;
        Ok(written.map_err(|error| raised(py, error))?.files)
    }

    fn __repr__(&self) -> String {
        let map = self.map();
        let counts = map.counts();
        let covered = (counts.ok + counts.folded) as f64 / counts.all().max(1) as f64;
        let bound = match map.error_bound.is_finite() {
            true => format!(", error bound {:.1e}", map.error_bound),
            false => String::new(),
        };
        let percent = midair::evaluate::percent(covered);
        format!("<midair.Map {} x {}, {percent} answered{bound}>", map.width, map.height)
    }
}

/// What keeps the memory that an array looks into.
enum Held {
    Map { _map: Arc<Origin> },
    Bled { _map: Arc<map::Map> },
    Gain { _gain: Arc<Gain> },
}

/// Numbers of a map, for numpy to look into: they do not change, and stay as long as an array looks into them.
#[pyclass(module = "midair._core", frozen)]
pub struct Samples {
    _held: Held,
    kind: &'static str,
    address: usize,
    shape: Vec<usize>,
}

#[pymethods]
impl Samples {
    /// numpy's array interface, version 3.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let order = match (self.kind, cfg!(target_endian = "little")) {
            ("u1", _) => '|',
            (_, true) => '<',
            (_, false) => '>',
        };
        let dict = PyDict::new(py);
        dict.set_item("version", 3)?;
        dict.set_item("typestr", format!("{order}{}", self.kind))?;
        dict.set_item("shape", PyTuple::new(py, &self.shape)?)?;
        // Not to be written to.
        dict.set_item("data", (self.address, true))?;
        Ok(dict)
    }
}

fn known_format(py: Python<'_>, name: Option<&str>) -> PyResult<Option<Format>> {
    let parsed = name.map(str::parse::<Format>).transpose();
    parsed.map_err(|error| refused(py, error.to_string(), "name one of them"))
}

/// Reads a map from a file.
///
/// The name tells the format, or format does. source is the size (width, height) of the pictures that it is for, which formats of absolute
/// pixels need; region names one of several in an MPCDI file.
#[pyfunction]
#[pyo3(signature = (path, *, format=None, source=None, region=None))]
pub fn load_map(
    py: Python<'_>,
    path: PathBuf,
    format: Option<&str>,
    source: Option<[usize; 2]>,
    region: Option<&str>,
) -> PyResult<Map> {
    let reading = Reading { format: known_format(py, format)?, source, region };
    let loaded = work(py, || decode_map(&path, &|file| std::fs::read(file), &reading))?;
    Ok(Map::new(Origin::File(loaded.map_err(|error| raised(py, error))?)))
}
