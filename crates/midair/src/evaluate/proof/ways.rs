//! Ways to fill the display, side by side: as it is, by a homography, by the paper's scattered samples, by the exact map, by the best display image, and by
//! maps that others made. Views are calculated: sharp, and without the plate's stray light.

use super::displacement::interpolated;
use super::likeness::{Channels, Likeness, Region};
use super::{ProofError, best};
use crate::Monitor;
use crate::clock::Stopwatch;
use crate::compensate::{AsIs, uncompensated_map};
use crate::map::{Accuracy, Map, Status, formation, invert, pixel_centre, splat};
use crate::measure::lattice::{Alignment, LatticeStyle, aligned};
use crate::picture::optimal::{ViewSamples, view_through};
use crate::picture::{Picture, display_image};
use crate::simulate::{Camera, Reference};
use crate::transport::{Path, Setup};
use serde::{Deserialize, Serialize};

/// A map by a way that is not known here.
#[derive(Clone, Debug)]
pub struct Way {
    /// What it is called in tables.
    pub name: String,
    /// The map.
    pub map: Map,
    /// Seconds that it took.
    pub seconds: f64,
}

/// What came of one way.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Compared {
    /// What it is called.
    pub name: String,
    /// Mean displacement of the lattice's intersections from where they belong, pixels of the camera; `None` where there is no map to tell it by.
    pub displacement: Option<f64>,
    /// The largest.
    pub largest: Option<f64>,
    /// Intersections that it answers for, of those that are formed.
    pub intersections: usize,
    /// SSIM of the views with those without the object, over the part of the image that is formed; the mean over the pictures.
    pub ssim: Option<f64>,
    /// The same in dB.
    pub psnr: Option<f64>,
    /// Seconds for the map; of the best display image, for one picture.
    pub seconds: f64,
}

/// The ways of one set-up.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Name of the surface.
    pub surface: String,
    /// Intersections of the lattice that are formed.
    pub intersections: usize,
    /// Of how many.
    pub lattice: usize,
    /// The share of the view over which likeness is compared.
    pub share: f64,
    /// The ways.
    pub ways: Vec<Compared>,
}

/// How ways are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaySettings {
    /// Pixels of a view in a row.
    pub width: usize,
    /// Samples a pixel of the paper's method.
    pub splat_spp: usize,
    /// Pixels of the camera's picture to a millimetre in the image's plane: what a displacement is told in.
    pub pixels_per_mm: f64,
}

impl Default for WaySettings {
    fn default() -> Self {
        Self { width: 512, splat_spp: 32, pixels_per_mm: 16.8 }
    }
}

/// Rays through each view pixel along each side.
const RAYS: usize = 2;

/// Image points along each side that a homography is fitted to.
const FITTED: usize = 33;

/// Compares ways to fill a display on some pictures, each stretched over the image; `others` come after the homography.
///
/// # Errors
/// [`ProofError`] where the views cannot be compared.
pub fn compare_ways(
    surface: &str,
    setup: &Setup,
    pictures: &[Picture],
    others: Vec<Way>,
    settings: &WaySettings,
    monitor: &dyn Monitor,
) -> Result<Comparison, ProofError> {
    let timed = |name: &str, make: &dyn Fn() -> Map| {
        let start = Stopwatch::start();
        let map = make();
        Way { name: name.to_owned(), map, seconds: start.elapsed().as_secs_f64() }
    };
    monitor.stage(&format!("{surface}: ways"), 6 + others.len());
    let step = |way: Way| {
        monitor.advance(1);
        way
    };
    let exact = step(timed("exact map", &|| invert(setup, Accuracy::default()).0));
    let mut ways = vec![step(timed("as it is", &|| uncompensated_map(setup)))];
    ways.push(step(timed("homography, best fit", &|| homography_map(setup))));
    ways.extend(others.into_iter().map(step));
    let spp = settings.splat_spp;
    let scattered = format!("the paper's samples, {spp} a pixel");
    ways.push(step(timed(&scattered, &|| splat(setup, spp, &|_| ()).map)));
    let stand = Stand::new(setup, &exact.map, pictures, settings)?;
    ways.push(exact);
    let mut compared = Vec::new();
    for way in &ways {
        compared.push(stand.way(way)?);
    }
    monitor.advance(1);
    if let Some(exact) = ways.last() {
        compared.push(stand.best_image(&exact.map)?);
    }
    monitor.advance(1);
    Ok(Comparison {
        surface: surface.to_owned(),
        intersections: stand.lattice.len(),
        lattice: LatticeStyle::default().intersections_uv().len(),
        share: stand.region.share,
        ways: compared,
    })
}

