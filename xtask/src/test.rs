//! `cargo xtask test`: everything that must hold before a change is merged.

use crate::{blender, book, fuzz, process, python, setup, studio, wasm};
use anyhow::{Context, Result, anyhow};
use clap::{Args, ValueEnum};
use midair_peers::Peer;
use std::collections::BTreeSet;
use std::process::Command;
use std::time::Instant;

#[derive(Args)]
pub struct Options {
    /// Run only this step; may be given several times.
    #[arg(long, value_name = "STEP")]
    only: Vec<Step>,
    /// Peers that may be missing, separated by commas: then tests that need them are skipped, and counted. All others are required.
    #[arg(long, value_name = "PEERS", value_delimiter = ',')]
    optional: Vec<Peer>,
}

/// The steps, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Step {
    /// Install what tests need.
    Setup,
    /// The code is formatted.
    Fmt,
    /// Clippy has nothing to say.
    Clippy,
    /// Unit, integration and documentation tests.
    Tests,
    /// The API's documentation builds without a warning.
    Docs,
    /// The library packages, and the package builds.
    Package,
    /// The commands of the README and the book do what they say.
    Book,
    /// The Python package does what it says, and its notebooks run.
    Python,
    /// The library does the same in WebAssembly as here.
    Wasm,
    /// The studio's page, in a browser.
    Studio,
    /// Blender's extension, installed and used.
    Blender,
    /// What reads files is fuzzed for some tens of seconds; only where it is named.
    Fuzz,
}

/// How many checks went which way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    pub passed: usize,
    pub failed: usize,
    /// Counted by the test runner as passed, but not here.
    pub skipped: usize,
}

impl Tally {
    /// One check.
    pub fn of(outcome: Result<()>) -> Self {
        match outcome {
            Ok(()) => Self { passed: 1, ..Self::default() },
            Err(error) => {
                println!("FAILED: {error:#}");
                Self { failed: 1, ..Self::default() }
            }
        }
    }

    /// Runs a program that tests, and counts what each of its lines says. Where it failed without a word, or ran no test, that is one failure more.
    pub fn watched(command: &mut Command, mut count: impl FnMut(&mut Self, &str)) -> Self {
        let mut tally = Self::default();
        let status = process::run_watched(command, |line| count(&mut tally, line));
        let name = process::shown(command);
        match status {
            Ok(_) if tally.failed > 0 => {}
            Ok(status) if !status.success() => {
                tally.add(Self::of(Err(anyhow!("`{name}` failed ({status})"))));
            }
            Ok(_) if tally.passed == 0 => {
                let problem = anyhow!("no test ran: has what `{name}` prints changed?");
                tally.add(Self::of(Err(problem)));
            }
            Ok(_) => {}
            Err(error) => tally.add(Self::of(Err(error))),
        }
        tally
    }

    pub fn add(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }
}

/// Runs the steps, all of them even if one fails; whether all passed. What is installed comes by the network, while the compiler has the processor: the first
/// steps that need none of it run beside.
pub fn run(options: &Options) -> Result<bool> {
    let mut total = Tally::default();
    let mut failed = Vec::new();
    let mut account = |step: Step, tally: Tally| {
        if tally.failed > 0 {
            failed.push(step.name());
        }
        total.add(tally);
    };
    let wanted = |step: &&Step| step.is_wanted(&options.only);
    let (first, rest): (Vec<&Step>, Vec<&Step>) =
        Step::value_variants().iter().filter(wanted).partition(|step| step.needs_no_setup());
    let is_setup = |step: &&Step| **step == Step::Setup;
    std::thread::scope(|scope| {
        let setup = rest.iter().copied().find(is_setup);
        let setup = setup.map(|step| (*step, scope.spawn(|| step.timed(&options.optional))));
        for step in first {
            account(*step, step.timed(&options.optional));
        }
        if let Some((step, setup)) = setup {
            let ended = setup.join().unwrap_or_else(|_| Tally::of(Err(anyhow!("a panic"))));
            account(step, ended);
        }
    });
    for step in rest.into_iter().filter(|step| !is_setup(step)) {
        account(*step, step.timed(&options.optional));
    }
    println!();
    if !failed.is_empty() {
        println!("failed steps: {}", failed.join(", "));
    }
    println!("{total}");
    Ok(total.failed == 0)
}

impl Step {
    /// Whether it is among the steps that were named; all are but those that are only run by name.
    fn is_wanted(self, named: &[Self]) -> bool {
        // Built from nothing with coverage counters, the fuzzer takes minutes that the whole run has no room for.
        (named.is_empty() && self != Self::Fuzz) || named.contains(&self)
    }

    /// Its name on the command line.
    fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    /// Whether it can run before anything is installed.
    fn needs_no_setup(self) -> bool {
        matches!(self, Self::Fmt | Self::Clippy)
    }

    /// Runs it, and says so.
    fn timed(self, optional: &[Peer]) -> Tally {
        let name = self.name();
        println!("\n== {name}");
        let start = Instant::now();
        let tally = self.run(optional);
        println!("-- {name}: {:.0} s", start.elapsed().as_secs_f64());
        tally
    }

