//! A map and what it took.

use crate::Monitor;
use crate::clock::Stopwatch;
use crate::map::{Accuracy, Effort, Map, invert, splat};
use crate::transport::Setup;
use serde::Serialize;
use std::time::Duration;

/// How a map is made.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase", tag = "method")]
pub enum Method {
    /// Exactly, by adaptive inversion with an error bound.
    Inverse {
        /// How finely.
        #[serde(skip)]
        accuracy: Accuracy,
    },
    /// The paper's way: random samples through the view, kept where they land.
    Splat {
        /// Samples per view pixel.
        spp: usize,
    },
}

impl Default for Method {
    fn default() -> Self {
        Self::Inverse { accuracy: Accuracy::default() }
    }
}

/// A map and what it took.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solved {
    /// What it is the map of.
    pub setup: Setup,
    /// The map.
    pub map: Map,
    /// Rays traced.
    pub rays: u64,
    /// What the inversion did; `None` for another method.
    pub effort: Option<Effort>,
    /// Time spent.
    pub time: Duration,
}

impl Solved {
    pub(super) fn make(setup: Setup, method: Method, monitor: &dyn Monitor) -> Self {
        let start = Stopwatch::start();
        match method {
            Method::Inverse { accuracy } => {
                monitor.stage("map", 1);
                let (map, effort) = invert(&setup, accuracy);
                let time = start.elapsed();
                Self { setup, map, rays: effort.rays, effort: Some(effort), time }
            }
            Method::Splat { spp } => {
                monitor.stage("samples of the view", setup.resolution[1]);
                let splat = splat(&setup, spp, &|rows| monitor.advance(rows));
                let time = start.elapsed();
                Self { setup, map: splat.map, rays: splat.rays, effort: None, time }
            }
        }
    }
}
