//! Maps for the newest viewpoint, and their gains.

use crate::brightness::Brightness;
use crate::newest::{Late, Newest};
use crate::spent::{SPARE, Spent};
use midair::compensate::uncompensated_map;
use midair::geometry::Vec3;
use midair::map::{Accuracy, Inverse};
use midair::picture::{Filter, FrameEvening, Overflow, Warp};
use midair::scene::Loaded;
use midair::transport::Setup;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What is wanted.
#[derive(Clone, Debug)]
pub struct Request {
    /// The set-up as it is now.
    pub loaded: Arc<Loaded>,
    /// The eye, if it is not the set-up's.
    pub viewpoint: Option<Vec3>,
    /// Pixels of the display.
    pub resolution: [usize; 2],
    /// Pixels of the source.
    pub source: [usize; 2],
    /// Whether the source is shown as it is.
    pub uncompensated: bool,
    /// Whether the gain is divided out, and how.
    pub gain: Option<Overflow>,
    /// The packet that asked for it, and when it came.
    pub packet: Option<(u64, Duration)>,
}

/// What the solver does next.
#[derive(Clone, Debug)]
pub enum Job {
    /// A map, which is waited for.
    Map(Request),
    /// The map has been shown: there is time for its gain, until the next one is asked for.
    Gain,
}

/// A gain for a map that is shown with an earlier one.
#[derive(Clone, Debug)]
pub struct Settled {
    /// The map's.
    pub viewpoint: Vec3,
    /// What is divided out of frames.
    pub evening: Arc<FrameEvening>,
}

/// A map ready to be shown.
#[derive(Debug)]
pub struct Solved {
    /// Counted from 0: no two maps have the same.
    pub number: u64,
    /// Its taps.
    pub warp: Warp,
    /// The gain to divide out of frames: the viewpoint's, or that of one nearby until there is time for it.
    pub evening: Option<Arc<FrameEvening>>,
    /// The set-up that it is of.
    pub loaded: Arc<Loaded>,
    /// Pixels of the source that the taps are for.
    pub source: [usize; 2],
    /// The eye that it is for.
    pub viewpoint: Vec3,
    /// The packet that asked for it, and when it came.
    pub packet: Option<(u64, Duration)>,
    /// Time that map and weights took, s; who runs the solver says it.
    pub seconds: f64,
}

/// The colours of a frame's channels: blue first, as windows have them.
pub(crate) const COLOURS: [usize; 3] = [2, 1, 0];

/// The viewer rests when no map was asked for in so long, the period of one and a half packets of a tracker that sends 60 a second.
/// A gain that was worked out meanwhile goes with the next map, so that a moving viewer's frames are drawn once each; at rest it is
/// shown by itself.
const REST: Duration = Duration::from_millis(25);

/// What the solver has to tell.
#[derive(Debug)]
// One of them is on its way at a time; a map's is the usual one.
#[expect(clippy::large_enum_variant)]
pub enum Found {
    /// There is a map.
    Map(Solved),
    /// The viewer rests, and the last map's gain is known.
    Gain(Settled),
    /// There is no map, and why.
    Refused(String),
}

/// Solves whatever is newest until the jobs are closed, on threads of its own: a map may take seconds, and the picture is warped by
/// others meanwhile. Warps that are no longer shown come back by `spent`: their memory is used again.
pub fn start(
    jobs: Arc<Newest<Job>>,
    spent: Arc<Spent>,
    tell: impl Fn(Found) + Send + Sync + 'static,
) {
    std::thread::spawn(move || {
        let solve = || {
            let mut solver = Solver::default();
            // What is to be shown when the viewer rests.
            let mut owed = None;
            loop {
                let longest = if owed.is_some() { REST } else { Duration::MAX };
                match jobs.wait_within(longest) {
                    Err(Late) => owed.take().map(Found::Gain).into_iter().for_each(&tell),
                    Ok(None) => return,
                    Ok(Some(Job::Gain)) => owed = solver.settle(|| jobs.calls()).or(owed),
                    Ok(Some(Job::Map(request))) => {
                        owed = None;
                        let start = Instant::now();
                        let solved = solver.solve(&request, &spent);
                        let seconds = start.elapsed().as_secs_f64();
                        tell(match solved {
                            Ok(solved) => Found::Map(Solved { seconds, ..solved }),
                            Err(why) => Found::Refused(why),
                        });
                    }
                }
            }
        };
        match rayon::ThreadPoolBuilder::new().build() {
            Ok(pool) => pool.install(solve),
            // Without threads of its own it shares those of the picture.
            Err(_) => solve(),
        }
    });
}

/// Makes maps one by one, and keeps what one of them has in common with the next.
#[derive(Default)]
pub struct Solver {
    known: Option<Known>,
    /// Of the next map.
    number: u64,
}

