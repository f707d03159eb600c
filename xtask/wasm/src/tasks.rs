//! The tasks: one for each part of the library that once trapped in WebAssembly, and the paper's map, which is timed as well.

use midair::clock::Stopwatch;
use midair::evaluate::proof::{Settings, prove};
use midair::map::{Accuracy, Map, invert};
use midair::picture::{Picture, decode_still, display_image};
use midair::scene::{Format, InMemory, Loaded, load_text};
use midair::simulate::{self, Camera, Light, Viewer, render};
use midair::transport::Setup;
use std::path::Path;
use std::time::Duration;

/// What is asked for, and how alike the answers must be.
pub struct Task {
    /// What it is, for the line that tells the outcome.
    pub name: &'static str,
    /// Does it.
    pub run: fn() -> Vec<f64>,
    /// The largest difference of two numbers.
    pub tolerance: f64,
    /// The share of numbers that may differ by more.
    pub apart: f64,
}

/// All tasks. Arithmetic is the same to the last bit on all targets, but for products that are added in one rounding or in two, and for functions
/// such as the cosine, whose last digit the targets' libraries choose.
pub const TASKS: [Task; 6] = [
    Task { name: "map of the paper's ball", run: ball, tolerance: 1e-12, apart: 0.0 },
    // Newton's method ends within 1e-12; which side of an edge a ray meets hangs on the last bit.
    Task { name: "map through a mesh", run: cow, tolerance: 1e-9, apart: 1e-4 },
    // Samples are 32-bit floats; a path that meets one mirror more or less is another path.
    Task { name: "render through a plate of slits", run: rendered, tolerance: 1e-5, apart: 1e-2 },
    // Colours are 32-bit floats, likenesses sums over a view of them.
    Task { name: "proof", run: proven, tolerance: 1e-4, apart: 0.0 },
    Task { name: "damaged pictures are refused", run: damaged, tolerance: 0.0, apart: 0.0 },
    Task { name: "display image and gain", run: shown, tolerance: 1e-5, apart: 1e-4 },
];

fn scene(text: &str, files: &InMemory) -> Loaded {
    load_text(text, "scene.toml", Format::Toml, files).expect("the scene is one of ours")
}

/// The paper's ball before a display of so many pixels along each side.
fn paper_setup(pixels: usize) -> Setup {
    Setup::new(&scene(include_str!("../../../scenes/paper/sphere.toml"), &InMemory::new()))
        .expect("a ball can be traced")
        .with_resolution([pixels; 2])
}

/// uv of all pixels, then their statuses.
fn numbers(map: &Map) -> Vec<f64> {
    let statuses = map.status.iter().map(|&status| f64::from(status as u8));
    map.uv.iter().flatten().copied().chain(statuses).collect()
}

fn ball() -> Vec<f64> {
    let setup = paper_setup(1024);
    numbers(&invert(&setup, Accuracy::default()).0)
}

/// How long the map of the paper's ball takes, 1024 x 1024.
pub fn time_of_map() -> Duration {
    let setup = paper_setup(1024);
    let stopwatch = Stopwatch::start();
    std::hint::black_box(invert(&setup, Accuracy::default()));
    stopwatch.elapsed()
}

fn cow() -> Vec<f64> {
    let text = include_str!("../../../scenes/spot.toml");
    let mesh = include_bytes!("../../../scenes/meshes/spot.obj");
    let loaded = scene(text, &InMemory::new().with("meshes/spot.obj", *mesh));
    let setup = Setup::new(&loaded).expect("the cow can be traced").with_resolution([96; 2]);
    numbers(&invert(&setup, Accuracy::default()).0)
}

/// Stripes of colour.
fn picture(pixels: usize) -> Picture {
    let mut picture = Picture::filled(pixels, pixels, [0.2, 0.3, 0.4, 1.0]);
    for (index, pixel) in picture.pixels.iter_mut().enumerate() {
        let (row, column) = (index / pixels, index % pixels);
        pixel[0] = if (column / 8) % 2 == 0 { 0.9 } else { 0.1 };
        pixel[1] = row as f32 / pixels as f32;
    }
    picture
}

fn samples(picture: &Picture) -> Vec<f64> {
    picture.pixels.iter().flatten().map(|&sample| f64::from(sample)).collect()
}

fn rendered() -> Vec<f64> {
    let text = include_str!("../../../scenes/plate.toml");
    let setup = Setup::new(&scene(text, &InMemory::new()))
        .expect("the scene can be traced")
        .with_resolution([64; 2]);
    let camera = Camera { eye: setup.viewpoint, size: [48; 2], window: 1.0, supersampling: 1 };
    let viewer = Viewer { camera, aperture: 4.0, focus: None };
    let settings = simulate::Settings { samples_per_pixel: 16, seed: 1 };
    let mut passes = 0;
    let mut pass = |_: &simulate::Progress<'_>| passes += 1;
    let render = render(&setup, &picture(64), &viewer, &settings, &(), &mut pass)
        .expect("there is something to render");
    let mut found = samples(&render.view(Light::All));
    found.push(f64::from(passes));
    found
}

fn proven() -> Vec<f64> {
    let setup = paper_setup(128);
    let settings = Settings { splat_spp: 2, ..Settings::for_setup(&setup) };
    let proof = prove(&setup, &picture(128), &settings, &()).expect("a ball can be proved");
    let likeness =
        |shown: &midair::evaluate::proof::Shown| shown.likeness.map_or(f64::NAN, |l| l.ssim);
    let lattice = &proof.lattice;
    vec![
        likeness(&proof.uncompensated),
        likeness(&proof.compensated),
        likeness(&proof.optimal),
        lattice.compensated.exact.mean,
        lattice.uncompensated.exact.mean,
        proof.region.share,
        proof.splat.map_or(f64::NAN, |splat| splat.holes as f64),
    ]
}

/// Pictures cut short and garbled, by kind: 1 for a message, and not reaching the end is what must not happen.
fn damaged() -> Vec<f64> {
    // The beginning of a PNG and of a JPEG, and no more.
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x10\0\0\0\x10\x08\x06\0\0\0\x1f\xf3\xffa\0\0\0\x20IDATx";
    let jpeg = b"\xff\xd8\xff\xe0\0\x10JFIF\0\x01\x01\0\0\x01\0\x01\0\0";
    let exr = b"v/1\x01\x02\0\0\0channels\0chlist\0";
    let files: [(&str, &[u8]); 3] = [("a.png", png), ("a.jpg", jpeg), ("a.exr", exr)];
    files.map(|(name, bytes)| f64::from(decode_still(Path::new(name), bytes).is_err())).to_vec()
}

fn shown() -> Vec<f64> {
    let setup = paper_setup(128);
    let (map, _) = invert(&setup, Accuracy::default());
    let gain = simulate::gain(&setup, &map);
    let gains = gain.rgb.iter().flatten().map(|&gain| f64::from(gain));
    samples(&display_image(&picture(128), &map)).into_iter().chain(gains).collect()
}
