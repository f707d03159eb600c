//! The peak resident memory of one row, measured on a process that does nothing else.

use super::{Outcome, Sizes};
use nix::sys::resource::{UsageWho, getrusage};
use std::process::{Command, Stdio};

/// Flag: run the command that follows and print the peak of its resident memory, in KiB.
pub const WATCH: &str = "--watch-memory-of";
/// Flag: prepare the row of this name, run it once, and end.
pub const ONCE: &str = "--once";

/// Runs a command as our only child, so that the system's peak over all children is that child's.
pub fn watch(command: &[String]) -> Outcome<()> {
    let [program, arguments @ ..] = command else {
        return Err("no command to watch".into());
    };
    let status = Command::new(program).args(arguments).stdout(Stdio::null()).status()?;
    if !status.success() {
        return Err(format!("`{program}` failed ({status})").into());
    }
    println!("{}", getrusage(UsageWho::RUSAGE_CHILDREN)?.max_rss());
    Ok(())
}

/// The peak of a row in KiB; `None` on systems that count in other units.
pub fn peak_of_row(name: &str, sizes: &Sizes, bunny: Option<&str>) -> Outcome<Option<u64>> {
    if !cfg!(target_os = "linux") {
        return Ok(None);
    }
    let this = std::env::current_exe()?;
    let mut command = Command::new(&this);
    command.arg(WATCH).arg(&this).args([ONCE, name]);
    if sizes.quick {
        command.arg("--quick");
    }
    if let Some(file) = bunny {
        command.args([super::BUNNY, file]);
    }
    let output = command.stderr(Stdio::inherit()).output()?;
    if !output.status.success() {
        return Err(format!("the memory of `{name}` cannot be measured").into());
    }
    Ok(Some(String::from_utf8(output.stdout)?.trim().parse()?))
}
