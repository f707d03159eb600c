//! The proof: what the viewer sees, measured against what should be seen.
//!
//! One picture and one lattice go three ways through the forward simulator: shown compensated, shown as they are
//! (uncompensated), and shown with no object in the way (the reference). The lattice tells shape, the picture likeness. Beside the
//! map's plain filter stand the averaged scatter, the best display image, and the paper's own map by splatting. [`compare_ways`] sets ways to fill the display
//! side by side on several pictures, maps by others among them.

mod baseline;
pub(super) mod displacement;
mod likeness;
mod told;
mod ways;

pub use baseline::Baseline;
pub use displacement::Shape;
pub use likeness::{Likeness, Region};
pub use ways::{Compared, Comparison, Way, WaySettings, compare_ways};

use crate::Monitor;
use crate::clock::{Laps, Stopwatch};
use crate::compensate::{AsIs, uncompensated_map};
use crate::map::{Accuracy, Effort, Formation, Map, formation, invert};
use crate::measure::SimilarityError;
use crate::measure::lattice::{LatticeStyle, LatticeStyleError, draw_lattice};
use crate::picture::optimal::{
    OptimalError, ViewSamples, Weighting, optimal_display, scatter_average, view_through,
};
use crate::picture::{Picture, display_image};
use crate::simulate::{Camera, Reference};
use crate::transport::{Setup, SetupError};
use std::time::Duration;

/// What is proved, and how finely.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Width and height of the views in pixels.
    pub view: [usize; 2],
    /// Rays through each view pixel along each side.
    pub supersampling: usize,
    /// Samples per pixel of the paper's own method, which is measured beside ours; 0 leaves it out.
    pub splat_spp: usize,
    /// The lattice that displacement is measured on.
    pub lattice: LatticeStyle,
}

impl Settings {
    /// Views with as many pixels in a row as the display has and with the image's proportions, four rays a pixel, the
    /// paper's lattice, and the paper's method with 32 samples a pixel: the paper has 1000, which take minutes for the same message.
    pub fn for_setup(setup: &Setup) -> Self {
        Self {
            view: setup.view_size(setup.resolution[0]),
            supersampling: 2,
            splat_spp: 32,
            lattice: LatticeStyle::default(),
        }
    }
}

