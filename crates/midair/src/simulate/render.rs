//! The render: path after path, pass after pass, until there are enough.

use super::bundle::{Bundle, Places, Straight};
use super::film::{Harvest, REPLICATIONS, Render, Row, develop};
use super::lens::{Lens, Viewer};
use super::light::Stage;
use super::sequence::{Points, mix};
use crate::clock::Stopwatch;
use crate::monitor::Monitor;
use crate::picture::Picture;
use crate::transport::Setup;
use crate::transport::packet::LANES;
use rayon::prelude::*;
use std::time::Duration;

/// How much work a render does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Paths through each pixel; rounded up to a multiple of 8. Powers of two are spread best.
    pub samples_per_pixel: u32,
    /// Chooses the random numbers: the same seed gives the same picture, whatever the threads.
    pub seed: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { samples_per_pixel: 256, seed: 0 }
    }
}

/// Called after each pass over the picture: the first one is a preview with 8 paths a pixel, and none is more than a sixteenth of the
/// whole.
pub type Pass<'a> = &'a mut dyn FnMut(&Progress);

/// How far a render is.
pub struct Progress<'a> {
    /// Paths through each pixel so far.
    pub samples_per_pixel: u32,
    /// Paths through each pixel in the end.
    pub total: u32,
    /// Time spent.
    pub elapsed: Duration,
    rows: &'a [Vec<Row>],
    paths_each: usize,
}

impl Progress<'_> {
    /// The time left if the render goes on as fast as it did.
    pub fn left(&self) -> Duration {
        let rest = f64::from(self.total - self.samples_per_pixel);
        self.elapsed.mul_f64(rest / f64::from(self.samples_per_pixel))
    }

    /// The picture so far; of several displays the first one's.
    pub fn preview(&self) -> Render {
        view_of(self.rows, 0, self.paths_each, self.samples_per_pixel == self.total)
    }
}

/// Why nothing can be rendered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulateError {
    /// A view without pixels.
    #[error("a view of {0} x {1} pixels cannot be rendered: give it at least one")]
    EmptyView(usize, usize),
    /// A display picture without pixels, or with the wrong number of them.
    #[error("a display picture of {width} x {height} pixels that holds {held} cannot be shown")]
    Display {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Pixels there.
        held: usize,
    },
    /// No paths.
    #[error("0 paths through each pixel show nothing: ask for at least 8")]
    NoPaths,
    /// A number of the viewer that is none, or out of range.
    #[error("the viewer's {name} is {value}, but must be {allowed}")]
    Viewer {
        /// Which.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What is possible.
        allowed: &'static str,
    },
}

/// Renders what `viewer` sees of the set-up while the display shows `display` (linear light, 1 = white; alpha is ignored).
///
/// Where an index goes with the wavelength, each colour is followed at its own.
///
/// `monitor` stops the render within a row or two; what was gathered is kept. `pass` is told of each pass.
///
/// Light is followed backwards, from the pupil through the elements with all their reflections and their absorption,
/// through the plate and to the display. Views are deterministic for a seed, and unbiased but for paths that are longer
/// than [`Setup::max_interactions`]: those end dark.
///
/// Points on the pixel and pupil and the choices between reflection and refraction are scrambled Sobol points in five
/// dimensions, eight sequences with independent random shifts for each pixel; on smooth views the error falls almost as 1/N, at edges still faster than 1/sqrt N.
/// The light that was gathered is known with a standard error that these eight tell.
///
/// # Errors
/// [`SimulateError`] where the arguments leave nothing to render.
pub fn render(
    setup: &Setup,
    display: &Picture,
    viewer: &Viewer,
    settings: &Settings,
    monitor: &dyn Monitor,
    pass: Pass,
) -> Result<Render, SimulateError> {
    Ok(first(render_all(setup, &[display], viewer, settings, monitor, pass)?))
}

