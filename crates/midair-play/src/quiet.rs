//! Drivers and the libraries under them write to standard error what they miss ("XDG_RUNTIME_DIR is invalid or not set"), whether or not a
//! device is found. What matters comes as an error of the device.

/// Does something while standard error leads nowhere; not where somebody asks Vulkan's loader for its log.
#[cfg(unix)]
pub(crate) fn quietly<T>(work: impl FnOnce() -> T) -> T {
    use std::os::fd::{AsFd as _, OwnedFd};

    /// Standard error as it was, put back however the work ends.
    struct Kept(OwnedFd);

    impl Drop for Kept {
        fn drop(&mut self) {
            // There is nowhere left to tell a failure.
            let _ = nix::unistd::dup2_stderr(&self.0);
        }
    }

    let shut = || {
        let kept = std::io::stderr().as_fd().try_clone_to_owned().ok()?;
        let nowhere = std::fs::File::options().write(true).open("/dev/null").ok()?;
        nix::unistd::dup2_stderr(&nowhere).ok()?;
        Some(Kept(kept))
    };
    let _kept = std::env::var_os("VK_LOADER_DEBUG").is_none().then(shut);
    work()
}

/// Elsewhere they are silent.
#[cfg(not(unix))]
pub(crate) fn quietly<T>(work: impl FnOnce() -> T) -> T {
    work()
}
