//! Frames a second of [`Warp`] and of OpenCV's remap on the same frames, in turns.
//!
//!     cargo run --release -p midair --example warp_speed [threads]
//!
//! OpenCV takes part where the workspace's `.venv/bin/python3`, or else `python3`, has cv2 and numpy.

use midair::map::Map;
use midair::media::{Filter, LinearScratch, Picture, Warp, display_image};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

/// Holds a frame and the maps, and times one remap for each line it reads.
const OPENCV: &str = "
import cv2, numpy, sys, time
width, height, threads = map(int, sys.argv[1:])
cv2.setNumThreads(threads)
frame = numpy.random.default_rng(1).integers(0, 256, (height, width, 3), numpy.uint8)
x, y = (numpy.frombuffer(sys.stdin.buffer.read(width * height * 4), numpy.float32).reshape(height, width) for _ in 'xy')
fixed = cv2.convertMaps(x, y, cv2.CV_16SC2)
result = numpy.empty_like(frame)
print(cv2.__version__, flush=True)
for line in sys.stdin.buffer:
    maps = (x, y) if line.strip() == b'float' else fixed
    start = time.perf_counter()
    cv2.remap(frame, *maps, cv2.INTER_LINEAR, dst=result, borderMode=cv2.BORDER_CONSTANT)
    print(time.perf_counter() - start, flush=True)
";

struct OpenCv {
    process: Child,
    answers: BufReader<std::process::ChildStdout>,
}

impl OpenCv {
    fn start(map: &Map, threads: usize) -> Option<Self> {
        let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../.venv/bin/python3");
        let python = [own, PathBuf::from("python3")].into_iter().find(|python| {
            let run = Command::new(python).args(["-c", "import cv2, numpy"]).output();
            run.is_ok_and(|output| output.status.success())
        })?;
        let size = [map.width, map.height, threads].map(|n| n.to_string());
        let mut process = Command::new(python)
            .args(["-c", OPENCV])
            .args(size)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .ok()?;
        let coordinates = |uv: &[f64; 2], axis: usize| match axis {
            0 => uv[0] * map.width as f64 - 0.5,
            _ => (1.0 - uv[1]) * map.height as f64 - 0.5,
        };
        let bytes: Vec<u8> = (0..2)
            .flat_map(|axis| map.uv.iter().map(move |uv| coordinates(uv, axis) as f32))
            .flat_map(f32::to_le_bytes)
            .collect();
        process.stdin.as_mut()?.write_all(&bytes).ok()?;
        let mut answers = BufReader::new(process.stdout.take()?);
        let mut version = String::new();
        answers.read_line(&mut version).ok()?;
        println!("OpenCV {}", version.trim());
        Some(Self { process, answers })
    }

    /// Seconds of one remap.
    fn remap(&mut self, maps: &str) -> Option<f64> {
        writeln!(self.process.stdin.as_mut()?, "{maps}").ok()?;
        let mut line = String::new();
        self.answers.read_line(&mut line).ok()?;
        line.trim().parse().ok()
    }
}

fn main() {
    let threads = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(2);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().expect("first use");
    for (width, height, rounds) in [(1920, 1080, 30), (3840, 2160, 10)] {
        println!("{width} x {height}, {threads} threads");
        for (name, bend) in [("magnifying", 0.75), ("both ways", 1.0)] {
            compare(name, &bent_map(width, height, bend), rounds, threads);
        }
    }
    let (map, picture) = (bent_map(1024, 1024, 0.9), Picture::filled(1024, 1024, [0.5; 4]));
    let times = (0..20).map(|_| seconds(|| drop(display_image(&picture, &map)))).collect();
    println!("display_image, 1024 x 1024, bend 0.9: {:.1} ms", 1e3 * median(times));
}

/// A lens-like map about the middle, in and out by a quarter; `scale` zooms.
fn bent_map(width: usize, height: usize, scale: f64) -> Map {
    let mut map = Map::identity(width, height);
    for uv in &mut map.uv {
        let [x, y] = [2.0 * uv[0] - 1.0, 2.0 * uv[1] - 1.0];
        let k = scale * (0.85 + 0.15 * (x * x + y * y) / 2.0);
        *uv = [0.5 + 0.5 * k * x, 0.5 + 0.5 * k * y];
    }
    map
}

fn compare(name: &str, map: &Map, rounds: usize, threads: usize) {
    let source = [map.width, map.height];
    let frame: Vec<u8> = (0..source[0] * source[1] * 4)
        .map(|i| (i as u32).wrapping_mul(2_654_435_761).to_be_bytes()[0])
        .collect();
    let mut output = vec![0; frame.len()];
    let warps = [Filter::Bilinear, Filter::Sharp].map(|filter| {
        let mut warp = None;
        let time = seconds(|| warp = Some(Warp::new(map, source, filter)));
        println!("  {name}: {filter:?} prepared in {:.0} ms", 1e3 * time);
        warp.expect("made above").expect("the source has pixels")
    });
    let mut opencv = OpenCv::start(map, threads);
    let mut scratch = LinearScratch::default();
    let mut times = vec![Vec::new(); 8];
    for _ in 0..rounds {
        for (k, warp) in warps.iter().enumerate() {
            for channels in [3, 4] {
                let bytes = source[0] * source[1] * channels;
                let (frame, output) = (&frame[..bytes], &mut output[..bytes]);
                let run = || warp.apply(frame, channels, output).expect("the sizes fit");
                times[2 * k + channels - 3].push(seconds(run));
            }
            let bytes = source[0] * source[1] * 3;
            let (frame, output) = (&frame[..bytes], &mut output[..bytes]);
            times[6 + k].push(seconds(|| {
                let done = warp.apply_in_linear_light(frame, 3, &mut scratch, output);
                done.expect("the sizes fit");
            }));
        }
        for (k, maps) in ["float", "fixed"].into_iter().enumerate() {
            times[4 + k].extend(opencv.as_mut().and_then(|opencv| opencv.remap(maps)));
        }
    }
    let names = [
        "bilinear RGB",
        "bilinear RGBA",
        "sharp RGB",
        "sharp RGBA",
        "OpenCV float maps, RGB",
        "OpenCV fixed-point maps, RGB",
        "bilinear RGB in linear light",
        "sharp RGB in linear light",
    ];
    for (what, times) in names.into_iter().zip(times) {
        if !times.is_empty() {
            let best = times.iter().copied().fold(f64::INFINITY, f64::min);
            let (median, best) = (1.0 / median(times), 1.0 / best);
            println!("  {name}: {what}: {median:.0} frames/s, at best {best:.0}");
        }
    }
    if let Some(mut opencv) = opencv {
        drop(opencv.process.stdin.take());
        let _ = opencv.process.wait();
    }
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