/// Why nothing can be proved.
#[derive(Debug, thiserror::Error)]
pub enum ProofError {
    /// The scene cannot be traced.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The lattice cannot be drawn.
    #[error(transparent)]
    Lattice(#[from] LatticeStyleError),
    /// The sizes of views and displays do not fit together.
    #[error(transparent)]
    View(#[from] OptimalError),
    /// The views cannot be compared.
    #[error(transparent)]
    Similarity(#[from] SimilarityError),
}

/// One way to fill the display, what is seen of it, and how like the reference that is.
#[derive(Clone, Debug)]
pub struct Shown {
    /// What the display shows; linear light.
    pub display: Picture,
    /// What the viewer sees; linear light.
    pub view: Picture,
    /// Against the reference; `None` where no pixel is formed.
    pub likeness: Option<Likeness>,
    /// Time to make the display image from map and picture.
    pub time: Duration,
}

/// All that was found; serialised, its figures.
#[derive(Clone, Debug)]
pub struct Proof {
    /// What was asked for.
    pub settings: Settings,
    /// The map.
    pub map: Map,
    /// What the inversion did.
    pub effort: Effort,
    /// Time that the map took.
    pub map_time: Duration,
    /// What becomes of the image's points, at the views' pixels.
    pub formation: Formation,
    /// The view pixels over which views are compared.
    pub region: Region,
    /// The picture with no object in the way.
    pub reference: Picture,
    /// The share of the reference's rays that were completed, see [`Reference`].
    pub reference_completed: f64,
    /// The picture shown as it is.
    pub uncompensated: Shown,
    /// The picture through the map with the plain filter.
    pub compensated: Shown,
    /// The picture by averaged scatter of the view's rays.
    pub scattered: Shown,
    /// The best display image there is.
    pub optimal: Shown,
    /// The lattice: with no object, and seen compensated and not.
    pub lattice: LatticeProof,
    /// The paper's own method, if asked for.
    pub splat: Option<Baseline>,
    /// How long each stage took, in their order.
    pub timings: Vec<(&'static str, Duration)>,
}

/// The lattice's three views and what they show.
#[derive(Clone, Debug)]
pub struct LatticeProof {
    /// With no object in the way.
    pub reference: Picture,
    /// Compensated.
    pub compensated: Shape,
    /// Shown as it is.
    pub uncompensated: Shape,
}

/// Proves a scene on a picture, which is stretched over the image.
///
/// # Errors
/// [`ProofError`] where the scene cannot be traced or the settings cannot be met.
pub fn prove(
    setup: &Setup,
    picture: &Picture,
    settings: &Settings,
    monitor: &dyn Monitor,
) -> Result<Proof, ProofError> {
    let mut laps = Laps::start();

    monitor.stage("map", 1);
    let (map, effort) = invert(setup, Accuracy::default());
    let map_time = laps.lap("map");

    monitor.stage("what can be formed", 1);
    let formation = formation(setup, &map, settings.view);
    let region = Region::of(&formation);
    laps.lap("formation");

    let camera = Camera {
        eye: setup.viewpoint,
        size: settings.view,
        window: 1.0,
        supersampling: settings.supersampling,
    };
    monitor.stage("rays of the view", settings.view[1]);
    let samples = ViewSamples::of(&camera.rays(setup), &|rows| monitor.advance(rows));
    monitor.stage("rays of the reference", settings.view[1]);
    let open = Reference::new(setup, &camera);
    let open_samples = ViewSamples::of(&open, &|rows| monitor.advance(rows));
    let reference_completed = open.completed();
    laps.lap("view_rays");

    let [width, height] = setup.resolution;
    let as_is = uncompensated_map(setup);
    let identity = Map::identity(width, height);

    monitor.stage("pictures", 4);
    let reference = view_through(&open_samples, &display_image(picture, &identity))?;
    let standard = region.standard(&reference)?;
    let shown = |display: Picture, time: Duration| -> Result<Shown, ProofError> {
        let view = view_through(&samples, &display)?;
        let likeness = standard.as_ref().map(|of| region.likeness(&view, of)).transpose()?;
        monitor.advance(1);
        Ok(Shown { display, view, likeness, time })
    };
    let timed = |make: &dyn Fn() -> Result<Picture, OptimalError>| -> Result<_, ProofError> {
        let start = Stopwatch::start();
        let display = make()?;
        Ok((display, start.elapsed()))
    };
    let (display, time) = timed(&|| Ok(display_image(picture, &as_is)))?;
    let uncompensated = shown(display, time)?;
    let (display, time) = timed(&|| Ok(display_image(picture, &map)))?;
    let compensated = shown(display, time)?;
    let (display, time) = timed(&|| scatter_average(&samples, &reference, width, height))?;
    let scattered = shown(display, time)?;
    let (display, time) = timed(&|| best(&samples, &reference, &compensated.display))?;
    let optimal = shown(display, time)?;
    laps.lap("pictures");

    monitor.stage("lattice", 3);
    // Twice as fine as view and display, so that display pixels average over exact shares of the lines' edges.
    let [columns, rows] = [0, 1].map(|axis| 2 * settings.view[axis].max(setup.resolution[axis]));
    let drawn = draw_lattice(columns, rows, &settings.lattice)?;
    let flat = view_through(&open_samples, &display_image(&drawn, &identity))?;
    monitor.advance(1);
    let lattice = {
        let sight = displacement::Sight { setup, map: &map };
        let measure = displacement::Measure::new(&settings.lattice, &flat);
        let view = view_through(&samples, &display_image(&drawn, &map))?;
        let compensated = measure.shape(view, |uv| sight.compensated(uv), &camera);
        monitor.advance(1);
        let view = view_through(&samples, &display_image(&drawn, &as_is))?;
        let shown_at = AsIs::new(setup);
        let place = |uv| sight.uncompensated(shown_at.shown_at(uv));
        let uncompensated = measure.shape(view, place, &camera);
        monitor.advance(1);
        LatticeProof { reference: flat, compensated, uncompensated }
    };
    laps.lap("lattice");

    let splat = match settings.splat_spp {
        0 => None,
        spp => {
            monitor.stage("the paper's method", height);
            let baseline = Baseline::measure(setup, &map, spp, monitor)?;
            let start = Stopwatch::start();
            let display = display_image(picture, &baseline.map);
            let shown = shown(display, start.elapsed())?;
            laps.lap("splat");
            Some(Baseline { shown: Some(shown), ..baseline })
        }
    };
    Ok(Proof {
        settings: settings.clone(),
        map,
        effort,
        map_time,
        formation,
        region,
        reference,
        reference_completed,
        uncompensated,
        compensated,
        scattered,
        optimal,
        lattice,
        splat,
        timings: laps.into_all(),
    })
}

fn best(
    samples: &ViewSamples,
    target: &Picture,
    initial: &Picture,
) -> Result<Picture, OptimalError> {
    let best = optimal_display(samples, target.clone(), initial.clone(), Weighting::default())?;
    Ok(best.display)
}

#[cfg(test)]
mod tests;
