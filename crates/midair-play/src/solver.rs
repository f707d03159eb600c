//! Maps for the newest viewpoint, on a thread of their own.

use midair::evaluate::proof::uncompensated_map;
use midair::geometry::Vec3;
use midair::map::{Accuracy, Inverse, invert, with_rim};
use midair::media::{Evening, Filter, FrameEvening, Overflow, Warp};
use midair::scene::Loaded;
use midair::simulate::{Plate, gain, image_gain};
use midair::transport::Setup;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Instant;

/// What is wanted.
#[derive(Clone, Debug)]
pub(crate) struct Request {
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

/// A map ready to be shown.
#[derive(Debug)]
pub(crate) struct Solved {
    /// Counted from 0: no two maps have the same.
    pub number: u64,
    pub warp: Warp,
    /// The gain to divide out of frames.
    pub evening: Option<Arc<FrameEvening>>,
    pub source: [usize; 2],
    pub viewpoint: Vec3,
    pub packet: Option<(u64, Instant)>,
    /// Time that map and weights took, s.
    pub seconds: f64,
}

/// A place for one thing, of which the newest counts.
#[derive(Debug)]
pub(crate) struct Newest<T> {
    slot: Mutex<(Option<T>, bool)>,
    bell: Condvar,
}

impl<T> Newest<T> {
    pub fn new() -> Self {
        Self { slot: Mutex::new((None, false)), bell: Condvar::new() }
    }

    /// Puts a thing in the place of what was there, which is given back.
    pub fn put(&self, thing: T) -> Option<T> {
        let before = self.slot.lock().unwrap_or_else(PoisonError::into_inner).0.replace(thing);
        self.bell.notify_one();
        before
    }

    /// Takes the thing, if there is one.
    pub fn take(&self) -> Option<T> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner).0.take()
    }

    /// Waits for a thing; `None` once [`close`](Self::close)d.
    pub fn wait(&self) -> Option<T> {
        let mut slot = self.slot.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if slot.1 {
                return None;
            }
            if let Some(thing) = slot.0.take() {
                return Some(thing);
            }
            slot = self.bell.wait(slot).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Nothing more is wanted.
    pub fn close(&self) {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner).1 = true;
        self.bell.notify_all();
    }
}

/// Solves whatever is newest until the requests are closed. `ready` is called after each map; `refused` with what cannot be solved.
/// Warps that are no longer shown come back by `spent`: their memory is used again.
pub(crate) fn start(
    requests: Arc<Newest<Request>>,
    solved: Arc<Newest<Solved>>,
    spent: Arc<Newest<Warp>>,
    ready: impl Fn() + Send + 'static,
    refused: impl Fn(String) + Send + 'static,
) {
    std::thread::spawn(move || {
        let mut known: Option<Known> = None;
        let mut numbers = 0..;
        while let Some(request) = requests.wait() {
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
            let Some(Known { loaded, setup, brightness }) = &mut known else { continue };
            setup.resolution = request.resolution;
            setup.viewpoint =
                request.viewpoint.unwrap_or_else(|| Vec3::from_array(loaded.scene.viewpoint));
            let warp = if request.uncompensated {
                let map = with_rim(&uncompensated_map(loaded, setup));
                Warp::new(&map, request.source, Filter::Bilinear)
            } else {
                let inverse = Inverse::new(setup, Accuracy { tolerance: LIVE_TOLERANCE });
                Warp::of_inverse(&inverse, request.source, spent.take())
            };
            // A picture without compensation is shown as it is.
            let evening = brightness
                .as_mut()
                .filter(|_| !request.uncompensated)
                .map(|brightness| brightness.evening(setup));
            match warp {
                Ok(warp) => {
                    let overtaken = solved.put(Solved {
                        number: numbers.next().unwrap_or_default(),
                        warp,
                        evening,
                        source: request.source,
                        viewpoint: setup.viewpoint,
                        packet: request.packet,
                        seconds: start.elapsed().as_secs_f64(),
                    });
                    ready();
                    if let Some(overtaken) = overtaken {
                        spent.put(overtaken.warp);
                    }
                }
                Err(error) => refused(error.to_string()),
            }
        }
    });
}

