//! The table of times and memory that `cargo xtask bench` prints, as Markdown.
//!
//! Rows run interleaved: each round runs every row once, so that whatever else the machine does in a while hits all
//! of them alike. A row's figure is the median of its rounds. Its memory is the highest resident size of a
//! process of its own that does nothing else.

mod live;
mod memory;
mod mitsuba;
mod python;
mod rows;
mod set_ups;
mod warp;

use rows::{Row, Sizes};
use std::error::Error;
use std::time::{Duration, Instant};

/// The option that names the bunny's mesh.
const BUNNY: &str = "--bunny";

/// Anything that goes wrong in a row ends the run.
type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |flag: &str| arguments.iter().any(|a| a == flag);
    let value = |flag: &str| {
        let at = arguments.iter().position(|a| a == flag)?;
        arguments.get(at + 1).cloned()
    };
    if let Some(at) = arguments.iter().position(|a| a == memory::WATCH) {
        return memory::watch(&arguments[at + 1..]);
    }
    let sizes = if has("--quick") { Sizes::QUICK } else { Sizes::FULL };
    if let Some(name) = value(memory::ONCE) {
        let mut rows = rows::of_midair(&sizes);
        rows.extend(warp::rows(&sizes));
        rows.extend(live::rows(&sizes));
        rows.extend(value(BUNNY).map(|file| rows::bunny(file.into())));
        return match rows.into_iter().find(|row| row.name == name) {
            Some(row) => {
                row.prepare()?()?;
                Ok(())
            }
            None => Err(format!("no row `{name}`").into()),
        };
    }
    // `cargo test --all-targets` runs benchmarks too, but without this flag: they must only start.
    if !has("--bench") {
        return Ok(());
    }
    let mut rows = rows::of_midair(&sizes);
    rows.extend(warp::rows(&sizes));
    rows.extend(live::rows(&sizes));
    rows.extend(python::rows(&sizes));
    if has("--with-mitsuba") {
        rows.extend(mitsuba::rows(&sizes));
    }
    let bunny = value(BUNNY);
    rows.extend(bunny.as_ref().map(|file| rows::bunny(file.into())));
    if let Some(only) = value("--only") {
        rows.retain(|row| row.name.contains(&only));
    }
    if rows.is_empty() {
        return Err("no row has such a name".into());
    }
    print_table(&rows, &measure(&rows, &sizes, bunny.as_deref())?);
    Ok(())
}

/// What was measured of a row.
struct Figures {
    median: Duration,
    best: Duration,
    /// KiB; `None` where it cannot be told.
    peak: Option<u64>,
    remark: String,
    rounds: usize,
}

fn measure(rows: &[Row], sizes: &Sizes, bunny: Option<&str>) -> Outcome<Vec<Figures>> {
    let mut works = rows.iter().map(Row::prepare).collect::<Outcome<Vec<_>>>()?;
    let mut times: Vec<Vec<Duration>> = vec![Vec::new(); rows.len()];
    let mut remarks = vec![String::new(); rows.len()];
    let rounds = rows.iter().map(|row| row.rounds).max().unwrap_or(0);
    for round in 0..=rounds {
        eprint!("\rround {round} of {rounds} ");
        for (index, row) in rows.iter().enumerate() {
            // Round 0 warms up the rows that can afford it. Rows of fewer rounds are spread over all of them.
            let warm_up = round == 0 && row.rounds > 3;
            let due =
                round > 0 && (round * row.rounds) / rounds > ((round - 1) * row.rounds) / rounds;
            if !warm_up && !due {
                continue;
            }
            let start = Instant::now();
            let done = works[index]()?;
            let time = done.time.unwrap_or_else(|| start.elapsed());
            remarks[index] = done.remark;
            if due {
                times[index].push(time.mul_f64(row.extrapolated));
            }
        }
    }
    eprintln!();
    drop(works);
    rows.iter()
        .zip(times)
        .zip(remarks)
        .map(|((row, mut times), remark)| {
            times.sort_unstable();
            Ok(Figures {
                median: times[times.len() / 2],
                best: times[0],
                peak: if row.watch_memory {
                    memory::peak_of_row(&row.name, sizes, bunny)?
                } else {
                    None
                },
                remark,
                rounds: times.len(),
            })
        })
        .collect()
}

fn print_table(rows: &[Row], figures: &[Figures]) {
    let milliseconds = |time: Duration| {
        let t = time.as_secs_f64() * 1e3;
        if t < 100.0 { format!("{t:.2}") } else { format!("{t:.0}") }
    };
    let unit = rows.iter().position(|row| row.name == rows::UNIT).map(|i| figures[i].median);
    println!("{}\n", machine());
    println!("| what | median, ms | best, ms | rounds | × {} | peak memory, MiB | |", rows::UNIT);
    println!("| --- | ---: | ---: | ---: | ---: | ---: | --- |");
    for (row, figures) in rows.iter().zip(figures) {
        let ratio = unit.map_or_else(String::new, |unit| {
            format!("{:.3}", figures.median.as_secs_f64() / unit.as_secs_f64())
        });
        let peak =
            figures.peak.map_or_else(String::new, |kib| format!("{:.0}", kib as f64 / 1024.0));
        let mut remark = figures.remark.clone();
        if row.extrapolated != 1.0 {
            remark = format!("extrapolated × {:.1}; {remark}", row.extrapolated);
        }
        println!(
            "| {} | {} | {} | {} | {ratio} | {peak} | {remark} |",
            row.name,
            milliseconds(figures.median),
            milliseconds(figures.best),
            figures.rounds,
        );
    }
}

/// The processor and what midair uses of it.
fn machine() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split(": ").nth(1))
        .unwrap_or("unknown processor");
    format!(
        "{model}, {} threads, midair {}",
        rayon::current_num_threads(),
        env!("CARGO_PKG_VERSION")
    )
}
