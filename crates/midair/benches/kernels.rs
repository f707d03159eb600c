//! The small things that everything else is made of: `cargo bench -p midair`.
//!
//! Each benchmark runs on one thread over the same thousand inputs, so that times are those of a typical input and
//! not of one that the processor has learnt by heart.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use midair::geometry::{Dual, Ray, Real, Vec3};
use midair::map::{Accuracy, Inverse, Map, invert_into};
use midair::optics::interface::{fresnel, reflect, refract};
use midair::optics::plate::{SlitMirror, SlitMirrorPlate, pass_ideal};
use midair::picture::Warp;
use midair::scene;
use midair::transport::{Path, Setup};
use std::path::Path as FilePath;

fn main() {
    divan::main();
}

const INPUTS: usize = 1000;

const SCENES: [&str; 4] = ["sphere", "cube", "cylinder", "bent-mirror-convex"];

fn set_up(name: &str) -> Setup {
    let scenes = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/paper");
    let loaded = scene::load(&scenes.join(name).with_extension("toml")).expect("a valid scene");
    Setup::new(&loaded).expect("a scene that can be traced")
}

/// Image points over the whole image, none twice (a Kronecker sequence by the plastic number, Roberts 2018).
fn image_points() -> Vec<[f64; 2]> {
    let place = |k: usize, factor: f64| (0.5 + k as f64 * factor).fract();
    (0..INPUTS)
        .map(|k| [place(k, 0.754_877_666_246_692_7), place(k, 0.569_840_290_998_053_2)])
        .collect()
}

/// Unit directions up to 60 degrees from -z.
fn directions() -> Vec<Vec3> {
    image_points()
        .into_iter()
        .map(|[u, v]| {
            let (azimuth, cosine) = (std::f64::consts::TAU * u, 1.0 - 0.5 * v);
            let sine = (1.0 - cosine * cosine).sqrt();
            Vec3::new(sine * azimuth.cos(), sine * azimuth.sin(), -cosine)
        })
        .collect()
}

/// F by searching what each path meets.
#[divan::bench(args = SCENES)]
fn transport(bencher: Bencher, name: &str) {
    let (setup, points) = (set_up(name), image_points());
    let mut path = Path::new();
    bencher.counter(ItemsCount::new(INPUTS)).bench_local(|| {
        for &uv in &points {
            black_box(setup.transport(black_box(uv), &mut path));
        }
    });
}

/// F and its Jacobian along known paths.
#[divan::bench(args = SCENES)]
fn follow_with_jacobian(bencher: Bencher, name: &str) {
    let setup = set_up(name);
    // Only points whose light arrives have a path to follow to the display.
    let mut known: Vec<([f64; 2], Path)> = image_points()
        .into_iter()
        .filter_map(|uv| {
            let mut path = Path::new();
            setup.transport(uv, &mut path).st().map(|_| (uv, path))
        })
        .collect();
    bencher.counter(ItemsCount::new(known.len())).bench_local(|| {
        for (uv, path) in &mut known {
            black_box(setup.follow_with_jacobian(black_box(*uv), path));
        }
    });
}

/// The whole map of 256 x 256 pixels, by all threads.
#[divan::bench(args = SCENES)]
fn map_256(bencher: Bencher, name: &str) {
    let setup = set_up(name);
    let mut map = Map::unanswered(256, 256);
    bencher.bench_local(|| invert_into(&setup, Accuracy::default(), black_box(&mut map)));
}

/// From a viewpoint to a warp of 1920 x 1080 pixels, as the live show does it: by all threads, in the memory of the last one.
#[divan::bench(args = SCENES)]
fn warp_for_a_viewpoint(bencher: Bencher, name: &str) {
    let setup = set_up(name).with_resolution([1920, 1080]);
    let mut last = None;
    bencher.bench_local(|| {
        let inverse = Inverse::new(black_box(&setup), Accuracy { tolerance: 2.5e-5 });
        last = Warp::of_inverse(&inverse, [1920, 1080], last.take()).ok();
    });
}

/// Snell's law, as plain numbers and with two derivatives.
#[divan::bench(types = [f64, Dual])]
fn refraction<T: Real>(bencher: Bencher) {
    let normal = Vec3::constant(Vec3::new(0.0, 0.0, 1.0));
    let incoming: Vec<Vec3<T>> = directions().into_iter().map(Vec3::constant).collect();
    let eta = T::constant(1.0 / 1.49);
    bencher.counter(ItemsCount::new(INPUTS)).bench_local(|| {
        for &d in &incoming {
            black_box(refract(black_box(d), normal, eta));
        }
    });
}

/// The mirror law.
#[divan::bench]
fn reflection(bencher: Bencher) {
    let (normal, incoming) = (Vec3::new(0.0, 0.0, 1.0), directions());
    bencher.counter(ItemsCount::new(INPUTS)).bench_local(|| {
        for &d in &incoming {
            black_box(reflect(black_box(d), normal));
        }
    });
}

/// Fresnel's equations.
#[divan::bench]
fn fresnel_equations(bencher: Bencher) {
    let incoming = directions();
    bencher.counter(ItemsCount::new(INPUTS)).bench_local(|| {
        for d in &incoming {
            black_box(fresnel(black_box(-d.z), 1.0 / 1.49));
        }
    });
}

/// The ideal plate.
#[divan::bench]
fn plate_ideal(bencher: Bencher) {
    let (normal, incoming) = (Vec3::new(0.0, 0.0, 1.0), directions());
    bencher.counter(ItemsCount::new(INPUTS)).bench_local(|| {
        for &d in &incoming {
            black_box(pass_ideal(black_box(d), normal));
        }
    });
}

/// The plate with its two layers of slit mirrors: the number of mirrors met does not matter.
#[divan::bench(args = [0.5, 0.05])]
fn plate_slit_mirror(bencher: Bencher, pitch: f64) {
    let plate = SlitMirrorPlate::new(SlitMirror { pitch, ..SlitMirror::default() });
    let plate = plate.expect("a possible plate");
    let rays: Vec<Ray> = image_points()
        .into_iter()
        .zip(directions())
        .map(|([u, v], direction)| Ray {
            origin: Vec3::new(100.0 * u - 50.0, 100.0 * v - 50.0, 10.0),
            direction,
        })
        .collect();
    bencher.counter(ItemsCount::new(INPUTS)).bench_local(|| {
        for ray in &rays {
            black_box(plate.pass(black_box(ray.origin), ray.direction));
        }
    });
}
