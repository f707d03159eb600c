//! What should be seen.

use crate::media::optimal::ViewSamples;
use crate::scene::Loaded;
use crate::simulate::Camera;
use crate::transport::Setup;

/// Where the rays of the view end on the display with no object in the way: the reference's rays.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The rays' ends.
    pub samples: ViewSamples,
    /// The share of the rays that the plate alone would not bring to the display. A mirror may show what its plate, out of the straight
    /// way, could not. They end where a plate without edges would bring them: at the display point that belongs to the image
    /// point, st = uv.
    pub completed: f64,
}

impl Reference {
    /// Traces the camera's rays through the scene without its elements. `progress` is called with rows that are done.
    pub fn new(loaded: &Loaded, camera: &Camera, progress: &(dyn Fn(usize) + Sync)) -> Self {
        let mut samples = camera.samples(&Setup::without_elements(loaded), progress);
        let n = camera.supersampling;
        let mut completed = 0usize;
        for (index, st) in samples.st.iter_mut().enumerate().filter(|(_, st)| st[0].is_nan()) {
            let (pixel, sub) = (index / (n * n), index % (n * n));
            let offset = |k: usize| (k as f64 + 0.5) / n as f64;
            let column = (pixel % camera.size[0]) as f64 + offset(sub % n);
            let row = (pixel / camera.size[0]) as f64 + offset(sub / n);
            let uv = camera.image_point(column, row);
            if uv.iter().all(|c| (0.0..=1.0).contains(c)) {
                *st = uv;
                completed += 1;
            }
        }
        let completed = completed as f64 / samples.st.len().max(1) as f64;
        Self { samples, completed }
    }
}
