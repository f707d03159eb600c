//! The Python package beside the library: the same work by both faces, in a Python process that lives through the run.

use super::rows::{Done, Row, Sizes, Work};
use super::{Outcome, set_ups};
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Its rows, by the script's names for them.
pub fn rows(sizes: &Sizes) -> Vec<Row> {
    let [often, some, _] = sizes.rounds;
    let row = |what: &'static str, name: &str, rounds| {
        let mut row = Row::new(name, rounds, move || work(what));
        row.watch_memory = false;
        row
    };
    vec![
        row("map", "map, sphere, in Python", often),
        row("forward", &format!("{}, in Python", super::rows::FORWARD), some),
    ]
}

/// Asks the process for one run at a time; it tells the seconds that it took.
fn work(what: &'static str) -> Outcome<Work> {
    let root = set_ups::root();
    let mut child = Command::new(root.join("target/python/environment/bin/python3"))
        .arg(root.join("xtask/peers/python_times.py"))
        .arg(root.join("scenes/paper"))
        .env("PYTHONPATH", root.join("target/python/release"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let mut to = child.stdin.take().ok_or("no input")?;
    let mut from = BufReader::new(child.stdout.take().ok_or("no output")?);
    Ok(Box::new(move || {
        // It ends when its input does.
        writeln!(to, "{what}")?;
        let mut line = String::new();
        from.read_line(&mut line)?;
        let seconds = line.trim().parse().map_err(|_| format!("Python's answer: {line:?}"))?;
        Ok(Done { time: Some(Duration::from_secs_f64(seconds)), ..Done::default() })
    }))
}