/// Renders what `viewer` sees of each of these displays in the set-up's display's place, as [`render`] would by itself: paths do not depend on
/// what a display shows, so that they are followed once for all.
///
/// # Errors
/// As [`render`].
pub fn render_all(
    setup: &Setup,
    displays: &[&Picture],
    viewer: &Viewer,
    settings: &Settings,
    monitor: &dyn Monitor,
    pass: Pass,
) -> Result<Vec<Render>, SimulateError> {
    if setup.disperses() {
        let colours = setup.by_colour();
        let stages = by_colour(colours.each_ref());
        return develop_stages(&stages, displays, viewer, settings, monitor, pass);
    }
    let stage = [(Stage { setup }, [1.0; 3])];
    develop_stages(&stage, displays, viewer, settings, monitor, pass)
}

fn first(renders: Vec<Render>) -> Render {
    renders.into_iter().next().expect("one display has one view")
}

/// As [`render`] with a set-up for each of linear R, G and B, which differ in nothing but indices.
/// Three paths are followed with the same random numbers.
///
/// # Errors
/// As [`render`].
pub fn render_by_colour(
    setups: [&Setup; 3],
    display: &Picture,
    viewer: &Viewer,
    settings: &Settings,
    monitor: &dyn Monitor,
    pass: Pass,
) -> Result<Render, SimulateError> {
    let stages = by_colour(setups);
    Ok(first(develop_stages(&stages, &[display], viewer, settings, monitor, pass)?))
}

fn by_colour(setups: [&Setup; 3]) -> [(Stage<'_>, [f64; 3]); 3] {
    std::array::from_fn(|c| {
        let mut only = [0.0; 3];
        only[c] = 1.0;
        (Stage { setup: setups[c] }, only)
    })
}

/// Renders on all stages, and takes from each the colours that its factors name.
fn develop_stages(
    stages: &[(Stage, [f64; 3])],
    displays: &[&Picture],
    viewer: &Viewer,
    settings: &Settings,
    monitor: &dyn Monitor,
    pass: Pass,
) -> Result<Vec<Render>, SimulateError> {
    displays.iter().try_for_each(|display| check_display(display))?;
    check(viewer, settings)?;
    if displays.is_empty() {
        return Ok(Vec::new());
    }
    let [width, height] = viewer.camera.size;
    let lens = Lens::new(viewer, stages[0].0.setup);
    let pupil = 0.5 * viewer.aperture;
    let straight: Vec<Option<Straight>> =
        stages.iter().map(|(stage, _)| Straight::of(stage, viewer.camera.eye, pupil)).collect();
    let start = Stopwatch::start();

    let total = settings.samples_per_pixel.div_ceil(REPLICATIONS as u32);
    // Of each row of the view: every display's.
    let mut rows: Vec<Vec<Row>> =
        (0..height).map(|_| displays.iter().map(|_| Row::new(width)).collect()).collect();
    let mut done = 0;
    while done < total {
        // Doubling passes show a picture soon; later ones are short enough to watch.
        let more = done.max(1).min((total / 16).max(1)).min(total - done);
        let points = Points::new(settings.seed, done, more);
        rows.par_iter_mut().enumerate().for_each(|(row, line)| {
            if monitor.is_cancelled() {
                return;
            }
            let of = Line { row, seed: settings.seed, points: &points, count: more as usize };
            for ((stage, colours), straight) in stages.iter().zip(&straight) {
                stage.row(straight.as_ref(), &lens, of, *colours, displays, line);
            }
            line.iter_mut().for_each(|row| row.done += more);
        });
        if monitor.is_cancelled() {
            break;
        }
        done += more;
        let [samples_per_pixel, total] = [done, total].map(|n| n * REPLICATIONS as u32);
        let (elapsed, paths_each) = (start.elapsed(), stages.len());
        pass(&Progress { samples_per_pixel, total, elapsed, rows: &rows, paths_each });
    }
    let complete = rows.iter().flatten().all(|row| row.done == total);
    Ok((0..displays.len()).map(|which| view_of(&rows, which, stages.len(), complete)).collect())
}

/// The view of one of the displays.
fn view_of(rows: &[Vec<Row>], which: usize, paths_each: usize, complete: bool) -> Render {
    let rows: Vec<&Row> = rows.iter().map(|line| &line[which]).collect();
    develop(&rows, paths_each, complete)
}

/// Paths of one pixel in a bundle: one of each replication.
const OCTETS: usize = LANES / REPLICATIONS;

/// A row of the view, and the pass that it is in.
#[derive(Clone, Copy)]
struct Line<'a> {
    row: usize,
    seed: u32,
    /// The sequence's points that each replication gets in this pass.
    points: &'a Points,
    count: usize,
}

