//! What midair is asked for in WebAssembly and on this machine alike.
//!
//! Each task gives numbers. In WebAssembly they are reached by plain functions ([`exports`]); on this machine by [`TASKS`].

mod tasks;

pub use tasks::{TASKS, Task, time_of_map};

/// The module's functions, in the C ABI: what a host calls.
#[cfg(target_arch = "wasm32")]
pub mod exports {
    use super::{TASKS, time_of_map};
    use std::sync::Mutex;
    use std::time::Duration;

    #[link(wasm_import_module = "host")]
    unsafe extern "C" {
        /// Milliseconds since some moment.
        safe fn now() -> f64;
    }

    static FINDINGS: Mutex<Vec<f64>> = Mutex::new(Vec::new());

    /// Runs a task; how many numbers it gave.
    #[unsafe(no_mangle)]
    pub extern "C" fn run(task: u32) -> u32 {
        lend_clock();
        let found = (TASKS[task as usize].run)();
        let mut findings = FINDINGS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        *findings = found;
        findings.len() as u32
    }

    /// Milliseconds that the map of the paper's ball takes.
    #[unsafe(no_mangle)]
    pub extern "C" fn map_time() -> f64 {
        lend_clock();
        time_of_map().as_secs_f64() * 1e3
    }

    fn lend_clock() {
        midair::clock::lend(|| Duration::from_secs_f64(now() / 1e3));
    }

    /// Where the numbers of the last task lie.
    #[unsafe(no_mangle)]
    pub extern "C" fn findings() -> *const f64 {
        FINDINGS.lock().unwrap_or_else(std::sync::PoisonError::into_inner).as_ptr()
    }
}
