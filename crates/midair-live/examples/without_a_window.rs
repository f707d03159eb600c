//! A show without a window: a viewer walks past the paper's ball and is followed; each line is a packet of a tracker.
//!
//!     cargo run --release -p midair-live --example without_a_window

use midair::geometry::Vec3;
use midair_live::{
    Calibration, Clock, Frame, Heard, Job, Protocol, Reading, Settings, Show, Solver, Spent,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/paper/sphere.toml");
    let loaded = midair::scene::load(scene.as_ref())?;
    let (image, size) = (loaded.scene.image.size, loaded.scene.display.resolution);
    let settings = Settings {
        tracker: Some((Protocol::OpenTrack, 4242)),
        calibration: Calibration::new([0.0; 3], [0.0; 3]),
        smoothing: None,
        predict: None,
        gain: None,
        figures: true,
        blank_after: None,
    };
    let (clock, spent) = (Clock::start(), Spent::default());
    let (mut show, mut solver) = (Show::new(loaded, settings), Solver::default());
    show.resize(size, true, clock.now());
    show.frame(Frame::lattice(image), clock.now());
    let mut display = vec![0; 4 * size[0] * size[1]];
    for step in 0..10 {
        if let Some(Job::Map(request)) = show.take_job() {
            let started = clock.now();
            let solved = solver.solve(&request, &spent)?;
            let seconds = (clock.now() - started).as_secs_f64();
            show.solved(midair_live::Solved { seconds, ..solved });
        }
        let begun = clock.now();
        if let Some(picture) = show.picture(begun)
            && let Some((warp, _)) = picture.warp
        {
            warp.apply_light(picture.light.0, 4, picture.drive, &mut display)?;
        }
        let now = clock.now();
        show.presented(begun, now, now, None);
        println!("{}", show.lines("memory", now).join("; "));
        let position = Vec3::new(10.0 * f64::from(step), 0.0, 800.0);
        show.heard(Heard::Reading(Reading { position, angles: [0.0; 3] }), clock.now());
    }
    Ok(())
}