impl Stage<'_> {
    /// Follows paths through one row of the view, as many through each of its pixels as the pass has, in bundles where `straight` knows
    /// how; light is multiplied by `colours`, and goes to each display's own `sums`.
    fn row(
        &self,
        straight: Option<&Straight>,
        lens: &Lens,
        line: Line,
        colours: [f64; 3],
        displays: &[&Picture],
        sums: &mut [Row],
    ) {
        let width = sums.first().map_or(0, Row::width);
        let mut bundle = Bundle::new();
        let mut at = Places {
            column: [0.0; LANES],
            pixel: [0; LANES],
            row: line.row as f64,
            index: [0; LANES],
        };
        let mut course = None;
        let mut harvests = vec![Harvest::default(); displays.len()];
        let octets = width * line.count;
        for first in (0..octets).step_by(OCTETS) {
            let used = OCTETS.min(octets - first);
            // What is left over in the last bundle goes along and is not counted.
            for octet in 0..OCTETS {
                let place = (first + octet).min(octets - 1);
                let (column, index) = (place / line.count, place % line.count);
                let pixel = (line.row * width + column) as u32;
                for replication in 0..REPLICATIONS {
                    let lane = octet * REPLICATIONS + replication;
                    at.column[lane] = column as f64;
                    at.index[lane] = index as u32;
                    at.pixel[lane] = mix(pixel ^ mix(line.seed ^ (replication as u32) << 28));
                }
            }
            Straight::start(&mut bundle, lens, &at, line.points);
            if let (Some(straight), None) = (straight, course) {
                course = straight.course(&bundle);
            }
            let straight = straight.zip(course);
            if let Some((straight, faces)) = straight {
                Straight::follow(straight, &mut bundle, self, faces);
            }
            for octet in 0..used {
                for replication in 0..REPLICATIONS {
                    let lane = octet * REPLICATIONS + replication;
                    let outcome = match straight {
                        Some((straight, _)) => straight.outcome(&bundle, self, lane),
                        None => {
                            let (ray, chance) = bundle.first(lane);
                            self.follow(ray, chance)
                        }
                    };
                    let Some(end) = outcome else { continue };
                    for (display, harvest) in displays.iter().zip(&mut harvests) {
                        if let Some(light) = end.light(display) {
                            let light = std::array::from_fn(|c| light[c] * colours[c]);
                            harvest.add(replication, end.class, light);
                        }
                    }
                }
                if (first + octet + 1).is_multiple_of(line.count) {
                    for (sums, harvest) in sums.iter_mut().zip(&mut harvests) {
                        sums.add((first + octet) / line.count, harvest);
                        *harvest = Harvest::default();
                    }
                }
            }
            if straight.is_some() && bundle.is_lost() {
                course = None;
            }
        }
    }
}

fn check_display(display: &Picture) -> Result<(), SimulateError> {
    let held = display.pixels.len();
    if held == 0 || display.width.checked_mul(display.height) != Some(held) {
        let (width, height) = (display.width, display.height);
        return Err(SimulateError::Display { width, height, held });
    }
    Ok(())
}

fn check(viewer: &Viewer, settings: &Settings) -> Result<(), SimulateError> {
    let [width, height] = viewer.camera.size;
    if width == 0 || height == 0 {
        return Err(SimulateError::EmptyView(width, height));
    }
    if settings.samples_per_pixel == 0 {
        return Err(SimulateError::NoPaths);
    }
    let number = |name, value: f64, holds: bool, allowed| match value.is_finite() && holds {
        true => Ok(()),
        false => Err(SimulateError::Viewer { name, value, allowed }),
    };
    let aperture = viewer.aperture;
    number("aperture", aperture, aperture >= 0.0, "a diameter of 0 mm or more")?;
    if let Some(focus) = viewer.focus {
        number("focus", focus, focus > 0.0, "a distance above 0 mm")?;
    }
    let window = viewer.camera.window;
    number("window", window, window > 0.0, "a share above 0")
}