/// The display as somebody fits it who can shift, turn, stretch and tilt the picture as a whole: the homography that brings display points nearest to the image
/// points that they are seen at, by least squares over all that is formed.
fn homography_map(setup: &Setup) -> Map {
    let as_is = AsIs::new(setup);
    let [width, height] = setup.resolution;
    let in_mm = |uv: [f64; 2]| [0, 1].map(|axis| uv[axis] * setup.image.size[axis]);
    let (mut shown, mut belongs) = (Vec::new(), Vec::new());
    for index in 0..FITTED * FITTED {
        let uv = pixel_centre(index % FITTED, index / FITTED, FITTED, FITTED);
        if let Some(st) = setup.transport(uv, &mut Path::new()).formed() {
            shown.push(Some(in_mm(as_is.image_point(st))));
            belongs.push(Some(in_mm(uv)));
        }
    }
    // What has no place that it belongs to is moved along with what has one.
    let fitted = shown.len();
    let pixels = (0..width * height)
        .map(|index| pixel_centre(index % width, index / width, width, height))
        .map(|st| Some(in_mm(as_is.image_point(st))));
    shown.extend(pixels);
    belongs.resize(shown.len(), None);
    let moved = aligned(&shown, &belongs, Alignment::Perspective);
    let mut map = Map::unanswered(width, height);
    for (index, place) in moved[fitted..].iter().enumerate() {
        let Some(place) = place else { continue };
        let uv = [0, 1].map(|axis| place[axis] / setup.image.size[axis]);
        if uv.iter().all(|c| (0.0..=1.0).contains(c)) {
            map.uv[index] = uv;
            map.status[index] = Status::Ok;
        }
    }
    map
}

/// What ways are held against.
struct Stand<'a> {
    setup: &'a Setup,
    settings: &'a WaySettings,
    pictures: &'a [Picture],
    samples: ViewSamples,
    region: Region,
    /// Each picture as it is seen without the object, and what is compared with it; `None` where nothing is formed.
    references: Vec<(Picture, Option<Channels>)>,
    /// Intersections that are formed, and where their light comes from.
    lattice: Vec<([f64; 2], [f64; 2])>,
}

impl<'a> Stand<'a> {
    fn new(
        setup: &'a Setup,
        exact: &Map,
        pictures: &'a [Picture],
        settings: &'a WaySettings,
    ) -> Result<Self, ProofError> {
        let size = setup.view_size(settings.width);
        let region = Region::of(&formation(setup, exact, size));
        let camera = Camera { eye: setup.viewpoint, size, window: 1.0, supersampling: RAYS };
        let samples = ViewSamples::of(&camera.rays(setup), &|_| ());
        let open = ViewSamples::of(&Reference::new(setup, &camera), &|_| ());
        let identity = Map::identity(setup.resolution[0], setup.resolution[1]);
        let references = pictures
            .iter()
            .map(|picture| {
                let reference = view_through(&open, &display_image(picture, &identity))?;
                let standard = region.standard(&reference)?;
                Ok((reference, standard))
            })
            .collect::<Result<_, ProofError>>()?;
        let crossings = LatticeStyle::default().intersections_uv().into_iter();
        let lattice = crossings
            .filter_map(|uv| Some((uv, setup.transport(uv, &mut Path::new()).formed()?)))
            .collect();
        Ok(Self { setup, settings, pictures, samples, region, references, lattice })
    }

