//! Where the program's files go: none over what the run reads, and none half-made if it is interrupted.

use crate::failure::Failure;
use midair::files::{Inputs, Kept, Output, remove_unfinished};
use midair::map::format::FileError;
use serde_json::Value;
use std::ffi::OsString;
use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{LazyLock, Mutex};

/// The files that this run reads.
static INPUTS: LazyLock<Inputs> = LazyLock::new(Inputs::default);

/// The files that this run reads: whatever reads one adds it.
pub fn inputs() -> &'static Inputs {
    &INPUTS
}

/// Files for a folder, as [`Output::into_folder`].
pub fn into_folder(folder: &Path) -> Result<Output, Failure> {
    Ok(Output::into_folder(folder, inputs())?)
}

/// One file, as [`Output::of_file`].
pub fn of_file(path: &Path) -> Result<(Output, OsString), Failure> {
    Ok(Output::of_file(path, inputs())?)
}

/// The pieces of work on a folder's files, kept until it is complete; see [`Kept::begin`]. The folder is made if need be.
pub fn keep_for_folder(folder: &Path, work: &Value, resume: bool) -> Result<Kept, Failure> {
    std::fs::create_dir_all(folder).map_err(|error| FileError::io(folder, "create", error))?;
    // A name of its own, whatever is written: `.`, `a/..`.
    let folder = folder.canonicalize().map_err(|error| FileError::io(folder, "find", error))?;
    Ok(Kept::begin(&folder, &format!("{work:#}\n"), resume, inputs())?)
}

/// Whether work is under way that keeps what it has when it is interrupted.
static STOPPABLE: AtomicBool = AtomicBool::new(false);
/// Whether it was.
static STOP: AtomicBool = AtomicBool::new(false);

/// What a shell reports for a program ended by an interrupt.
pub const INTERRUPTED: u8 = 130;

/// The flag that an interrupt sets from now on, for work that watches it and keeps what it has. A second interrupt
/// ends the program.
pub fn stop_on_interrupt() -> &'static AtomicBool {
    STOPPABLE.store(true, Ordering::SeqCst);
    &STOP
}

/// Whether the work is to stop.
pub fn is_stopped() -> bool {
    STOP.load(Ordering::SeqCst)
}

/// What is said if the program is interrupted.
static FAREWELL: Mutex<Option<&'static str>> = Mutex::new(None);

/// Has an interrupt say something.
pub fn on_interrupt_say(farewell: &'static str) {
    if let Ok(mut text) = FAREWELL.lock() {
        *text = Some(farewell);
    }
}

/// On Ctrl-C (and on a request to end) unfinished files are removed before the program ends.
pub fn clean_up_on_interrupt() {
    // If no handler can be set an interrupt leaves a hidden folder behind, which harms nobody.
    let _ = ctrlc::set_handler(|| {
        if STOPPABLE.load(Ordering::SeqCst) && !STOP.swap(true, Ordering::SeqCst) {
            return;
        }
        remove_unfinished();
        if let Ok(Some(farewell)) = FAREWELL.lock().map(|text| *text) {
            // A closed standard error is no reason to stay.
            let _ = writeln!(std::io::stderr(), "\n{farewell}");
        }
        std::process::exit(INTERRUPTED.into());
    });
}
