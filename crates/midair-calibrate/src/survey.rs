//! From decoded photographs to points for the fit: which of them are real, and where the cameras stood.

use crate::camera::Lens;
use crate::cameras::{self, ViewPoints};
use crate::correspondences::Correspondence;
use crate::decoded::Decoded;
use crate::equations::without_elements;
use crate::plane::{Pair, distances, homography, median};
use crate::stray::mark;
use midair::geometry::Frame;
use midair::scene::Loaded;
use midair::transport::Setup;
use midair::{Error, Monitor};

/// What one state of a view was decoded to.
#[derive(Clone, Debug)]
pub enum Sighting {
    /// By us: what every pixel sees.
    Photographs(Box<Decoded>),
    /// By another tool: points.
    Points(Vec<Correspondence>),
}

/// A view as it was decoded.
#[derive(Clone, Debug)]
pub struct SightedView {
    /// What it is called.
    pub name: String,
    /// Without the object.
    pub empty: Sighting,
    /// With it.
    pub object: Sighting,
}

/// About the most points of one state of a view: more tell nothing more.
pub const MOST_POINTS: usize = 10_000;

impl Sighting {
    /// Its points.
    pub fn points(&self, resolution: [usize; 2]) -> Vec<Correspondence> {
        match self {
            Self::Photographs(decoded) => decoded.correspondences(resolution, MOST_POINTS),
            Self::Points(points) => points.clone(),
        }
    }
}

/// Where the cameras stood, the lens, and each view's points, stray light told apart.
#[derive(Clone, Debug)]
pub struct Survey {
    /// Each view's camera: its axes are right, down and ahead.
    pub cameras: Vec<Frame>,
    /// The lens.
    pub lens: Lens,
    /// The points.
    pub views: Vec<ViewPoints>,
}

/// Finds the cameras by the empty photographs, and marks stray light by where the assumed scene has it.
///
/// # Errors
/// Views with too few points, or whose empty photographs are no flat picture.
pub fn survey(
    loaded: &Loaded,
    lens: Option<Lens>,
    views: &mut [SightedView],
    monitor: &dyn Monitor,
) -> Result<Survey, Error> {
    let setup = Setup::new(loaded)?;
    let resolution = setup.resolution;
    let points = |views: &[SightedView]| -> Vec<ViewPoints> {
        views
            .iter()
            .map(|view| ViewPoints {
                name: view.name.clone(),
                empty: view.empty.points(resolution),
                object: view.object.points(resolution),
            })
            .collect()
    };
    monitor.stage("cameras", 1);
    let mut first = points(views);
    for view in &mut first {
        view.empty = agreeing(&view.empty);
    }
    let found = cameras::find(loaded, &first, lens, &|| monitor.is_cancelled())?;
    let (cameras, lens) = (found.state.cameras, found.state.lens);
    let bare = without_elements(&setup);
    monitor.stage("stray light", 2 * views.len());
    for (view, camera) in views.iter_mut().zip(&cameras) {
        for (sighting, setup) in [(&mut view.empty, &bare), (&mut view.object, &setup)] {
            if let Sighting::Photographs(decoded) = sighting {
                mark(decoded, setup, camera, &lens);
            }
            monitor.advance(1);
        }
    }
    Ok(Survey { cameras, lens, views: points(views) })
}

/// The points that agree with one flat picture, as far as a lens bends it: stray images are others.
fn agreeing(points: &[Correspondence]) -> Vec<Correspondence> {
    let pairs: Vec<Pair> = points.iter().map(|p| Pair { on_plane: p.pixel, seen: p.st }).collect();
    let Some(h) = homography(&pairs) else { return points.to_vec() };
    let off = distances(&h, &pairs);
    // A fiftieth of the display is more than lenses bend; a stray image is further off nearly everywhere.
    let bound = (4.0 * median(&off)).clamp(0.005, 0.05);
    points.iter().zip(&off).filter(|(_, off)| **off <= bound).map(|(p, _)| *p).collect()
}
