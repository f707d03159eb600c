//! A proof as data: the figures of report.json.

use super::{Baseline, Likeness, Proof, Shape, Shown};
use crate::map::{Counts, Effort};
use crate::measure::lattice::Displacement;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

#[derive(Serialize)]
struct Told<'a> {
    method: &'static str,
    size: [usize; 2],
    view: View,
    status: Counts,
    error_bound: f64,
    rays: u64,
    effort: Effort,
    formed: f64,
    compared_share: f64,
    reference_completed: f64,
    lattice: ToldLattice<'a>,
    likeness: Likenesses<'a>,
    splat: Option<ToldBaseline>,
}

#[derive(Serialize)]
struct View {
    size: [usize; 2],
    supersampling: usize,
}

#[derive(Serialize)]
struct ToldLattice<'a> {
    lines: usize,
    compensated: &'a Shape,
    uncompensated: &'a Shape,
}

/// The ways to fill the display, by their names in JSON.
struct Likenesses<'a>(Vec<(&'static str, &'a Shown)>);

#[derive(Serialize)]
struct ToldBaseline {
    spp: usize,
    time_ms: f64,
    rays: u64,
    reached: usize,
    holes: usize,
    rms_error: f64,
    max_error: f64,
}

impl Proof {
    /// The ways to fill the display, by their names in JSON, in the order in which they are told.
    pub fn ways(&self) -> Vec<(&'static str, &Shown)> {
        let splat = self.splat.as_ref().and_then(|splat| splat.shown.as_ref());
        let known = [
            ("uncompensated", &self.uncompensated),
            ("compensated", &self.compensated),
            ("scattered", &self.scattered),
            ("optimal", &self.optimal),
        ];
        known.into_iter().chain(splat.map(|shown| ("splat", shown))).collect()
    }
}

/// All figures, without the pictures and the times: these differ from run to run.
impl Serialize for Proof {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let told = Told {
            method: "inverse",
            size: [self.map.width, self.map.height],
            view: View { size: self.settings.view, supersampling: self.settings.supersampling },
            status: self.map.counts(),
            error_bound: self.map.error_bound,
            rays: self.effort.rays,
            effort: self.effort,
            formed: self.formation.formed(),
            compared_share: self.region.share,
            reference_completed: self.reference_completed,
            lattice: ToldLattice {
                lines: self.settings.lattice.lines,
                compensated: &self.lattice.compensated,
                uncompensated: &self.lattice.uncompensated,
            },
            likeness: Likenesses(self.ways()),
            splat: self.splat.as_ref().map(ToldBaseline::of),
        };
        told.serialize(serializer)
    }
}

impl Serialize for Likenesses<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, shown)| (name, &shown.likeness)))
    }
}

impl ToldBaseline {
    fn of(splat: &Baseline) -> Self {
        Self {
            spp: splat.spp,
            time_ms: splat.time.as_secs_f64() * 1e3,
            rays: splat.rays,
            reached: splat.reached,
            holes: splat.holes,
            rms_error: splat.rms_error,
            max_error: splat.max_error,
        }
    }
}

impl Serialize for Likeness {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(2))?;
        map.serialize_entry("ssim", &self.ssim)?;
        map.serialize_entry("psnr_db", &self.psnr)?;
        map.end()
    }
}

/// Without the views.
impl Serialize for Shape {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        #[serde(untagged)]
        enum Measured<'a> {
            Of(&'a Displacement),
            Not { mean: Option<f64>, max: Option<f64>, compared: usize, why: &'a str },
        }
        let measured = match &self.measured {
            Ok(measured) => Measured::Of(measured),
            Err(why) => Measured::Not { mean: None, max: None, compared: 0, why },
        };
        let mut map = serializer.serialize_map(Some(4))?;
        map.serialize_entry("measured", &measured)?;
        map.serialize_entry("exact", &self.exact)?;
        map.serialize_entry("exact_of_measured", &self.exact_there)?;
        map.serialize_entry("left_out", &self.left_out)?;
        map.end()
    }
}
