//! From a new viewpoint to the display's frame, at 1080p: what the live show does for each packet of a tracker.

use super::rows::{Done, Row, Sizes, Work};
use super::{Outcome, set_ups};
use midair::geometry::Vec3;
use midair::map::{Accuracy, Inverse, Map, invert_into};
use midair::picture::{Drive, Filter, LightFrame, Warp};
use midair::transport::Setup;
use std::hint::black_box;

const DISPLAY: [usize; 2] = [1920, 1080];
/// The lattice's size in the show.
const SOURCE: [usize; 2] = [1024, 1024];
/// What the show asks of its maps.
const ACCURACY: Accuracy = Accuracy { tolerance: 2.5e-5 };

/// Weights with a map in memory and without, and drawing.
pub fn rows(sizes: &Sizes) -> Vec<Row> {
    let often = sizes.rounds[0];
    let mut rows = Vec::new();
    for (name, file) in [
        ("sphere", "paper/sphere.toml"),
        ("cube", "paper/cube.toml"),
        ("cylinder", "paper/cylinder.toml"),
        ("bent mirror", "paper/bent-mirror-convex.toml"),
    ] {
        let by_map = format!("warp for a new viewpoint by a map, {name}, 1080p");
        rows.push(Row::new(&by_map, often, move || weights(file, false)));
        let by_rows = format!("warp for a new viewpoint by rows (play), {name}, 1080p");
        rows.push(Row::new(&by_rows, often, move || weights(file, true)));
    }
    rows.push(Row::new("the inverse alone (play), sphere, warp's 1080p", often, || {
        let mut walk = Walk::new("paper/sphere.toml")?;
        Ok(Box::new(move || {
            black_box(Inverse::new(walk.step(), ACCURACY));
            Ok(Done::default())
        }))
    }));
    rows.push(Row::new("warp of a decoded frame (play), sphere, 1080p", often, draw));
    rows
}

/// A viewer who sways.
struct Walk {
    setup: Setup,
    start: Vec3,
    count: u32,
}

impl Walk {
    fn new(file: &str) -> Outcome<Self> {
        let mut setup = set_ups::scene(file)?;
        setup.resolution = DISPLAY;
        Ok(Self { start: setup.viewpoint, setup, count: 0 })
    }

    fn step(&mut self) -> &Setup {
        self.count += 1;
        let t = f64::from(self.count) / 60.0;
        let sway =
            Vec3::new(40.0 * (2.1 * t).sin(), 15.0 * (1.3 * t).sin(), 20.0 * (0.7 * t).sin());
        self.setup.viewpoint = self.start + sway;
        &self.setup
    }
}

fn weights(file: &str, by_rows: bool) -> Outcome<Work> {
    let mut walk = Walk::new(file)?;
    let mut map = Map::unanswered(DISPLAY[0], DISPLAY[1]);
    let mut old: Option<Warp> = None;
    Ok(Box::new(move || {
        let setup = walk.step();
        if by_rows {
            old = Some(Warp::of_inverse(&Inverse::new(setup, ACCURACY), SOURCE, old.take())?);
        } else {
            invert_into(setup, ACCURACY, &mut map);
            black_box(Warp::new(&map, SOURCE, Filter::Bilinear)?);
        }
        Ok(Done::default())
    }))
}

fn draw() -> Outcome<Work> {
    let mut walk = Walk::new("paper/sphere.toml")?;
    let warp = Warp::of_inverse(&Inverse::new(walk.step(), ACCURACY), SOURCE, None)?;
    let code = |i: usize| (i as u32).wrapping_mul(2_654_435_761).to_be_bytes()[0];
    let frame: Vec<u8> = (0..SOURCE[0] * SOURCE[1] * 4).map(code).collect();
    let (mut decoded, drive) = (LightFrame::default(), Drive::default());
    decoded.decode(&frame, 4)?;
    let mut output = vec![0; DISPLAY[0] * DISPLAY[1] * 4];
    Ok(Box::new(move || {
        warp.apply_light(&decoded, 4, &drive, &mut output)?;
        Ok(Done::default())
    }))
}
