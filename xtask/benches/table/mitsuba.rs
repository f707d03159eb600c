//! Mitsuba 3 as a peer: the paper's scatter in one fused kernel, in a Python process that lives through the run.

use super::rows::{Done, Row, Sizes, Work};
use super::{Outcome, set_ups};
use midair::geometry::{Rectangle, Vec3};
use midair::transport::Setup;
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

fn python() -> PathBuf {
    set_ups::root().join(".venv/bin/python3")
}

fn script() -> PathBuf {
    set_ups::root().join("xtask/peers/mitsuba_sphere.py")
}

/// Its rows.
pub fn rows(sizes: &Sizes) -> Vec<Row> {
    let [often, some, _] = sizes.rounds;
    let row = |(spp, rounds)| {
        let name = format!("Mitsuba (LLVM), sphere, {spp} spp");
        let mut row = Row::new(&name, rounds, move || work(spp));
        row.watch_memory = false;
        row
    };
    [(1, often), (16, some)].map(row).into()
}

/// The Python process.
struct Peer {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl Peer {
    /// Mitsuba's version, if its LLVM backend works here; otherwise why not.
    fn version() -> Result<String, String> {
        if !python().exists() {
            return Err("no .venv; `cargo xtask bench --with-mitsuba` makes it".to_owned());
        }
        let output = Command::new(python()).arg(script()).arg("--version").output();
        let output = output.map_err(|error| error.to_string())?;
        if output.status.success() {
            return Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned());
        }
        let told = String::from_utf8_lossy(&output.stderr);
        Err(told.trim().lines().next_back().unwrap_or("it does not start").to_owned())
    }

    fn start(setup: &Setup) -> Outcome<Self> {
        let mut child = Command::new(python())
            .arg(script())
            .arg(numbers(setup))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let to = child.stdin.take().ok_or("no input")?;
        let from = BufReader::new(child.stdout.take().ok_or("no output")?);
        Ok(Self { child, to, from })
    }

    /// Scatters so many samples per pixel: the time, and the display pixels that were hit.
    fn scatter(&mut self, spp: usize) -> Outcome<(Duration, usize)> {
        writeln!(self.to, "{spp}")?;
        self.to.flush()?;
        let mut line = String::new();
        self.from.read_line(&mut line)?;
        let mut words = line.split_whitespace();
        let mut next = || words.next().ok_or_else(|| format!("Mitsuba's answer: {line:?}"));
        Ok((Duration::from_secs_f64(next()?.parse()?), next()?.parse()?))
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // It may have ended by itself; either way nothing is left to do.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The paper's sphere, scattered by Mitsuba.
///
/// # Errors
/// Where Mitsuba does not work here.
fn work(spp: usize) -> Outcome<Work> {
    let version = Peer::version().map_err(|why| format!("Mitsuba cannot be measured: {why}"))?;
    let setup = set_ups::scene("paper/sphere.toml")?;
    let (exact, _) = midair::map::invert(&setup, midair::map::Accuracy::default());
    let reached = exact.uv.iter().filter(|uv| uv[0].is_finite()).count();
    let mut peer = Peer::start(&setup)?;
    Ok(Box::new(move || {
        let (time, hit) = peer.scatter(spp)?;
        let holes = 100.0 * (1.0 - hit as f64 / reached as f64);
        Ok(Done {
            remark: format!("Mitsuba {version}; {holes:.1} % holes; single precision"),
            time: Some(time),
        })
    }))
}

/// The set-up as the script reads it: JSON, so that both sides trace the same numbers.
fn numbers(setup: &Setup) -> String {
    let vector = |v: Vec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
    let rectangle = |r: &Rectangle| {
        let [x, y, z] = r.frame.axes.map(vector);
        let (origin, [width, height]) = (vector(r.frame.origin), r.size);
        format!(r#"{{"origin": {origin}, "axes": [{x}, {y}, {z}], "size": [{width}, {height}]}}"#)
    };
    format!(
        r#"{{"viewpoint": {}, "image": {}, "plate": {}, "display": {}, "resolution": [{}, {}], "radius": 25.0, "ior": 1.49}}"#,
        vector(setup.viewpoint),
        rectangle(&setup.image),
        rectangle(&setup.plate.rectangle),
        rectangle(&setup.display),
        setup.resolution[0],
        setup.resolution[1],
    )
}
