//! The map without a model of the object: each camera pixel's image point by the empty photograph, its display point by the object photograph.

use crate::camera::{Lens, seen_at};
use crate::decoded::Decoded;
use midair::geometry::Frame;
use midair::map::{Map, Status, pixel_centre, reversed};
use midair::transport::Setup;
use rayon::prelude::*;

/// The most image samples along a side: about as many as a camera has pixels there.
const MOST: usize = 2048;

/// The map G at a camera's place, whatever stands between it and the plate: sampled through the camera's pixels, so as exact as they were decoded, and with no
/// answer where nothing was. `setup` says where the image and the display are.
pub fn model_free(setup: &Setup, camera: &Frame, lens: &Lens, object: &Decoded) -> Map {
    let corner = |uv: [f64; 2]| seen_at(camera, lens, setup.image.point(uv));
    let apart = |a: [f64; 2], b: [f64; 2]| match (corner(a), corner(b)) {
        (Some(a), Some(b)) => (a[0] - b[0]).hypot(a[1] - b[1]),
        _ => 0.0,
    };
    let size = [apart([0.0, 0.5], [1.0, 0.5]), apart([0.5, 0.0], [0.5, 1.0])]
        .map(|pixels| (pixels.round() as usize).clamp(2, MOST));
    let [width, height] = size;
    let (uv, status) = (0..width * height)
        .into_par_iter()
        .map(|i| {
            let uv = pixel_centre(i % width, i / width, width, height);
            let seen = corner(uv).and_then(|pixel| object.around(pixel, setup.resolution));
            match seen.filter(|st| st.iter().all(|c| (0.0..=1.0).contains(c))) {
                Some(st) => (st, Status::Ok),
                None => ([f64::NAN; 2], Status::Outside),
            }
        })
        .unzip();
    let forward = Map { width, height, uv, status, error_bound: f64::INFINITY };
    reversed(&forward, setup.resolution)
}
