//! What stands before the camera: with and without the object, shown compensated and as it is.

use super::super::proof::displacement::interpolated;
use crate::geometry::{Rectangle, Vec3};
use crate::map::{Accuracy, Map, apply_inverse, invert, reach};
use crate::optics::plate::Model;
use crate::picture::{Picture, display_image};
use crate::scene::model::{Material, Shape};
use crate::scene::{Asset, Loaded};
use crate::simulate::{
    Camera, Light, Settings as RenderSettings, SimulateError, Viewer, render_all,
};
use crate::transport::{End, Path, Setup, SetupError};

/// Why an evaluation cannot be done.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// A scene cannot be traced.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A view cannot be rendered.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The lattice cannot be drawn.
    #[error(transparent)]
    Lattice(#[from] crate::measure::lattice::LatticeStyleError),
    /// Views cannot be compared.
    #[error(transparent)]
    Similarity(#[from] crate::measure::SimilarityError),
    /// Views cannot be compared by LPIPS.
    #[error(transparent)]
    Lpips(#[from] crate::measure::lpips::LpipsError),
    /// No light of the image reaches the eye.
    #[error("{surface}: no point of the image is formed for an eye at ({x:.0}, {y:.0}, {z:.0}) mm")]
    NothingFormed {
        /// The surface.
        surface: String,
        /// The eye, mm.
        x: f64,
        /// The eye, mm.
        y: f64,
        /// The eye, mm.
        z: f64,
    },
}

/// One of the paper's surfaces, ready to be looked at.
pub(super) struct Stage<'a> {
    loaded: &'a Loaded,
    /// The object in its place.
    object: Setup,
    /// Without it: solids taken away, bent mirrors made flat, for without a mirror the image could not be seen from there.
    without: Setup,
}

/// How a view is taken.
#[derive(Clone, Copy)]
pub(super) struct Take {
    pub camera: Camera,
    /// Diameter of the pupil, mm.
    pub aperture: f64,
    pub samples_per_pixel: u32,
    pub seed: u32,
    /// Which light the picture shows.
    pub light: Light,
}

impl<'a> Stage<'a> {
    pub fn new(loaded: &'a Loaded, plate: &Model) -> Result<Self, SetupError> {
        let mut flat = loaded.clone();
        // Where the image belongs without the object.
        flat.scene.display.pose = None;
        flat.scene.display.size = None;
        let mirrors = loaded.scene.elements.iter().zip(&loaded.assets);
        let mirrors = mirrors.filter(|(e, _)| matches!(e.material, Material::Mirror { .. }));
        (flat.scene.elements, flat.assets) =
            mirrors.map(|(element, asset)| (element.clone(), asset.clone())).unzip();
        for (element, asset) in flat.scene.elements.iter_mut().zip(&mut flat.assets) {
            // No larger: it must not come between plate and display.
            let size = match element.shape {
                Shape::CylinderMirror { size, .. } | Shape::HeightField { size, .. } => size,
                Shape::SphereMirror { diameter, .. } => [diameter; 2],
                _ => continue,
            };
            element.shape = Shape::Plane { size };
            *asset = Asset::None;
        }
        let through = |loaded: &Loaded| -> Result<Setup, SetupError> {
            Ok(Setup::new(loaded)?.with_plate(plate.clone()))
        };
        Ok(Self { loaded, object: through(loaded)?, without: through(&flat)? })
    }

    pub fn image(&self) -> Rectangle {
        self.object.image
    }

    pub fn viewpoint(&self) -> Vec3 {
        self.object.viewpoint
    }

    /// What the display must show for an eye that sees the image through the object (`with_object`) or as if it were not there, on a
    /// display that covers all of the image with `columns` pixels in a row.
    pub fn display(
        &self,
        eye: Vec3,
        with_object: bool,
        columns: usize,
    ) -> Result<Display, PaperError> {
        let mut setup = if with_object { self.object.clone() } else { self.without.clone() };
        setup.viewpoint = eye;
        setup.display = covering(&setup).ok_or_else(|| PaperError::NothingFormed {
            surface: self.loaded.scene.name.clone(),
            x: eye.x,
            y: eye.y,
            z: eye.z,
        })?;
        let [width, height] = setup.display.size;
        let rows = (columns as f64 * height / width).round();
        setup.resolution = [columns, (rows as usize).clamp(1, 4 * columns)];
        let (map, _) = invert(&setup, Accuracy::default());
        Ok(Display { setup, map })
    }

    /// The views of a display that shows one of these after the other, with the object or without it; linear light.
    pub fn views(
        &self,
        display: &Display,
        shown: &[Picture],
        with_object: bool,
        take: Take,
    ) -> Result<Vec<Picture>, SimulateError> {
        let mut setup = if with_object { self.object.clone() } else { self.without.clone() };
        (setup.display, setup.resolution) = (display.setup.display, display.setup.resolution);
        let viewer = Viewer { camera: take.camera, aperture: take.aperture, focus: None };
        let settings =
            RenderSettings { samples_per_pixel: take.samples_per_pixel, seed: take.seed };
        let shown: Vec<&Picture> = shown.iter().collect();
        let rendered = render_all(&setup, &shown, &viewer, &settings, &(), &mut |_| ())?;
        Ok(rendered.into_iter().map(|view| view.view(take.light)).collect())
    }

    /// Where an eye sees, through the object, what a display shows: by calculation, over `window` times the image.
    pub fn sight(&self, display: &Display, eye: Vec3, window: f64) -> Sight {
        let mut setup = self.object.clone();
        setup.viewpoint = eye;
        setup.image.size = setup.image.size.map(|side| side * window);
        setup.display = display.setup.display;
        let [columns, rows] = display.setup.resolution;
        setup.resolution = [SIGHT, (SIGHT * rows / columns).max(2)];
        let (map, _) = invert(&setup, Accuracy::default());
        Sight { setup, map, window }
    }
}

/// Pixels in a row of the maps that tell where a display's points are seen; from there Newton's method goes on.
const SIGHT: usize = 256;

/// A display for one eye: where it stands, and the map that it is coloured through.
pub(super) struct Display {
    setup: Setup,
    map: Map,
}

impl Display {
    pub fn showing(&self, picture: &Picture) -> Picture {
        display_image(picture, &self.map)
    }

    /// The point that shows an image point, in the world; `None` where the eye it is for sees none.
    pub fn shown_at(&self, uv: [f64; 2]) -> Option<Vec3> {
        let st = self.setup.transport(uv, &mut Path::new()).formed()?;
        Some(self.setup.display.point(st))
    }
}

/// An eye that looks at a display.
pub(super) struct Sight {
    /// Its image is larger than the scene's by `window`.
    setup: Setup,
    map: Map,
    window: f64,
}

impl Sight {
    /// The image point where a point of the display is seen; `None` where it is not, or at several places.
    pub fn seen_at(&self, point: Vec3) -> Option<[f64; 2]> {
        let st = self.setup.display.coordinates(point);
        let mut uv = interpolated(&self.map, st)?;
        let mut path = Path::new();
        // The map is interpolated to a hundredth of its pixel or so: two steps leave rounding.
        for _ in 0..4 {
            self.setup.transport(uv, &mut path).st()?;
            let (end, jacobian) = self.setup.follow_with_jacobian(uv, &mut path);
            let step = apply_inverse(jacobian, [st[0] - end[0], st[1] - end[1]]);
            uv = [uv[0] + step[0], uv[1] + step[1]];
        }
        let end = self.setup.transport(uv, &mut path).st()?;
        // A nanometre on a display of a metre: where steps do not lead there, the point lies at an edge.
        let near = (end[0] - st[0]).hypot(end[1] - st[1]) < 1e-9;
        near.then(|| uv.map(|c| (c - 0.5) * self.window + 0.5))
    }
}

/// Image points along each side that are followed to see how large a display must be.
const PROBES: usize = 48;

/// The part of the display's plane that the whole image needs, with a little more around.
fn covering(setup: &Setup) -> Option<Rectangle> {
    let mut path = Path::new();
    let asked_for = (0..(PROBES + 1) * (PROBES + 1)).filter_map(|index| {
        let uv = [index % (PROBES + 1), index / (PROBES + 1)].map(|i| i as f64 / PROBES as f64);
        match setup.transport(uv, &mut path) {
            End::Display { st, through_plate: true } => Some(st),
            _ => None,
        }
    });
    // An edge that a line of sight only grazes throws its light anywhere: not a display for that.
    let [low, high] = reach(asked_for.filter(|st| st.iter().all(|c| (-2.0..=3.0).contains(c))))?;
    let mut display = setup.display;
    display.frame.origin =
        setup.display.point([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])]);
    // Two per cent on each side, for what lies between the probes.
    display.size = [0, 1].map(|axis| 1.04 * (high[axis] - low[axis]) * setup.display.size[axis]);
    display.size.iter().all(|side| *side > 0.0).then_some(display)
}
