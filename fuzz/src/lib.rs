//! What the fuzzer's targets share.
//!
//! A target's first byte says how the rest is read; the tests that lay down its corpus (`midair_peers::corpus`) write the same.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    static LAST: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Runs a reader. Panics that the library catches itself, those of decoders that it does not trust, are no finds; libFuzzer would end at each.
///
/// # Panics
/// By aborting, where a panic comes out: that is a find.
pub fn reader(read: impl FnOnce()) {
    static HUSHED: Once = Once::new();
    HUSHED.call_once(|| {
        std::panic::set_hook(Box::new(|told| {
            LAST.with(|last| *last.borrow_mut() = told.to_string())
        }));
    });
    if catch_unwind(AssertUnwindSafe(read)).is_err() {
        LAST.with(|last| eprintln!("{}", last.borrow()));
        std::process::abort();
    }
}

/// The first byte and the rest.
pub fn chosen(data: &[u8]) -> Option<(u8, &[u8])> {
    data.split_first().map(|(&first, rest)| (first, rest))
}

/// Checks an error's message as people see it.
///
/// # Panics
/// Where it does not name the file.
pub fn told(error: &impl std::fmt::Display, file: &str) {
    assert!(error.to_string().contains(file), "{error}");
}