    fn run(self, optional: &[Peer]) -> Tally {
        match self {
            Self::Setup => Tally::of(setup::install(optional)),
            Self::Fmt => Tally::of(cargo(&["fmt", "--all", "--check"])),
            Self::Clippy => Tally::of(process::run(
                process::cargo(&["clippy", "--quiet", "--all-targets"])
                    .args(process::WHOLE)
                    .args(["--", "-Dwarnings"]),
            )),
            Self::Tests => tests(optional),
            Self::Docs => Tally::of(process::run(
                process::cargo(&["doc", "--quiet", "--no-deps"])
                    .args(process::WHOLE)
                    .env("RUSTDOCFLAGS", "-Dwarnings"),
            )),
            Self::Package => Tally::of(package()),
            Self::Book => {
                // The same features as the tests had: there is nothing left to build after them.
                match python::assemble() {
                    Ok(()) => book::run(),
                    built => Tally::of(built),
                }
            }
            Self::Python => python::test(),
            Self::Wasm => wasm::run(),
            Self::Studio => studio::test(),
            Self::Blender => blender::test(optional),
            Self::Fuzz => fuzz::test(),
        }
    }
}

/// Packages the library, and type-checks what is in the package: to generate its code as well would take minutes, and the tests did it.
fn package() -> Result<()> {
    cargo(&["package", "--quiet", "--package", "midair", "--allow-dirty", "--no-verify"])?;
    let target = crate::root().join("target");
    // All packages of the workspace have one version.
    let archive = target.join(format!("package/midair-{}.crate", env!("CARGO_PKG_VERSION")));
    // Elsewhere: within the workspace it would be taken for a part of it.
    let unpacked = tempfile::tempdir()?;
    process::run(
        Command::new("tar")
            .args(["--extract", "--strip-components=1", "--file"])
            .arg(&archive)
            .current_dir(unpacked.path()),
    )?;
    let mut check = process::cargo(&["check", "--quiet", "--manifest-path"]);
    check.arg(unpacked.path().join("Cargo.toml")).arg("--target-dir").arg(&target);
    process::run(&mut check)
}

fn cargo(arguments: &[&str]) -> Result<()> {
    process::run(&mut process::cargo(arguments))
}

/// All tests of the workspace, documentation tests among them.
fn tests(optional: &[Peer]) -> Tally {
    let skips = std::env::temp_dir().join(format!("midair-skips-{}", std::process::id()));
    let mut command = process::cargo(&["test", "--quiet", "--no-fail-fast"]);
    command.args(process::WHOLE);
    command.env(midair_peers::REQUIRED, required(optional)).env(midair_peers::SKIPS, &skips);
    command.env(midair_peers::corpus::CORPUS, fuzz::seeds());
    let mut tally = Tally::watched(&mut command, |tally, line| {
        if let Some(counts) = read_result(line) {
            tally.add(counts);
        }
    });
    match take_skips(&skips) {
        Ok(skipped) => {
            for line in &skipped {
                println!("skipped: {line}");
            }
            tally.passed = tally.passed.saturating_sub(skipped.len());
            tally.skipped += skipped.len();
        }
        Err(error) => tally.add(Tally::of(Err(error))),
    }
    tally
}

/// The peers that tests must find.
fn required(optional: &[Peer]) -> String {
    let wanted = Peer::ALL.into_iter().filter(|peer| !optional.contains(peer));
    wanted.map(Peer::name).collect::<Vec<_>>().join(",")
}

/// What tests wrote of the peers that they missed, each test once; the file is removed.
fn take_skips(file: &std::path::Path) -> Result<BTreeSet<String>> {
    if !file.exists() {
        return Ok(BTreeSet::new());
    }
    let text = std::fs::read_to_string(file).with_context(|| format!("{}", file.display()))?;
    std::fs::remove_file(file)?;
    let mut seen = BTreeSet::new();
    // A test that asks twice is skipped once.
    let first = |line: &&str| seen.insert(line.split('\t').next().unwrap_or_default().to_owned());
    Ok(text.lines().filter(first).map(|line| line.replace('\t', ": ")).collect())
}

impl std::fmt::Display for Tally {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            formatter,
            "{} passed, {} failed, {} skipped",
            self.passed, self.failed, self.skipped
        )
    }
}

/// The counts in a test runner's line `test result: ok. 3 passed; 0 failed; ...`.
fn read_result(line: &str) -> Option<Tally> {
    let counts = line.trim().strip_prefix("test result: ")?;
    let count = |word: &str| {
        let before = counts.split(word).next()?;
        before.split_whitespace().next_back()?.parse().ok()
    };
    Some(Tally { passed: count(" passed;")?, failed: count(" failed;")?, skipped: 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_runner_s_summary_is_counted() {
        let line = "test result: FAILED. 12 passed; 3 failed; 1 ignored; 0 measured; 7 filtered \
                    out; finished in 0.10s\n";
        let tally = Tally { passed: 12, failed: 3, skipped: 0 };
        assert_eq!(read_result(line), Some(tally));
        assert_eq!(tally.to_string(), "12 passed, 3 failed, 0 skipped");
        assert_eq!(read_result("running 15 tests"), None);
        assert_eq!(read_result("test result: nonsense"), None);
    }

    #[test]
    fn skips_are_counted_once_a_test() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("skips");
        assert!(take_skips(&file).unwrap().is_empty());
        let text = "a::b\tffmpeg\tnone\na::c\tffmpeg\tnone\na::b\tpython\tneither\n";
        std::fs::write(&file, text).unwrap();
        let skips: Vec<_> = take_skips(&file).unwrap().into_iter().collect();
        assert_eq!(skips, ["a::b: ffmpeg: none", "a::c: ffmpeg: none"]);
        assert!(!file.exists());
    }

    #[test]
    fn all_peers_are_required_but_those_left_out() {
        let list = required(&[Peer::Blender]);
        let named: Vec<Peer> = list.split(',').map(|name| name.parse().unwrap()).collect();
        assert_eq!(named.len(), Peer::ALL.len() - 1);
        assert!(!named.contains(&Peer::Blender) && named.contains(&Peer::Ffmpeg));
    }
}
