//! What is seen of a display.

use crate::error::{raised, refused};
use crate::picture::{self, Kind};
use crate::threads::{interruptible, work};
use midair::geometry::Vec3;
use midair::picture::optimal::view_through;
use midair::picture::{Picture, emitted};
use midair::scene::Loaded;
use midair::scene::model::PlateModel;
use midair::simulate::tone::{Exposure, exposed};
use midair::simulate::{Camera, Light, Settings, Viewer, check_view, render};
use midair::transport::Setup;
use pyo3::prelude::*;

/// Options of a view, as `midair view` has them.
pub struct Options {
    pub eye: Option<[f64; 3]>,
    pub size: Option<[usize; 2]>,
    pub window: f64,
    pub supersampling: u16,
    pub spp: Option<u32>,
    pub plate: Option<String>,
    pub aperture: Option<f64>,
    pub focus: Option<f64>,
    pub light: Option<String>,
    pub exposure: Option<f64>,
    pub seed: Option<u32>,
}

impl Options {
    /// Whether light is followed by chance: whether any option is given that asks for it.
    fn by_chance(&self) -> bool {
        self.spp.is_some()
            || self.plate.is_some()
            || self.aperture.is_some()
            || self.focus.is_some()
            || self.light.is_some()
            || self.exposure.is_some()
            || self.seed.is_some()
    }

    fn plate(&self, py: Python<'_>, own: PlateModel) -> PyResult<PlateModel> {
        match self.plate.as_deref() {
            None => Ok(own),
            Some("ideal") => Ok(PlateModel::Ideal),
            Some("slit-mirror") => Ok(PlateModel::SlitMirror(own.or_slit_mirror())),
            Some(other) => {
                let message = format!("there is no plate model {other:?}");
                Err(refused(py, message, "ask for \"ideal\" or \"slit-mirror\""))
            }
        }
    }

    fn light(&self, py: Python<'_>) -> PyResult<Light> {
        match self.light.as_deref() {
            None | Some("all") => Ok(Light::All),
            Some("real") => Ok(Light::Real),
            Some("stray") => Ok(Light::Stray),
            Some(other) => {
                let message = format!("there is no light {other:?}");
                Err(refused(py, message, "ask for \"real\", \"stray\" or \"all\""))
            }
        }
    }
}

/// A pixel of a render takes as much memory as this many rays along each side.
const MEMORY_AS_RAYS: usize = 2;

/// The view of a display's picture, as an array of the picture's kind.
pub fn view<'py>(
    py: Python<'py>,
    loaded: &Loaded,
    setup: &Setup,
    display: &Bound<'py, PyAny>,
    options: &Options,
) -> PyResult<Bound<'py, PyAny>> {
    let (mut display, kind) = picture::read(display)?;
    if !loaded.screen.is_plain() {
        display = work(py, || emitted(&display, &loaded.screen))?;
    }
    let camera = Camera {
        eye: options.eye.map_or(setup.viewpoint, Vec3::from_array),
        size: options.size.unwrap_or_else(|| setup.view_size(setup.resolution[0])),
        window: options.window,
        supersampling: options.supersampling.max(1).into(),
    };
    if !(camera.window > 0.0 && camera.window <= 1e3) {
        let message = format!("a window of {} shows nothing", camera.window);
        return Err(refused(py, message, "give a number above 0, at most 1000"));
    }
    let weight = if options.by_chance() { MEMORY_AS_RAYS } else { 1 };
    check_view(camera.size, camera.supersampling.max(weight)).map_err(|error| raised(py, error))?;
    let view = match options.by_chance() {
        true => by_chance(py, loaded, setup, &display, camera, options, kind)?,
        false => work(py, || view_through(&camera.rays(setup), &display))?
            .map_err(|error| raised(py, error))?,
    };
    picture::write(py, &view, kind)
}

fn by_chance(
    py: Python<'_>,
    loaded: &Loaded,
    setup: &Setup,
    display: &Picture,
    camera: Camera,
    options: &Options,
    kind: Kind,
) -> PyResult<Picture> {
    let own = loaded.scene.plate.model;
    let model = options.plate(py, own)?;
    let light = options.light(py)?;
    let setup = setup.with_plate_model(&own, &model).map_err(|error| raised(py, error))?;
    let viewer = Viewer { camera, aperture: options.aperture.unwrap_or(0.0), focus: options.focus };
    let usual = Settings::default();
    let settings = Settings {
        samples_per_pixel: options.spp.unwrap_or(usual.samples_per_pixel),
        seed: options.seed.unwrap_or(usual.seed),
    };
    let render =
        interruptible(py, |watch| render(&setup, display, &viewer, &settings, watch, &mut |_| ()))?;
    let render = render.map_err(|error| raised(py, error))?;
    let view = render.view(light);
    // Codes are of a picture that is exposed; light is light.
    Ok(match kind {
        Kind::Light => view,
        Kind::Eight | Kind::Sixteen => {
            let exposure = options.exposure.map_or(Exposure::Auto, Exposure::Fixed);
            let factor = exposure.factor(&view);
            exposed(&view, factor)
        }
    })
}
