//! The paper's own method, measured beside the exact map.

use super::{ProofError, Shown};
use crate::clock::Stopwatch;
use crate::map::{Map, Status, splat};
use crate::monitor::Monitor;
use crate::transport::Setup;
use std::time::Duration;

/// What scattering samples gave.
#[derive(Clone, Debug)]
pub struct Baseline {
    /// Samples per pixel.
    pub spp: usize,
    /// The map.
    pub map: Map,
    /// Samples traced.
    pub rays: u64,
    /// Time that it took.
    pub time: Duration,
    /// Pixels of the exact map that have an answer: the reached region.
    pub reached: usize,
    /// Pixels of the reached region that no sample hit.
    pub holes: usize,
    /// Root mean square of |uv - exact| over the pixels that are ok in both, of 1.
    pub rms_error: f64,
    /// The largest |uv - exact| there, of 1.
    pub max_error: f64,
    /// The picture through this map.
    pub shown: Option<Shown>,
}

impl Baseline {
    pub(super) fn measure(
        setup: &Setup,
        exact: &Map,
        spp: usize,
        monitor: &dyn Monitor,
    ) -> Result<Self, ProofError> {
        let start = Stopwatch::start();
        let splat = splat(setup, spp, &|rows| monitor.advance(rows));
        let time = start.elapsed();
        let (mut squares, mut max_error, mut count) = (0.0, 0.0f64, 0usize);
        for index in 0..exact.uv.len() {
            if exact.status[index] == Status::Ok && splat.map.status[index] == Status::Ok {
                let (a, b) = (splat.map.uv[index], exact.uv[index]);
                let error = (a[0] - b[0]).hypot(a[1] - b[1]);
                squares += error * error;
                max_error = max_error.max(error);
                count += 1;
            }
        }
        let reached = exact.status.iter().filter(|status| status.is_answered()).count();
        Ok(Self {
            spp,
            holes: splat.holes(exact),
            rays: splat.rays,
            map: splat.map,
            time,
            reached,
            rms_error: (squares / count.max(1) as f64).sqrt(),
            max_error,
            shown: None,
        })
    }
}
