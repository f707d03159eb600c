//! Who watches long work: how far it is, whether it is to stop.

/// Watches long work. Its methods are called from any thread; each does nothing unless it is told to.
pub trait Monitor: Sync {
    /// A stage of so many steps begins.
    fn stage(&self, _name: &str, _steps: usize) {}
    /// So many steps of it are done.
    fn advance(&self, _steps: usize) {}
    /// Whether the work is to stop as soon as it can.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Nobody.
impl Monitor for () {}
