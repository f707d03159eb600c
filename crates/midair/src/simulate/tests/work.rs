//! Long renders: noise, watching, stopping, what is refused.

use super::*;

#[test]
fn on_a_smooth_view_the_error_falls_faster_than_one_over_the_root() {
    let setup = setup(20.0, vec![]);
    let mut ramp = Picture::filled(2, 2, [0.0; 4]);
    for (pixel, value) in ramp.pixels.iter_mut().zip([0.1f32, 0.9, 0.5, 0.3]) {
        *pixel = [value; 4];
    }
    let camera = Camera { window: 0.4, ..Camera::at_viewpoint(&setup, [12, 12]) };
    let viewer = Viewer { camera, aperture: 8.0, focus: Some(700.0) };
    let noise = |paths| shoot(&setup, &ramp, &viewer, paths).error.noise;
    let (few, many) = (noise(64), noise(1024));
    // 16 times the paths: 4 by chance, 16 to 64 by low discrepancy.
    assert!(few / many > 12.0, "{few} {many}");
    // And the estimate is true: the view of another seed is off by that much.
    let other = Settings { samples_per_pixel: 64, seed: 8 };
    let other = render(&setup, &ramp, &viewer, &other, &(), &mut |_| ());
    let (a, b) = (shoot(&setup, &ramp, &viewer, 1024), other.expect("sound"));
    let squares = a.layers.real.pixels.iter().zip(&b.layers.real.pixels);
    let off = squares.map(|(a, b)| f64::from(a[1] - b[1]).powi(2)).sum::<f64>() / 144.0;
    // 144 pixels: their root mean square is sure to 1 / sqrt(288) = 6 %, its estimate about as well.
    assert!((off.sqrt() / few - 1.0).abs() < 0.3, "{} {few}", off.sqrt());
}

/// A flag that stops the work.
struct Stop<'a>(&'a AtomicBool);

impl Monitor for Stop<'_> {
    fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

#[test]
fn a_render_can_be_watched_and_stopped_and_repeats_itself() {
    let setup = setup(20.0, vec![element(sphere(25.0), ACRYLIC, [0.0; 3], [0.0; 3], 0)]);
    let viewer = pinhole(&setup, [8, 6]);
    let settings = Settings { samples_per_pixel: 256, seed: 3 };
    let display = dot(2, 0, 0);
    let cancel = AtomicBool::new(false);
    let mut seen = Vec::new();
    let mut preview = None;
    let mut pass = |progress: &Progress| {
        seen.push((progress.samples_per_pixel, progress.total));
        if progress.samples_per_pixel >= 32 {
            cancel.store(true, Ordering::Relaxed);
            preview = Some(progress.preview());
        }
    };
    let partial = render(&setup, &display, &viewer, &settings, &Stop(&cancel), &mut pass).unwrap();
    assert_eq!(seen, [(8, 256), (16, 256), (32, 256)]);
    assert!(!partial.complete);
    assert_eq!(partial.paths, 8 * 6 * 32);
    assert_eq!(Some(&partial), preview.as_ref());

    let whole = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| shoot(&setup, &display, &viewer, 32))
    };
    let (one, two) = (whole(1), whole(2));
    assert!(one.complete && one == two);
}

#[test]
fn what_cannot_be_rendered_is_said() {
    let setup = setup(20.0, vec![]);
    let viewer = pinhole(&setup, [4, 4]);
    let attempt = |viewer: &Viewer, display: &Picture, samples_per_pixel| {
        let settings = Settings { samples_per_pixel, seed: 0 };
        render(&setup, display, viewer, &settings, &(), &mut |_| ()).map(|_| ())
    };
    assert_eq!(attempt(&viewer, &white(), 0), Err(SimulateError::NoPaths));
    let broken = Picture { width: 2, height: 2, pixels: vec![[0.0; 4]; 3] };
    assert!(matches!(attempt(&viewer, &broken, 8), Err(SimulateError::Display { .. })));
    let bad = Viewer { aperture: f64::NAN, ..viewer };
    let message = attempt(&bad, &white(), 8).unwrap_err().to_string();
    assert!(message.contains("aperture"), "{message}");
    let bad = Viewer { focus: Some(0.0), ..viewer };
    assert!(attempt(&bad, &white(), 8).unwrap_err().to_string().contains("focus"));
    let mut empty = viewer;
    empty.camera.size = [0, 4];
    assert_eq!(attempt(&empty, &white(), 8), Err(SimulateError::EmptyView(0, 4)));
}