/// The colours of a frame's channels: blue first, as windows have them.
pub(crate) const COLOURS: [usize; 3] = [2, 1, 0];

/// A set-up that maps are solved for.
struct Known {
    loaded: Arc<Loaded>,
    setup: Setup,
    brightness: Option<Brightness>,
}

/// What the gain is divided out by.
struct Brightness {
    plate: Plate,
    /// How bright white is, over the display's: what the scene's own viewpoint allows. It stays while the viewer moves, for a picture whose
    /// brightness goes with the viewer's head is worse than one that clips at its most demanding pixels from aside.
    level: f64,
    /// The last gain, and the eye that it is for.
    last: Option<(Vec3, Arc<FrameEvening>)>,
}

/// A gain serves all eyes as near as this to its own, mm. It costs more than the map, and is smooth where the map is: from 5 mm aside
/// it is within half a hundredth of itself nearly everywhere (a test holds it to that), which is half a code.
const SAME_GAIN: f64 = 5.0;

impl Brightness {
    fn evening(&mut self, setup: &Setup) -> Arc<FrameEvening> {
        if let Some((eye, evening)) = &self.last
            && (*eye - setup.viewpoint).length() <= SAME_GAIN
        {
            return Arc::clone(evening);
        }
        let evening =
            Arc::new(FrameEvening::new(&image_gain(setup, &self.plate), self.level, COLOURS));
        self.last = Some((setup.viewpoint, Arc::clone(&evening)));
        evening
    }
}

/// Columns of the display that the level is found with: it is the gain of the most demanding pixel or tenth of the pixels, and
/// gains change little between pixels.
const LEVEL_COLUMNS: usize = 320;

impl Known {
    fn new(request: &Request) -> Result<Self, String> {
        let loaded = Arc::clone(&request.loaded);
        let setup = Setup::new(&loaded).map_err(|error| error.to_string())?;
        let brightness = request.gain.map(|overflow| {
            let plate = Plate::of_scene(&loaded, &setup).map_err(|error| error.to_string())?;
            let [width, height] = request.resolution;
            let columns = width.min(LEVEL_COLUMNS);
            let rows = (height * columns / width.max(1)).max(1);
            let small = Setup { resolution: [columns, rows], ..setup.clone() };
            let (map, _) = invert(&small, Accuracy { tolerance: LIVE_TOLERANCE });
            let level = Evening::for_white(&gain(&small, &plate, &map), overflow).level();
            Ok::<_, String>(Brightness { plate, level, last: None })
        });
        Ok(Self { setup, brightness: brightness.transpose()?, loaded })
    }
}

/// A twentieth of a pixel of 2048: finer is not seen, and coarser is not quicker.
const LIVE_TOLERANCE: f64 = 2.5e-5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_serves_eyes_nearby() {
        for name in ["sphere", "cube", "cylinder", "bent-mirror-convex"] {
            let file = format!("../../scenes/paper/{name}.toml");
            let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
            let mut setup = Setup::new(&midair::scene::load(&root.join(file)).unwrap()).unwrap();
            let here = image_gain(&setup, &Plate::Ideal);
            setup.viewpoint = setup.viewpoint + Vec3::new(SAME_GAIN, 0.0, 0.0);
            let aside = image_gain(&setup, &Plate::Ideal);
            let (mut far, mut all) = (0, 0);
            for uv in (0..10_000).map(|i| [i % 100, i / 100].map(|i| (f64::from(i) + 0.5) / 100.0))
            {
                let ([a, ..], [b, ..]) = (here.at(uv), aside.at(uv));
                if a.is_finite() && b.is_finite() {
                    all += 1;
                    far += i32::from((a - b).abs() > 0.005 * a);
                }
            }
            println!("{name}: {far} of {all}");
            // Along the edges of what is formed the gain falls steeply.
            assert!(all > 3000 && far * 50 < all, "{name}: {far} of {all}");
        }
    }

    #[test]
    fn the_newest_wins_and_closing_ends_the_wait() {
        let newest = Newest::new();
        assert_eq!((newest.put(1), newest.put(2)), (None, Some(1)));
        assert_eq!((newest.wait(), newest.take()), (Some(2), None));
        newest.close();
        assert_eq!(newest.wait(), None);
    }
}
