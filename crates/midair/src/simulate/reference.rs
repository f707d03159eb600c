//! What should be seen.

use super::Camera;
use crate::optics::plate::Model;
use crate::picture::optimal::ViewRays;
use crate::transport::Setup;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The rays of the view with no object in the way: what the plate shows by itself of a display that is drawn for it, so that every image point
/// is seen where it belongs.
///
/// For a plate with one plane of symmetry that is the picture as it is. One with two shows it out of place, by some hundredths of a millimetre
/// more in one corner than in another wherever the display stands, and the display that is drawn for it makes up for just that:
/// again the plane symmetry alone remains.
///
/// A mirror may show what its plate, out of the straight way, could not: a ray that the plate alone would not bring to the display
/// ends where a plate without edges would bring it, at the display point that belongs to the image point, st = uv. It is completed.
#[derive(Debug)]
pub struct Reference<'a> {
    setup: Setup,
    camera: &'a Camera,
    asked: AtomicUsize,
    completed: AtomicUsize,
}

impl<'a> Reference<'a> {
    /// The camera's rays through the set-up without its elements.
    pub fn new(setup: &Setup, camera: &'a Camera) -> Self {
        let setup = setup.with_plate(Model::Ideal).unobstructed();
        Self { setup, camera, asked: AtomicUsize::new(0), completed: AtomicUsize::new(0) }
    }

    /// The share of the rays asked for so far that were completed.
    pub fn completed(&self) -> f64 {
        let asked = self.asked.load(Ordering::Relaxed);
        self.completed.load(Ordering::Relaxed) as f64 / asked.max(1) as f64
    }
}

impl ViewRays for Reference<'_> {
    fn size(&self) -> [usize; 2] {
        self.camera.size
    }

    fn rays_per_pixel(&self) -> usize {
        self.camera.rays(&self.setup).rays_per_pixel()
    }

    fn ends(&self, pixels: Range<usize>, ends: &mut [[f64; 2]]) {
        let (sight, each) = (self.camera.rays(&self.setup), self.rays_per_pixel());
        sight.ends(pixels.clone(), ends);
        let mut completed = 0;
        for (index, st) in ends.iter_mut().enumerate().filter(|(_, st)| st[0].is_nan()) {
            let uv = sight.image_point(pixels.start + index / each, index % each);
            if uv.iter().all(|c| (0.0..=1.0).contains(c)) {
                *st = uv;
                completed += 1;
            }
        }
        self.asked.fetch_add(ends.len(), Ordering::Relaxed);
        self.completed.fetch_add(completed, Ordering::Relaxed);
    }
}
