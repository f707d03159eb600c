//! Warping a film's frames as `midair apply` does (codes to light, interpolated in light, light to codes), and OpenCV's remap (which interpolates
//! the codes) as a peer on the same map, frame and number of threads, in the same rounds.

use super::rows::{Done, Row, Sizes, Work};
use super::{Outcome, set_ups};
use midair::map::Map;
use midair::picture::{Drive, Filter, LightFrame, Warp};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

/// Holds a frame and the maps, and times one remap for each line that it reads.
const OPENCV: &str = "
import cv2, numpy, sys, time
width, height, threads = map(int, sys.argv[1:4])
cv2.setNumThreads(threads)
frame = numpy.frombuffer(sys.stdin.buffer.read(width * height * 3), numpy.uint8).reshape(height, width, 3)
maps = [numpy.frombuffer(sys.stdin.buffer.read(width * height * 4), numpy.float32).reshape(height, width) for _ in 'xy']
if sys.argv[4] == 'fixed':
    maps = cv2.convertMaps(*maps, cv2.CV_16SC2)
result = numpy.empty_like(frame)
for line in sys.stdin.buffer:
    start = time.perf_counter()
    cv2.remap(frame, *maps, cv2.INTER_LINEAR, dst=result, borderMode=cv2.BORDER_CONSTANT)
    print(time.perf_counter() - start, flush=True)
";

fn python() -> PathBuf {
    set_ups::root().join(".venv/bin/python3")
}

/// OpenCV's version.
fn version() -> Outcome<String> {
    let said = Command::new(python()).args(["-c", "import cv2; print(cv2.__version__)"]).output();
    match said {
        Ok(output) if output.status.success() => {
            Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
        }
        _ => Err("OpenCV, the peer of the rows of warps, is not in .venv: \
                  `cargo xtask test --only setup` installs it"
            .into()),
    }
}

/// Frames of RGB through a lens-like map, at 1080p and 4K.
pub fn rows(sizes: &Sizes) -> Vec<Row> {
    let [often, some, _] = sizes.rounds;
    let mut rows = Vec::new();
    for (size, name, rounds) in [([1920, 1080], "1080p", often), ([3840, 2160], "4K", some)] {
        for (filter, what) in [(Filter::Bilinear, "bilinear"), (Filter::Sharp, "sharp")] {
            let label = format!("warp of a film's frame (apply), {what}, {name}");
            rows.push(Row::new(&label, rounds, move || ours(size, filter)));
        }
        for maps in ["float", "fixed"] {
            let label = format!("warp by OpenCV's remap, bilinear, {maps} maps, {name}");
            let mut row = Row::new(&label, rounds, move || theirs(size, maps));
            row.watch_memory = false;
            rows.push(row);
        }
    }
    rows
}

/// A lens-like map about the middle that magnifies everywhere, as maps of display and image of one size mostly do.
fn lens([width, height]: [usize; 2]) -> Map {
    let mut map = Map::identity(width, height);
    for uv in &mut map.uv {
        let [x, y] = [2.0 * uv[0] - 1.0, 2.0 * uv[1] - 1.0];
        let k = 0.75 * (0.85 + 0.075 * (x * x + y * y));
        *uv = [0.5 + 0.5 * k * x, 0.5 + 0.5 * k * y];
    }
    map
}

fn frame([width, height]: [usize; 2]) -> Vec<u8> {
    let code = |i: usize| (i as u32).wrapping_mul(2_654_435_761).to_be_bytes()[0];
    (0..width * height * 3).map(code).collect()
}

fn per_second(time: Duration) -> String {
    format!("{:.0} frames/s", 1.0 / time.as_secs_f64())
}

fn ours(size: [usize; 2], filter: Filter) -> Outcome<Work> {
    let warp = Warp::new(&lens(size), size, filter)?;
    let frame = frame(size);
    let (mut light, drive, mut output) =
        (LightFrame::default(), Drive::default(), vec![0; frame.len()]);
    Ok(Box::new(move || {
        let start = std::time::Instant::now();
        light.decode(&frame, 3)?;
        warp.apply_light(&light, 3, &drive, &mut output)?;
        let time = start.elapsed();
        Ok(Done { remark: format!("last {}", per_second(time)), time: Some(time) })
    }))
}

struct Peer {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// # Errors
/// Where OpenCV is missing: a table without the peer says nothing.
fn theirs(size: [usize; 2], maps: &str) -> Outcome<Work> {
    let version = version()?;
    let threads = rayon::current_num_threads();
    let mut child = Command::new(python())
        .args(["-c", OPENCV])
        .args([size[0], size[1], threads].map(|n| n.to_string()))
        .arg(maps)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let (Some(to), Some(from)) = (child.stdin.take(), child.stdout.take()) else {
        return Err("Python has no pipes".into());
    };
    let mut peer = Peer { child, to, from: BufReader::new(from) };
    peer.to.write_all(&frame(size))?;
    let map = lens(size);
    for axis in 0..2 {
        // cv2.remap counts pixel centres from the top left.
        let place = |uv: &[f64; 2]| match axis {
            0 => uv[0] * size[0] as f64 - 0.5,
            _ => (1.0 - uv[1]) * size[1] as f64 - 0.5,
        };
        let bytes: Vec<u8> =
            map.uv.iter().flat_map(|uv| (place(uv) as f32).to_le_bytes()).collect();
        peer.to.write_all(&bytes)?;
    }
    Ok(Box::new(move || {
        writeln!(peer.to, "go")?;
        let mut line = String::new();
        peer.from.read_line(&mut line)?;
        let time = Duration::from_secs_f64(line.trim().parse()?);
        let remark = format!("OpenCV {version}; last {}", per_second(time));
        Ok(Done { remark, time: Some(time) })
    }))
}
