//! Paths a second of [`render`] through a scene with the slit-mirror plate.
//!
//!     cargo run --release -p midair --example simulate_speed [scene.toml [threads]]
//!
//! On Linux the processor time of each path is told as well: other programs do not change it much.

use midair::media::Picture;
use midair::optics::plate::SlitMirror;
use midair::scene::model::PlateModel;
use midair::simulate::{Camera, Plate, Settings, Viewer, Watch, render};
use midair::transport::Setup;
use std::path::Path;
use std::time::Instant;

/// Seconds that this program's threads have run, where the system tells.
fn processor_seconds() -> Option<f64> {
    let tasks = std::fs::read_dir("/proc/self/task").ok()?;
    let nanoseconds = tasks.filter_map(|task| {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    });
    Some(nanoseconds.sum::<f64>() * 1e-9)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let built_in = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/paper/cylinder.toml");
    let scene = arguments.next().map_or(built_in, Into::into);
    if let Some(threads) = arguments.next() {
        rayon::ThreadPoolBuilder::new().num_threads(threads.parse()?).build_global()?;
    }
    let loaded = midair::scene::load(&scene)?;
    let setup = Setup::new(&loaded)?;
    let [width, height] = setup.resolution;
    let mut display = Picture::filled(width, height, [0.0, 0.0, 0.0, 1.0]);
    for (index, pixel) in display.pixels.iter_mut().enumerate() {
        let (x, y) = (index % width * 16 / width, index / width * 16 / height);
        *pixel = if (x + y) % 2 == 0 { [0.9, 0.8, 0.6, 1.0] } else { [0.05, 0.1, 0.3, 1.0] };
    }
    let viewer =
        Viewer { aperture: 6.0, ..Viewer::pinhole(Camera::at_viewpoint(&setup, [512, 512])) };
    let plates = [
        ("ideal plate", Plate::Ideal),
        ("slit-mirror plate", Plate::new(&PlateModel::SlitMirror(SlitMirror::default()))?),
    ];
    for (name, plate) in plates {
        let before = processor_seconds();
        let start = Instant::now();
        let settings = Settings { samples_per_pixel: 64, seed: 1 };
        let view = render(&setup, &plate, &display, &viewer, &settings, Watch::default())?;
        let seconds = start.elapsed().as_secs_f64();
        let paths = view.paths as f64;
        print!("{name}: {:.1} M paths/s", paths / seconds * 1e-6);
        if let (Some(before), Some(after)) = (before, processor_seconds()) {
            let each = (after - before) / paths;
            print!(", {:.0} ns of processor time a path", each * 1e9);
            print!(" (two free cores: {:.1} M paths/s)", 2e-6 / each);
        }
        println!(", noise {:.4}, mean error {:.6}", view.error.noise, view.error.of_mean);
    }
    Ok(())
}
