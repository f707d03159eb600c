//! Work without Python's lock, on threads of this process.

use midair::Monitor;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

thread_local! {
    /// Threads that work begun by this thread is done on; 0: one for each core.
    static WANTED: Cell<usize> = const { Cell::new(0) };
}

/// A pool for each process and number of threads. After a fork the parent's threads are gone, and whoever waited for them would wait for
/// ever: a child has pools of its own. The parent's are left alone.
static POOLS: Mutex<Vec<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

fn pool() -> PyResult<Arc<ThreadPool>> {
    let (process, wanted) = (std::process::id(), WANTED.get());
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((.., pool)) = pools.iter().find(|(p, w, _)| (*p, *w) == (process, wanted)) {
        return Ok(Arc::clone(pool));
    }
    let built = ThreadPoolBuilder::new().num_threads(wanted).build();
    let pool = Arc::new(built.map_err(|error| {
        pyo3::exceptions::PyRuntimeError::new_err(format!("no threads can be had: {error}"))
    })?);
    pools.push((process, wanted, Arc::clone(&pool)));
    Ok(pool)
}

/// Does work on all threads, while other threads of Python go on.
pub fn work<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = pool()?;
    Ok(py.detach(|| pool.install(work)))
}

/// Whether somebody pressed Ctrl-C.
#[derive(Default)]
pub struct Watch(AtomicBool);

impl Monitor for Watch {
    fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// How often Ctrl-C is looked for.
const LOOK: Duration = Duration::from_millis(50);

/// As [`work`], for work that takes long and stops when its monitor says so: Ctrl-C raises what Python makes of it.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<T> {
    let pool = pool()?;
    let watch = Watch::default();
    py.detach(|| {
        std::thread::scope(|scope| {
            let (done, found) = channel();
            let watch = &watch;
            let worker = scope.spawn(move || {
                // Nobody but the loop below receives, and it waits.
                let _ = done.send(pool.install(|| work(watch)));
            });
            let mut interrupted = None;
            loop {
                match found.recv_timeout(LOOK) {
                    Ok(found) => break interrupted.map_or(Ok(found), Err),
                    Err(RecvTimeoutError::Timeout) => {
                        if let Err(error) = Python::attach(|py| py.check_signals()) {
                            watch.0.store(true, Ordering::Relaxed);
                            interrupted = Some(error);
                        }
                    }
                    // The work panicked: its panic is passed on.
                    Err(RecvTimeoutError::Disconnected) => match worker.join() {
                        Err(panic) => std::panic::resume_unwind(panic),
                        Ok(()) => unreachable!("the work ended without a result"),
                    },
                }
            }
        })
    })
}

/// Sets how many threads midair uses for work that the calling thread begins.
///
/// None: one for each core, or as many as RAYON_NUM_THREADS says.
#[pyfunction]
#[pyo3(signature = (count=None))]
pub fn use_threads(count: Option<u16>) {
    WANTED.set(count.unwrap_or(0).into());
}

/// How many threads midair uses for work that the calling thread begins.
#[pyfunction]
pub fn thread_count() -> PyResult<usize> {
    Ok(pool()?.current_num_threads())
}