impl Solver {
    /// A map that was asked for.
    ///
    /// # Errors
    /// Why there is none.
    pub fn solve(&mut self, request: &Request, spent: &Spent) -> Result<Solved, String> {
        let same =
            self.known.as_ref().is_some_and(|known| Arc::ptr_eq(&known.loaded, &request.loaded));
        if !same {
            self.known = Some(Known::new(request)?);
        }
        let Some(known) = &mut self.known else { return Err("there is no set-up".to_owned()) };
        let (warp, evening) = known.solve(request, spent.take())?;
        // The next viewpoints find memory at once.
        if self.number == 0 {
            (0..SPARE).for_each(|_| spent.put(warp.clone()));
        }
        let number = self.number;
        self.number += 1;
        Ok(Solved {
            number,
            warp,
            evening,
            loaded: Arc::clone(&known.loaded),
            source: request.source,
            viewpoint: known.setup.viewpoint,
            packet: request.packet,
            seconds: 0.0,
        })
    }

    /// Goes on with the last map's gain until something else is to be done. The gain, once it is another than the map was handed over
    /// with.
    pub fn settle(&mut self, calls: impl Fn() -> bool) -> Option<Settled> {
        self.known.as_mut()?.settle(calls)
    }
}

/// A set-up that maps are solved for.
struct Known {
    loaded: Arc<Loaded>,
    setup: Setup,
    brightness: Option<Brightness>,
    /// What the last map was handed over with.
    evening: Option<Arc<FrameEvening>>,
}

impl Known {
    fn new(request: &Request) -> Result<Self, String> {
        let loaded = Arc::clone(&request.loaded);
        let setup = Setup::new(&loaded).map_err(|error| error.to_string())?;
        let brightness =
            request.gain.map(|overflow| Brightness::new(&setup, request.resolution, overflow));
        Ok(Self { loaded, setup, brightness, evening: None })
    }

    fn solve(
        &mut self,
        request: &Request,
        spent: Option<Warp>,
    ) -> Result<(Warp, Option<Arc<FrameEvening>>), String> {
        let (loaded, setup) = (&self.loaded, &mut self.setup);
        setup.resolution = request.resolution;
        setup.viewpoint =
            request.viewpoint.unwrap_or_else(|| Vec3::from_array(loaded.scene.viewpoint));
        let warp = if request.uncompensated {
            let map = uncompensated_map(setup);
            Warp::new(&map, request.source, Filter::Bilinear)
        } else {
            let inverse = Inverse::new(setup, Accuracy { tolerance: LIVE_TOLERANCE });
            Warp::of_inverse(&inverse, request.source, spent)
        };
        // A picture without compensation is shown as it is.
        let brightness = self.brightness.as_mut().filter(|_| !request.uncompensated);
        self.evening = brightness.map(|brightness| brightness.at_hand(setup));
        warp.map(|warp| (warp, self.evening.clone())).map_err(|error| error.to_string())
    }

    fn settle(&mut self, calls: impl Fn() -> bool) -> Option<Settled> {
        let (Some(brightness), Some(handed)) = (&mut self.brightness, &self.evening) else {
            return None;
        };
        while !calls() {
            if let Some(evening) = brightness.go_on(&self.setup) {
                let viewpoint = self.setup.viewpoint;
                return (!Arc::ptr_eq(&evening, handed)).then_some(Settled { viewpoint, evening });
            }
        }
        None
    }
}

/// A twentieth of a pixel of 2048: finer is not seen, and coarser is not quicker.
pub(crate) const LIVE_TOLERANCE: f64 = 2.5e-5;

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    const MINUTE: Duration = Duration::from_secs(60);

    #[test]
    fn a_map_has_the_last_gain_at_once_and_its_own_when_the_viewer_rests() {
        let scene = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/paper");
        let loaded = Arc::new(midair::scene::load(&scene.join("sphere.toml")).unwrap());
        let jobs = Arc::new(Newest::new());
        let (sender, found) = channel();
        start(Arc::clone(&jobs), Arc::default(), move |found| sender.send(found).unwrap());
        let next = |within: Duration| found.recv_timeout(within);
        let eye = Vec3::from_array(loaded.scene.viewpoint);
        let map = |x: f64| {
            let viewpoint = eye + Vec3::new(x, 0.0, 0.0);
            jobs.put(Job::Map(Request {
                loaded: Arc::clone(&loaded),
                viewpoint: Some(viewpoint),
                resolution: [64, 64],
                source: [32, 32],
                uncompensated: false,
                gain: Some(Overflow::Fit),
                packet: None,
            }));
            let Found::Map(solved) = next(MINUTE).unwrap() else { panic!("no map") };
            assert_eq!(solved.viewpoint, viewpoint);
            solved.evening.unwrap()
        };
        let first = map(0.0);
        let moved = map(4.0);
        assert!(Arc::ptr_eq(&moved, &first));
        jobs.offer(Job::Gain);
        let Found::Gain(own) = next(MINUTE).unwrap() else { panic!("no gain") };
        assert_eq!(own.viewpoint, eye + Vec3::new(4.0, 0.0, 0.0));
        assert!(own.evening != first);
        // The next map has it, and nothing is left to be settled.
        assert!(Arc::ptr_eq(&map(4.0), &own.evening));
        jobs.offer(Job::Gain);
        assert!(next(8 * REST).is_err());
        jobs.close();
    }
}
