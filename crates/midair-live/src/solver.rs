//! Maps for the newest viewpoint, on a thread of their own.

use crate::brightness::Brightness;
use crate::newest::{Late, Newest};
use crate::spent::{SPARE, Spent};
use midair::evaluate::proof::uncompensated_map;
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
    pub packet: Option<(u64, Instant)>,
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
    /// Pixels of the source that the taps are for.
    pub source: [usize; 2],
    /// The eye that it is for.
    pub viewpoint: Vec3,
    /// The packet that asked for it, and when it came.
    pub packet: Option<(u64, Instant)>,
    /// Time that map and weights took, s.
    pub seconds: f64,
}

/// The viewer rests when no map was asked for in so long, the period of one and a half packets of a tracker that sends 60 a second.
/// A gain that was worked out meanwhile goes with the next map, so that a moving viewer's frames are drawn once each; at rest it is
/// shown by itself.
const REST: Duration = Duration::from_millis(25);

/// Solves whatever is newest until the jobs are closed. `ready` is called after each map, `settled` with a gain that replaces a shown
/// map's, `refused` with what cannot be solved. Warps that are no longer shown come back by `spent`: their memory is used again.
pub fn start(
    jobs: Arc<Newest<Job>>,
    solved: Arc<Newest<Solved>>,
    spent: Arc<Spent>,
    ready: impl Fn() + Send + 'static,
    settled: impl Fn(Settled) + Send + 'static,
    refused: impl Fn(String) + Send + 'static,
) {
    std::thread::spawn(move || {
        let mut known: Option<Known> = None;
        let mut numbers = 0..;
        let mut began = false;
        // What is to be shown when the viewer rests.
        let mut owed = None;
        loop {
            let longest = if owed.is_some() { REST } else { Duration::MAX };
            let request = match jobs.wait_within(longest) {
                Err(Late) => {
                    owed.take().into_iter().for_each(&settled);
                    continue;
                }
                Ok(None) => return,
                Ok(Some(Job::Gain)) => {
                    owed = known.as_mut().and_then(|known| known.settle(&jobs)).or(owed);
                    continue;
                }
                Ok(Some(Job::Map(request))) => request,
            };
            owed = None;
            let start = Instant::now();
            let same =
                known.as_ref().is_some_and(|known| Arc::ptr_eq(&known.loaded, &request.loaded));
            if !same {
                match Known::new(&request) {
                    Ok(new) => known = Some(new),
                    Err(why) => {
                        refused(why);
                        continue;
                    }
                }
            }
            let Some(known) = &mut known else { continue };
            match known.solve(&request, spent.take()) {
                Ok((warp, evening)) => {
                    // The next viewpoints find memory at once.
                    if !began {
                        began = true;
                        (0..SPARE).for_each(|_| spent.put(warp.clone()));
                    }
                    let overtaken = solved.put(Solved {
                        number: numbers.next().unwrap_or_default(),
                        warp,
                        evening,
                        source: request.source,
                        viewpoint: known.setup.viewpoint,
                        packet: request.packet,
                        seconds: start.elapsed().as_secs_f64(),
                    });
                    ready();
                    if let Some(overtaken) = overtaken {
                        spent.put(overtaken.warp);
                    }
                }
                Err(why) => refused(why),
            }
        }
    });
}

/// The colours of a frame's channels: blue first, as windows have them.
pub const COLOURS: [usize; 3] = [2, 1, 0];

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

    /// Goes on with the last map's gain until something else is to be done. The gain, once it is another than the map was handed over
    /// with.
    fn settle(&mut self, jobs: &Newest<Job>) -> Option<Settled> {
        let (Some(brightness), Some(handed)) = (&mut self.brightness, &self.evening) else {
            return None;
        };
        while !jobs.calls() {
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

    #[test]
    fn a_map_has_the_last_gain_at_once_and_its_own_when_the_viewer_rests() {
        let scene = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/paper");
        let loaded = Arc::new(midair::scene::load(&scene.join("sphere.toml")).unwrap());
        let (jobs, solved, spent) =
            (Arc::new(Newest::new()), Arc::new(Newest::new()), Arc::new(Spent::default()));
        let ((ready, maps), (settled, gains)) = (channel(), channel());
        start(
            Arc::clone(&jobs),
            Arc::clone(&solved),
            spent,
            move || ready.send(()).unwrap(),
            move |gain| settled.send(gain).unwrap(),
            |why| panic!("{why}"),
        );
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
            maps.recv_timeout(Duration::from_secs(60)).unwrap();
            let solved: Solved = solved.take().unwrap();
            assert_eq!(solved.viewpoint, viewpoint);
            solved.evening.unwrap()
        };
        let first = map(0.0);
        let moved = map(4.0);
        assert!(Arc::ptr_eq(&moved, &first));
        jobs.offer(Job::Gain);
        let own = gains.recv_timeout(Duration::from_secs(60)).unwrap();
        assert_eq!(own.viewpoint, eye + Vec3::new(4.0, 0.0, 0.0));
        assert!(own.evening != first);
        // The next map has it, and nothing is left to be settled.
        assert!(Arc::ptr_eq(&map(4.0), &own.evening));
        jobs.offer(Job::Gain);
        assert!(gains.recv_timeout(8 * REST).is_err());
        jobs.close();
    }
}
