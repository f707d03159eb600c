//! The paper's own method, kept for comparison: shoot many samples through each view pixel and keep what lands.

use super::{Map, Status, pixel_at};
use crate::transport::{Packets, Setup};
use rayon::prelude::*;

/// A map by scattered samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Splat {
    /// The map: each pixel holds the mean uv of the samples that landed in it; no error is bounded, so its
    /// `error_bound` is infinite. A pixel that no sample hit is `Outside`: its holes look like that.
    pub map: Map,
    /// Samples traced.
    pub rays: u64,
}

impl Splat {
    /// Pixels that the exact map answers and the samples missed.
    pub fn holes(&self, exact: &Map) -> usize {
        let answered = |status: &Status| status.is_answered();
        exact
            .status
            .iter()
            .zip(&self.map.status)
            .filter(|(e, s)| answered(e) && !answered(s))
            .count()
    }
}

/// Samples that are followed together.
const AT_ONCE: usize = 4096;

/// Shoots `spp` random samples through each of as many view pixels as the display has, from the viewpoint.
///
/// `progress` is called with a number of view rows whenever they are done.
pub fn splat(setup: &Setup, spp: usize, progress: &(dyn Fn(usize) + Sync)) -> Splat {
    let [width, height] = setup.resolution;
    let threads = rayon::current_num_threads().min(height).max(1);
    let sums = (0..threads)
        .into_par_iter()
        .map(|thread| {
            let mut sums = vec![[0.0f64; 3]; width * height];
            let mut random = fastrand::Rng::with_seed(thread as u64);
            let mut packets = Packets::new(setup, setup.viewpoint);
            let mut samples = vec![[0.0; 2]; AT_ONCE.min(width * spp)];
            for row in (thread..height).step_by(threads) {
                let mut in_row = 0..width * spp;
                while !in_row.is_empty() {
                    let count = in_row.len().min(AT_ONCE);
                    for (uv, number) in samples.iter_mut().zip(in_row.by_ref().take(count)) {
                        *uv = [
                            ((number / spp) as f64 + random.f64()) / width as f64,
                            ((height - 1 - row) as f64 + random.f64()) / height as f64,
                        ];
                    }
                    packets.ends(&samples[..count], |i, end| {
                        let Some(st) = end.formed() else { return };
                        let (x, y) = pixel_at(st, width, height);
                        let (sum, uv) = (&mut sums[y * width + x], samples[i]);
                        *sum = [sum[0] + uv[0], sum[1] + uv[1], sum[2] + 1.0];
                    });
                }
                progress(1);
            }
            sums
        })
        .reduce_with(|mut a, b| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a = [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
            a
        })
        .unwrap_or_default();
    let mut map = Map::unanswered(width, height);
    map.error_bound = f64::INFINITY;
    for ((uv, status), [u, v, count]) in map.uv.iter_mut().zip(&mut map.status).zip(sums) {
        if count > 0.0 {
            *uv = [u / count, v / count];
            *status = Status::Ok;
        }
    }
    Splat { map, rays: (width * height * spp) as u64 }
}
