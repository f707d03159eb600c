//! Runs the module of its first argument under node, does the same here, and compares: a line for each task that begins with `ok: ` or `FAILED: `.

use midair_wasm_check::{TASKS, Task, time_of_map};
use std::path::Path;
use std::process::{Command, ExitCode};

/// Maps of the ball that are timed, here and there.
const ROUNDS: usize = 9;

/// How much longer WebAssembly may take for the map than this machine on one thread.
const LONGEST: f64 = 5.0;

fn main() -> ExitCode {
    let Some(module) = std::env::args_os().nth(1) else {
        eprintln!("error: no module; `cargo xtask test --only wasm` builds and names it");
        return ExitCode::from(2);
    };
    match compare(Path::new(&module)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(problem) => {
            eprintln!("error: {problem}");
            ExitCode::FAILURE
        }
    }
}

/// Whether all is as it should be.
fn compare(module: &Path) -> Result<bool, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/run.mjs");
    let numbers = [TASKS.len(), ROUNDS].map(|number| number.to_string());
    let mut node = Command::new("node");
    node.arg(script).arg(module).arg(folder.path()).args(numbers);
    let output = node.output().map_err(|error| format!("node cannot be run: {error}"))?;
    // A trap ends node; the tasks before it have left their numbers.
    print!("{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8_lossy(&output.stdout);

    let mut all = output.status.success();
    for (index, task) in TASKS.iter().enumerate() {
        let outcome = std::fs::read(folder.path().join(format!("{index}.f64")))
            .map_err(|_| "it did not end in WebAssembly".to_owned())
            .and_then(|bytes| alike(task, &bytes));
        all &= outcome.is_ok();
        match outcome {
            Ok(how) => println!("ok: {}: {how}", task.name),
            Err(problem) => println!("FAILED: {}: {problem}", task.name),
        }
    }
    let outcome = quick_enough(&told);
    all &= outcome.is_ok();
    match outcome {
        Ok(how) => println!("ok: {how}"),
        Err(problem) => println!("FAILED: {problem}"),
    }
    Ok(all)
}

/// Whether a task's numbers are those that it gives here.
fn alike(task: &Task, bytes: &[u8]) -> Result<String, String> {
    let there: Vec<f64> =
        bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let here = (task.run)();
    if there.len() != here.len() || here.is_empty() {
        return Err(format!("{} numbers instead of {}", there.len(), here.len()));
    }
    let differences = here.iter().zip(&there).map(|(&here, &there)| match here.is_nan() {
        // NaN says that there is no answer, which has to be said on both sides.
        true if there.is_nan() => 0.0,
        _ if there == here => 0.0,
        _ => (here - there).abs(),
    });
    let (mut apart, mut largest) = (0, 0.0f64);
    for difference in differences {
        if difference <= task.tolerance {
            largest = largest.max(difference);
        } else {
            apart += 1;
        }
    }
    let told = format!(
        "{} numbers, {apart} of them apart, the others by {largest:.1e} at most",
        here.len()
    );
    if apart as f64 <= task.apart * here.len() as f64 { Ok(told) } else { Err(told) }
}

/// Whether the map of the ball takes no more than [`LONGEST`] times as long there as here.
fn quick_enough(told: &str) -> Result<String, String> {
    let mut there: Vec<f64> = told.lines().filter_map(|line| line.trim().parse().ok()).collect();
    if there.len() != ROUNDS {
        return Err(format!("the map was timed {} times instead of {ROUNDS}", there.len()));
    }
    let mut here: Vec<f64> = (0..ROUNDS).map(|_| time_of_map().as_secs_f64() * 1e3).collect();
    let median = |times: &mut [f64]| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    };
    let (there, here) = (median(&mut there), median(&mut here));
    let told = format!(
        "time of that map: {there:.1} ms in WebAssembly, {here:.1} ms here on one thread: {:.2} times as long",
        there / here
    );
    if there <= LONGEST * here { Ok(told) } else { Err(told) }
}