    fn way(&self, way: &Way) -> Result<Compared, ProofError> {
        // The viewer who looks at `uv` sees the display at `st`, and there what belongs elsewhere.
        let off = |&(uv, st): &([f64; 2], [f64; 2])| {
            let shown = interpolated(&way.map, st)?;
            let mm = [0, 1].map(|axis| (shown[axis] - uv[axis]) * self.setup.image.size[axis]);
            Some(self.settings.pixels_per_mm * mm[0].hypot(mm[1]))
        };
        let off: Vec<f64> = self.lattice.iter().filter_map(off).collect();
        let (ssim, psnr) = self.likeness(|k| Ok(display_image(&self.pictures[k], &way.map)))?;
        Ok(Compared {
            name: way.name.clone(),
            displacement: (!off.is_empty()).then(|| off.iter().sum::<f64>() / off.len() as f64),
            largest: off.iter().copied().reduce(f64::max),
            intersections: off.len(),
            ssim,
            psnr,
            seconds: way.seconds,
        })
    }

    /// The display image whose view is nearest to the reference: what any descent on the display's pixels ends in.
    fn best_image(&self, exact: &Map) -> Result<Compared, ProofError> {
        let start = Stopwatch::start();
        let (ssim, psnr) = self.likeness(|k| {
            let plain = display_image(&self.pictures[k], exact);
            Ok(best(&self.samples, &self.references[k].0, &plain)?)
        })?;
        let seconds = start.elapsed().as_secs_f64() / self.pictures.len().max(1) as f64;
        let name = "best display image, least squares".to_owned();
        Ok(Compared { name, ssim, psnr, seconds, ..Compared::default() })
    }

    /// Mean SSIM and PSNR of the views of what the display shows of each picture.
    fn likeness(
        &self,
        shown: impl Fn(usize) -> Result<Picture, ProofError>,
    ) -> Result<(Option<f64>, Option<f64>), ProofError> {
        let mut all: Vec<Likeness> = Vec::new();
        for (k, (_, standard)) in self.references.iter().enumerate() {
            if let Some(standard) = standard {
                let view = view_through(&self.samples, &shown(k)?)?;
                all.push(self.region.likeness(&view, standard)?);
            }
        }
        let mean = |of: fn(&Likeness) -> f64| {
            (!all.is_empty()).then(|| all.iter().map(of).sum::<f64>() / all.len() as f64)
        };
        Ok((mean(|l| l.ssim), mean(|l| l.psnr)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;

    /// A slab at a slant shifts the picture, nearly the same everywhere: what a homography makes good. A ball bends it, which none does.
    #[test]
    fn a_homography_makes_good_what_is_one_and_nothing_else() {
        let off = |scene: &str, way: &dyn Fn(&Setup) -> Map| {
            let loaded = load(format!("../../scenes/{scene}.toml").as_ref()).expect("a scene");
            let setup = Setup::new(&loaded).expect("a set-up").with_resolution([96, 96]);
            let stand = |pictures| {
                let exact = invert(&setup, Accuracy::default()).0;
                Stand::new(&setup, &exact, pictures, &WaySettings::default()).map(|stand| {
                    let way = Way { name: String::new(), map: way(&setup), seconds: 0.0 };
                    stand.way(&way).expect("it is compared").displacement.expect("formed")
                })
            };
            stand(&[]).expect("it stands")
        };
        let (plain, fitted) =
            (off("paper/cube", &uncompensated_map), off("paper/cube", &homography_map));
        assert!(plain > 60.0 && fitted < 1.0, "{plain} {fitted}");
        let (plain, fitted) = (off("ball", &uncompensated_map), off("ball", &homography_map));
        let exact = off("ball", &|setup| invert(setup, Accuracy::default()).0);
        assert!(fitted < plain && fitted > 20.0 * exact, "{plain} {fitted} {exact}");
    }
}
