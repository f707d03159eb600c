//! `cargo xtask fuzz`: what reads people's files, under libFuzzer: inputs are changed towards those that reach code that none has reached.
//!
//! The package `fuzz` is built apart from the workspace, with LLVM's coverage counters in all of it. They are what `cargo fuzz` asks for, too; but its
//! sanitizers need a nightly compiler, and midair has next to no unsafe code for them to look at, so a stable compiler without them will do. The corpus
//! begins with what the tests read (`midair_peers::corpus`).

use crate::process;
use crate::test::Tally;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

#[derive(Args)]
pub struct Options {
    /// Seconds for each target.
    #[arg(long, default_value_t = 60)]
    seconds: u32,
    /// Only this target; may be given several times.
    #[arg(long, value_name = "TARGET")]
    target: Vec<Target>,
    /// Run the targets on these inputs instead, to see what a find is.
    #[arg(value_name = "INPUT")]
    inputs: Vec<PathBuf>,
}

/// What is fuzzed: a program of the package `fuzz` each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Target {
    /// Mesh files, up to the normals.
    Meshes,
    /// Pictures.
    Pictures,
    /// Maps of all formats.
    Maps,
    /// Scene text, and the same scene saved and read again.
    Scenes,
    /// Glass files and measured tables.
    Tables,
}

impl Target {
    fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }
}

/// LLVM's instrumentation for libFuzzer, as cargo-fuzz has it without a sanitizer: edges counted in 8 bits, comparisons traced.
const FLAGS: &str = "--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares";

/// In the tests' run, where all targets go side by side.
const SECONDS_IN_TESTS: u32 = 20;

/// The folder of what tests read, by targets.
pub fn seeds() -> PathBuf {
    crate::root().join("target/fuzz-corpus/seeds")
}

/// Fuzzes; whether nothing was found.
pub fn run(options: &Options) -> Result<bool> {
    let targets = match options.target.as_slice() {
        [] => Target::value_variants(),
        asked => asked,
    };
    let folder = build()?;
    let mut sound = true;
    for target in targets {
        let program = folder.join(target.name());
        if options.inputs.is_empty() {
            lay_down_seeds()?;
            sound &= fuzz(*target, &program, options.seconds)?;
        } else {
            let inputs = options.inputs.iter().map(std::path::absolute);
            let inputs = inputs.collect::<std::io::Result<Vec<_>>>()?;
            sound &= Command::new(&program).args(LIMITS).args(inputs).status()?.success();
        }
    }
    Ok(sound)
}

/// The step of `cargo xtask test`: some seconds for each target, one check each.
pub fn test() -> Tally {
    let mut tally = Tally::default();
    let folder = match build().and_then(|folder| lay_down_seeds().map(|()| folder)) {
        Ok(folder) => folder,
        Err(error) => return Tally::of(Err(error)),
    };
    std::thread::scope(|scope| {
        let start = |target: &Target| {
            let (target, program) = (*target, folder.join(target.name()));
            (target, scope.spawn(move || fuzz(target, &program, SECONDS_IN_TESTS)))
        };
        let under_way: Vec<_> = Target::value_variants().iter().map(start).collect();
        for (target, fuzzing) in under_way {
            let outcome = fuzzing.join().unwrap_or_else(|_| bail!("a panic"));
            tally.add(Tally::of(outcome.and_then(|sound| match sound {
                true => Ok(()),
                false => bail!("the target {} has a find", target.name()),
            })));
        }
    });
    tally
}

/// Builds the targets; the folder that they are in.
fn build() -> Result<PathBuf> {
    // A target that is named keeps the flags from build scripts and macros.
    let host = process::output(Command::new("rustc").arg("-vV"))?;
    let host = host.lines().find_map(|line| line.strip_prefix("host: "));
    let host = host.context("rustc -vV does not tell its host")?;
    let place = crate::root().join("target/fuzz");
    let mut command = process::cargo(&["build", "--quiet", "--release", "--bins", "--locked"]);
    command.args(["--manifest-path", "fuzz/Cargo.toml", "--target", host, "--target-dir"]);
    process::run(command.arg(&place).env("RUSTFLAGS", FLAGS))?;
    Ok(place.join(host).join("release"))
}

/// Has the library's tests lay down what they read, unless they have.
fn lay_down_seeds() -> Result<()> {
    let missing = |target: &Target| !seeds().join(target.name()).is_dir();
    if Target::value_variants().iter().any(missing) {
        let mut command =
            process::cargo(&["test", "--quiet", "--package", "midair", "--lib", "--tests"]);
        process::run(command.env(midair_peers::corpus::CORPUS, seeds()))?;
    }
    Ok(())
}

/// What an input may take: seconds, and megabytes. The largest picture that is read takes 2 GiB.
const LIMITS: [&str; 2] = ["-timeout=20", "-rss_limit_mb=5000"];

/// Runs one target; whether nothing was found.
fn fuzz(target: Target, program: &Path, seconds: u32) -> Result<bool> {
    let name = target.name();
    let [corpus, finds] = ["corpus", "finds"]
        .map(|kind| crate::root().join("target").join(format!("fuzz-{kind}")).join(&name));
    for folder in [&corpus, &finds] {
        std::fs::create_dir_all(folder).with_context(|| format!("{}", folder.display()))?;
    }
    let mut command = Command::new(program);
    command.args(LIMITS).args(["-max_len=32768", "-print_final_stats=1", "-verbosity=0"]);
    command.arg(format!("-max_total_time={seconds}"));
    command.arg(format!("-artifact_prefix={}/", finds.display()));
    let output = command.arg(&corpus).arg(seeds().join(&name)).stdin(Stdio::null()).output();
    let output = output.with_context(|| format!("cannot run `{}`", process::shown(&command)))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let runs = said.lines().find_map(|line| line.strip_prefix("stat::number_of_executed_units:"));
    let runs: u64 = runs.and_then(|runs| runs.trim().parse().ok()).unwrap_or(0);
    if output.status.success() && runs > 0 {
        println!("{name}: {runs} inputs in {seconds} s, no find");
        return Ok(true);
    }
    println!("{said}");
    println!("see it again: cargo xtask fuzz --target {name} FILE (from {})", finds.display());
    Ok(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_is_a_program_of_the_package() {
        let manifest = std::fs::read_to_string(crate::root().join("fuzz/Cargo.toml")).unwrap();
        for target in Target::value_variants() {
            let name = target.name();
            assert!(manifest.contains(&format!("path = \"fuzz_targets/{name}.rs\"")), "{name}");
        }
        assert_eq!(manifest.matches("[[bin]]").count(), Target::value_variants().len());
    }
}
